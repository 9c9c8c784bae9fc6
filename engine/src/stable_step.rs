//! The stable step of a world as it stands: which segment limits it, and to what.

use std::collections::BTreeMap;

use aerobot_components::body::Anchor;
use aerobot_components::segment::{KelvinVoigt, Segment, SegmentGeometry};
use aerobot_components::state::{AddedInertia, Attitude, Inertia, Mass};
use aerobot_components::tether::{Attachment, TetherPoint};
use aerobot_systems::dynamics::rigid_body::CarriedMass;
use aerobot_systems::dynamics::state_space::StateSpace;
use aerobot_systems::integration::stability::largest_stable_step_s;
use aerobot_systems::integration::stable_step::{BodyMobility, Mobility, StiffSegment, stiffest};
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;
use glam::{DMat3, DVec3};

use crate::builtin::recorder::segment_name;
use crate::linearisation::Linearisation;
use crate::world::EntityName;

/// The largest step that fixed-step RK4 takes without growth on the axial motion of the tethers, and
/// what limits it. Drag and fast spin are not in it: they limit a step far later in any flight of a
/// balloon. Of trees of links: on all their linearised motion.
#[derive(Clone, Debug, PartialEq)]
pub struct StableStep {
    /// The step, s; infinite where no tether is.
    pub step_s: f64,
    /// The segment that sets it, as `tether/3`; empty where no tether is.
    pub segment: String,
}

/// Shift of the matrix by which motion in joint coordinates is probed, s: short against any of it.
const PROBE_S: f64 = 1e-6;
/// Power iterations, each a solution with the whole tree; they come within 1 % of the limit.
const PROBES: usize = 60;
const MARGIN: f64 = 1.01;

/// Finds the stable step of a tree of links with its linearised motion: the
/// fastest of its transverse waves, of bodies turning about their joints, of elastic links, and of what
/// drag and dampers bring to rest.
pub(crate) fn find_of_links(
    world: &mut World,
    linearisation: &mut Linearisation,
    state: &mut dyn StateSpace,
) -> StableStep {
    linearisation.linearise(world);
    let mut step = StableStep {
        step_s: f64::INFINITY,
        segment: String::new(),
    };
    if linearisation.factorise(PROBE_S, 1.0).is_err() {
        return step;
    }
    let mut motion = Motion {
        scratch: vec![0.0; state.layout().len()],
        coordinates: state.layout().coordinates,
        linearisation,
    };
    let elastic = motion.largest(|motion, q| motion.pushed_back(q));
    let damped = motion.largest(|motion, q| motion.braked(q));
    for (limit_s, place) in [
        (largest_stable_step_s(MARGIN * elastic.0, 0.0), elastic.1),
        (largest_stable_step_s(0.0, MARGIN * damped.0), damped.1),
    ] {
        if limit_s < step.step_s {
            step.step_s = limit_s;
            let part = state.owner(world, place);
            step.segment = part.map_or_else(String::new, |part| name_of(world, part));
        }
    }
    step
}

/// A linearised motion whose matrix (M - g D - g^2 K), with g short, has been factorised: it solves
/// (M - g D - g^2 K) V = g M r_v + g^2 K r_x for motions that the joints allow.
struct Motion<'a> {
    linearisation: &'a mut Linearisation,
    coordinates: usize,
    scratch: Vec<f64>,
}

impl Motion<'_> {
    /// V, scaled, for r_x or r_v at `first` of the state.
    fn solve(&mut self, first: usize, r: &[f64], scale: f64) -> Vec<f64> {
        self.scratch.fill(0.0);
        self.scratch[first..first + r.len()].copy_from_slice(r);
        self.linearisation.solve(&mut self.scratch);
        let v = &self.scratch[self.coordinates..2 * self.coordinates];
        v.iter().map(|v| v * scale).collect()
    }

    /// M^-1 K q.
    fn pushed_back(&mut self, q: &[f64]) -> Vec<f64> {
        self.solve(0, q, 1.0 / (PROBE_S * PROBE_S))
    }

    /// What the joints allow of `q`, but for what D makes of it within g.
    fn allowed(&mut self, q: &[f64]) -> Vec<f64> {
        self.solve(self.coordinates, q, 1.0 / PROBE_S)
    }

    /// M^-1 D q, as a difference.
    fn braked(&mut self, q: &[f64]) -> Vec<f64> {
        // Round-off that the joints do not allow would be taken for a brake.
        let before = self.allowed(q);
        let mut after = self.allowed(&before);
        for (after, before) in after.iter_mut().zip(before) {
            *after = (*after - before) / PROBE_S;
        }
        after
    }

    /// The largest eigenvalue of what `acts` on motions, and the coordinate that moves most.
    fn largest(&mut self, acts: impl Fn(&mut Self, &[f64]) -> Vec<f64>) -> (f64, usize) {
        // Neighbours out of phase, unevenly: close to the fastest mode and orthogonal to none.
        let sign = |k: usize| if (k / 3).is_multiple_of(2) { 1.0 } else { -1.0 };
        let mut q: Vec<f64> = (0..self.coordinates)
            .map(|k| sign(k) * (1.0 + 0.1 / (k as f64 + 1.0)))
            .collect();
        q = self.allowed(&q);
        let mut eigenvalue = 0.0;
        for _ in 0..PROBES {
            let norm = norm(&q);
            if norm == 0.0 || !norm.is_finite() {
                return (0.0, 0);
            }
            q.iter_mut().for_each(|x| *x /= norm);
            q = acts(self, &q);
            eigenvalue = self::norm(&q);
        }
        let place = (0..q.len()).max_by(|a, b| q[*a].abs().total_cmp(&q[*b].abs()));
        (eigenvalue, place.unwrap_or(0))
    }
}

fn norm(q: &[f64]) -> f64 {
    q.iter().map(|x| x * x).sum::<f64>().sqrt()
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

/// The name of a body or node, or `tether/3` of a segment.
fn name_of(world: &World, part: Entity) -> String {
    if let Some(name) = world.get::<EntityName>(part) {
        return name.0.to_string();
    }
    let (tether, number) = segment_name(world, part);
    format!("{tether}/{number}")
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
        .query::<(&Segment, &KelvinVoigt, &SegmentGeometry)>()
        .iter(world)
        .map(|(segment, spring, geometry)| {
            let stiff = StiffSegment {
                from_point: segment.from_point,
                direction: geometry.direction,
                stiffness_n_m: spring.stiffness_n_m,
                damping_n_s_m: spring.damping_n_s_m,
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
