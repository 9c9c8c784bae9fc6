//! The stable step of a world as it stands: which segment limits it, and to what.

use std::collections::BTreeMap;

use aerobot_components::body::Anchor;
use aerobot_components::segment::{KelvinVoigt, Segment, SegmentGeometry};
use aerobot_components::state::{AddedInertia, Attitude, Inertia, Mass};
use aerobot_components::tether::{Attachment, TetherPoint};
use aerobot_components::torsion::{Torsion, Twist};
use aerobot_components::winch::Reeled;
use aerobot_systems::dynamics::rigid_body::CarriedMass;
use aerobot_systems::integration::stability::largest_stable_step_s;
use aerobot_systems::integration::stable_step::{BodyMobility, Mobility, StiffSegment, stiffest};
use aerobot_systems::integration::torsional_modes::{TwistedTether, fastest_twist};
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;
use glam::{DMat3, DVec3};

use crate::world::EntityName;

/// The largest step that fixed-step RK4 takes without growth on the axial motion of the tethers and on the
/// turning of bodies that their torsion restores, and what limits it. Drag and fast spin are not in it: they limit a step far later in any flight of a
/// balloon. Of trees of links: on all their linearised motion (`link_stable_step.rs`).
#[derive(Clone, Debug, PartialEq)]
pub struct StableStep {
    /// The step, s; infinite where nothing limits it.
    pub step_s: f64,
    /// The segment, tether (by its torsion) or body that sets it, as `tether/3`; empty where nothing does.
    pub segment: String,
}

/// Finds the stable step of a world whose last evaluation was of the state it is in.
pub(crate) fn find(world: &mut World) -> StableStep {
    let (segments, names) = segments(world);
    let (points, bodies) = mobilities(world);
    let torsion = torsional_modes(world);
    let spring = stiffest(&segments, &points, &bodies, |segment| segment.stiffness_n_m);
    let damper = stiffest(&segments, &points, &bodies, |segment| segment.damping_n_s_m);
    // Where damping is proportional to stiffness both belong to one mode; else the stiffest spring and
    // the stiffest damper may be at home in different modes, and each also counts alone.
    // Of two stiffnesses at once, no mode is faster than the sum of what each makes alone.
    let (lambda, gamma) = (
        spring.eigenvalue + torsion.lambda,
        damper.eigenvalue + torsion.gamma,
    );
    let by_spring = largest_stable_step_s(lambda, 0.0);
    let by_damper = largest_stable_step_s(0.0, gamma);
    let together = largest_stable_step_s(lambda, gamma);
    let step_s = if damping_is_proportional(&segments) && torsion.tether.is_empty() {
        together
    } else {
        together.min(by_spring).min(by_damper)
    };
    let by_axial = largest_stable_step_s(spring.eigenvalue, 0.0)
        .min(largest_stable_step_s(0.0, damper.eigenvalue));
    if torsion.step_s() < by_axial {
        return StableStep {
            step_s,
            segment: torsion.tether,
        };
    }
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

/// The stable step by torsion alone.
pub(crate) fn by_torsion(world: &mut World) -> StableStep {
    let modes = torsional_modes(world);
    StableStep {
        step_s: modes.step_s(),
        segment: modes.tether,
    }
}

/// Bounds of the torsional motion.
struct TorsionalModes {
    /// Squared frequency, 1/s^2.
    lambda: f64,
    /// Damping rate, 1/s.
    gamma: f64,
    /// Name of the tether that takes the largest part; empty where there is none.
    tether: String,
}

impl TorsionalModes {
    /// The largest step that is stable whether both bounds belong to one mode or to two.
    fn step_s(&self) -> f64 {
        let (lambda, gamma) = (self.lambda, self.gamma);
        [(lambda, 0.0), (0.0, gamma), (lambda, gamma)]
            .map(|(lambda, gamma)| largest_stable_step_s(lambda, gamma))
            .into_iter()
            .fold(f64::INFINITY, f64::min)
    }
}

fn torsional_modes(world: &mut World) -> TorsionalModes {
    let mut query = world.query::<(&Torsion, &Twist, &EntityName)>();
    let mut found: Vec<_> = query
        .iter(world)
        .map(|(torsion, twist, name)| (torsion.clone(), *twist, name.0.to_string()))
        .collect();
    found.sort_by_key(|(torsion, ..)| torsion.points.start);
    let mut indices: BTreeMap<Entity, usize> = BTreeMap::new();
    let mut inverse_inertias = Vec::new();
    let mut tethers = Vec::new();
    for (torsion, twist, _) in &found {
        let mut arms = Vec::new();
        for (end, arm) in [
            (torsion.from.carrier, -twist.from_arm),
            (torsion.to.carrier, twist.to_arm),
        ] {
            if world.get::<Anchor>(end).is_some() {
                continue;
            }
            let body = *indices.entry(end).or_insert_with(|| {
                inverse_inertias.push(body_mobility(world, end).inverse_inertia);
                inverse_inertias.len() - 1
            });
            arms.push((body, arm));
        }
        tethers.push(TwistedTether {
            stiffness_n_m: torsion.stiffness_n_m,
            damping_n_m_s: torsion.damping_n_m_s,
            arms,
        });
    }
    let (lambda, stiffest) = fastest_twist(&tethers, &inverse_inertias, |t| t.stiffness_n_m);
    let (gamma, most_damped) = fastest_twist(&tethers, &inverse_inertias, |t| t.damping_n_m_s);
    let limiting = if largest_stable_step_s(0.0, gamma) < largest_stable_step_s(lambda, 0.0) {
        most_damped
    } else {
        stiffest
    };
    TorsionalModes {
        lambda,
        gamma,
        tether: found
            .get(limiting)
            .map_or_else(String::new, |(.., name)| name.clone()),
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
