//! What stands after the bodies in the matrix of an implicit step: loose nodes, tips, and the multipliers that
//! keep these at their places.

use glam::{DMat3, DVec3};

use super::{LinkStages, ends, places};
use crate::denoc::articulated_link::Stretch;
use crate::denoc::loops::{LoopGeometry, Told};
use crate::denoc::reduced_tree::Factors;
use crate::denoc::tree::KinematicTree;
use crate::linearised_motion::body_block::{BodyBlock, Place, Twist};
use crate::linearised_motion::derivatives::Derivatives;
use crate::linearised_motion::symmetric3::Symmetric3;

impl LinkStages {
    /// Leaves the loads of a stage on loose nodes and tips.
    pub(super) fn load_points(&mut self, derivatives: &Derivatives) {
        let g = self.g;
        for (body, point) in (self.topology.bodies.len()..).zip(&self.extras.loose) {
            let point = &derivatives.points[*point];
            let (shift, speed) = (self.motions[body].linear, self.speeds[body].linear);
            self.body_loads[body] = Twist {
                linear: g * point.mass_kg * speed - g * g * point.stiffness.times(shift),
                angular: DVec3::ZERO,
            };
        }
        for (closure, kg) in self.tree.closures.iter().zip(&self.extras.tips_kg) {
            let tip = self.speeds[closure.tip].linear;
            self.body_loads[closure.tip] = Twist {
                linear: g * *kg * tip,
                angular: DVec3::ZERO,
            };
            if let Some(body) = closure.onto {
                let place = self.tie(closure.limb, derivatives);
                let lent = place.load(g * *kg * place.motion(self.speeds[body]));
                self.body_loads[body].linear -= lent.linear;
                self.body_loads[body].angular -= lent.angular;
            }
        }
    }

    /// The place of the tip of a limb on the body that it is tied to.
    pub(super) fn tie(&self, limb: usize, derivatives: &Derivatives) -> Place {
        ends(&self.tree.limbs[limb], derivatives).1
    }

    /// Gives loose nodes and tips their masses: those of tips are taken from the bodies that they are tied to.
    pub(super) fn weigh_points(&mut self, derivatives: &Derivatives) {
        for (body, point) in (self.topology.bodies.len()..).zip(&self.extras.loose) {
            let point = &derivatives.points[*point];
            self.blocks[body] = BodyBlock {
                linear: Symmetric3::identity(point.mass_kg)
                    .plus_scaled(point.damping, self.g)
                    .plus_scaled(point.stiffness, self.g * self.g)
                    .into(),
                ..BodyBlock::ZERO
            };
        }
        for (index, kg) in self.extras.tips_kg.iter().enumerate() {
            let closure = self.tree.closures[index];
            self.blocks[closure.tip] = BodyBlock::point(*kg);
            if let Some(body) = closure.onto {
                let place = self.tie(closure.limb, derivatives);
                let lent = BodyBlock::between(&place, DMat3::IDENTITY, &place);
                self.blocks[body].add(&lent, -kg);
            }
        }
    }

    /// Finds how tips answer to forces on them, from the factors of the matrix.
    pub(super) fn factorise_loops(&mut self, derivatives: &Derivatives) {
        let factors = Factors {
            links: &self.links,
            bodies: &self.bodies,
            at_base: &self.at_base,
            carried: &self.carried,
            biases: &[],
        };
        let geometry = Linearised {
            tree: &self.tree,
            bodies: self.topology.bodies.len(),
            derivatives,
        };
        self.loops
            .factorise(&self.tree, &factors, &geometry, Some(self.g));
    }

    /// Takes note of how far r_x, in `self.motions`, moves tips from their places.
    pub(super) fn note_given_gaps(&mut self) {
        for (index, given_m) in self.given_gaps_m.iter_mut().enumerate() {
            *given_m = self.loops.gap(index, &self.motions);
        }
    }

    /// Finds the multipliers of the loops and sweeps them inward, on top of the loads of the stage:
    /// `self.motions` hold V of bodies and tips without them.
    pub(super) fn close_loops(&mut self, derivatives: &Derivatives) {
        let moved = self.moved_gaps.iter_mut();
        for (index, (gap, moved)) in self.gaps.iter_mut().zip(moved).enumerate() {
            *moved = self.loops.gap(index, &self.motions);
            *gap = *moved - self.g * self.loops.gap(index, &self.speeds);
        }
        self.loops.close(
            &self.gaps,
            Told::Stage(&self.moved_gaps, &self.given_gaps_m),
        );
        self.loops.add_loads(&mut self.tip_loads);
        for limb in self.tree.limbs.iter().rev() {
            let child = limb.child;
            let load = std::mem::take(&mut self.tip_loads[child]);
            let bias = self.bodies[child].inward(-load, DVec3::ZERO);
            self.body_biases[child] = self.body_biases[child].plus(&bias);
            let mut force = bias.passed_on;
            for link in limb.links.clone().rev() {
                let bias = self.links[link].inward(force, 0.0);
                self.biases[link] = self.biases[link].plus(&bias);
                force = bias.passed_on;
            }
            if let Some(parent) = limb.parent {
                let push = self.places(limb, derivatives).0.load(force);
                self.tip_loads[parent].linear -= push.linear;
                self.tip_loads[parent].angular -= push.angular;
            }
        }
        for &base in &self.tree.bases {
            let load = std::mem::take(&mut self.tip_loads[base]);
            self.body_loads[base].linear += load.linear;
            self.body_loads[base].angular += load.angular;
        }
    }
}

/// Where limbs stand in a linearised motion.
struct Linearised<'a> {
    tree: &'a KinematicTree,
    /// Number of bodies, loose nodes and tips not counted.
    bodies: usize,
    derivatives: &'a Derivatives,
}

impl LoopGeometry for Linearised<'_> {
    fn proximal(&self, limb: usize) -> Place {
        places(&self.tree.limbs[limb], self.bodies, self.derivatives).0
    }

    fn distal(&self, limb: usize) -> Place {
        places(&self.tree.limbs[limb], self.bodies, self.derivatives).1
    }

    fn tie(&self, closure: usize, _: usize) -> Place {
        let limb = self.tree.closures[closure].limb;
        ends(&self.tree.limbs[limb], self.derivatives).1
    }

    fn chord(&self, limb: usize) -> (DVec3, f64, bool) {
        let (limb, kind) = (&self.tree.limbs[limb], &self.tree.kinds[limb]);
        let span = |k: usize| {
            let segment = &self.derivatives.segments[limb.segment(k)];
            limb.sign() * segment.length_m * segment.direction
        };
        let chord_m = (0..limb.links.len()).map(span).sum();
        let length_m = kind.length_m * limb.links.len() as f64;
        (chord_m, length_m, kind.stretch == Stretch::Rigid)
    }
}
