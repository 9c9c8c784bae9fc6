//! A winch whose drum turns as a controller or a schedule commands. The command is held from sample to sample, so
//! that the length still changes steadily and the next turn is known before: it is planned anew at every sample.

use aerobot_components::actuator::{Actuator, Command};
use aerobot_components::control::{BoundController, Controller};
use aerobot_components::state::FirstOrderState;
use aerobot_components::winch::ReeledLine;
use aerobot_systems::clock::Clock;
use aerobot_systems::control::actuators::EndStop;
use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;

use super::reeling::{Reeling, SHORTEST_PART, Turn, has_next, plan, set_rate, warn};
use super::{Change, log};

/// The actuator that turns the drum of a line.
#[derive(Component, Clone, Copy, Debug)]
pub(crate) struct Drive {
    actuator: Entity,
    /// Until when the next turn is known, a little beyond the next sample, s.
    planned_until_s: f64,
    /// From when on it is planned anew, s.
    plan_from_s: f64,
    /// Whether it has been told that the drum was commanded beyond an end of its line.
    told: bool,
}

impl Drive {
    /// A drive by an actuator.
    pub(crate) fn by(actuator: Entity) -> Self {
        Self {
            actuator,
            planned_until_s: f64::NEG_INFINITY,
            plan_from_s: f64::NEG_INFINITY,
            told: false,
        }
    }
}

/// The part of a nominal segment by which a line may miss an end and still be there.
const AT_END_PART: f64 = 1e-9;

/// What drives command now: lines whose drum is to turn at another rate, or whose next turn is to be planned.
pub(crate) fn due(world: &mut World) -> Vec<Change> {
    let time_s = world.resource::<Clock>().time_s;
    let mut lines = world.query::<(Entity, &Drive, &ReeledLine, &FirstOrderState)>();
    let driven: Vec<(Entity, Drive, ReeledLine, f64)> = lines
        .iter(world)
        .map(|(line, drive, reeled, state)| (line, *drive, *reeled, state.value))
        .collect();
    let mut changes = Vec::new();
    for (line, drive, reeled, length_m) in driven {
        let (Some(actuator), Some(command)) = (
            world.get::<Actuator>(drive.actuator),
            world.get::<Command>(drive.actuator),
        ) else {
            continue;
        };
        let commanded_m_s = actuator.limits.cut(command.0);
        let allowed_m_s = allowed(world, &reeled, length_m, commanded_m_s);
        let turns_on = allowed_m_s != 0.0 && time_s >= drive.plan_from_s;
        if allowed_m_s != reeled.rate_m_s || turns_on {
            changes.push(Change::Drive(line, allowed_m_s));
        }
        if allowed_m_s == commanded_m_s {
            world.entity_mut(drive.actuator).remove::<EndStop>();
        } else {
            world.entity_mut(drive.actuator).insert(EndStop);
            tell(world, line, reeled.tether);
        }
    }
    changes
}

/// The rate that is left of a command at the ends of the line, m/s.
fn allowed(world: &World, line: &ReeledLine, length_m: f64, commanded_m_s: f64) -> f64 {
    let near_m = AT_END_PART * line.nominal_m;
    let is_empty = line.near_and_stored_m - length_m <= near_m;
    let is_shortest = length_m - SHORTEST_PART * line.nominal_m <= near_m && !has_next(world, line);
    if (commanded_m_s > 0.0 && is_empty) || (commanded_m_s < 0.0 && is_shortest) {
        0.0
    } else {
        commanded_m_s
    }
}

/// Turns the drum of a line at a rate, m/s.
pub(super) fn turn(world: &mut World, line: Entity, rate_m_s: f64) {
    set_rate(world, line, rate_m_s);
    if rate_m_s == 0.0 {
        world.entity_mut(line).remove::<Reeling>();
        return;
    }
    let (from_s, until_s) = next_plan_s(world, line);
    if let Some(mut drive) = world.get_mut::<Drive>(line) {
        (drive.plan_from_s, drive.planned_until_s) = (from_s, until_s);
    }
    world.entity_mut(line).insert(Reeling {
        done_s: f64::INFINITY,
        next: (f64::INFINITY, Turn::Done),
    });
    plan(world, line, until_s);
}

/// When the controller of a drum samples next, less and more than round-off, s.
fn next_plan_s(world: &mut World, line: Entity) -> (f64, f64) {
    const ROUND_OFF: f64 = 1e-9;
    let never = (f64::INFINITY, f64::INFINITY);
    let Some(actuator) = world.get::<Drive>(line).map(|drive| drive.actuator) else {
        return never;
    };
    let time_s = world.resource::<Clock>().time_s;
    let mut controllers = world.query::<(&Controller, &BoundController)>();
    controllers
        .iter(world)
        .find(|(_, bound)| bound.actuator == actuator)
        .map_or(never, |(controller, _)| {
            let after = |part: f64| time_s + controller.period_s * part;
            (after(1.0 - ROUND_OFF), after(1.0 + ROUND_OFF))
        })
}

/// Whether a drive turns the drum of a line.
pub(super) fn is_driven(world: &World, line: Entity) -> bool {
    world.get::<Drive>(line).is_some()
}

/// Until when the next turn of a line is to be known, s.
pub(super) fn planned_until_s(world: &World, line: Entity) -> f64 {
    world
        .get::<Drive>(line)
        .map_or(f64::INFINITY, |drive| drive.planned_until_s)
}

/// Stops a drum at an end of its line.
pub(super) fn stop(world: &mut World, line: Entity) {
    turn(world, line, 0.0);
}

/// Tells once that a drum was commanded beyond an end of its line.
fn tell(world: &mut World, line: Entity, tether: Entity) {
    let is_first = world
        .get_mut::<Drive>(line)
        .is_some_and(|mut drive| !std::mem::replace(&mut drive.told, true));
    if is_first {
        log(world, "reel end", tether, None);
        warn(world, tether, "was commanded beyond an end of its line");
    }
}
