//! A factorised tree with every limb in one piece: what forces on bodies and tips do to all of them, at a price
//! that does not depend on the number of links.
//!
//! The distal end Q of a limb follows its proximal end P and yields to a force f on Q, and it passes on of
//! that force
//!
//! ```text
//! a_Q = Phi a_P + S f     f_P = Phi' f
//! Phi_k = F_k Phi_(k-1)     S_k = W_k + F_k S_(k-1) F_k'
//! ```
//!
//! with F and W of each link ([`ArticulatedLink::follows`], [`ArticulatedLink::yields`]). S is how Q yields with
//! all that it carries. Under loads that have been swept inward, Q accelerates besides by
//!
//! ```text
//! y_k = F_k y_(k-1) + a_k        a_k of link k where its proximal end is held
//! ```

use glam::{DMat3, DVec3};

use super::articulated_body::{ArticulatedBody, BodyBias};
use super::articulated_link::{ArticulatedLink, Coupling, LinkBias};
use super::tree::KinematicTree;
use crate::linearised_motion::body_block::{Place, Twist};
use crate::linearised_motion::symmetric3::Symmetric3;

/// A limb in one piece.
#[derive(Clone, Copy, Debug)]
struct Piece {
    /// Phi.
    follows: DMat3,
    /// S.
    yields: DMat3,
    /// y; zero where no loads were swept inward.
    drifts: DVec3,
    /// Where its proximal end is on its parent.
    proximal: Place,
    /// Inertia that it carries at its distal end.
    carried: Symmetric3,
}

/// A factorised tree, as it is handed over.
pub struct Factors<'a, E> {
    /// The links.
    pub links: &'a [ArticulatedLink<E>],
    /// Bodies and tips.
    pub bodies: &'a [ArticulatedBody],
    /// Of bases: what they would pass on.
    pub at_base: &'a [Symmetric3],
    /// What each limb carries at its distal end.
    pub carried: &'a [Symmetric3],
    /// Of the links, what loads have left there on their way inward; empty where there were none.
    pub biases: &'a [LinkBias],
}

/// The tree in pieces, and scratch for its answers.
#[derive(Clone, Debug, Default)]
pub struct ReducedTree {
    pieces: Vec<Piece>,
    bodies: Vec<ArticulatedBody>,
    at_base: Vec<Symmetric3>,
    biases: Vec<BodyBias>,
    /// Loads on bodies and tips: what [`ReducedTree::respond`] answers, and uses up.
    pub loads: Vec<Twist>,
    /// The accelerations of bodies and tips with which it answered.
    pub motions: Vec<Twist>,
    /// The force with which each limb holds what it carries, in that answer.
    pub holds: Vec<DVec3>,
}

impl ReducedTree {
    /// Takes over the factors of a tree; `proximal` is the place of each limb on its parent.
    pub fn take<E: Coupling>(
        &mut self,
        tree: &KinematicTree,
        factors: &Factors<'_, E>,
        proximal: impl Fn(usize) -> Place,
    ) {
        self.pieces.clear();
        for (index, limb) in tree.limbs.iter().enumerate() {
            let (mut follows, mut yields) = (DMat3::IDENTITY, DMat3::ZERO);
            let mut drifts = DVec3::ZERO;
            for link in limb.links.clone() {
                let at = &factors.links[link];
                let f = at.follows();
                follows = f * follows;
                yields = DMat3::from(at.yields()) + f * yields * f.transpose();
                if let Some(bias) = factors.biases.get(link) {
                    drifts = f * drifts + bias.distal;
                }
            }
            self.pieces.push(Piece {
                follows,
                yields,
                drifts,
                proximal: proximal(index),
                carried: factors.carried[index],
            });
        }
        self.bodies.clear();
        self.bodies.extend_from_slice(factors.bodies);
        self.at_base.clear();
        self.at_base.extend_from_slice(factors.at_base);
        let count = self.bodies.len();
        self.biases.resize(count, BodyBias::default());
        self.loads.resize(count, Twist::default());
        self.motions.resize(count, Twist::default());
        self.holds.resize(tree.limbs.len(), DVec3::ZERO);
    }

    /// Finds how bodies and tips move under the loads that were swept inward: `biases` is what these left at
    /// bodies, `motions` hold the bases, and `centripetal` is what the place of a limb's proximal end accelerates
    /// by besides the motion of its parent, m/s^2.
    pub fn drift(
        &mut self,
        tree: &KinematicTree,
        biases: &[BodyBias],
        centripetal: impl Fn(usize) -> DVec3,
    ) {
        for (index, (limb, piece)) in tree.limbs.iter().zip(&self.pieces).enumerate() {
            let at = limb.parent.map_or(DVec3::ZERO, |body| {
                piece.proximal.motion(self.motions[body])
            });
            let distal = piece.follows * (at + centripetal(index)) + piece.drifts;
            let bias = &biases[limb.child];
            self.motions[limb.child] = self.bodies[limb.child].outward(bias, distal);
            self.holds[index] = piece.carried.times(distal) + bias.passed_on;
        }
    }

    /// Finds what `loads` alone do to bodies and tips.
    pub fn respond(&mut self, tree: &KinematicTree) {
        for (limb, piece) in tree.limbs.iter().zip(&self.pieces).rev() {
            let child = limb.child;
            let load = std::mem::take(&mut self.loads[child]);
            if load == Twist::default() {
                self.biases[child] = BodyBias::default();
                continue;
            }
            let bias = self.bodies[child].inward(-load, DVec3::ZERO);
            self.biases[child] = bias;
            if let Some(parent) = limb.parent {
                let passed_on = piece.follows.transpose() * bias.passed_on;
                let push = piece.proximal.load(passed_on);
                self.loads[parent].linear -= push.linear;
                self.loads[parent].angular -= push.angular;
            }
        }
        for &base in &tree.bases {
            let load = std::mem::take(&mut self.loads[base]);
            let bias = self.bodies[base].inward(-load, DVec3::ZERO);
            let motion = self.bodies[base].free(&bias, &self.at_base[base]);
            self.motions[base] = motion.unwrap_or_default();
        }
        for (index, (limb, piece)) in tree.limbs.iter().zip(&self.pieces).enumerate() {
            let at = limb.parent.map_or(DVec3::ZERO, |body| {
                piece.proximal.motion(self.motions[body])
            });
            let bias = &self.biases[limb.child];
            let distal = piece.follows * at - piece.yields * bias.passed_on;
            self.motions[limb.child] = self.bodies[limb.child].outward(bias, distal);
            self.holds[index] = piece.carried.times(distal) + bias.passed_on;
        }
    }
}
