//! Closed loops: multipliers that keep the tips of cut tethers where they belong, on top of the recursion.
//!
//! The tree without its loops moves as [`super::forward_dynamics`] says. What is missing are the forces lambda
//! at the cuts, on each tip and, opposite, on the place to which it is tied:
//!
//! ```text
//! M a = F + G' lambda     G a = c        G: how far tips leave their places
//! A lambda = c - G a_tree                A = G M^-1 G',  3 by 3 for each pair of the m loops
//! ```
//!
//! A is found loop by loop from the answers of the reduced tree to unit forces ([`super::reduced_tree`]), so
//! that the price is O(n) for the links, m times the number of limbs for A and m^3 for its factors, which
//! are few numbers beside those.
//!
//! **Redundant loops.** Three rigid tethers between two bodies are independent; of four, one is more than
//! the lengths can tell: A is singular, and forces with G' lambda = 0 could be added. Tethers that are
//! almost rigid are not in doubt: they share the load so that their elastic energy is the least
//! (Castigliano). Where the tethers of a graph are straight, [`super::self_stress`] says in advance which
//! combinations are redundant, and `shared_load.rs` puts the energy in the place of what they would say twice.
//! What becomes singular on the way is regularised: with H_i the force with which limb i holds what it carries,
//! and kappa_i its compliance,
//!
//! ```text
//! (A + eps sum_i R_i' kappa_i R_i) lambda = c - G a_tree - eps sum_i R_i' kappa_i H_i(tree)    R_i = dH_i/dlambda
//! ```
//!
//! for a small eps, followed by refinements with A itself: where A is regular they take the effect of eps
//! away, where it is not, the solution of least energy is left.
//!
//! **A tip has a mass**, so that the recursion can move it: a share of the mass of the body to which it is
//! tied, lent by that body at the very place, which changes nothing once the tip stays there. A tip that is
//! tied to an anchor has any mass.

use glam::DVec3;

mod shared_load;

use shared_load::SharedLoad;

use super::articulated_link::Coupling;
use super::reduced_tree::{Factors, ReducedTree};
use super::self_stress::{SelfStress, Strut};
use super::tree::KinematicTree;
use crate::linearised_motion::body_block::{Place, Twist};

/// eps, as a part of what makes it weigh as much as A.
const BY_ENERGY: f64 = 1e-9;
/// A pivot below this part of its diagonal is round-off.
const DEPENDENT: f64 = 1e-14;
const REFINEMENTS: usize = 3;

/// A tip, and the place on a body where it belongs.
#[derive(Clone, Copy, Debug)]
struct Tie {
    tip: usize,
    onto: Option<(usize, Place)>,
}

/// The loops of a tree at one state.
#[derive(Clone, Debug, Default)]
pub struct Loops {
    reduced: ReducedTree,
    ties: Vec<Tie>,
    /// kappa of each limb: how much it gives under a force, m/N, up to a common factor.
    compliance: Vec<f64>,
    /// A, row by row.
    matrix: Vec<f64>,
    /// R: of each limb and direction of its hold, a row.
    holds: Vec<f64>,
    /// eps.
    by_energy: f64,
    /// Lower triangular factor of A + eps R' kappa R.
    factor: Vec<f64>,
    multipliers: Vec<f64>,
    step: Vec<f64>,
    stress: SelfStress,
    /// Unit vectors along the limbs.
    chords: Vec<DVec3>,
    /// In the place of the factor, where there are states of self-stress.
    shared: Option<SharedLoad>,
}

impl Loops {
    /// Of a tree whose limbs have these compliances (m/N, up to a common factor).
    #[must_use]
    pub fn new(tree: &KinematicTree, compliance: Vec<f64>) -> Self {
        let n = 3 * tree.closures.len();
        Self {
            ties: Vec::with_capacity(tree.closures.len()),
            compliance,
            matrix: vec![0.0; n * n],
            holds: vec![0.0; 3 * tree.limbs.len() * n],
            factor: vec![0.0; n * n],
            multipliers: vec![0.0; n],
            step: vec![0.0; n],
            ..Self::default()
        }
    }

    /// Finds A and its factors from a factorised tree: `proximal` is the place of each limb on its parent,
    /// `onto` the place of each tip on its body, `chord` the chord of each limb with its length (m) and whether
    /// it is rigid.
    pub fn factorise<E: Coupling>(
        &mut self,
        tree: &KinematicTree,
        factors: &Factors<'_, E>,
        proximal: impl Fn(usize) -> Place,
        onto: impl Fn(usize, usize) -> Place,
        distal: impl Fn(usize) -> Place,
        chord: impl Fn(usize) -> (DVec3, f64, bool),
    ) {
        self.reduced.take(tree, factors, &proximal);
        self.ties.clear();
        for (index, closure) in tree.closures.iter().enumerate() {
            self.ties.push(Tie {
                tip: closure.tip,
                onto: closure.onto.map(|body| (body, onto(index, body))),
            });
        }
        let n = self.multipliers.len();
        for column in 0..n {
            let mut unit = [0.0; 3];
            unit[column % 3] = 1.0;
            self.load(column / 3, DVec3::from_array(unit));
            self.reduced.respond(tree);
            for row in 0..self.ties.len() {
                let gap = self.gap(row, &self.reduced.motions).to_array();
                for (k, part) in gap.into_iter().enumerate() {
                    self.matrix[(3 * row + k) * n + column] = part;
                }
            }
            for (limb, hold) in self.reduced.holds.iter().enumerate() {
                for (k, part) in hold.to_array().into_iter().enumerate() {
                    self.holds[(3 * limb + k) * n + column] = part;
                }
            }
        }
        let struts = self.struts(tree, proximal, distal, chord);
        self.stress.find(&struts);
        self.shared = None;
        if self.stress.states.is_empty() {
            self.factorise_matrix();
            return;
        }
        self.chords.clear();
        self.chords.extend(struts.iter().map(Strut::direction));
        let tips: Vec<usize> = tree.closures.iter().map(|closure| closure.limb).collect();
        self.shared = Some(SharedLoad::new(
            &self.matrix,
            &self.stress.states,
            &self.chords,
            &tips,
            (&self.holds, &self.compliance),
        ));
    }

    /// The limbs as struts between bodies.
    fn struts(
        &self,
        tree: &KinematicTree,
        proximal: impl Fn(usize) -> Place,
        distal: impl Fn(usize) -> Place,
        chord: impl Fn(usize) -> (DVec3, f64, bool),
    ) -> Vec<Strut> {
        let limbs = tree.limbs.iter().enumerate();
        limbs
            .map(|(index, limb)| {
                let tie = tree
                    .closures
                    .iter()
                    .position(|closure| closure.limb == index);
                let (chord_m, length_m, is_rigid) = chord(index);
                Strut {
                    chord_m,
                    length_m,
                    is_rigid,
                    near: limb.parent.map(|body| (body, proximal(index))),
                    far: match tie {
                        None => Some((limb.child, distal(index))),
                        Some(tie) => self.ties[tie].onto,
                    },
                }
            })
            .collect()
    }

    /// Takes from gaps of tips what the lengths of redundant tethers say twice, and no multiplier answers for.
    pub fn drop_redundant(&self, gaps: &mut [DVec3]) {
        if let Some(shared) = &self.shared {
            shared.drop_redundant(gaps);
        }
    }

    /// Puts a force on a tip, and its opposite on the place of the tip.
    fn load(&mut self, closure: usize, force: DVec3) {
        let Tie { tip, onto } = self.ties[closure];
        self.reduced.loads[tip].linear += force;
        if let Some((body, place)) = onto {
            let load = place.load(-force);
            self.reduced.loads[body].linear += load.linear;
            self.reduced.loads[body].angular += load.angular;
        }
    }

    /// How a tip leaves its place where bodies and tips move so; an anchor is taken to stand still.
    #[must_use]
    pub fn gap(&self, closure: usize, motions: &[Twist]) -> DVec3 {
        let Tie { tip, onto } = self.ties[closure];
        let place = onto.map_or(DVec3::ZERO, |(body, place)| place.motion(motions[body]));
        motions[tip].linear - place
    }

    fn factorise_matrix(&mut self) {
        let n = self.multipliers.len();
        let weighed = |i: usize, j: usize| -> f64 {
            let rows = self.holds.chunks_exact(n);
            let parts = rows.enumerate();
            parts
                .map(|(row, hold)| self.compliance[row / 3] * hold[i] * hold[j])
                .sum()
        };
        let diagonal = |i: usize| self.matrix[i * n + i];
        let ratio = |i: usize| diagonal(i) / weighed(i, i);
        let least = (0..n).map(ratio).fold(f64::INFINITY, f64::min);
        let by_energy = if least.is_finite() {
            BY_ENERGY * least
        } else {
            0.0
        };
        let mut factor = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..=i {
                let symmetric = 0.5 * (self.matrix[i * n + j] + self.matrix[j * n + i]);
                factor[i * n + j] = symmetric + by_energy * weighed(i, j);
            }
        }
        self.by_energy = by_energy;
        self.factor = factor;
        cholesky(&mut self.factor, n);
    }

    /// The multipliers that make the gaps (accelerations, velocities or displacements of tips from their
    /// places, less those wanted) vanish; `holds` are the forces of the limbs without them, where loads are
    /// to be shared.
    pub fn close(&mut self, gaps: &[DVec3], holds: Option<&[DVec3]>) {
        if let Some(shared) = &self.shared {
            shared.solve(gaps, &self.chords, holds, &mut self.multipliers);
            return;
        }
        let n = self.multipliers.len();
        let wanted = |row: usize| -gaps[row / 3][row % 3];
        self.multipliers.fill(0.0);
        for pass in 0..=REFINEMENTS {
            for row in 0..n {
                let matrix = &self.matrix[row * n..(row + 1) * n];
                let reached: f64 = matrix
                    .iter()
                    .zip(&self.multipliers)
                    .map(|(a, l)| a * l)
                    .sum();
                self.step[row] = wanted(row) - reached;
            }
            if let (0, Some(holds)) = (pass, holds) {
                for (row, of_limb) in self.holds.chunks_exact(n).enumerate() {
                    let pull = self.by_energy * self.compliance[row / 3] * holds[row / 3][row % 3];
                    for (step, hold) in self.step.iter_mut().zip(of_limb) {
                        *step -= pull * hold;
                    }
                }
            }
            substitute(&self.factor, n, &mut self.step);
            for (multiplier, step) in self.multipliers.iter_mut().zip(&self.step) {
                *multiplier += step;
            }
        }
    }

    /// The force on each tip that [`Loops::close`] found, N (or impulse, or what else was asked for).
    #[must_use]
    pub fn multiplier(&self, closure: usize) -> DVec3 {
        DVec3::from_slice(&self.multipliers[3 * closure..])
    }

    /// Adds the multipliers, and their opposites at the places of the tips, to loads of bodies and tips.
    pub fn add_loads(&self, loads: &mut [Twist]) {
        for (closure, tie) in self.ties.iter().enumerate() {
            let force = self.multiplier(closure);
            loads[tie.tip].linear += force;
            if let Some((body, place)) = tie.onto {
                let load = place.load(-force);
                loads[body].linear += load.linear;
                loads[body].angular += load.angular;
            }
        }
    }
}

/// Factorises the lower triangle of a symmetric matrix in place: L L'. A row that depends on those before is
/// left out: what is asked of it is answered with zero.
fn cholesky(a: &mut [f64], n: usize) {
    for j in 0..n {
        let (above, below) = a.split_at_mut((j + 1) * n);
        let row = &mut above[j * n..];
        let whole = row[j];
        let rest = whole - row[..j].iter().map(|v| v * v).sum::<f64>();
        let pivot = if rest > DEPENDENT * whole {
            rest.sqrt()
        } else {
            f64::INFINITY
        };
        row[j] = pivot;
        for other in below.chunks_exact_mut(n) {
            let known: f64 = row[..j].iter().zip(&other[..j]).map(|(a, b)| a * b).sum();
            other[j] = (other[j] - known) / pivot;
        }
    }
}

/// Solves `L L' x = b` in place.
fn substitute(factor: &[f64], n: usize, b: &mut [f64]) {
    for i in 0..n {
        let row = &factor[i * n..(i + 1) * n];
        let known: f64 = row[..i].iter().zip(&*b).map(|(l, x)| l * x).sum();
        b[i] = (b[i] - known) / row[i];
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|k| factor[k * n + i] * b[k]).sum();
        b[i] = (b[i] - known) / factor[i * n + i];
    }
}
