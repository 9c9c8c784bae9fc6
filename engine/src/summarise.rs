//! The summary of a run, from the world as the run has left it.

use aerobot_components::body::Body;
use aerobot_components::state::{AngularVelocity, Attitude, Position, Velocity};
use aerobot_systems::forces::body_drag::BeyondMorrison;
use bevy_ecs::world::World;

use crate::builtin::recorder::Recorder;
use crate::recording::summary::{EventRow, FinalState, LargestTension, Stop, Summary, VERSION};
use crate::simulation::Simulation;
use crate::world::{EntityName, EventLog, SceneEntities, Warnings};

impl Simulation {
    /// The summary of a run that has ended, or was stopped.
    pub(crate) fn summary(&mut self, stopped: Option<Stop>) -> Summary {
        let cost = self.cost();
        let world = &self.world;
        let recorder = world.resource::<Recorder>();
        let events = world.resource::<EventLog>();
        let largest_tension = recorder
            .largest_tension
            .map(|(tension_n, time_s, segment)| {
                let tether = world.get::<EntityName>(segment.tether);
                LargestTension {
                    tension_n,
                    time_s,
                    tether: tether.map_or_else(String::new, |name| name.0.to_string()),
                    segment: segment.number,
                }
            });
        let has_segments = self.stable_step.step_s.is_finite();
        Summary {
            version: VERSION.into(),
            scene: self.scene.name.clone(),
            seed: self.scene.seed,
            formulation: self.scene.formulation.into(),
            integrator: self.scene.integrator.clone(),
            stable_step_s: has_segments.then_some(self.stable_step.step_s),
            stiffest_segment: has_segments.then(|| self.stable_step.segment.clone()),
            steps: cost.steps,
            implicit_steps: cost.implicit_steps,
            rejected_steps: cost.rejected,
            evaluations: cost.evaluations,
            simulated_s: stopped.as_ref().map_or(self.time_s(), |stop| stop.time_s),
            outcome: if stopped.is_some() { "stopped" } else { "done" }.into(),
            stopped,
            largest_tension,
            events: events.events().iter().map(EventRow::from).collect(),
            events_dropped: events.dropped(),
            final_states: final_states(world),
            warnings: warnings(world),
        }
    }
}

fn final_states(world: &World) -> Vec<FinalState> {
    let bodies = world.resource::<SceneEntities>().in_order().iter();
    bodies
        .filter(|entity| world.get::<Body>(**entity).is_some())
        .filter_map(|entity| {
            Some(FinalState {
                entity: world.get::<EntityName>(*entity)?.0.to_string(),
                position_m: world.get::<Position>(*entity)?.0.to_array(),
                velocity_m_s: world.get::<Velocity>(*entity)?.0.to_array(),
                attitude: world.get::<Attitude>(*entity)?.0.to_array(),
                rate_rad_s: world.get::<AngularVelocity>(*entity)?.0.to_array(),
            })
        })
        .filter(|state| {
            let numbers = state.position_m.iter().chain(&state.velocity_m_s);
            numbers
                .chain(&state.attitude)
                .chain(&state.rate_rad_s)
                .all(|x| x.is_finite())
        })
        .collect()
}

fn warnings(world: &World) -> Vec<String> {
    let mut warnings = world.resource::<Warnings>().0.clone();
    let beyond = world.resource::<BeyondMorrison>().0.iter();
    warnings.extend(
        beyond
            .filter_map(|entity| world.get::<EntityName>(*entity))
            .map(|name| {
                format!(
                    "`{}` has been beyond Re = 1e6, where Morrison's drag coefficient ends; it was \
                     held",
                    name.0
                )
            }),
    );
    warnings
}
