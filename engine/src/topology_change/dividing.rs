//! Where the segment at a winch becomes two, or joins the next one.
//!
//! A new node stands on the straight line between the ends, at the place and with the velocity of the line there,
//! which comes out of the drum: neither strain nor its rate has a step. It takes its mass from the two ends in the
//! proportion in which it lies between them, and what its mass gains in speed the winch takes as an impulse along the
//! line: mass, momentum and centre of mass stay as they are. A node that is taken away gives its mass and momentum to
//! its neighbours; to a body as an impulse at the attachment.
//!
//! Rigid links then take what they do not allow by impulses of their own ([`crate::restructure`]): the part beyond
//! a new node keeps its length from there on, and a line that is bent where two links become one is straight
//! there, which moves what hangs on it.

use aerobot_components::body::Anchor;
use aerobot_components::segment::{KelvinVoigt, RigidLink};
use aerobot_components::state::{
    AddedInertia, AngularVelocity, Attitude, FirstOrderState, Inertia, Mass, Position, Velocity,
};
use aerobot_components::tether::{Attachment, Tether, TetherNode, TetherParts};
use aerobot_components::winch::ReeledLine;
use aerobot_systems::dynamics::rigid_body::{CarriedMass, accelerations};
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;
use glam::DVec3;

use super::renumbering::{place_in_order, renumber};
use crate::builtin::tethers::{spawn_node, spawn_segment};

/// Puts a node between the winch and the next point.
pub(super) fn divide(world: &mut World, line: Entity) {
    let (Some(reeled), Some(length_m)) =
        (world.get::<ReeledLine>(line).copied(), length(world, line))
    else {
        return;
    };
    let (Some(tether), Some(mut parts)) = (
        world.get::<Tether>(reeled.tether).cloned(),
        world.get::<TetherParts>(reeled.tether).cloned(),
    ) else {
        return;
    };
    let outer_m = reeled.nominal_m;
    let inner_m = length_m - outer_m;
    let part = inner_m / length_m;
    let (near, far) = (motion(world, reeled.near), motion(world, reeled.far));
    let node_kg = 0.5 * reeled.line_kg_m * length_m;
    let leaving_m_s = (far.0 - near.0) * ((1.0 - part) * reeled.rate_m_s / length_m);
    let velocity_m_s = near.1.lerp(far.1, part) + leaving_m_s;
    let between = (near.0.lerp(far.0, part), velocity_m_s);
    let node = spawn_node(world, reeled.tether, node_kg, between);
    if let Some(end) = world.get::<Attachment>(reeled.near).copied() {
        carry(world, &end, -0.5 * reeled.line_kg_m * outer_m);
        push(world, &end, -node_kg * leaving_m_s);
    }
    // Its number is given with all others.
    let segment = spawn_segment(world, reeled.tether, &tether, 1, 0);
    if world.get::<RigidLink>(reeled.segment).is_some() {
        world.entity_mut(segment).insert(RigidLink);
    }
    set_mass(
        world,
        reeled.far,
        reeled.far_mass_kg + 0.5 * reeled.line_kg_m * outer_m,
    );
    if is_at_start(&parts, &reeled) {
        parts.points.insert(1, node);
        parts.segments.insert(1, segment);
    } else {
        let last = parts.points.len() - 1;
        parts.points.insert(last, node);
        parts.segments.insert(last - 1, segment);
    }
    place_in_order(world, &parts, node);
    world.entity_mut(reeled.tether).insert(parts);
    world.entity_mut(line).insert(ReeledLine {
        far: node,
        far_mass_kg: 0.5 * reeled.line_kg_m * outer_m,
        near_and_stored_m: reeled.near_and_stored_m - outer_m,
        ..reeled
    });
    set_length(world, line, inner_m);
    renumber(world);
}

/// Takes the node next to the winch away, with the segment beyond it.
pub(super) fn join(world: &mut World, line: Entity) {
    let (Some(reeled), Some(length_m)) =
        (world.get::<ReeledLine>(line).copied(), length(world, line))
    else {
        return;
    };
    let Some(mut parts) = world.get::<TetherParts>(reeled.tether).cloned() else {
        return;
    };
    let at_start = is_at_start(&parts, &reeled);
    let (node_at, beyond_at, segment_at) = if at_start {
        (1, 2, 1)
    } else {
        let last = parts.points.len() - 1;
        (last - 1, last - 2, parts.segments.len() - 2)
    };
    let (node, beyond) = (parts.points[node_at], parts.points[beyond_at]);
    let segment = parts.segments[segment_at];
    if world.get::<KelvinVoigt>(segment).is_none() {
        return;
    }
    let joined_m = reeled.nominal_m;
    let half_kg_m = 0.5 * reeled.line_kg_m;
    let velocity = motion(world, node).1;
    take_in(world, reeled.near, half_kg_m * joined_m, velocity);
    let far_mass_kg = mass(world, beyond) - half_kg_m * joined_m;
    take_in(world, beyond, half_kg_m * length_m, velocity);
    parts.points.remove(node_at);
    parts.segments.remove(segment_at);
    world.despawn(node);
    world.despawn(segment);
    world.entity_mut(reeled.tether).insert(parts);
    world.entity_mut(line).insert(ReeledLine {
        far: beyond,
        far_mass_kg,
        near_and_stored_m: reeled.near_and_stored_m + joined_m,
        ..reeled
    });
    set_length(world, line, length_m + joined_m);
    renumber(world);
}

/// The segment beyond the one at the winch.
pub(super) fn next_segment(parts: &TetherParts, line: &ReeledLine) -> Option<Entity> {
    let count = parts.segments.len();
    let next = if is_at_start(parts, line) {
        1
    } else {
        count.checked_sub(2)?
    };
    parts.segments.get(next).copied()
}

/// Whether the winch is at `from`.
fn is_at_start(parts: &TetherParts, line: &ReeledLine) -> bool {
    parts.points.first() == Some(&line.near)
}

fn length(world: &World, line: Entity) -> Option<f64> {
    world.get::<FirstOrderState>(line).map(|state| state.value)
}

fn set_length(world: &mut World, line: Entity, length_m: f64) {
    if let Some(mut state) = world.get_mut::<FirstOrderState>(line) {
        state.value = length_m;
    }
}

fn mass(world: &World, point: Entity) -> f64 {
    world.get::<Mass>(point).map_or(0.0, |mass| mass.0)
}

fn set_mass(world: &mut World, point: Entity, mass_kg: f64) {
    if let Some(mut mass) = world.get_mut::<Mass>(point) {
        mass.0 = mass_kg;
    }
}

/// Position (m) and velocity (m/s) of a point.
fn motion(world: &World, point: Entity) -> (DVec3, DVec3) {
    (
        world.get::<Position>(point).map_or(DVec3::ZERO, |p| p.0),
        world.get::<Velocity>(point).map_or(DVec3::ZERO, |v| v.0),
    )
}

/// Adds a mass (kg) of this velocity (m/s) to a point: momentum stays as it is.
fn take_in(world: &mut World, point: Entity, mass_kg: f64, velocity_m_s: DVec3) {
    let own_kg = mass(world, point);
    let own_m_s = motion(world, point).1;
    set_mass(world, point, own_kg + mass_kg);
    if world.get::<TetherNode>(point).is_some() {
        let share = mass_kg / (own_kg + mass_kg);
        if let Some(mut velocity) = world.get_mut::<Velocity>(point) {
            velocity.0 = own_m_s.lerp(velocity_m_s, share);
        }
    } else if let Some(end) = world.get::<Attachment>(point).copied() {
        carry(world, &end, mass_kg);
        push(world, &end, mass_kg * (velocity_m_s - own_m_s));
    }
}

/// Adds to the mass (kg) that a body carries at an attachment.
fn carry(world: &mut World, end: &Attachment, mass_kg: f64) {
    if let Some(mut carried) = world.get_mut::<CarriedMass>(end.carrier) {
        carried.add(mass_kg, end.offset_m);
    }
}

/// Gives a body an impulse (N s) at an attachment.
fn push(world: &mut World, end: &Attachment, impulse_n_s: DVec3) {
    let body = end.carrier;
    if world.get::<Anchor>(body).is_some() {
        return;
    }
    let (Some(attitude), Some(carried)) = (
        world.get::<Attitude>(body).copied(),
        world.get::<CarriedMass>(body).copied(),
    ) else {
        return;
    };
    let mass_kg = mass(world, body)
        + world.get::<AddedInertia>(body).map_or(0.0, |added| added.0)
        + carried.mass_kg;
    let inertia = world.get::<Inertia>(body).map(|inertia| inertia.0);
    let impulse = attitude.0.conjugate() * impulse_n_s;
    // Of bodies at rest, impulses are to velocities what forces are to accelerations.
    let (linear, angular) = match inertia {
        Some(inertia) => accelerations(
            mass_kg,
            carried.first_moment_kg_m,
            inertia + carried.inertia_kg_m2,
            DVec3::ZERO,
            impulse,
            end.offset_m.cross(impulse),
        ),
        None => (impulse / mass_kg, DVec3::ZERO),
    };
    if let Some(mut velocity) = world.get_mut::<Velocity>(body) {
        velocity.0 += attitude.0 * linear;
    }
    if let Some(mut rate) = world.get_mut::<AngularVelocity>(body) {
        rate.0 += angular;
    }
}
