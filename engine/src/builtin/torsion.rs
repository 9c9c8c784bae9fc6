//! Torsion of tethers: what holds their ends, and the law.

use aerobot_components::body::{Body, Fixed, Moving};
use aerobot_components::inertia::InertiaShape;
use aerobot_components::scene_component::FieldReport;
use aerobot_components::tether::{Attachment, Tether, TetherParts, TetherPoint};
use aerobot_components::torsion::{AcceptedTwist, ClampedEnd, Torsion, Twist};
use aerobot_systems::forces::torsion::{accept_twist, torsion, torsion_derivatives};
use bevy_ecs::world::World;
use glam::DVec3;

use crate::plugin::{Plugin, Simulator};
use crate::scene::{Scene, SetupError};
use crate::schedule::Phase;
use crate::world::SceneEntities;

/// Tethers that resist being twisted.
pub struct TorsionPlugin;

impl Plugin for TorsionPlugin {
    fn build(&self, simulator: &mut Simulator) {
        simulator
            .add_check(check_ends)
            .add_setup(set_up)
            .add_systems_if(Phase::Forces, has_torsion, || torsion)
            .add_systems_if(Phase::Derivatives, has_torsion, || torsion_derivatives)
            .add_systems_if(Phase::Constrain, has_torsion, || accept_twist);
    }
}

/// Whether a tether of the scene resists being twisted.
pub(super) fn has_torsion(scene: &Scene) -> bool {
    scene
        .with::<Tether>()
        .any(|(_, tether)| tether.torsion.is_some())
}

/// What does not turn cannot hold an end against turning.
fn check_ends(scene: &Scene, report: &mut FieldReport) {
    for (entity, tether) in scene.with::<Tether>() {
        if tether.torsion.is_none() {
            continue;
        }
        for end in [&tether.from, &tether.to] {
            let Some(carrier) = scene.entity(&end.0) else {
                continue;
            };
            let is_anchor = carrier.has::<Fixed>() || carrier.has::<Moving>();
            let is_point = carrier
                .get::<Body>()
                .is_some_and(|body| matches!(body.inertia, InertiaShape::Point));
            if is_point && !is_anchor {
                report.add(
                    &format!("{}.torsion", entity.path::<Tether>()),
                    format!(
                        "`{}` is a point: it cannot hold a tether against turning",
                        end.0
                    ),
                    "give the body an `inertia`, or leave out `torsion`",
                );
            }
        }
    }
}

/// The axes of the ends follow when everything is placed.
fn set_up(world: &mut World, scene: &Scene) -> Result<(), SetupError> {
    for (entity, tether) in scene.with::<Tether>() {
        let Some(id) = world.resource::<SceneEntities>().get(&entity.name) else {
            continue;
        };
        let (Some(spec), Some(parts)) = (tether.torsion, world.get::<TetherParts>(id)) else {
            continue;
        };
        let (Some(&first), Some(&last)) = (parts.points.first(), parts.points.last()) else {
            continue;
        };
        let clamped = |point| {
            let carrier = world.get::<Attachment>(point)?.carrier;
            let axis = DVec3::NEG_Z;
            let across = DVec3::X;
            Some(ClampedEnd {
                carrier,
                axis,
                across,
            })
        };
        let (Some(from), Some(to), Some(start)) = (
            clamped(first),
            clamped(last),
            world.get::<TetherPoint>(first).map(|point| point.index),
        ) else {
            continue;
        };
        let torsion = Torsion {
            stiffness_n_m: spec.stiffness_n_m2 / tether.length_m,
            damping_n_m_s: spec.damping_n_m_s,
            points: start..start + parts.points.len(),
            from,
            to,
        };
        world
            .entity_mut(id)
            .insert((torsion, Twist::default(), AcceptedTwist::default()));
    }
    Ok(())
}
