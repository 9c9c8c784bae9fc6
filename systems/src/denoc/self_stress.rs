//! What the lengths of rigid tethers do not tell: states of self-stress.
//!
//! Taut tethers act on bodies as struts along their chords u, one length each. Tensions T that leave every body
//! without a load,
//!
//! ```text
//! J' T = 0        row i of J: -u_i at the place of the proximal end of limb i, u_i at that of its distal end
//! ```
//!
//! can be added to any solution: of four parallel tethers between two bodies there is one such state, of three
//! none. They are found once, as eigenvectors of J J' whose eigenvalue is almost zero, torques on a body counted
//! by its longest arm, and followed from there. What is taken for redundant and is not quite is held by the
//! elasticity of the tethers instead of by their lengths, which is no less true.

use glam::DVec3;
use nalgebra::DMatrix;

use crate::linearised_motion::body_block::Place;

/// Eigenvalues below this part of the largest are zero.
const ZERO: f64 = 1e-4;
/// A limb is a strut where its chord is shorter than it by less than this part: about what tethers stretch.
const STRAIGHT: f64 = 1e-3;

/// A limb as a strut.
#[derive(Clone, Copy, Debug)]
pub struct Strut {
    /// From its proximal to its distal end, m.
    pub chord_m: DVec3,
    /// Its length, m.
    pub length_m: f64,
    /// Whether its links are rigid.
    pub is_rigid: bool,
    /// The body at its proximal end, and the place there; an anchor if there is none.
    pub near: Option<(usize, Place)>,
    /// The same at its distal end; where it closes a loop, of what its tip is tied to.
    pub far: Option<(usize, Place)>,
}

impl Strut {
    /// Unit vector along its chord.
    #[must_use]
    pub fn direction(&self) -> DVec3 {
        self.chord_m.normalize_or_zero()
    }

    fn is_taut(&self) -> bool {
        self.is_rigid && self.chord_m.length() > (1.0 - STRAIGHT) * self.length_m
    }

    /// The longest arm at a body, m.
    fn arm_m(&self, body: usize) -> f64 {
        let ends = [&self.near, &self.far].into_iter().flatten();
        let own = ends.filter(|(other, _)| *other == body);
        // The cross-product matrix of r has twice the square of r in its entries.
        let turn = |place: &Place| {
            place
                .turn
                .to_cols_array()
                .iter()
                .map(|v| v * v)
                .sum::<f64>()
        };
        let squares = own.map(|(_, place)| 0.5 * turn(place));
        squares.fold(0.0, f64::max).sqrt()
    }

    /// What unit tensions of two struts do to the bodies that both hold: their entry of J J', with the longest
    /// arm of each body.
    fn with(&self, other: &Self, arms_m: &[f64]) -> f64 {
        let mut sum = 0.0;
        for (end, sign) in [(&self.near, -1.0), (&self.far, 1.0)] {
            for (other_end, other_sign) in [(&other.near, -1.0), (&other.far, 1.0)] {
                if let (Some((body, place)), Some((other_body, other_place))) = (end, other_end)
                    && body == other_body
                {
                    let (a, b) = (
                        place.load(sign * self.direction()),
                        other_place.load(other_sign * other.direction()),
                    );
                    let arm_m = arms_m[*body];
                    sum += a.linear.dot(b.linear);
                    if arm_m > 0.0 {
                        sum += a.angular.dot(b.angular) / (arm_m * arm_m);
                    }
                }
            }
        }
        sum
    }
}

/// The states of self-stress of a graph of struts.
#[derive(Clone, Debug, Default)]
pub struct SelfStress {
    /// Limbs that are struts: fixed at first sight, as is the number of states.
    struts: Option<Vec<usize>>,
    /// Tensions of all limbs in each state.
    pub states: Vec<Vec<f64>>,
}

impl SelfStress {
    /// Whether a first sight has found that there is none.
    #[must_use]
    pub fn is_absent(&self) -> bool {
        self.struts.is_some() && self.states.is_empty()
    }

    /// Finds the states for the struts as they stand now.
    pub fn find(&mut self, struts: &[Strut]) {
        let is_first = self.struts.is_none();
        let taut = self.struts.get_or_insert_with(|| {
            let limbs = 0..struts.len();
            limbs.filter(|limb| struts[*limb].is_taut()).collect()
        });
        if taut.is_empty() {
            return;
        }
        let ends = struts.iter().flat_map(|strut| [strut.near, strut.far]);
        let bodies = ends.flatten().map(|(body, _)| body + 1).max().unwrap_or(0);
        let arm_m = |body: usize| {
            let arms = struts.iter().map(|strut| strut.arm_m(body));
            arms.fold(0.0, f64::max)
        };
        let arms_m: Vec<f64> = (0..bodies).map(arm_m).collect();
        let entry = |i: usize, j: usize| struts[taut[i]].with(&struts[taut[j]], &arms_m);
        let decomposed = DMatrix::from_fn(taut.len(), taut.len(), entry).symmetric_eigen();
        let values = &decomposed.eigenvalues;
        let mut order: Vec<usize> = (0..taut.len()).collect();
        order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
        let count = if is_first {
            let largest = values.amax();
            order
                .iter()
                .filter(|k| values[**k] <= ZERO * largest)
                .count()
        } else {
            self.states.len()
        };
        self.states = order[..count]
            .iter()
            .map(|k| {
                let mut state = vec![0.0; struts.len()];
                for (limb, tension) in taut.iter().zip(decomposed.eigenvectors.column(*k).iter()) {
                    state[*limb] = *tension;
                }
                state
            })
            .collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    fn ring(count: usize, chord_m: DVec3) -> Vec<Strut> {
        let angle = |k: usize| std::f64::consts::TAU * k as f64 / count as f64;
        let strut = |k: usize| Strut {
            chord_m,
            length_m: 10.0,
            is_rigid: true,
            near: None,
            far: Some((
                0,
                Place::new(
                    DQuat::IDENTITY,
                    DVec3::new(angle(k).cos(), angle(k).sin(), 0.3),
                ),
            )),
        };
        (0..count).map(strut).collect()
    }

    #[test]
    fn parallel_tethers_beyond_three_are_redundant() {
        for (count, surplus) in [(1, 0), (2, 0), (3, 0), (4, 1), (6, 3)] {
            let mut stress = SelfStress::default();
            stress.find(&ring(count, -10.0 * DVec3::Z));
            assert_eq!(stress.states.len(), surplus, "{count}");
        }
        let mut stress = SelfStress::default();
        stress.find(&ring(4, -10.0 * DVec3::Z));
        for (k, tension) in stress.states[0].iter().enumerate() {
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            assert!((tension * sign * stress.states[0][0].signum() - 0.5).abs() < 1e-12);
        }
    }

    #[test]
    fn what_hangs_slack_is_no_strut() {
        let mut stress = SelfStress::default();
        stress.find(&ring(4, -9.0 * DVec3::Z));
        assert!(stress.states.is_empty());
    }
}
