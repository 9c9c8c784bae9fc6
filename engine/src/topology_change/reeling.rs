//! A winch on its way: when it starts and ends, and where its segment is divided or joined to the next.
//!
//! The length at the winch changes steadily, so that every turn is an instant known before: no step crosses
//! it.

use aerobot_components::segment::Severed;
use aerobot_components::state::FirstOrderState;
use aerobot_components::tether::TetherParts;
use aerobot_components::winch::{Reeled, ReeledLine};
use aerobot_systems::clock::Clock;
use aerobot_systems::dynamics::winch::{carry, pay_out};
use aerobot_systems::instruments::winch::ReelPower;
use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use bevy_ecs::system::RunSystemOnce;
use bevy_ecs::world::World;

use super::{Change, dividing, driving, log};
use crate::world::{Edges, EntityName, SceneEntities, Warnings};

/// The segment at a winch is divided when it is longer than this part of a nominal one.
pub(crate) const LONGEST_PART: f64 = 1.6;
/// It is joined to the next when it is shorter than this part, or, where there is none, reeled in no further.
pub(crate) const SHORTEST_PART: f64 = 0.4;

/// What comes next at a winch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Turn {
    /// All that was asked for is done.
    Done,
    /// The drum is empty.
    Empty,
    /// Nothing is left to reel in.
    Shortest,
    /// The segment is long enough to be two.
    Divide,
    /// The segment is so short that it joins the next.
    Join,
}

/// A winch that turns.
#[derive(Component, Clone, Copy, Debug)]
pub(crate) struct Reeling {
    /// When what was asked for is done, s.
    pub(super) done_s: f64,
    /// When the next turn comes, s, and what it is.
    pub(super) next: (f64, Turn),
}

/// The lines whose next turn has come.
pub(crate) fn due(world: &mut World) -> Vec<Change> {
    let time_s = world.resource::<Clock>().time_s;
    world
        .query::<(Entity, &Reeling)>()
        .iter(world)
        .filter(|(_, reeling)| reeling.next.0 <= time_s)
        .map(|(line, reeling)| Change::Winch(line, reeling.next.1))
        .collect()
}

/// Starts the winch of the tether of this name, until a length (m) or a time (s).
pub(super) fn start(
    world: &mut World,
    tether: &str,
    rate_m_s: f64,
    (length_m, until_s): (Option<f64>, Option<f64>),
) {
    let time_s = world.resource::<Clock>().time_s;
    let Some(entity) = world.resource::<SceneEntities>().get(tether) else {
        return;
    };
    let line = world
        .query::<(Entity, &ReeledLine)>()
        .iter(world)
        .find(|(_, line)| line.tether == entity)
        .map(|(line, _)| line);
    let Some(line) = line else {
        warn(world, entity, "was cut at its winch and is not reeled");
        return;
    };
    if world.get::<Reeling>(line).is_some() {
        end(world, line, None);
    }
    let done_s = match length_m {
        Some(length_m) => time_s + length_m / rate_m_s.abs(),
        None => until_s.unwrap_or(time_s),
    };
    set_rate(world, line, rate_m_s);
    world.entity_mut(line).insert(Reeling {
        done_s,
        next: (done_s, Turn::Done),
    });
    log(world, "reel start", entity, None);
    plan(world, line, f64::INFINITY);
}

/// Gives the points at winches, and what carries them, the masses that they have at the lengths of now.
pub(super) fn weigh(world: &mut World) {
    // Systems that were written here and take nothing that could be missing.
    let _ = world.run_system_once(pay_out);
    let _ = world.run_system_once(carry);
}

/// Takes the turn that has come at a line.
pub(super) fn turn(world: &mut World, line: Entity, turn: Turn) {
    let is_stop = matches!(turn, Turn::Empty | Turn::Shortest);
    if is_stop && driving::is_driven(world, line) {
        driving::stop(world, line);
        return;
    }
    match turn {
        Turn::Divide => dividing::divide(world, line),
        Turn::Join => dividing::join(world, line),
        Turn::Done => end(world, line, None),
        Turn::Empty => end(
            world,
            line,
            Some("has been paid out to the end of its drum"),
        ),
        Turn::Shortest => end(world, line, Some("has been reeled in as far as it can be")),
    }
    let until_s = driving::planned_until_s(world, line);
    plan(world, line, until_s);
}

/// The segment at the winch has been cut: what is left of the line stays as it is.
pub(super) fn abandon(world: &mut World, segment: Entity) {
    let line = world
        .query::<(Entity, &ReeledLine)>()
        .iter(world)
        .find(|(_, line)| line.segment == segment)
        .map(|(line, _)| line);
    let Some(line) = line else { return };
    if world.get::<Reeling>(line).is_some() {
        end(world, line, None);
    }
    // Masses stay; work done stays, at a power of zero.
    world.entity_mut(line).remove::<(ReeledLine, ReelPower)>();
    if let Some(mut state) = world.get_mut::<FirstOrderState>(line) {
        state.rate_per_s = 0.0;
    }
}

fn end(world: &mut World, line: Entity, warning: Option<&str>) {
    set_rate(world, line, 0.0);
    world.entity_mut(line).remove::<Reeling>();
    let Some(tether) = world.get::<ReeledLine>(line).map(|line| line.tether) else {
        return;
    };
    log(world, "reel end", tether, None);
    if let Some(warning) = warning {
        warn(world, tether, warning);
    }
}

pub(super) fn warn(world: &mut World, tether: Entity, what: &str) {
    let time_s = world.resource::<Clock>().time_s;
    let name = world
        .get::<EntityName>(tether)
        .map_or_else(String::new, |name| name.0.to_string());
    let mut warnings = world.resource_mut::<Warnings>();
    warnings.0.push(format!("`{name}` {what} at {time_s} s"));
}

pub(super) fn set_rate(world: &mut World, line: Entity, rate_m_s: f64) {
    let Some(mut reeled_line) = world.get_mut::<ReeledLine>(line) else {
        return;
    };
    reeled_line.rate_m_s = rate_m_s;
    let segment = reeled_line.segment;
    if let Some(mut reeled) = world.get_mut::<Reeled>(segment) {
        reeled.rate_m_s = rate_m_s;
    }
}

/// Finds the next turn of a line, and keeps steps from crossing it if it comes until `until_s`, when it is planned
/// anew.
pub(super) fn plan(world: &mut World, line: Entity, until_s: f64) {
    let time_s = world.resource::<Clock>().time_s;
    let (Some(reeling), Some(reeled), Some(state)) = (
        world.get::<Reeling>(line).copied(),
        world.get::<ReeledLine>(line).copied(),
        world.get::<FirstOrderState>(line).copied(),
    ) else {
        return;
    };
    let rate = reeled.rate_m_s.abs();
    let length_m = state.value;
    let mut next = (reeling.done_s, Turn::Done);
    let mut consider = |length_m: f64, turn: Turn| {
        let at_s = time_s + (length_m / rate).max(0.0);
        if at_s < next.0 {
            next = (at_s, turn);
        }
    };
    if reeled.rate_m_s > 0.0 {
        consider(reeled.near_and_stored_m - length_m, Turn::Empty);
        // A line without mass has no nodes, and is one segment however long it is.
        if reeled.line_kg_m > 0.0 {
            consider(LONGEST_PART * reeled.nominal_m - length_m, Turn::Divide);
        }
    } else {
        let turn = if has_next(world, &reeled) {
            Turn::Join
        } else {
            Turn::Shortest
        };
        consider(length_m - SHORTEST_PART * reeled.nominal_m, turn);
    }
    world.entity_mut(line).insert(Reeling { next, ..reeling });
    if next.0 <= until_s {
        world.resource_mut::<Edges>().add([next.0]);
    }
}

/// Whether there is a segment beyond the one at the winch that is not cut.
pub(super) fn has_next(world: &World, line: &ReeledLine) -> bool {
    let Some(parts) = world.get::<TetherParts>(line.tether) else {
        return false;
    };
    dividing::next_segment(parts, line).is_some_and(|next| world.get::<Severed>(next).is_none())
}
