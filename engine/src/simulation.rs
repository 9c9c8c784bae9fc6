//! A simulation: the world of one scene, built, and the loop that runs it.

use aerobot_components::body::Body;
use aerobot_components::run::IntegratorSpec;
use aerobot_components::sampling::Sampling;
use aerobot_components::state::{AngularVelocity, Attitude, Position, StateIndex, Velocity};
use aerobot_systems::clock::Clock;
use aerobot_systems::dynamics::state_vector::StateVector;
use aerobot_systems::environment::EnvironmentModel;
use aerobot_systems::fault::{Fault, FaultSlot};
use aerobot_systems::forces::body_drag::BeyondMorrison;
use aerobot_systems::integration::dormand_prince::DormandPrince;
use aerobot_systems::integration::runge_kutta4::RungeKutta4;
use aerobot_systems::integration::{Cost, Equations, Integrator, StepFailure, Trajectory};
use bevy_ecs::query::QueryState;
use bevy_ecs::schedule::Schedule;
use bevy_ecs::world::World;

use crate::builtin::channels::find_supports;
use crate::builtin::recorder::{Recorder, segment_name};
use crate::evaluation::{
    Evaluation, Integration, IntegrationSlot, WorldEquations, with_integration,
};
use crate::placement;
use crate::plugin::Simulator;
use crate::recording::frame::ResultSink;
use crate::recording::summary::{EventRow, FinalState, LargestTension, Stop, Summary, VERSION};
use crate::scene::{Scene, SceneError, SetupError};
use crate::schedule::{self, EVALUATE, Evaluate, STEP, Step};
use crate::stable_step::{self, StableStep};
use crate::world::{Edges, EntityName, EventLog, SceneEntities, build_world, lay_out_state};

/// RK4 steps of this part of the largest stable one unless the scene says otherwise.
const DEFAULT_PART_OF_STABLE_STEP: f64 = 0.5;
/// Without a tether nothing limits the step of RK4; then it is this, s.
const DEFAULT_STEP_S: f64 = 1e-3;
/// First step of an adaptive integration, as a part of the stable one.
const FIRST_PART_OF_STABLE_STEP: f64 = 0.1;

/// A built simulation.
pub struct Simulation {
    world: World,
    step: Schedule,
    samplings: QueryState<&'static Sampling>,
    duration_s: f64,
    stable_step: StableStep,
    step_s: Option<f64>,
    scene: SceneFacts,
}

/// What the summary says of the scene.
struct SceneFacts {
    name: String,
    seed: u64,
    formulation: &'static str,
    integrator: String,
}

impl Simulator {
    /// Builds the world of a scene and places everything in it.
    ///
    /// # Errors
    /// What cannot be built, rendered: no equilibrium, a step that is not stable, an altitude outside
    /// the atmosphere, an ambiguity between systems.
    pub fn build(&self, scene: &Scene) -> Result<Simulation, SceneError> {
        let mut world = build_world(self, scene).map_err(|error| scene.refuse(error))?;
        let layout = lay_out_state(&mut world);
        let mut evaluation = Evaluation {
            schedule: schedule::build(Evaluate, &EVALUATE, self, scene, &mut world)
                .map_err(unordered)?,
            state: StateVector::new(&mut world, layout),
        };
        let step = schedule::build(Step, &STEP, self, scene, &mut world).map_err(unordered)?;
        placement::place(&mut world, &mut evaluation, scene)
            .map_err(|error| scene.refuse(error))?;
        find_supports(&mut world);
        start_environment(&mut world);
        evaluation.run(&mut world).map_err(|fault| {
            let name = fault.entity.and_then(|entity| owner_name(&world, entity));
            let path = name
                .as_ref()
                .map_or_else(String::new, |name| format!("entities.{name}"));
            let who = name.map_or_else(String::new, |name| format!("`{name}`: "));
            scene.refuse(SetupError::new(path, format!("{who}{}", fault.message), ""))
        })?;
        let stable_step = stable_step::find(&mut world);
        let scales = evaluation.state.error_scales(&mut world);
        let (integrator, step_s) = choose_integrator(scene, &stable_step, scales)?;
        let mut state = vec![0.0; layout.len()];
        evaluation.state.gather(&mut world, &mut state);
        world.insert_resource(IntegrationSlot::new(Integration {
            evaluation,
            integrator,
            trajectory: Trajectory::new(0.0, state),
            limit_s: 0.0,
            failure: None,
        }));
        Ok(Simulation {
            samplings: world.query(),
            world,
            step,
            duration_s: scene.run.duration_s,
            scene: SceneFacts {
                name: scene.name.clone(),
                seed: scene.run.seed,
                formulation: scene.run.formulation.name(),
                integrator: describe(&scene.run.integrator, step_s),
            },
            stable_step,
            step_s,
        })
    }
}

fn unordered(text: String) -> SceneError {
    SceneError::plain(format_args!(
        "the systems of the plugins cannot be ordered: {text}"
    ))
}

/// The wind of the first interval.
fn start_environment(world: &mut World) {
    world
        .resource_mut::<EnvironmentModel>()
        .wind
        .begin_interval(0.0);
}

fn choose_integrator(
    scene: &Scene,
    stable: &StableStep,
    scales: Vec<f64>,
) -> Result<(Box<dyn Integrator>, Option<f64>), SceneError> {
    match scene.run.integrator {
        IntegratorSpec::Adaptive {
            relative_tolerance,
            longest_step_s,
        } => {
            let first_s = (FIRST_PART_OF_STABLE_STEP * stable.step_s).min(DEFAULT_STEP_S);
            let longest_s = longest_step_s.unwrap_or(f64::INFINITY);
            let method = DormandPrince::new(relative_tolerance, scales, first_s, longest_s);
            Ok((Box::new(method), None))
        }
        IntegratorSpec::Fixed { step_s } => {
            let default_s = if stable.step_s.is_finite() {
                DEFAULT_PART_OF_STABLE_STEP * stable.step_s
            } else {
                DEFAULT_STEP_S
            };
            let chosen_s = step_s.unwrap_or(default_s);
            if chosen_s > stable.step_s {
                return Err(scene.refuse(SetupError::new(
                    "run.integrator.step_s",
                    format!(
                        "a step of {chosen_s} s is not stable: the largest stable one is {:.4e} s, \
                         set by segment `{}`",
                        stable.step_s, stable.segment
                    ),
                    "choose a shorter step, leave it out, or use `Adaptive()`",
                )));
            }
            Ok((Box::new(RungeKutta4::new(chosen_s)), Some(chosen_s)))
        }
    }
}

fn describe(integrator: &IntegratorSpec, step_s: Option<f64>) -> String {
    match (integrator, step_s) {
        (
            IntegratorSpec::Adaptive {
                relative_tolerance, ..
            },
            _,
        ) => {
            format!("Dormand-Prince 5(4), relative tolerance {relative_tolerance:e}")
        }
        (IntegratorSpec::Fixed { .. }, Some(step_s)) => format!("RK4, step {step_s:e} s"),
        (IntegratorSpec::Fixed { .. }, None) => "RK4".to_owned(),
    }
}

/// The name of an entity, or of the tether that a segment belongs to.
fn owner_name(world: &World, entity: bevy_ecs::entity::Entity) -> Option<String> {
    if let Some(name) = world.get::<EntityName>(entity) {
        return Some(name.0.to_string());
    }
    let (tether, segment) = segment_name(world, entity);
    (segment > 0).then_some(tether)
}

impl Simulation {
    /// Runs from the start to the end of the scene, or to where it cannot go on. Frames go to `sink`
    /// as they come; `progress` hears of every accepted step's time in s.
    pub fn run(&mut self, sink: &mut dyn ResultSink, progress: &mut dyn FnMut(f64)) -> Summary {
        let mut stop = self.step_to(0.0, sink);
        let mut time_s = 0.0;
        while stop.is_none() && time_s < self.duration_s {
            let limit_s = self.next_limit_s(time_s);
            stop = self.step_to(limit_s, sink);
            time_s = self.time_s();
            progress(time_s);
        }
        self.summary(stop)
    }

    /// Brings a system that anchors hold to rest in the scene's own wind before it is run: its
    /// steady state, where a run would end after all motion has died out.
    ///
    /// # Errors
    /// What finds no rest, rendered.
    pub fn settle_in_wind(&mut self, scene: &Scene) -> Result<(), SceneError> {
        with_integration(&mut self.world, |world, integration| {
            let Integration { evaluation, trajectory, .. } = integration;
            placement::settle_in_wind(world, evaluation, scene)?;
            evaluation.state.gather(world, &mut trajectory.state);
            trajectory.rates_are_current = false;
            Ok(())
        })
        .unwrap_or(Ok(()))
        .map_err(|error| scene.refuse(error))
    }

    /// The world, for programs that look at components themselves.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The world, to be changed before the run.
    pub fn world_mut(&mut self) -> &mut World {
        &mut self.world
    }

    /// Time of the current state, s.
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.world.resource::<Clock>().time_s
    }

    /// The largest step that fixed-step RK4 can take, and the segment that sets it.
    #[must_use]
    pub fn stable_step(&self) -> &StableStep {
        &self.stable_step
    }

    /// Runs Evaluate on the components as they are: for measurements, and after changes by hand.
    ///
    /// # Errors
    /// The fault that a system reported.
    pub fn evaluate(&mut self) -> Result<(), Fault> {
        with_integration(&mut self.world, |world, integration| {
            integration.evaluation.run(world)
        })
        .unwrap_or(Ok(()))
    }

    /// Finds the rates of the current state `count` times, as an integrator does: for measurements.
    ///
    /// # Errors
    /// The fault that a system reported.
    pub fn rates(&mut self, count: usize) -> Result<(), Fault> {
        with_integration(&mut self.world, |world, integration| {
            let Integration {
                evaluation,
                trajectory,
                ..
            } = integration;
            let mut equations = WorldEquations { world, evaluation };
            (0..count).try_for_each(|_| {
                equations.rates(trajectory.time_s, &trajectory.state, &mut trajectory.rates)
            })
        })
        .unwrap_or(Ok(()))
    }

    /// The integrator with its settings, in words.
    #[must_use]
    pub fn integrator(&self) -> &str {
        &self.scene.integrator
    }

    /// What the integration has cost so far.
    pub fn cost(&mut self) -> Cost {
        with_integration(&mut self.world, |_, integration| {
            integration.trajectory.cost
        })
        .unwrap_or_default()
    }

    /// The instant that the next step may not cross, s.
    fn next_limit_s(&mut self, time_s: f64) -> f64 {
        let mut limit_s = self.duration_s;
        limit_s = limit_s.min(self.world.resource::<Edges>().next_s());
        limit_s = limit_s.min(self.world.resource::<Recorder>().next_s());
        for sampling in self.samplings.iter(&self.world) {
            if sampling.next_s() > time_s {
                limit_s = limit_s.min(sampling.next_s());
            }
        }
        limit_s
    }

    /// One pass through the Step schedule, with a step that ends at `limit_s` or before.
    fn step_to(&mut self, limit_s: f64, sink: &mut dyn ResultSink) -> Option<Stop> {
        let known = with_integration(&mut self.world, |_, integration| {
            integration.limit_s = limit_s;
            integration.trajectory.time_s
        })?;
        self.step.run(&mut self.world);
        let (failure, time_s) = with_integration(&mut self.world, |_, integration| {
            (integration.failure.take(), integration.trajectory.time_s)
        })?;
        if let Some(failure) = failure {
            // What was observed after a failed step is not an accepted state.
            self.world.resource_mut::<Recorder>().frame.clear(time_s);
            return Some(self.explain(&failure, known));
        }
        // What an instrument reports belongs to this state, not to the next evaluation.
        if let Some(fault) = self.world.resource_mut::<FaultSlot>().take() {
            self.world.resource_mut::<Recorder>().frame.clear(time_s);
            return Some(self.explain(&StepFailure::Fault(fault), time_s));
        }
        let mut recorder = self.world.resource_mut::<Recorder>();
        recorder.done(time_s);
        recorder.frame.time_s = time_s;
        let written = if recorder.frame.is_empty() {
            Ok(())
        } else {
            sink.take(&recorder.frame)
        };
        recorder.frame.clear(time_s);
        if let Some((entity, channel)) = recorder.not_finite.take() {
            let reason = format!("the channel `{channel}` is not a finite number");
            return Some(Stop {
                time_s,
                entity: Some(entity.to_string()),
                reason,
            });
        }
        written.err().map(|error| Stop {
            time_s,
            entity: None,
            reason: format!("the results cannot be written: {error}"),
        })
    }

    fn explain(&mut self, failure: &StepFailure, time_s: f64) -> Stop {
        let remedy = match self.step_s {
            Some(step_s) => format!(
                "; the step is {step_s:.4e} s and the largest stable one was {:.4e} s at the start \
                 (segment `{}`): choose a shorter step, or `Adaptive()`",
                self.stable_step.step_s, self.stable_step.segment
            ),
            None => String::new(),
        };
        let (entity, reason) = match failure {
            StepFailure::Fault(fault) => {
                let entity = fault
                    .entity
                    .and_then(|entity| owner_name(&self.world, entity));
                (entity, fault.message.clone())
            }
            StepFailure::NotFinite { index } => (
                self.name_of_state(*index),
                format!("the motion is no longer a finite number{remedy}"),
            ),
            StepFailure::Runaway { index, value } => (
                self.name_of_state(*index),
                format!("the motion grows beyond all bounds ({value:.3e}){remedy}"),
            ),
            StepFailure::StepTooSmall { step_s, index } => (
                self.name_of_state(*index),
                format!(
                    "no step is short enough for the error asked for (tried {step_s:.3e} s): a force \
                     that jumps, or a tolerance below round-off"
                ),
            ),
        };
        Stop {
            time_s,
            entity,
            reason,
        }
    }

    /// The entity to which a place in the state belongs.
    fn name_of_state(&mut self, index: usize) -> Option<String> {
        let coordinates = with_integration(&mut self.world, |_, integration| {
            integration.evaluation.state.layout().coordinates
        })?;
        if index >= 2 * coordinates {
            return None;
        }
        let place = index % coordinates;
        let mut states = self.world.query::<(&StateIndex, &EntityName)>();
        states
            .iter(&self.world)
            .filter(|(start, _)| start.0 <= place)
            .max_by_key(|(start, _)| start.0)
            .map(|(_, name)| name.0.to_string())
    }

    fn summary(&mut self, stopped: Option<Stop>) -> Summary {
        let cost = self.cost();
        let world = &self.world;
        let recorder = world.resource::<Recorder>();
        let events = world.resource::<EventLog>();
        let largest_tension = recorder.largest_tension.map(|(tension_n, time_s, entity)| {
            let (tether, segment) = segment_name(world, entity);
            LargestTension {
                tension_n,
                time_s,
                tether,
                segment,
            }
        });
        let has_segments = self.stable_step.step_s.is_finite();
        Summary {
            version: VERSION,
            scene: self.scene.name.clone(),
            seed: self.scene.seed,
            formulation: self.scene.formulation,
            integrator: self.scene.integrator.clone(),
            stable_step_s: has_segments.then_some(self.stable_step.step_s),
            stiffest_segment: has_segments.then(|| self.stable_step.segment.clone()),
            steps: cost.steps,
            rejected_steps: cost.rejected,
            evaluations: cost.evaluations,
            simulated_s: stopped.as_ref().map_or(self.time_s(), |stop| stop.time_s),
            outcome: if stopped.is_some() { "stopped" } else { "done" },
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
    world
        .resource::<BeyondMorrison>()
        .0
        .iter()
        .filter_map(|entity| world.get::<EntityName>(*entity))
        .map(|name| {
            format!(
                "`{}` has been beyond Re = 1e6, where Morrison's drag coefficient ends; it was held",
                name.0
            )
        })
        .collect()
}
