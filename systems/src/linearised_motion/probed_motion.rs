//! The fastest vibration and the strongest damper of a linearised motion, by what a stage makes of motions.
//!
//! A stage solves (M - g D - g^2 K) V = g M r_v + g^2 K r_x for motions that joints allow. With g short
//! against any of the motion, r_x = q gives V / g^2 = M^-1 K q, and r_v = q gives V / g = q + g M^-1 D q: power
//! iterations (Golub and Van Loan 2013, sec. 7.3.1) find the largest eigenvalue of either.

use crate::dynamics::state_space::Layout;

/// Power iterations, each a solution or two; they come within 1 % of the limit.
const PROBES: usize = 60;
const MARGIN: f64 = 1.01;

/// A linearised motion whose matrix has been factorised with a short g.
pub struct ProbedMotion<'a> {
    /// g, s.
    probe_s: f64,
    /// Solves a stage in place.
    stage: &'a mut dyn FnMut(&mut [f64]),
    coordinates: usize,
    scratch: Vec<f64>,
}

impl<'a> ProbedMotion<'a> {
    /// Of a state of this layout; `stage` solves a stage in place by a matrix factorised with g = `probe_s` (s).
    pub fn new(stage: &'a mut dyn FnMut(&mut [f64]), layout: Layout, probe_s: f64) -> Self {
        Self {
            probe_s,
            stage,
            coordinates: layout.coordinates,
            scratch: vec![0.0; layout.len()],
        }
    }

    /// The largest squared frequency (1/s^2), with a margin, and the coordinate that moves most with it.
    pub fn fastest_vibration(&mut self) -> (f64, usize) {
        self.largest(Self::pushed_back)
    }

    /// The largest damping rate (1/s), with a margin, and the coordinate that moves most with it.
    pub fn strongest_damper(&mut self) -> (f64, usize) {
        self.largest(Self::braked)
    }

    /// V, scaled, for r_x or r_v at `first` of the state.
    fn solve(&mut self, first: usize, r: &[f64], scale: f64) -> Vec<f64> {
        self.scratch.fill(0.0);
        self.scratch[first..first + r.len()].copy_from_slice(r);
        (self.stage)(&mut self.scratch);
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
        (MARGIN * eigenvalue, place.unwrap_or(0))
    }
}

fn norm(q: &[f64]) -> f64 {
    q.iter().map(|x| x * x).sum::<f64>().sqrt()
}
