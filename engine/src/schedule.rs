//! What happens in which order: the table of contents of the simulator.
//!
//! **Step**, once per accepted step:
//! 1. [`Phase::Control`]: controllers sample and hold, random processes advance.
//! 2. [`Phase::Integrate`]: one exclusive system; it runs Evaluate once per stage.
//! 3. [`Phase::Constrain`]: what changes the state at once (latches, cuts).
//! 4. [`Phase::Observe`]: instruments and built-in channels look at the accepted state.
//! 5. [`Phase::Record`]: rows are made of what is due.
//!
//! **Evaluate**, once per stage and once for the accepted state:
//! 1. [`Phase::Prepare`]: accumulators are cleared, anchors and attachments placed, segments measured.
//! 2. [`Phase::Environment`]: air density and wind at everything that asks for them; added mass.
//! 3. [`Phase::Forces`]: every law adds to forces, torques and segment loads.
//! 4. [`Phase::Dynamics`]: segment loads go to their ends, and everything is accelerated.
//!
//! **Linearise**, once per implicit step, on the accepted state:
//! 1. [`Phase::Derivatives`]: stiff laws say how their forces change with position and velocity.
//!
//! Within a phase, systems run in the order in which they were registered, so that sums have the same
//! bits under every shuffle; an ambiguity inside one registration is an error.

use aerobot_components::run::Formulation;
use bevy_ecs::schedule::{
    IntoScheduleConfigs, LogLevel, Schedule, ScheduleBuildSettings, ScheduleLabel, SystemSet,
};
use bevy_ecs::world::World;

use crate::plugin::Simulator;
use crate::scene::Scene;
use crate::sequence::{OrderOf, Sequence};

/// A place in the order of a step.
#[derive(Clone, Copy, Debug, Hash, PartialEq, Eq, SystemSet)]
pub enum Phase {
    /// Step: controllers sample and hold, random processes advance.
    Control,
    /// Step: the state moves on by one accepted step.
    Integrate,
    /// Step: what changes the state at once.
    Constrain,
    /// Step: instruments and channels look at the accepted state.
    Observe,
    /// Step: rows are made of what is due.
    Record,
    /// Evaluate: accumulators, anchors, attachments, segments.
    Prepare,
    /// Evaluate: air and wind.
    Environment,
    /// Evaluate: everything that pushes or pulls.
    Forces,
    /// Evaluate: accelerations.
    Dynamics,
    /// Linearise: derivatives of stiff forces.
    Derivatives,
}

/// The phases of a step.
pub const STEP: [Phase; 5] = [
    Phase::Control,
    Phase::Integrate,
    Phase::Constrain,
    Phase::Observe,
    Phase::Record,
];

/// The phases of an evaluation.
pub const EVALUATE: [Phase; 4] = [
    Phase::Prepare,
    Phase::Environment,
    Phase::Forces,
    Phase::Dynamics,
];

/// The phases of a linearisation.
pub const LINEARISE: [Phase; 1] = [Phase::Derivatives];

/// Label of the schedule that runs once per accepted step.
#[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
pub struct Step;

/// Label of the schedule that runs once per stage.
#[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
pub struct Evaluate;

/// Label of the schedule that runs once per implicit step.
#[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
pub struct Linearise;

/// The place of one registration in the total order.
#[derive(Clone, Copy, Debug, Hash, PartialEq, Eq, SystemSet)]
pub(crate) struct Registered(usize);

/// One call of [`Simulator::add_systems`](crate::plugin::Simulator::add_systems).
pub(crate) struct Registration {
    pub(crate) phase: Phase,
    pub(crate) needed: Box<dyn Fn(&Scene, Formulation) -> bool + Send + Sync>,
    pub(crate) add: Box<dyn Fn(&mut Schedule, Registered) + Send + Sync>,
}

/// The systems of the schedule `label` of `phases` from all registrations that `scene` needs in a
/// formulation, checked for ambiguities.
///
/// # Errors
/// The text of an ambiguity or of a cycle.
pub(crate) fn build(
    label: impl ScheduleLabel + Clone,
    phases: &[Phase],
    simulator: &Simulator,
    (scene, formulation): (&Scene, Formulation),
    world: &mut World,
) -> Result<Sequence, String> {
    let registrations = needed(phases, simulator, (scene, formulation));
    let assemble = || assemble(label.clone(), simulator, &registrations);
    let of = OrderOf {
        registrations: registrations.clone(),
        shuffle_seed: simulator.shuffle_seed,
    };
    simulator.orders.sequence(of, assemble, world)
}

/// Numbers of the registrations of `phases` that a scene needs, in their order.
fn needed(
    phases: &[Phase],
    simulator: &Simulator,
    (scene, formulation): (&Scene, Formulation),
) -> Vec<usize> {
    let of_phase = |phase: &Phase| {
        let phase = *phase;
        let registrations = simulator.systems.iter().enumerate();
        registrations.filter_map(move |(index, registration)| {
            let is_needed =
                registration.phase == phase && (registration.needed)(scene, formulation);
            is_needed.then_some(index)
        })
    };
    phases.iter().flat_map(of_phase).collect()
}

/// The schedule, not yet ordered.
fn assemble(label: impl ScheduleLabel, simulator: &Simulator, registrations: &[usize]) -> Schedule {
    let mut schedule = Schedule::new(label);
    schedule.set_build_settings(ScheduleBuildSettings {
        ambiguity_detection: LogLevel::Error,
        shuffle_seed: simulator.shuffle_seed,
        ..ScheduleBuildSettings::default()
    });
    let mut before: Option<Registered> = None;
    for index in registrations {
        let Some(registration) = simulator.systems.get(*index) else {
            continue;
        };
        let set = Registered(*index);
        schedule.configure_sets(set.in_set(registration.phase));
        if let Some(before) = before {
            schedule.configure_sets(set.after(before));
        }
        (registration.add)(&mut schedule, set);
        before = Some(set);
    }
    schedule
}
