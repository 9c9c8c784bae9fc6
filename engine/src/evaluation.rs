//! The world as a system of ordinary differential equations, and the exclusive system that advances
//! it by one step.

use std::sync::{Mutex, PoisonError};

use aerobot_systems::clock::Clock;
use aerobot_systems::dynamics::state_space::StateSpace;
use aerobot_systems::environment::EnvironmentModel;
use aerobot_systems::fault::{Fault, FaultSlot};
use aerobot_systems::integration::{
    Correction, Equations, Integrator, MechanicalEnergy, StepFailure, Trajectory,
};
use bevy_ecs::resource::Resource;
use bevy_ecs::system::SystemId;
use bevy_ecs::world::World;

use crate::builtin::actuators::commands_have_changed;
use crate::event_location;
use crate::linearisation::Linearisation;
use crate::sequence::Sequence;
use crate::world::{Discontinuity, Edges};

/// The Evaluate schedule.
pub struct Evaluation {
    pub(crate) schedule: Sequence,
}

/// Derivatives and solutions for implicit steps.
pub(crate) struct Implicit {
    pub(crate) linearisation: Linearisation,
    /// Measures the energy of the world.
    pub(crate) energy: SystemId<(), MechanicalEnergy>,
}

impl Evaluation {
    /// Runs Evaluate on the components as they are.
    ///
    /// # Errors
    /// The first fault that a system reported.
    pub fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        self.schedule.run(world);
        match world.resource_mut::<FaultSlot>().take() {
            None => Ok(()),
            Some(fault) => Err(fault),
        }
    }
}

/// A world seen as y' = f(t, y).
pub struct WorldEquations<'a> {
    /// The world.
    pub world: &'a mut World,
    /// Its Evaluate schedule.
    pub evaluation: &'a mut Evaluation,
    /// Carries states to and from its components.
    pub(crate) state: &'a mut dyn StateSpace,
    /// Its derivatives, for implicit steps.
    pub(crate) implicit: &'a mut Implicit,
}

impl Equations for WorldEquations<'_> {
    fn rates(&mut self, time_s: f64, state: &[f64], rates: &mut [f64]) -> Result<(), Fault> {
        self.world.resource_mut::<Clock>().time_s = time_s;
        self.state.scatter(self.world, state)?;
        self.evaluation.run(self.world)?;
        self.state.gather_rates(self.world, state, rates);
        Ok(())
    }

    fn accept(&mut self, state: &mut [f64], rates: &mut [f64]) -> Correction {
        self.state.recentre(self.world, state, rates)
    }

    fn linearise(&mut self) {
        self.implicit.linearisation.linearise(self.world);
    }

    fn factorise(&mut self, step_s: f64, gamma: f64) -> Result<(), usize> {
        self.implicit.linearisation.factorise(step_s, gamma)
    }

    fn solve(&mut self, r: &mut [f64]) {
        self.implicit.linearisation.solve(r);
    }

    fn position_error(&mut self, error: &[f64], tolerance_m: f64) -> (f64, usize) {
        self.implicit
            .linearisation
            .position_error(error, tolerance_m)
    }

    fn strain_error(&mut self, error: &[f64], increment: &[f64]) -> (f64, usize) {
        self.implicit.linearisation.strain_error(error, increment)
    }

    fn has_slack(&self) -> bool {
        self.implicit.linearisation.has_slack
    }

    fn energy(&mut self) -> MechanicalEnergy {
        // It was registered when the simulation was built, and takes nothing that could be missing.
        self.world
            .run_system(self.implicit.energy)
            .unwrap_or_default()
    }
}

/// What the integration of one run consists of.
pub struct Integration {
    /// The world's equations.
    pub evaluation: Evaluation,
    /// The forces of the lumped formulation, where another moves the world: what is at rest is found with
    /// them.
    pub(crate) statics: Option<Evaluation>,
    /// Carries states to and from the components.
    pub(crate) state: Box<dyn StateSpace>,
    /// What implicit steps need besides.
    pub(crate) implicit: Implicit,
    /// The method.
    pub integrator: Box<dyn Integrator>,
    /// The state on its way.
    pub trajectory: Trajectory,
    /// Where the next step must end at the latest, s.
    pub limit_s: f64,
    /// Why the last step could not be taken.
    pub failure: Option<StepFailure>,
}

/// Holds the [`Integration`] of a world; taken out while it works on the world.
#[derive(Resource)]
pub struct IntegrationSlot(Mutex<Option<Box<Integration>>>);

impl IntegrationSlot {
    /// A slot that holds `integration`.
    #[must_use]
    pub fn new(integration: Integration) -> Self {
        Self(Mutex::new(Some(Box::new(integration))))
    }

    fn take(&self) -> Option<Box<Integration>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    fn put(&self, integration: Box<Integration>) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(integration);
    }
}

/// Works on a world with its integration taken out; `None` if there is none.
pub fn with_integration<R>(
    world: &mut World,
    work: impl FnOnce(&mut World, &mut Integration) -> R,
) -> Option<R> {
    let mut integration = world.get_resource::<IntegrationSlot>()?.take()?;
    let result = work(world, &mut integration);
    world.resource::<IntegrationSlot>().put(integration);
    Some(result)
}

/// The system of [`Phase::Integrate`](crate::schedule::Phase): one accepted step, or none where the
/// limit is the present.
pub fn integrate(world: &mut World) {
    with_integration(world, |world, integration| {
        integration.failure = advance(world, integration).err();
        if integration.failure.is_some() {
            restore(world, integration);
        }
    });
}

/// Leaves the last accepted state in the components after a step that failed.
fn restore(world: &mut World, integration: &mut Integration) {
    let Integration {
        evaluation,
        state,
        trajectory,
        ..
    } = integration;
    world.resource_mut::<Clock>().time_s = trajectory.time_s;
    // A state that could be evaluated once can be again; the initial one may be at fault itself.
    let _ = state
        .scatter(world, &trajectory.state)
        .and_then(|()| evaluation.run(world));
}

fn advance(world: &mut World, integration: &mut Integration) -> Result<(), StepFailure> {
    let Integration {
        evaluation,
        state,
        implicit,
        integrator,
        trajectory,
        limit_s,
        ..
    } = integration;
    let state = &mut **state;
    if std::mem::take(&mut world.resource_mut::<Discontinuity>().0) {
        state.gather(world, &mut trajectory.state);
        trajectory.switch();
    }
    if commands_have_changed(world) {
        world.resource_mut::<Clock>().interval_start_s = trajectory.time_s;
        trajectory.switch();
    }
    begin_interval(world, trajectory);
    if trajectory.time_s < *limit_s {
        world.resource_mut::<Clock>().interval_start_s = trajectory.time_s;
        let mut equations = WorldEquations {
            world,
            evaluation,
            state,
            implicit,
        };
        event_location::step(&mut **integrator, &mut equations, trajectory, *limit_s)?;
        begin_interval(world, trajectory);
    }
    let mut equations = WorldEquations {
        world,
        evaluation,
        state,
        implicit,
    };
    // On an edge the accepted state is seen with what holds from the edge on.
    if trajectory.time_s < *limit_s {
        trajectory.refresh(&mut equations)
    } else {
        trajectory.look(&mut equations)
    }
}

/// Enters the interval that starts at the present, if the present is an edge.
fn begin_interval(world: &mut World, trajectory: &mut Trajectory) {
    let time_s = trajectory.time_s;
    if world.resource_mut::<Edges>().pass(time_s) {
        world.resource_mut::<Clock>().interval_start_s = time_s;
        world
            .resource_mut::<EnvironmentModel>()
            .wind
            .begin_interval(time_s);
        trajectory.switch();
    }
}
