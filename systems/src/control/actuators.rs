//! Actuators: d' = (u - d)/lag, cut at the largest rate; without a lag d = u. u is the command, cut at the
//! limits, d the value.

use aerobot_components::actuator::{Actuator, ActuatorValue, Command};
use aerobot_components::state::FirstOrderState;
use bevy_ecs::component::Component;
use bevy_ecs::query::Has;
use bevy_ecs::system::Query;
use bevy_ecs::world::Mut;

/// The command that an actuator had in the last interval, within its limits: what has to be evaluated anew when
/// it changes.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct AppliedCommand(pub f64);

/// Marks an actuator that is held at zero, whatever its command: a drum without line.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EndStop;

/// Lets actuators follow their commands.
pub fn follow_commands(
    mut actuators: Query<(
        &Actuator,
        &Command,
        &mut ActuatorValue,
        Option<&mut FirstOrderState>,
        Has<EndStop>,
    )>,
) {
    for (actuator, command, mut value, state, is_stopped) in &mut actuators {
        if is_stopped {
            value.0 = 0.0;
            continue;
        }
        let command = actuator.limits.cut(command.0);
        let Some(mut state) = state else {
            value.0 = command;
            continue;
        };
        let rate = (command - state.value) / actuator.limits.lag_s;
        state.rate_per_s = match actuator.limits.rate_per_s {
            Some(most) => rate.clamp(-most, most),
            None => rate,
        };
        value.0 = state.value;
    }
}

/// Marks an actuator whose command is a function of time, which every evaluation finds by itself.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FollowsSchedule;

/// Takes note of commands; whether one has changed since it was asked last.
pub fn take_commands<'a>(
    actuators: impl Iterator<Item = (&'a Actuator, &'a Command, Mut<'a, AppliedCommand>)>,
) -> bool {
    let mut changed = false;
    for (actuator, command, mut applied) in actuators {
        let command = actuator.limits.cut(command.0);
        changed |= command != applied.0;
        applied.0 = command;
    }
    changed
}
