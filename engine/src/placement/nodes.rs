//! Where the nodes of a tether start between its ends: on the straight line, or hanging in a catenary.

use aerobot_components::state::Position;
use aerobot_components::tether::{Attachment, Tether, TetherParts, TetherStart};
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;
use glam::DVec3;

use super::attachment_position;

/// Places the nodes of all tethers between their ends as they stand.
pub(super) fn place_nodes(world: &mut World) {
    let mut tethers = world.query::<(Entity, &Tether)>();
    let all: Vec<(Entity, bool)> = tethers
        .iter(world)
        .map(|(entity, tether)| (entity, tether.start == TetherStart::Equilibrium))
        .collect();
    for (tether, may_sag) in all {
        if may_sag {
            place_sagging(world, tether);
        } else {
            place_on_line(world, tether);
        }
    }
}

/// Puts the nodes of a tether on the straight line between its ends, equally spaced.
pub(super) fn place_on_line(world: &mut World, tether: Entity) {
    let Some((from, to, count)) = span(world, tether) else {
        return;
    };
    let positions: Vec<DVec3> = (1..=count)
        .map(|number| from.lerp(to, number as f64 / (count + 1) as f64))
        .collect();
    set_node_positions(world, tether, &positions);
}

/// As [`place_on_line`], but a line longer than its span hangs in its catenary
/// z = a cosh((x - x0)/a) + c, with sinh(h/2a)/(h/2a) = sqrt(l^2 - v^2)/h for a line of length l over
/// the horizontal distance h and the height v, and x0 = h/2 - a artanh(v/l) (Irvine 1981).
pub(super) fn place_sagging(world: &mut World, tether: Entity) {
    let Some((from, to, count)) = span(world, tether) else {
        return;
    };
    let Some(line) = world.get::<Tether>(tether) else {
        return;
    };
    let (length, segments) = (line.length_m, f64::from(line.segments()));
    if length <= from.distance(to) {
        return place_on_line(world, tether);
    }
    let across = (to - from).with_z(0.0);
    // Ends above one another: a narrow loop stands in for the folded line.
    let h = across.length().max(1e-4 * length);
    let direction = across.try_normalize().unwrap_or(DVec3::X);
    let v = to.z - from.z;
    let parameter = |l: f64| 0.5 * h / catenary_argument((l * l - v * v).sqrt() / h);
    let a = parameter(length);
    // Chords are shorter than arcs, and the line is stretched by its own weight: a line a little
    // longer leaves every segment taut.
    let weight_n_m = line.mass_kg() / length * STRETCHING_GRAVITY_M_S2;
    let chord = (length / (segments * a)).powi(2) / 24.0;
    let stretch = weight_n_m * (a + 0.5 * length) / line.axial_stiffness_n;
    let l = length * (1.0 + chord.min(0.1) + stretch.min(0.1));
    let a = parameter(l);
    let x0 = 0.5 * h - a * libm::atanh(v / l);
    let lowest = a * libm::sinh(x0 / a);
    let positions: Vec<DVec3> = (1..=count)
        .map(|number| {
            let arc = l * number as f64 / (count + 1) as f64 - lowest;
            let x = (x0 + a * libm::asinh(arc / a)) * across.length() / h;
            let z = libm::hypot(a, arc) - libm::hypot(a, lowest);
            from + x * direction + z * DVec3::Z
        })
        .collect();
    set_node_positions(world, tether, &positions);
}

/// Gravity for the stretch of a sagging guess, m/s^2: no planet of interest pulls much harder.
const STRETCHING_GRAVITY_M_S2: f64 = 10.0;

/// The x at which sinh(x)/x = `ratio`, for a ratio above one.
fn catenary_argument(ratio: f64) -> f64 {
    let (mut low, mut high) = (1e-9, 700.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if libm::sinh(middle) / middle < ratio {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

fn span(world: &World, tether: Entity) -> Option<(DVec3, DVec3, usize)> {
    let parts = world.get::<TetherParts>(tether)?;
    let end = |point: &Entity| {
        let end = world.get::<Attachment>(*point)?;
        Some(attachment_position(world, end.carrier, end.offset_m))
    };
    Some((
        end(parts.points.first()?)?,
        end(parts.points.last()?)?,
        parts.points.len() - 2,
    ))
}

/// Puts the nodes of a tether at `positions`, from its `from` on, m.
pub(super) fn set_node_positions(world: &mut World, tether: Entity, positions: &[DVec3]) {
    let Some(parts) = world.get::<TetherParts>(tether) else {
        return;
    };
    let nodes: Vec<Entity> = parts.points[1..parts.points.len() - 1].to_vec();
    for (node, place) in nodes.into_iter().zip(positions) {
        if let Some(mut position) = world.get_mut::<Position>(node) {
            position.0 = *place;
        }
    }
}
