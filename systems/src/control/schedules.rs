//! Commands over time: steps, and straight lines between points.

use aerobot_components::actuator::Command;
use aerobot_components::control::{BoundSchedule, Commands, Schedule};
use bevy_ecs::system::{Query, Res};

use crate::clock::Clock;

/// Commands actuators by their schedules. What switches is decided at the start of an interval and holds for all
/// of it.
pub fn follow_schedules(
    clock: Res<Clock>,
    schedules: Query<(&Schedule, &BoundSchedule)>,
    mut actuators: Query<&mut Command>,
) {
    for (schedule, actuator) in &schedules {
        if let Ok(mut command) = actuators.get_mut(actuator.0) {
            command.0 = command_at(&schedule.commands, clock.interval_start_s, clock.time_s);
        }
    }
}

/// The command at `time_s` in an interval that starts at `interval_start_s` and has no point of the schedule
/// inside of it.
#[must_use]
pub fn command_at(commands: &Commands, interval_start_s: f64, time_s: f64) -> f64 {
    let points = commands.points();
    let passed = points
        .iter()
        .filter(|(at_s, _)| *at_s <= interval_start_s)
        .count();
    let before = passed.checked_sub(1).map(|index| points[index]);
    match commands {
        Commands::Steps(_) => before.map_or(0.0, |(_, command)| command),
        Commands::Ramps(_) => match (before, points.get(passed)) {
            (Some((from_s, from)), Some((to_s, to))) => {
                from + (to - from) * ((time_s - from_s) / (to_s - from_s))
            }
            (Some((_, held)), None) => held,
            (None, first) => first.map_or(0.0, |(_, held)| *held),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_hold_and_ramps_run() {
        let steps = Commands::Steps(vec![(10.0, 1.0), (50.0, -2.0)]);
        let at = |commands: &Commands, time_s| command_at(commands, time_s, time_s);
        assert_eq!(
            [0.0, 10.0, 49.0, 50.0].map(|t| at(&steps, t)),
            [0.0, 1.0, 1.0, -2.0]
        );
        // A stage on the end of an interval still belongs to it.
        assert_eq!(command_at(&steps, 0.0, 10.0), 0.0);
        let ramps = Commands::Ramps(vec![(10.0, 1.0), (20.0, 3.0), (20.0, 0.0), (30.0, 4.0)]);
        let found = [0.0, 10.0, 15.0, 20.0, 25.0, 30.0, 99.0].map(|t| at(&ramps, t));
        assert_eq!(found, [1.0, 1.0, 2.0, 0.0, 2.0, 4.0, 4.0]);
        assert_eq!(command_at(&ramps, 10.0, 20.0), 3.0);
    }
}
