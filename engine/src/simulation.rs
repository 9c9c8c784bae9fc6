//! A simulation: the world of one scene, built, and the loop that runs it.

use aerobot_components::sampling::Sampling;
use aerobot_systems::clock::Clock;
use aerobot_systems::environment::EnvironmentModel;
use aerobot_systems::fault::{Fault, FaultSlot};
use aerobot_systems::integration::{Cost, Equations, StepFailure};
use bevy_ecs::query::QueryState;
use bevy_ecs::world::World;

use crate::builtin::recorder::Recorder;
use crate::evaluation::{Integration, WorldEquations, with_integration};
use crate::recording::frame::ResultSink;
use crate::recording::summary::{Stop, Summary};
use crate::scene::{Scene, SceneError};
use crate::sequence::Sequence;
use crate::stable_step::StableStep;
use crate::world::Edges;

/// A step of less than this part of the one before it is none.
const SLIVER: f64 = 1e-6;

/// A built simulation.
pub struct Simulation {
    pub(crate) world: World,
    step: Sequence,
    samplings: QueryState<&'static Sampling>,
    duration_s: f64,
    pub(crate) stable_step: StableStep,
    pub(crate) step_s: Option<f64>,
    pub(crate) scene: SceneFacts,
}

/// What the summary says of the scene.
pub(crate) struct SceneFacts {
    pub(crate) name: String,
    pub(crate) seed: u64,
    pub(crate) formulation: &'static str,
    pub(crate) integrator: String,
}

impl Simulation {
    /// Of what was built.
    pub(crate) fn new(
        mut world: World,
        step: Sequence,
        duration_s: f64,
        scene: SceneFacts,
        (stable_step, step_s): (StableStep, Option<f64>),
    ) -> Self {
        Self {
            samplings: world.query(),
            world,
            step,
            duration_s,
            stable_step,
            step_s,
            scene,
        }
    }

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

    /// As [`Simulation::trim`], for those who do not ask what was found.
    ///
    /// # Errors
    /// As there.
    pub fn settle_in_wind(&mut self, scene: &Scene) -> Result<(), SceneError> {
        self.trim(scene).map(|_| ())
    }

    /// The world, for programs that look at components themselves.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
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

    /// Runs Evaluate on the components as they are, `count` times: for measurements.
    ///
    /// # Errors
    /// The fault that a system reported.
    pub fn evaluate(&mut self, count: usize) -> Result<(), Fault> {
        with_integration(&mut self.world, |world, integration| {
            (0..count).try_for_each(|_| integration.evaluation.run(world))
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
                state,
                implicit,
                trajectory,
                ..
            } = integration;
            let mut equations = WorldEquations {
                world,
                evaluation,
                state: &mut **state,
                implicit,
            };
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
        let wind = &self.world.resource::<EnvironmentModel>().wind;
        let knot_s = wind.step_limit_s(time_s);
        // A knot that round-off parts from the limit would leave a sliver.
        if limit_s - knot_s > SLIVER * (knot_s - time_s) {
            limit_s = knot_s;
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
}
