//! How the ends of tethers with torsion are held: the axes of their carriers, and what is untwisted.
//!
//! The axis on a carrier is that of its own axes, x, y or z to either side, which is nearest to the line as
//! it stands: a choice that a start found elsewhere does not change. The directions across the axes are
//! such that the line has the twist that the scene gives it.

use aerobot_components::state::{Attitude, Position};
use aerobot_components::tether::{Attachment, Tether, TetherParts};
use aerobot_components::torsion::{AcceptedTwist, Torsion, Twist};
use aerobot_systems::clock::Clock;
use aerobot_systems::dynamics::rotation_chart::exponential;
use aerobot_systems::forces::line_twist::carried;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;
use glam::{DQuat, DVec3};

use super::attachment_position;

/// Takes all tethers as twisted, where they stand, by what the scene says.
pub(super) fn refer(world: &mut World) {
    refer_where(world, |_| true);
}

/// The same for tethers whose carriers both are where the scene wants them: not among the `unplaced`.
pub(super) fn refer_given(world: &mut World, unplaced: &[Entity]) {
    refer_where(world, |torsion| {
        ![torsion.from.carrier, torsion.to.carrier]
            .iter()
            .any(|carrier| unplaced.contains(carrier))
    });
}

fn refer_where(world: &mut World, chosen: impl Fn(&Torsion) -> bool) {
    let mut query = world.query::<(Entity, &Torsion)>();
    let tethers: Vec<Entity> = query
        .iter(world)
        .filter(|(_, torsion)| chosen(torsion))
        .map(|(entity, _)| entity)
        .collect();
    for tether in tethers {
        refer_tether(world, tether);
    }
}

fn refer_tether(world: &mut World, id: Entity) {
    let Some(twist_rad) = world
        .get::<Tether>(id)
        .and_then(|tether| tether.torsion)
        .map(|torsion| torsion.twist_rad)
    else {
        return;
    };
    let points_m = points_m(world, id);
    let Some(mut torsion) = world.get::<Torsion>(id).cloned() else {
        return;
    };
    let directions: Vec<DVec3> = points_m
        .windows(2)
        .filter_map(|pair| (pair[1] - pair[0]).try_normalize())
        .collect();
    let attitude = |carrier| {
        world
            .get::<Attitude>(carrier)
            .map_or(DQuat::IDENTITY, |attitude| attitude.0)
    };
    let from = attitude(torsion.from.carrier);
    let to = attitude(torsion.to.carrier);
    let down = DVec3::NEG_Z;
    torsion.from.axis = nearest_axis(from, directions.first().copied().unwrap_or(down));
    torsion.to.axis = nearest_axis(to, directions.last().copied().unwrap_or(down));
    // The next axis in turn is across.
    let axis = torsion.from.axis.abs();
    torsion.from.across = DVec3::new(axis.z, axis.x, axis.y);
    let to_axis = to * torsion.to.axis;
    let arrives = carried(
        from * torsion.from.across,
        from * torsion.from.axis,
        &points_m,
        to_axis,
    );
    let met = exponential(twist_rad * to_axis) * arrives;
    torsion.to.across = (to.conjugate() * met)
        .reject_from_normalized(torsion.to.axis)
        .normalize();
    let accepted = AcceptedTwist {
        twist_rad,
        rate_rad_s: 0.0,
        time_s: world.resource::<Clock>().time_s,
    };
    world.entity_mut(id).insert((torsion, accepted));
}

/// The points of a tether as they stand, m.
fn points_m(world: &World, tether: Entity) -> Vec<DVec3> {
    let parts = world.get::<TetherParts>(tether);
    let points = parts.map_or(&[][..], |parts| &parts.points);
    let position = |point: &Entity| match world.get::<Attachment>(*point) {
        Some(end) => attachment_position(world, end.carrier, end.offset_m),
        None => world.get::<Position>(*point).map_or(DVec3::ZERO, |p| p.0),
    };
    points.iter().map(position).collect()
}

/// The axis of a body, in its own frame, that is nearest to a direction in the inertial frame.
fn nearest_axis(attitude: DQuat, direction: DVec3) -> DVec3 {
    let own = attitude.conjugate() * direction;
    let size = own.abs();
    let axis = if size.z >= size.x && size.z >= size.y {
        DVec3::Z
    } else if size.x >= size.y {
        DVec3::X
    } else {
        DVec3::Y
    };
    if own.dot(axis) < 0.0 { -axis } else { axis }
}

/// Counts turns on from the twists that were found last.
pub(crate) fn accept_twists(world: &mut World) {
    let time_s = world.resource::<Clock>().time_s;
    let mut tethers = world.query::<(&Twist, &mut AcceptedTwist)>();
    for (twist, mut accepted) in tethers.iter_mut(world) {
        *accepted = AcceptedTwist {
            twist_rad: twist.twist_rad,
            rate_rad_s: twist.rate_rad_s,
            time_s,
        };
    }
}
