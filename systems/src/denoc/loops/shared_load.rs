//! Multipliers of loops with states of self-stress.
//!
//! What the lengths of redundant tethers say twice is asked once: along the states z, taken to the multipliers
//! and made orthonormal, the equation of the loops gives way to the elasticity of the tethers. Tips that are
//! d_i beyond their places along their chords u_i, limbs that are stretched by kappa_i T_i, T_i their tension,
//! fit together if for every state
//!
//! ```text
//! (1 - z z') (A lambda - b) = 0        sum_i Z_i kappa_i T_i = -sum_tips Z_i u_i.(d_i + tau d_i')
//! ```
//!
//! with Z_i the parts of the state and tau the retardation of a damper beside each spring (Kelvin-Voigt). Closed
//! tips share the load with the least elastic energy (Castigliano); a motion that redundant tethers cannot follow
//! with their lengths, such as of a ring of four that swings and turns at once, opens them as far as their
//! stiffness allows. T is linear in lambda.
//!
//! An implicit stage solves for increments V = V_0 + .. of velocities, x = g (V + r_x) of positions and mu = g
//! d lambda, for which the same law says
//!
//! ```text
//! sum_i Z_i kappa_i T_i(mu) + g (g + tau) Z u.G V = -g^2 Z u.G r_x
//! ```

use glam::DVec3;
use nalgebra::{DMatrix, DVector, Dyn, LU};

use super::{LimbElasticity, Told};

/// What the equations of the states ask for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Law {
    /// Forces, or changes of positions and velocities.
    Forces,
    /// Increments of an implicit stage with this g, s.
    Stage(f64),
}

/// One state of self-stress.
#[derive(Clone, Debug)]
struct State {
    /// z.
    direction: DVector<f64>,
    /// Z u of the tips.
    along_tips: DVector<f64>,
    /// Z kappa, by limb.
    weights: Vec<f64>,
    /// tau, s.
    retardation_s: f64,
    /// What makes its row weigh as much as those of A.
    scale: f64,
}

/// The equations of a redundant set of loops.
#[derive(Clone, Debug)]
pub(super) struct SharedLoad {
    states: Vec<State>,
    law: Law,
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
        (holds, elasticity): (&[f64], &[LimbElasticity]),
        law: Law,
    ) -> Self {
        let n = 3 * tip_limbs.len();
        let mut states: Vec<State> = states
            .iter()
            .map(|state| State::new(state, chords, tip_limbs, elasticity))
            .collect();
        make_orthonormal(&mut states);
        let a = DMatrix::from_row_slice(n, n, matrix);
        let largest = a.diagonal().amax();
        let mut whole = a.clone();
        for state in &states {
            let row = a.tr_mul(&state.direction);
            whole.ger(-1.0, &state.direction, &row, 1.0);
        }
        for state in &mut states {
            let mut row = DVector::<f64>::zeros(n);
            for (limb, weight) in state.weights.iter().enumerate() {
                for (axis, part) in chords[limb].to_array().into_iter().enumerate() {
                    let hold = &holds[(3 * limb + axis) * n..(3 * limb + axis + 1) * n];
                    for (entry, hold) in row.iter_mut().zip(hold) {
                        *entry -= weight * part * hold;
                    }
                }
            }
            if let Law::Stage(g) = law {
                let by_motion = g * (g + state.retardation_s);
                row += by_motion * a.tr_mul(&state.along_tips);
            }
            state.scale = largest / row.amax().max(f64::MIN_POSITIVE);
            whole.ger(state.scale, &state.direction, &row, 1.0);
        }
        Self {
            states,
            law,
            factor: whole.lu(),
        }
    }

    /// Takes from gaps what no multiplier has to answer for.
    pub(super) fn drop_redundant(&self, gaps: &mut [DVec3]) {
        for state in &self.states {
            let along = dot(&state.direction, gaps);
            let parts = state.direction.as_slice().chunks_exact(3);
            for (gap, z) in gaps.iter_mut().zip(parts) {
                *gap -= along * DVec3::from_slice(z);
            }
        }
    }

    /// Solves for the multipliers that close `gaps`: `chords` are those of the limbs, which hold what they carry
    /// with the forces `holds` (N) without the multipliers.
    pub(super) fn solve(
        &self,
        gaps: &[DVec3],
        limbs: (&[DVec3], &[DVec3]),
        told: Told<'_>,
        out: &mut [f64],
    ) {
        let mut closed = gaps.to_vec();
        self.drop_redundant(&mut closed);
        let wanted = closed.iter().flat_map(|gap| (-*gap).to_array());
        let mut right = DVector::from_iterator(out.len(), wanted);
        for state in &self.states {
            let asked = state.scale * self.asked(state, limbs, told);
            right.axpy(asked, &state.direction, 1.0);
        }
        if self.factor.solve_mut(&mut right) {
            out.copy_from_slice(right.as_slice());
        } else {
            out.fill(0.0);
        }
    }

    /// The right-hand side of the equation of a state.
    fn asked(&self, state: &State, (chords, holds): (&[DVec3], &[DVec3]), told: Told<'_>) -> f64 {
        match (told, self.law) {
            (Told::Forces(open), Law::Forces) => {
                let limbs = state.weights.iter().zip(chords).zip(holds);
                let held: f64 = limbs.map(|((w, u), hold)| w * u.dot(*hold)).sum();
                let open: Vec<DVec3> = open
                    .iter()
                    .map(|[gap_m, rate_m_s]| *gap_m + state.retardation_s * *rate_m_s)
                    .collect();
                held - dot(&state.along_tips, &open)
            }
            (Told::Stage(moved, given_m), Law::Stage(g)) => {
                let by_motion = g * (g + state.retardation_s) * dot(&state.along_tips, moved);
                -by_motion - g * g * dot(&state.along_tips, given_m)
            }
            _ => 0.0,
        }
    }
}

impl State {
    fn new(
        state: &[f64],
        chords: &[DVec3],
        tip_limbs: &[usize],
        elasticity: &[LimbElasticity],
    ) -> Self {
        let parts = tip_limbs
            .iter()
            .flat_map(|limb| (state[*limb] * chords[*limb]).to_array());
        let along_tips = DVector::from_iterator(3 * tip_limbs.len(), parts);
        let limbs = state.iter().zip(elasticity);
        let retarded: f64 = limbs.map(|(z, limb)| z.abs() * limb.retardation_s).sum();
        let whole: f64 = state.iter().map(|z| z.abs()).sum();
        Self {
            direction: along_tips.clone(),
            along_tips,
            weights: state
                .iter()
                .zip(elasticity)
                .map(|(z, limb)| z * limb.compliance_m_n)
                .collect(),
            // Of tethers that are equal, theirs.
            retardation_s: retarded / whole,
            scale: 1.0,
        }
    }
}

/// Gram and Schmidt's method.
fn make_orthonormal(states: &mut [State]) {
    for k in 0..states.len() {
        let (before, rest) = states.split_at_mut(k);
        let own = &mut rest[0].direction;
        for other in before.iter() {
            let part = other.direction.dot(own);
            own.axpy(-part, &other.direction, 1.0);
        }
        let norm = own.norm();
        *own /= norm;
    }
}

fn dot(direction: &DVector<f64>, gaps: &[DVec3]) -> f64 {
    let parts = gaps.iter().zip(direction.as_slice().chunks_exact(3));
    parts.map(|(gap, z)| gap.dot(DVec3::from_slice(z))).sum()
}
