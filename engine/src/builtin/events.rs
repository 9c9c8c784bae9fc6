//! Events of a scene: each happens once, at its time or when its condition first holds, after the step that
//! ends there; the rows of that time show what follows.

use aerobot_components::body::Body;
use aerobot_components::docking::Latch;
use aerobot_components::events::{Action, Condition, EventSpec};
use aerobot_components::fixed_wing::FixedWing;
use aerobot_components::scene_component::FieldReport;
use aerobot_components::segment::Tension;
use aerobot_components::state::{Air, Position, Velocity};
use aerobot_components::tether::{Tether, TetherParts};
use aerobot_components::winch::Winch;
use aerobot_systems::clock::Clock;
use bevy_ecs::resource::Resource;
use bevy_ecs::world::World;

use crate::plugin::{Plugin, Simulator};
use crate::scene::checks::meant;
use crate::scene::{Scene, SceneEntity, SetupError};
use crate::schedule::Phase;
use crate::topology_change::{Change, apply};
use crate::world::{Edges, SceneEntities, Warnings};

/// Events.
pub struct EventsPlugin;

impl Plugin for EventsPlugin {
    fn build(&self, simulator: &mut Simulator) {
        simulator.add_check(check).add_setup(set_up).add_systems_if(
            Phase::Constrain,
            has_events,
            || happen,
        );
    }
}

fn has_events(scene: &Scene) -> bool {
    !scene.events.is_empty()
}

/// The events of a run that have not happened.
#[derive(Resource, Clone, Debug, Default)]
pub(crate) struct Pending(pub(crate) Vec<EventSpec>);

fn set_up(world: &mut World, scene: &Scene) -> Result<(), SetupError> {
    let times = scene.events.iter().filter_map(|event| event.at_s);
    let ends = scene.events.iter().filter_map(|event| match event.action {
        Action::Reel { until_s, .. } => until_s,
        _ => None,
    });
    world.resource_mut::<Edges>().add(times.chain(ends));
    for event in &scene.events {
        let Some(Condition::AirspeedAbove { entity, .. }) = &event.when else {
            continue;
        };
        if let Some(body) = world.resource::<SceneEntities>().get(entity)
            && world.get::<Air>(body).is_none()
        {
            world.entity_mut(body).insert(Air::default());
        }
    }
    warn_of_late_events(world, scene);
    world.insert_resource(Pending(scene.events.clone()));
    Ok(())
}

fn warn_of_late_events(world: &mut World, scene: &Scene) {
    let end_s = scene.run.duration_s;
    for (index, event) in scene.events.iter().enumerate() {
        if let Some(at_s) = event.at_s.filter(|at_s| *at_s > end_s) {
            world.resource_mut::<Warnings>().0.push(format!(
                "`events.{index}` is to happen at {at_s} s, and the run ends at {end_s} s"
            ));
        }
    }
}

/// Lets happen what is due, and what that makes due, until nothing is.
fn happen(world: &mut World) {
    loop {
        let mut changes = due(world);
        changes.extend(crate::topology_change::reeling::due(world));
        if changes.is_empty() || !apply(world, &changes) {
            return;
        }
    }
}

/// Takes what is due from what is pending.
fn due(world: &mut World) -> Vec<Change> {
    let time_s = world.resource::<Clock>().time_s;
    let pending = std::mem::take(&mut world.resource_mut::<Pending>().0);
    let (now, later): (Vec<EventSpec>, Vec<EventSpec>) =
        pending.into_iter().partition(|event| match &event.when {
            Some(condition) => margin(world, condition).is_some_and(|margin| margin >= 0.0),
            None => event.at_s.is_some_and(|at_s| at_s <= time_s),
        });
    world.resource_mut::<Pending>().0 = later;
    now.into_iter()
        .map(|event| Change::Event(event.action))
        .collect()
}

/// By how much a condition holds, in its own unit; negative where it does not.
pub(crate) fn margin(world: &World, condition: &Condition) -> Option<f64> {
    let entity = |name: &str| world.resource::<SceneEntities>().get(name);
    match condition {
        Condition::TensionAbove { tether, tension_n } => {
            let parts = world.get::<TetherParts>(entity(tether)?)?;
            let tensions = parts.segments.iter();
            let largest = tensions
                .filter_map(|segment| world.get::<Tension>(*segment))
                .map(|tension| tension.0)
                .fold(f64::NEG_INFINITY, f64::max);
            Some(largest - tension_n)
        }
        Condition::AltitudeBelow {
            entity: name,
            altitude_m,
        } => Some(altitude_m - world.get::<Position>(entity(name)?)?.0.z),
        Condition::AltitudeAbove {
            entity: name,
            altitude_m,
        } => Some(world.get::<Position>(entity(name)?)?.0.z - altitude_m),
        Condition::AirspeedAbove {
            entity: name,
            airspeed_m_s,
        } => {
            let body = entity(name)?;
            let wind = world.get::<Air>(body)?.velocity_m_s;
            let drone = world.get::<FixedWing>(body);
            let wind = drone.map_or(wind, |drone| drone.wind.velocity_m_s(wind));
            Some((world.get::<Velocity>(body)?.0 - wind).length() - airspeed_m_s)
        }
    }
}

/// Names must be those of what the event is about, and the formulation able to follow.
fn check(scene: &Scene, report: &mut FieldReport) {
    for (index, event) in scene.events.iter().enumerate() {
        report.within(&format!("events.{index}"), |report| {
            if let Some(condition) = &event.when {
                report.within("when", |report| check_condition(scene, condition, report));
            }
            report.within("do", |report| check_action(scene, &event.action, report));
        });
    }
}

fn check_condition(scene: &Scene, condition: &Condition, report: &mut FieldReport) {
    match condition {
        Condition::TensionAbove { tether, .. } => {
            check_tether(scene, tether, report);
        }
        Condition::AltitudeBelow { entity, .. }
        | Condition::AltitudeAbove { entity, .. }
        | Condition::AirspeedAbove { entity, .. } => {
            check_body(scene, "entity", entity, report);
        }
    }
}

fn check_action(scene: &Scene, action: &Action, report: &mut FieldReport) {
    match action {
        Action::Cut { tether, segment } => {
            if let Some(found) = check_tether(scene, tether, report) {
                check_segment(found, *segment, report);
            }
        }
        Action::Release { body } => {
            check_body(scene, "body", body, report);
            let holds = |tether: &Tether| tether.from.0 == *body || tether.to.0 == *body;
            let is_held = scene.with::<Tether>().any(|(_, tether)| holds(tether));
            if scene.entity(body).is_some_and(|entity| entity.complete) && !is_held {
                report.add("body", format!("no tether holds `{body}`"), "");
            }
        }
        Action::Undock { body } => {
            check_body(scene, "body", body, report);
            let has_none = |entity: &SceneEntity| entity.complete && !entity.has::<Latch>();
            if scene.entity(body).is_some_and(has_none) {
                report.add(
                    "body",
                    format!("`{body}` has no latch"),
                    "give it one: `Latch: (to: ..)`",
                );
            }
        }
        Action::Reel {
            tether,
            rate_m_s,
            length_m,
            ..
        } => {
            if let Some(found) = check_tether(scene, tether, report) {
                check_winch(scene, found, (*rate_m_s, *length_m), report);
            }
        }
    }
}

fn check_tether<'a>(
    scene: &'a Scene,
    name: &str,
    report: &mut FieldReport,
) -> Option<&'a SceneEntity> {
    match scene.entity(name) {
        Some(entity) if entity.has::<Tether>() => Some(entity),
        Some(entity) if !entity.complete => None,
        Some(_) => {
            report.add("tether", format!("`{name}` is not a tether"), "");
            None
        }
        None => {
            let tethers = scene.with::<Tether>().map(|(entity, _)| entity);
            let help = meant(name, tethers);
            report.add("tether", format!("there is no tether `{name}`"), help);
            None
        }
    }
}

fn check_body(scene: &Scene, field: &str, name: &str, report: &mut FieldReport) {
    match scene.entity(name) {
        Some(entity) if entity.has::<Body>() || !entity.complete => {}
        Some(_) => report.add(field, format!("`{name}` is not a body"), ""),
        None => {
            let bodies = scene.with::<Body>().map(|(entity, _)| entity);
            let help = meant(name, bodies);
            report.add(field, format!("there is no body `{name}`"), help);
        }
    }
}

/// A tether with a winch may have more segments by then.
fn check_segment(entity: &SceneEntity, segment: u32, report: &mut FieldReport) {
    let Some(tether) = entity.get::<Tether>() else {
        return;
    };
    if segment > tether.segments() && !entity.has::<Winch>() {
        report.add(
            "segment",
            format!(
                "`{}` has no segment {segment}: it has {}",
                entity.name,
                tether.segments()
            ),
            "segments count from 1 at `from`",
        );
    }
}

fn check_winch(
    scene: &Scene,
    entity: &SceneEntity,
    (rate_m_s, length_m): (f64, Option<f64>),
    report: &mut FieldReport,
) {
    let Some(winch) = entity.get::<Winch>() else {
        if entity.complete {
            report.add(
                "tether",
                format!("`{}` has no winch", entity.name),
                "give it one: `Winch: (end: From, stored_m: ..)`",
            );
        }
        return;
    };
    if winch.drive.is_some() {
        report.add(
            "tether",
            format!("the winch of `{}` has a drive, which turns it", entity.name),
            "leave out the `drive`, or command it by a `Schedule` or a `Controller`",
        );
    }
    let reels_in = |event: &EventSpec| {
        matches!(&event.action, Action::Reel { tether, rate_m_s, .. }
            if *tether == entity.name && *rate_m_s < 0.0)
    };
    let length_m = length_m.unwrap_or(0.0);
    if rate_m_s > 0.0 && length_m > winch.stored_m && !scene.events.iter().any(reels_in) {
        report.add(
            "length_m",
            format!(
                "the winch of `{}` has {} m of line to pay out, not {length_m} m",
                entity.name, winch.stored_m
            ),
            "raise `stored_m` of its `Winch`",
        );
    }
}
