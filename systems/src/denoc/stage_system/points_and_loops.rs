//! What stands after the bodies in the matrix of an implicit step: loose nodes, tips, and the multipliers that
//! keep these at their places.

use glam::{DMat3, DVec3};

use super::{LinkStages, ends, places};
use crate::denoc::articulated_link::Stretch;
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
        };
        let (tree, limbs) = (&self.tree, &self.tree.limbs);
        let bodies = self.topology.bodies.len();
        self.loops.factorise(
            tree,
            &factors,
            |limb| places(&limbs[limb], bodies, derivatives).0,
            |closure, _| ends(&limbs[tree.closures[closure].limb], derivatives).1,
            |limb| places(&limbs[limb], bodies, derivatives).1,
            |limb| chord(tree, limb, derivatives),
        );
    }

    /// Adds to V and X what the multipliers of the loops do: `self.motions` hold V of bodies and tips.
    pub(super) fn close_loops(
        &mut self,
        derivatives: &Derivatives,
        r_x: &mut [f64],
        r_v: &mut [f64],
    ) {
        for (index, gap) in self.gaps.iter_mut().enumerate() {
            let wanted = self.g * self.loops.gap(index, &self.speeds);
            *gap = self.loops.gap(index, &self.motions) - wanted;
        }
        self.loops.close(&self.gaps, None);
        self.body_loads.fill(Twist::default());
        self.flows.fill(DVec3::ZERO);
        self.loads.fill(DVec3::ZERO);
        self.loops.add_loads(&mut self.body_loads);
        self.sweep_inward(derivatives);
        let g = self.g;
        self.sweep_outward(derivatives, |at, v| {
            let x = DVec3::from_slice(&r_x[at..]) + g * v;
            let v = DVec3::from_slice(&r_v[at..]) + v;
            x.write_to_slice(&mut r_x[at..]);
            v.write_to_slice(&mut r_v[at..]);
        });
    }
}

/// The chord of a limb, its length (m) and whether it is rigid.
fn chord(tree: &KinematicTree, limb: usize, derivatives: &Derivatives) -> (DVec3, f64, bool) {
    let (limb, kind) = (&tree.limbs[limb], &tree.kinds[limb]);
    let span = |k: usize| {
        let segment = &derivatives.segments[limb.segment(k)];
        limb.sign() * segment.length_m * segment.direction
    };
    let chord_m = (0..limb.links.len()).map(span).sum();
    let length_m = kind.length_m * limb.links.len() as f64;
    (chord_m, length_m, kind.stretch == Stretch::Rigid)
}
