//! The second formulation: bodies and tethers as trees of links, and what such a tree cannot be.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use aerobot_components::body::{Body, Fixed, Moving};
use aerobot_components::scene_component::FieldReport;
use aerobot_components::segment::{RigidLink, Segment, SegmentGeometry, Tension};
use aerobot_components::state::Mass;
use aerobot_components::tether::Tether;
use aerobot_components::winch::Reeled;
use aerobot_systems::clock::Clock;
use aerobot_systems::dynamics::links::{accelerate_by_links, add_reactions, solve_links};
use aerobot_systems::linearised_motion::topology::BodyIndex;
use bevy_ecs::entity::Entity;
use bevy_ecs::query::{With, Without};
use bevy_ecs::schedule::IntoScheduleConfigs;
use bevy_ecs::system::{Local, Query, Res, ResMut};

use super::tethers::{has_links, has_rigid_links};
use crate::plugin::{Plugin, Simulator};
use crate::scene::checks::meant;
use crate::scene::{Scene, SceneEntity};
use crate::schedule::Phase;
use crate::world::{EntityName, EventLog, Warnings};

/// A tension below this part of the largest force on any body is a push and not round-off.
const ROUND_OFF: f64 = 1e-9;

/// For the size of forces, m/s^2.
const STANDARD_GRAVITY_M_S2: f64 = 9.806_65;

/// Equations of motion of trees of links, after everything that loads them.
pub struct LinksPlugin;

impl Plugin for LinksPlugin {
    fn build(&self, simulator: &mut Simulator) {
        simulator
            .add_check(check_base)
            .add_systems_in(Phase::Dynamics, has_links, || {
                (solve_links, accelerate_by_links, add_reactions).chain()
            })
            .add_systems_in(Phase::Observe, has_rigid_links, || {
                (log_compression, log_strain).chain()
            });
    }
}

fn is_anchor(entity: &SceneEntity) -> bool {
    entity.has::<Fixed>() || entity.has::<Moving>()
}

/// What stands for an end of a tether in the graph: all anchors are one.
fn corner<'a>(scene: &Scene, name: &'a str) -> &'a str {
    if scene.entity(name).is_some_and(is_anchor) {
        ""
    } else {
        name
    }
}

/// What each corner is joined to, and by which tether.
type Joined<'a> = BTreeMap<&'a str, Vec<(&'a str, &'a str)>>;

fn join<'a>(scene: &Scene, joined: &mut Joined<'a>, name: &'a str, tether: &'a Tether) {
    let from = corner(scene, &tether.from.0);
    let to = corner(scene, &tether.to.0);
    joined.entry(from).or_default().push((to, name));
    joined.entry(to).or_default().push((from, name));
}

/// The tethers by which one corner is reached from another, if it is.
fn path_between<'a>(joined: &Joined<'a>, from: &'a str, to: &'a str) -> Option<Vec<&'a str>> {
    let mut reached: BTreeMap<&str, Option<(&str, &str)>> = BTreeMap::from([(from, None)]);
    let mut waiting = VecDeque::from([from]);
    while let Some(here) = waiting.pop_front() {
        if here == to {
            let mut path = Vec::new();
            let mut at = here;
            while let Some(Some((before, tether))) = reached.get(at).copied() {
                path.push(tether);
                at = before;
            }
            path.reverse();
            return Some(path);
        }
        for (next, tether) in joined.get(here).into_iter().flatten() {
            if !reached.contains_key(next) {
                reached.insert(next, Some((here, tether)));
                waiting.push_back(next);
            }
        }
    }
    None
}

/// The base must be a body that moves, of a system that no anchor holds.
fn check_base(scene: &Scene, report: &mut FieldReport) {
    let Some(name) = &scene.run.base else {
        return;
    };
    let Some(entity) = scene.entity(name) else {
        let bodies = scene.entities.iter().filter(|entity| entity.has::<Body>());
        let help = scene.groups.help(name);
        let help = help.unwrap_or_else(|| meant(name, bodies));
        report.add("run.base", format!("there is no entity `{name}`"), help);
        return;
    };
    if !entity.complete {
        return;
    }
    if !entity.has::<Body>() || is_anchor(entity) {
        report.add(
            "run.base",
            format!("`{name}` is not a body that moves"),
            "a tree grows from a free body; from an anchor it grows without being told",
        );
        return;
    }
    let mut joined = Joined::new();
    for (tether_entity, tether) in scene.with::<Tether>() {
        join(scene, &mut joined, &tether_entity.name, tether);
    }
    if path_between(&joined, name, "").is_some() {
        report.add(
            "run.base",
            format!("an anchor holds the system of `{name}`, and its tree grows from there"),
            "leave out `base`",
        );
    }
}

/// Rigid links are stretched where redundant tethers cannot all keep their lengths: more than this part of it is
/// told.
const STRAINED: f64 = 1e-5;

/// Logs when redundant tethers first cannot all keep their lengths.
fn log_strain(
    clock: Res<Clock>,
    mut events: ResMut<EventLog>,
    mut warnings: ResMut<Warnings>,
    links: Query<(&Segment, &SegmentGeometry), (With<RigidLink>, Without<Reeled>)>,
    tethers: Query<(&Tether, &EntityName)>,
    mut seen: Local<BTreeSet<Entity>>,
) {
    for (segment, geometry) in &links {
        let Ok((tether, name)) = tethers.get(segment.tether) else {
            continue;
        };
        let length_m = tether.segment_length_m();
        let stretch_m = geometry.length_m - length_m;
        if stretch_m.abs() > STRAINED * length_m && seen.insert(segment.tether) {
            let part = format!("{}/{}", name.0, segment.number);
            events.add(clock.time_s, "strained", &part);
            warnings.0.push(format!(
                "the rigid link `{part}` is stretched by {stretch_m:.6} m at {} s: redundant tethers cannot all keep \
                 their lengths in this motion, and give way by their stiffness; `LumpedMass` lets all of them \
                 stretch, and go slack",
                clock.time_s
            ));
        }
    }
}

/// Logs when a tether first has a link that pushes.
fn log_compression(
    clock: Res<Clock>,
    mut events: ResMut<EventLog>,
    mut warnings: ResMut<Warnings>,
    links: Query<(&Segment, &Tension), With<RigidLink>>,
    bodies: Query<&Mass, With<BodyIndex>>,
    names: Query<&EntityName>,
    mut seen: Local<BTreeSet<Entity>>,
) {
    // What a body weighs on Earth is large against the round-off of any force here.
    let heaviest = bodies.iter().map(|mass| mass.0).fold(0.0, f64::max);
    let largest = links
        .iter()
        .map(|(_, tension)| tension.0.abs())
        .fold(STANDARD_GRAVITY_M_S2 * heaviest, f64::max);
    let mut pushed: BTreeMap<Entity, u32> = BTreeMap::new();
    for (segment, tension) in &links {
        if tension.0 < -ROUND_OFF * largest && !seen.contains(&segment.tether) {
            let number = pushed.entry(segment.tether).or_insert(segment.number);
            *number = segment.number.min(*number);
        }
    }
    for (tether, number) in pushed {
        seen.insert(tether);
        let name = names.get(tether).map_or("", |name| &name.0);
        events.add(clock.time_s, "compression", &format!("{name}/{number}"));
        warnings.0.push(format!(
            "link {number} of `{name}` pushes at {} s: a rigid link can, a tether goes slack there",
            clock.time_s
        ));
    }
}
