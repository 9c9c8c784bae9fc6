//! The stable step of a world as it stands: which segment limits it, and to what.

use std::collections::BTreeMap;

use aerobot_components::body::Anchor;
use aerobot_components::segment::{KelvinVoigt, Segment, SegmentGeometry};
use aerobot_components::state::{AddedInertia, Attitude, Inertia, Mass};
use aerobot_components::tether::{Attachment, TetherPoint};
use aerobot_components::winch::Reeled;
use aerobot_systems::dynamics::rigid_body::CarriedMass;
use aerobot_systems::integration::stability::largest_stable_step_s;
use aerobot_systems::integration::stable_step::{BodyMobility, Mobility, StiffSegment, stiffest};
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;
use glam::{DMat3, DVec3};

use crate::world::EntityName;

/// The largest step that fixed-step RK4 takes without growth on the axial motion of the tethers, and
/// what limits it. Drag and fast spin are not in it: they limit a step far later in any flight of a
/// balloon. Of trees of links: on all their linearised motion (`link_stable_step.rs`).
#[derive(Clone, Debug, PartialEq)]
pub struct StableStep {
    /// The step, s; infinite where nothing limits it.
    pub step_s: f64,
    /// The segment or body that sets it, as `tether/3`; empty where nothing does.
    pub segment: String,
}

/// Finds the stable step of a world whose last evaluation was of the state it is in.
pub(crate) fn find(world: &mut World) -> StableStep {
    let (segments, names) = segments(world);
    let (points, bodies) = mobilities(world);
    let spring = stiffest(&segments, &points, &bodies, |segment| segment.stiffness_n_m);
    let damper = stiffest(&segments, &points, &bodies, |segment| segment.damping_n_s_m);
    // Where damping is proportional to stiffness both belong to one mode; else the stiffest spring and
    // the stiffest damper may be at home in different modes, and each also counts alone.
    let by_spring = largest_stable_step_s(spring.eigenvalue, 0.0);
    let by_damper = largest_stable_step_s(0.0, damper.eigenvalue);
    let together = largest_stable_step_s(spring.eigenvalue, damper.eigenvalue);
    let step_s = if damping_is_proportional(&segments) {
        together
    } else {
        together.min(by_spring).min(by_damper)
    };
    let limiting = if by_damper < by_spring {
        damper.segment
    } else {
        spring.segment
    };
    StableStep {
        step_s,
        segment: names.get(limiting).cloned().unwrap_or_default(),
    }
}

/// Whether all segments have the same ratio of damping to stiffness.
fn damping_is_proportional(segments: &[StiffSegment]) -> bool {
    let ratio = |segment: &StiffSegment| segment.damping_n_s_m / segment.stiffness_n_m;
    let Some(first) = segments.first().map(ratio) else {
        return true;
    };
    segments
        .iter()
        .all(|segment| (ratio(segment) - first).abs() <= 1e-9 * first.abs())
}

fn segments(world: &mut World) -> (Vec<StiffSegment>, Vec<String>) {
    let mut found: Vec<(Segment, StiffSegment)> = world
        .query::<(&Segment, &KelvinVoigt, &SegmentGeometry, Option<&Reeled>)>()
        .iter(world)
        .map(|(segment, spring, geometry, reeled)| {
            // At a winch it becomes shorter, and the node beyond it lighter.
            let part = reeled.map_or(1.0, |reeled| {
                reeled.shortest_part * 0.5 * (1.0 + reeled.shortest_part)
            });
            let stiff = StiffSegment {
                from_point: segment.from_point,
                direction: geometry.direction,
                stiffness_n_m: spring.stiffness_n_m / part,
                damping_n_s_m: spring.damping_n_s_m / part,
            };
            (*segment, stiff)
        })
        .collect();
    found.sort_by_key(|(segment, _)| segment.from_point);
    found
        .into_iter()
        .map(|(segment, stiff)| {
            let tether = world
                .get::<EntityName>(segment.tether)
                .map_or("", |name| &name.0)
                .to_owned();
            (stiff, format!("{tether}/{}", segment.number))
        })
        .unzip()
}

fn mobilities(world: &mut World) -> (Vec<Mobility>, Vec<BodyMobility>) {
    let mut points: Vec<(usize, Entity)> = world
        .query::<(&TetherPoint, Entity)>()
        .iter(world)
        .map(|(point, entity)| (point.index, entity))
        .collect();
    points.sort_unstable();
    let mut bodies = Vec::new();
    let mut indices: BTreeMap<Entity, usize> = BTreeMap::new();
    let mobilities = points
        .into_iter()
        .map(|(_, point)| {
            let Some(end) = world.get::<Attachment>(point).copied() else {
                let mass = world.get::<Mass>(point).map_or(0.0, |mass| mass.0);
                return Mobility::Node(1.0 / mass);
            };
            if world.get::<Anchor>(end.carrier).is_some() {
                return Mobility::Held;
            }
            let body = *indices.entry(end.carrier).or_insert_with(|| {
                bodies.push(body_mobility(world, end.carrier));
                bodies.len() - 1
            });
            let attitude = world
                .get::<Attitude>(end.carrier)
                .copied()
                .unwrap_or_default();
            Mobility::OnBody {
                body,
                arm_m: attitude.0 * end.offset_m,
            }
        })
        .collect();
    (mobilities, bodies)
}

/// The coupling of a carried mass to the turning of its body is left out: it is small, and on the
/// safe side.
fn body_mobility(world: &World, body: Entity) -> BodyMobility {
    let carried = world.get::<CarriedMass>(body).copied().unwrap_or_default();
    let mass = world.get::<Mass>(body).map_or(0.0, |mass| mass.0)
        + world.get::<AddedInertia>(body).map_or(0.0, |added| added.0)
        + carried.mass_kg;
    let attitude = world
        .get::<Attitude>(body)
        .map_or(DMat3::IDENTITY, |a| DMat3::from_quat(a.0));
    let inverse_inertia = world.get::<Inertia>(body).map_or(DMat3::ZERO, |inertia| {
        let about_centre = inertia.0
            + carried.inertia_kg_m2
            + parallel_axis(carried.first_moment_kg_m) * (1.0 / mass);
        attitude * about_centre.inverse() * attitude.transpose()
    });
    BodyMobility {
        inverse_mass: 1.0 / mass,
        inverse_inertia,
    }
}

/// `s s' - s^2 I`.
fn parallel_axis(s: DVec3) -> DMat3 {
    DMat3::from_cols(s * s.x, s * s.y, s * s.z)
        - DMat3::from_diagonal(DVec3::splat(s.length_squared()))
}
