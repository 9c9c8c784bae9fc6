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
//! almost rigid are not in doubt: they share the load by their elasticity. Where the tethers of a graph are
//! straight, [`super::self_stress`] says in advance which combinations are redundant, and `shared_load.rs` puts
//! the elasticity of the tethers in the place of what their lengths would say twice. What becomes singular on
//! the way is regularised: with H_i the force with which limb i holds what it carries, and kappa_i its
//! compliance,
//!
//! ```text
//! (A + eps sum_i R_i' kappa_i R_i) lambda = c - G a_tree - eps sum_i R_i' kappa_i H_i(tree)    R_i = dH_i/dlambda
//! ```
//!
//! for a small eps, followed by refinements with A itself: where A is regular they take the effect of eps
//! away, where it is not, the solution of least energy is left. Where no pivot of A is small there is no eps.
//!
//! **A tip has a mass**, so that the recursion can move it: a share of the mass of the body to which it is
//! tied, lent by that body at the very place, which changes nothing once the tip stays there. A tip that is
//! tied to an anchor has any mass.

use glam::DVec3;

mod shared_load;

use shared_load::{Law, SharedLoad};

use super::articulated_body::BodyBias;
use super::articulated_link::Coupling;
use super::reduced_tree::{Factors, ReducedTree};
use super::self_stress::{SelfStress, Strut};
use super::tree::KinematicTree;
use crate::linearised_motion::body_block::{Place, Twist};

/// eps, as a part of what makes it weigh as much as A.
const BY_ENERGY: f64 = 1e-9;
/// A pivot below this part of its diagonal is small: A is regularised.
const SMALL: f64 = 1e-7;
/// A pivot below this part of its diagonal is round-off.
const DEPENDENT: f64 = 1e-14;
/// Refinements where A is regular, and where it has been regularised.
const REFINEMENTS: [usize; 2] = [1, 3];

/// A tip, and the place on a body where it belongs.
#[derive(Clone, Copy, Debug)]
struct Tie {
    tip: usize,
    onto: Option<(usize, Place)>,
}

/// How a tether gives under a force, as far as the lengths of rigid links leave its tension undetermined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimbElasticity {
    /// kappa: of its length L at rest, L / EA, m/N.
    pub compliance_m_n: f64,
    /// Damping over stiffness, s.
    pub retardation_s: f64,
}

/// Where the limbs of a tree stand at one state.
pub trait LoopGeometry {
    /// The place of a limb's proximal end on its parent.
    fn proximal(&self, limb: usize) -> Place;
    /// The place of a limb's distal end on what it carries.
    fn distal(&self, limb: usize) -> Place;
    /// The place of the tip of a closure on a body.
    fn tie(&self, closure: usize, body: usize) -> Place;
    /// The chord of a limb (m), its length (m) and whether it is rigid.
    fn chord(&self, limb: usize) -> (DVec3, f64, bool);
}

/// What tips are to be told beside their gaps where the tethers of a loop are redundant.
#[derive(Clone, Copy, Debug)]
pub enum Told<'a> {
    /// Nothing: impulses, or a change of positions or velocities.
    Nothing,
    /// Forces, on top of those of [`Loops::drift`]: how far tips have left their places (m) and how fast they do
    /// (m/s).
    Forces(&'a [[DVec3; 2]]),
    /// The increments of an implicit stage: how tips leave their places in V without the multipliers (m/s), and
    /// in r_x (m).
    Stage(&'a [DVec3], &'a [DVec3]),
}

/// The loops of a tree at one state.
#[derive(Clone, Debug, Default)]
pub struct Loops {
    reduced: ReducedTree,
    ties: Vec<Tie>,
    elasticity: Vec<LimbElasticity>,
    /// A, row by row.
    matrix: Vec<f64>,
    /// R: of each limb and direction of its hold, a row.
    holds: Vec<f64>,
    /// eps; zero where A is regular.
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
    /// Of a tree with these limbs.
    #[must_use]
    pub fn new(tree: &KinematicTree, elasticity: Vec<LimbElasticity>) -> Self {
        let n = 3 * tree.closures.len();
        Self {
            ties: Vec::with_capacity(tree.closures.len()),
            elasticity,
            matrix: vec![0.0; n * n],
            holds: vec![0.0; 3 * tree.limbs.len() * n],
            factor: vec![0.0; n * n],
            multipliers: vec![0.0; n],
            step: vec![0.0; n],
            ..Self::default()
        }
    }

    /// Finds A and its factors from a factorised tree, for accelerations or, with its g, for an implicit stage.
    pub fn factorise<E: Coupling>(
        &mut self,
        tree: &KinematicTree,
        factors: &Factors<'_, E>,
        geometry: &impl LoopGeometry,
        stage_g: Option<f64>,
    ) {
        self.reduced
            .take(tree, factors, |limb| geometry.proximal(limb));
        self.ties.clear();
        for (index, closure) in tree.closures.iter().enumerate() {
            self.ties.push(Tie {
                tip: closure.tip,
                onto: closure.onto.map(|body| (body, geometry.tie(index, body))),
            });
        }
        self.find_matrix(tree);
        self.shared = None;
        if !self.stress.is_absent() {
            self.stress.find(&self.struts(tree, geometry));
            for state in &mut self.stress.states {
                for limb in 0..state.len() {
                    state[limb] = state[first_of_tether(tree, limb)];
                }
            }
            self.chords.clear();
            let limbs = 0..tree.limbs.len();
            let direction = |limb: usize| geometry.chord(limb).0.normalize_or_zero();
            self.chords.extend(limbs.map(direction));
        }
        if self.stress.states.is_empty() {
            self.factorise_matrix();
            return;
        }
        let tips: Vec<usize> = tree.closures.iter().map(|closure| closure.limb).collect();
        self.shared = Some(SharedLoad::new(
            &self.matrix,
            &self.stress.states,
            &self.chords,
            &tips,
            (&self.holds, &self.elasticity),
            stage_g.map_or(Law::Forces, Law::Stage),
        ));
    }

    /// How bodies and tips move under the loads of the last sweep inward, and with what force each limb then holds
    /// what it carries, N, both without the multipliers: `bases` has the motions of the bases, `biases` what the
    /// sweep left at bodies, `centripetal` what proximal ends accelerate by besides the motion of their parents.
    pub fn drift(
        &mut self,
        tree: &KinematicTree,
        bases: &[Twist],
        biases: &[BodyBias],
        centripetal: impl Fn(usize) -> DVec3,
    ) {
        for &base in &tree.bases {
            self.reduced.motions[base] = bases[base];
        }
        self.reduced.drift(tree, biases, centripetal);
    }

    /// How a tip leaves its place where bodies and tips move as [`Loops::drift`] has found.
    #[must_use]
    pub fn drifting_gap(&self, closure: usize) -> DVec3 {
        self.gap(closure, &self.reduced.motions)
    }

    /// A, and the forces of limbs, column by column from the answers to unit forces on tips.
    fn find_matrix(&mut self, tree: &KinematicTree) {
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
    }

    /// The limbs as struts between bodies. A tether of several limbs, with a winch, is one strut: that of its first.
    fn struts(&self, tree: &KinematicTree, geometry: &impl LoopGeometry) -> Vec<Strut> {
        let mut struts: Vec<Strut> = Vec::with_capacity(tree.limbs.len());
        for (index, limb) in tree.limbs.iter().enumerate() {
            let mut ties = tree.closures.iter();
            let tie = ties.position(|closure| closure.limb == index);
            let (chord_m, length_m, is_rigid) = geometry.chord(index);
            let own = Strut {
                chord_m,
                length_m,
                is_rigid,
                near: limb.parent.map(|body| (body, geometry.proximal(index))),
                far: match tie {
                    None => Some((limb.child, geometry.distal(index))),
                    Some(tie) => self.ties[tie].onto,
                },
            };
            let first = first_of_tether(tree, index);
            if first != index {
                struts[first].chord_m += chord_m;
                struts[first].length_m += length_m;
                struts[first].far = own.far;
            }
            struts.push(Strut {
                is_rigid: is_rigid && first == index,
                ..own
            });
        }
        struts
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
        self.by_energy = 0.0;
        self.fill_factor();
        if cholesky(&mut self.factor, self.multipliers.len()) < SMALL {
            self.by_energy = self.regularisation();
            self.fill_factor();
            cholesky(&mut self.factor, self.multipliers.len());
        }
    }

    /// Puts the lower triangle of A + eps R' kappa R where it is to be factorised.
    fn fill_factor(&mut self) {
        let n = self.multipliers.len();
        for i in 0..n {
            for j in 0..=i {
                let symmetric = 0.5 * (self.matrix[i * n + j] + self.matrix[j * n + i]);
                self.factor[i * n + j] = symmetric;
                if self.by_energy > 0.0 {
                    self.factor[i * n + j] += self.by_energy * self.energy(i, j);
                }
            }
        }
    }

    /// Of R' kappa R.
    fn energy(&self, i: usize, j: usize) -> f64 {
        let rows = self.holds.chunks_exact(self.multipliers.len());
        let each = rows.enumerate();
        each.map(|(row, hold)| self.elasticity[row / 3].compliance_m_n * hold[i] * hold[j])
            .sum()
    }

    /// eps.
    fn regularisation(&self) -> f64 {
        let n = self.multipliers.len();
        let ratio = |i: usize| self.matrix[i * n + i] / self.energy(i, i);
        let least = (0..n).map(ratio).fold(f64::INFINITY, f64::min);
        if least.is_finite() {
            BY_ENERGY * least
        } else {
            0.0
        }
    }

    /// The multipliers that make the gaps (accelerations, velocities or displacements of tips from their
    /// places, less those wanted) vanish, where redundant tethers are told what else there is.
    pub fn close(&mut self, gaps: &[DVec3], told: Told<'_>) {
        if let Some(shared) = &self.shared {
            let holds = &self.reduced.holds;
            shared.solve(gaps, (&self.chords, holds), told, &mut self.multipliers);
            return;
        }
        let n = self.multipliers.len();
        let wanted = |row: usize| -gaps[row / 3][row % 3];
        self.multipliers.fill(0.0);
        for pass in 0..=REFINEMENTS[usize::from(self.by_energy > 0.0)] {
            for row in 0..n {
                let matrix = &self.matrix[row * n..(row + 1) * n];
                let reached: f64 = matrix
                    .iter()
                    .zip(&self.multipliers)
                    .map(|(a, l)| a * l)
                    .sum();
                self.step[row] = wanted(row) - reached;
            }
            if let (0, Told::Forces(_), true) = (pass, told, self.by_energy > 0.0) {
                self.pull_by_energy();
            }
            substitute(&self.factor, n, &mut self.step);
            for (multiplier, step) in self.multipliers.iter_mut().zip(&self.step) {
                *multiplier += step;
            }
        }
    }

    /// Takes from the right-hand side what the forces of the limbs without the multipliers weigh there.
    fn pull_by_energy(&mut self) {
        let holds = &self.reduced.holds;
        let n = self.multipliers.len();
        for (row, of_limb) in self.holds.chunks_exact(n).enumerate() {
            let compliance_m_n = self.elasticity[row / 3].compliance_m_n;
            let pull = self.by_energy * compliance_m_n * holds[row / 3][row % 3];
            for (step, hold) in self.step.iter_mut().zip(of_limb) {
                *step -= pull * hold;
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

/// The first limb of the tether that a limb is a part of: limbs of one tether meet at loose nodes.
fn first_of_tether(tree: &KinematicTree, limb: usize) -> usize {
    let mut first = limb;
    while let Some(parent) = tree.limbs[first].parent
        && tree.knots[parent]
        && let Some(before) = tree.carried_by[parent]
        && tree.limbs[before].line == tree.limbs[first].line
    {
        first = before;
    }
    first
}

/// Factorises the lower triangle of a symmetric matrix in place: L L'. A row that depends on those before is
/// left out: what is asked of it is answered with zero. Returns the smallest pivot as a part of its diagonal.
fn cholesky(a: &mut [f64], n: usize) -> f64 {
    let mut least = f64::INFINITY;
    for j in 0..n {
        let (above, below) = a.split_at_mut((j + 1) * n);
        let row = &mut above[j * n..];
        let whole = row[j];
        let rest = whole - row[..j].iter().map(|v| v * v).sum::<f64>();
        least = least.min(rest / whole);
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
    least
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
