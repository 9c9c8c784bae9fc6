//! Rigid links at rest, found with springs: the method of multipliers.
//!
//! A state of rest is found with springs of the tether's stiffness k. Where links keep their length L, each
//! spring's length at rest is shortened until it is L under its tension T, which is then the force of the
//! constraint:
//!
//! ```text
//! L0 := L0 - (length - L)        length -> L, T = k (length - L0)
//! ```
//!
//! Tensions follow from what hangs and hardly from lengths, so every pass takes off all of the error but
//! about the strain (Hestenes 1969; Bertsekas 1982, ch. 2).

use std::collections::BTreeMap;

use aerobot_components::segment::{KelvinVoigt, RigidLink, Segment, SegmentGeometry};
use aerobot_components::tether::Tether;
use bevy_ecs::entity::Entity;
use bevy_ecs::query::With;
use bevy_ecs::world::World;

use crate::scene::SetupError;

/// Lengths within this part of L are right.
const TOLERANCE: f64 = 1e-13;
/// Lengths within this part of L are right where no pass makes them better.
const GOOD_ENOUGH: f64 = 1e-9;
/// A pass that leaves more than this part of the error is the last one.
const LEAST_GAIN: f64 = 0.7;
const MOST_PASSES: usize = 60;

/// Brings every rigid link to its length by solving anew with other lengths at rest. Where that cannot
/// be, for the two ends of a tether are held elsewhere, springs are left as they were solved first.
///
/// # Errors
/// As `solve`.
pub(super) fn impose(
    world: &mut World,
    mut solve: impl FnMut(&mut World) -> Result<(), SetupError>,
) -> Result<(), SetupError> {
    let lengths_m = lengths_m(world);
    if lengths_m.is_empty() {
        return Ok(());
    }
    let mut error = largest_error(world, &lengths_m);
    for _ in 0..MOST_PASSES {
        if error <= TOLERANCE {
            return Ok(());
        }
        shorten(world, &lengths_m);
        let solved = solve(world);
        let now = largest_error(world, &lengths_m);
        if solved.is_err() || now > LEAST_GAIN * error {
            if solved.is_ok() && now <= GOOD_ENOUGH {
                return Ok(());
            }
            release(world, &lengths_m);
            return solve(world);
        }
        error = now;
    }
    Ok(())
}

/// The lengths that rigid links keep, m.
fn lengths_m(world: &mut World) -> BTreeMap<Entity, f64> {
    let mut links = world.query_filtered::<(Entity, &Segment), With<RigidLink>>();
    let found: Vec<(Entity, Entity)> = links
        .iter(world)
        .map(|(link, segment)| (link, segment.tether))
        .collect();
    found
        .into_iter()
        .filter_map(|(link, tether)| Some((link, world.get::<Tether>(tether)?.segment_length_m())))
        .collect()
}

/// Largest error of a length, as a part of it; lengths are those of the last evaluation.
fn largest_error(world: &World, lengths_m: &BTreeMap<Entity, f64>) -> f64 {
    let errors = lengths_m.iter().filter_map(|(link, length_m)| {
        let geometry = world.get::<SegmentGeometry>(*link)?;
        Some((geometry.length_m / length_m - 1.0).abs())
    });
    errors.fold(0.0, f64::max)
}

fn shorten(world: &mut World, lengths_m: &BTreeMap<Entity, f64>) {
    for (link, length_m) in lengths_m {
        let stretched_m = world
            .get::<SegmentGeometry>(*link)
            .map_or(*length_m, |geometry| geometry.length_m);
        if let Some(mut spring) = world.get_mut::<KelvinVoigt>(*link) {
            spring.rest_length_m -= stretched_m - length_m;
        }
    }
}

/// Gives springs the lengths at rest of the scene.
fn release(world: &mut World, lengths_m: &BTreeMap<Entity, f64>) {
    for (link, length_m) in lengths_m {
        if let Some(mut spring) = world.get_mut::<KelvinVoigt>(*link) {
            spring.rest_length_m = *length_m;
        }
    }
}
