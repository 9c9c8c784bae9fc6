//! Multipliers of loops with states of self-stress.
//!
//! What the lengths of redundant tethers say twice is asked once: along the states z, taken to the multipliers
//! and made orthonormal, the equation of the loops gives way to the one that tensions share the load with the
//! least elastic energy:
//!
//! ```text
//! (1 - z z') (A lambda - b) = 0        sum_i Z_i kappa_i T_i = 0
//! ```
//!
//! T_i the tension of limb i, linear in lambda, kappa_i its compliance, Z_i its part of the state. So no
//! tension has to answer for what a link that hangs slightly askew takes off the length of one tether of four:
//! the elasticity of real ones takes it up.

use glam::DVec3;
use nalgebra::{DMatrix, DVector, Dyn, LU};

/// The equations of a redundant set of loops.
#[derive(Clone, Debug)]
pub(super) struct SharedLoad {
    /// z, each by multiplier.
    states: Vec<DVector<f64>>,
    /// Z kappa of each state, by limb.
    weights: Vec<Vec<f64>>,
    /// What makes the rows of energy weigh as much as those of A.
    scales: Vec<f64>,
    factor: LU<f64, Dyn, Dyn>,
}

impl SharedLoad {
    /// Of A (row by row), the states of self-stress by limb, with what limbs they are of and along what chords:
    /// `tip_limbs` carry the tips, in order; `holds` are the rows of the limbs' forces by multiplier.
    pub(super) fn new(
        matrix: &[f64],
        states: &[Vec<f64>],
        chords: &[DVec3],
        tip_limbs: &[usize],
        (holds, compliance): (&[f64], &[f64]),
    ) -> Self {
        let n = 3 * tip_limbs.len();
        let along_tips = |state: &Vec<f64>| {
            let parts = tip_limbs
                .iter()
                .flat_map(|limb| (state[*limb] * chords[*limb]).to_array());
            DVector::from_iterator(n, parts)
        };
        let mut tips: Vec<DVector<f64>> = states.iter().map(along_tips).collect();
        for k in 0..tips.len() {
            let (before, rest) = tips.split_at_mut(k);
            for other in before.iter() {
                let part = other.dot(&rest[0]);
                rest[0].axpy(-part, other, 1.0);
            }
            let norm = rest[0].norm();
            rest[0] /= norm;
        }
        let a = DMatrix::from_row_slice(n, n, matrix);
        let mut whole = a.clone();
        for z in &tips {
            let row = a.tr_mul(z);
            whole.ger(-1.0, z, &row, 1.0);
        }
        let (mut weights, mut scales) = (Vec::new(), Vec::new());
        for (z, state) in tips.iter().zip(states) {
            let weight: Vec<f64> = state.iter().zip(compliance).map(|(z, c)| z * c).collect();
            let mut row = DVector::<f64>::zeros(n);
            for (limb, weight) in weight.iter().enumerate() {
                for (axis, part) in chords[limb].to_array().into_iter().enumerate() {
                    let hold = &holds[(3 * limb + axis) * n..(3 * limb + axis + 1) * n];
                    for (entry, hold) in row.iter_mut().zip(hold) {
                        *entry -= weight * part * hold;
                    }
                }
            }
            let scale = a.diagonal().amax() / row.amax().max(f64::MIN_POSITIVE);
            whole.ger(scale, z, &row, 1.0);
            weights.push(weight);
            scales.push(scale);
        }
        Self {
            states: tips,
            weights,
            scales,
            factor: whole.lu(),
        }
    }

    /// Takes from gaps what no multiplier has to answer for.
    pub(super) fn drop_redundant(&self, gaps: &mut [DVec3]) {
        for z in &self.states {
            let parts = gaps.iter().zip(z.as_slice().chunks_exact(3));
            let along: f64 = parts.map(|(gap, z)| gap.dot(DVec3::from_slice(z))).sum();
            for (gap, z) in gaps.iter_mut().zip(z.as_slice().chunks_exact(3)) {
                *gap -= along * DVec3::from_slice(z);
            }
        }
    }

    /// Solves for the multipliers that close `gaps`; `holds` are the forces of the limbs without them.
    pub(super) fn solve(
        &self,
        gaps: &[DVec3],
        chords: &[DVec3],
        holds: Option<&[DVec3]>,
        out: &mut [f64],
    ) {
        let mut gaps = gaps.to_vec();
        self.drop_redundant(&mut gaps);
        let wanted = gaps.iter().flat_map(|gap| (-*gap).to_array());
        let mut right = DVector::from_iterator(out.len(), wanted);
        for ((z, weights), scale) in self.states.iter().zip(&self.weights).zip(&self.scales) {
            let energy: f64 = holds.map_or(0.0, |holds| {
                let limbs = weights.iter().zip(chords).zip(holds);
                limbs.map(|((w, u), hold)| w * u.dot(*hold)).sum()
            });
            right.axpy(scale * energy, z, 1.0);
        }
        if self.factor.solve_mut(&mut right) {
            out.copy_from_slice(right.as_slice());
        } else {
            out.fill(0.0);
        }
    }
}
