//! Cutting a segment. The masses of a segment are lumped in halves at its two ends, so a cut takes its force
//! away and nothing else: positions, velocities and masses stay, and with them momentum and angular momentum;
//! the energy of its stretch, and of the twist of the line, is lost.

use aerobot_components::derivatives::SegmentDerivatives;
use aerobot_components::segment::{
    KelvinVoigt, RigidLink, SegmentDrag, SegmentLoad, Severed, Tension,
};
use aerobot_components::tether::{Attachment, TetherParts};
use aerobot_components::torsion::{AcceptedTwist, Torsion, Twist};
use aerobot_components::winch::Reeled;
use aerobot_systems::clock::Clock;
use aerobot_systems::instruments::swing::Support;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;

use super::{log, reeling};
use crate::world::{SceneEntities, Warnings};

/// Cuts the segment of this number of the tether of this name.
pub(super) fn cut(world: &mut World, tether: &str, number: u32) {
    let Some(entity) = world.resource::<SceneEntities>().get(tether) else {
        return;
    };
    let Some(parts) = world.get::<TetherParts>(entity).cloned() else {
        return;
    };
    match parts.segments.get(number as usize - 1) {
        Some(segment) => sever(world, entity, number, *segment),
        None => {
            let time_s = world.resource::<Clock>().time_s;
            world.resource_mut::<Warnings>().0.push(format!(
                "segment {number} of `{tether}` was to be cut at {time_s} s, when the tether had {}",
                parts.segments.len()
            ));
        }
    }
}

/// Cuts every tether in its segment at the body of this name.
pub(super) fn release(world: &mut World, body: &str) {
    let Some(body) = world.resource::<SceneEntities>().get(body) else {
        return;
    };
    log(world, "release", body, None);
    let tethers = world.resource::<SceneEntities>().in_order().to_vec();
    for tether in tethers {
        let Some(parts) = world.get::<TetherParts>(tether).cloned() else {
            continue;
        };
        let count = parts.segments.len();
        let ends = [(parts.points.first(), 0), (parts.points.last(), count - 1)];
        for (point, index) in ends {
            let is_here = point
                .and_then(|point| world.get::<Attachment>(*point))
                .is_some_and(|end| end.carrier == body);
            if is_here {
                sever(world, tether, index as u32 + 1, parts.segments[index]);
            }
        }
    }
}

/// What was cut before stays cut.
fn sever(world: &mut World, tether: Entity, number: u32, segment: Entity) {
    if world.get::<Severed>(segment).is_some() {
        return;
    }
    if world.get::<Reeled>(segment).is_some() {
        reeling::abandon(world, segment);
    }
    world
        .entity_mut(segment)
        .remove::<(KelvinVoigt, SegmentDrag, Reeled, RigidLink)>()
        .insert((
            Severed,
            Tension(0.0),
            SegmentLoad::default(),
            SegmentDerivatives::default(),
        ));
    // A line in two pieces passes on no torque.
    world
        .entity_mut(tether)
        .remove::<(Torsion, AcceptedTwist)>();
    if let Some(mut twist) = world.get_mut::<Twist>(tether) {
        *twist = Twist::default();
    }
    let_go(world, tether);
    log(world, "cut", tether, Some(number));
}

/// What hung by this tether does not any more.
fn let_go(world: &mut World, tether: Entity) {
    let Some(parts) = world.get::<TetherParts>(tether).cloned() else {
        return;
    };
    for body in world.resource::<SceneEntities>().in_order().to_vec() {
        let Some(mut support) = world.get_mut::<Support>(body) else {
            continue;
        };
        support.above.retain(|point| !parts.points.contains(point));
        support.below.retain(|point| !parts.points.contains(point));
        if support.above.is_empty() {
            world.entity_mut(body).remove::<Support>();
        }
    }
}
