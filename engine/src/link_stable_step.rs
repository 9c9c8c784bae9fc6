//! The stable step of trees of links: the fastest of their transverse waves, of bodies turning about their
//! joints, of elastic links, and of what drag and dampers bring to rest, at the tensions of the start.

use aerobot_systems::dynamics::state_space::StateSpace;
use aerobot_systems::integration::stability::largest_stable_step_s;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;

use crate::builtin::recorder::segment_name;
use crate::linearisation::Linearisation;
use crate::stable_step::StableStep;
use crate::world::EntityName;

/// Shift of the matrix by which the motion of rigid links is probed, s: short against any of it.
const PROBE_S: f64 = 1e-6;
/// The same for elastic links, as a part of the stable step of their springs between point masses.
const PART_OF_SPRINGS: f64 = 1e-4;
/// Power iterations, each a solution with the whole tree; they come within 1 % of the limit.
const PROBES: usize = 60;
const MARGIN: f64 = 1.01;
/// A longer step than this, s, is limited by round-off of forces alone.
const NO_LIMIT_S: f64 = 1e5;

/// Finds the stable step with the linearised motion of a world whose last evaluation was of the state it is
/// in; `springs` is the stable step of its springs, if links are elastic.
pub(crate) fn find(
    world: &mut World,
    linearisation: &mut Linearisation,
    state: &mut dyn StateSpace,
    springs: Option<&StableStep>,
) -> StableStep {
    linearisation.linearise(world);
    let none = StableStep {
        step_s: f64::INFINITY,
        segment: String::new(),
    };
    let probe_s = springs.map_or(PROBE_S, |springs| PART_OF_SPRINGS * springs.step_s);
    if linearisation.factorise(probe_s, 1.0).is_err() {
        return none;
    }
    let mut motion = Motion {
        probe_s,
        scratch: vec![0.0; state.layout().len()],
        coordinates: state.layout().coordinates,
        linearisation,
    };
    let elastic = motion.largest(|motion, q| motion.pushed_back(q));
    let damped = motion.largest(|motion, q| motion.braked(q));
    let (lambda, gamma) = (MARGIN * elastic.0, MARGIN * damped.0);
    // The fastest vibration and the strongest damper may be of one mode or of two.
    let by_damper = largest_stable_step_s(0.0, gamma);
    let step_s = largest_stable_step_s(lambda, 0.0)
        .min(by_damper)
        .min(largest_stable_step_s(lambda, gamma));
    if step_s > NO_LIMIT_S {
        return none;
    }
    let place = if by_damper == step_s {
        damped.1
    } else {
        elastic.1
    };
    let part = state.owner(world, place);
    StableStep {
        step_s,
        segment: part.map_or_else(String::new, |part| name_of(world, part)),
    }
}

/// A linearised motion whose matrix (M - g D - g^2 K), with g short, has been factorised: it solves
/// (M - g D - g^2 K) V = g M r_v + g^2 K r_x for motions that the joints allow.
struct Motion<'a> {
    /// g, s.
    probe_s: f64,
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
        self.solve(0, q, 1.0 / (self.probe_s * self.probe_s))
    }

    /// What the joints allow of `q`, but for what D makes of it within g.
    fn allowed(&mut self, q: &[f64]) -> Vec<f64> {
        self.solve(self.coordinates, q, 1.0 / self.probe_s)
    }

    /// M^-1 D q, as a difference.
    fn braked(&mut self, q: &[f64]) -> Vec<f64> {
        // Round-off that the joints do not allow would be taken for a brake.
        let before = self.allowed(q);
        let mut after = self.allowed(&before);
        for (after, before) in after.iter_mut().zip(before) {
            *after = (*after - before) / self.probe_s;
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

/// The name of a body or node, or `tether/3` of a segment.
fn name_of(world: &World, part: Entity) -> String {
    if let Some(name) = world.get::<EntityName>(part) {
        return name.0.to_string();
    }
    let (tether, number) = segment_name(world, part);
    format!("{tether}/{number}")
}
