//! What more forces on bodies and tips do to a tree that has been solved: the same sweeps with the factors of
//! the last solution.

use glam::DVec3;

use super::{Accelerations, ForwardDynamics};
use crate::denoc::reduced_tree::Factors;
use crate::denoc::tree::KinematicTree;
use crate::linearised_motion::body_block::{Place, Twist};

impl ForwardDynamics {
    /// The factors of the last solution.
    #[must_use]
    pub fn factors(&self) -> Factors<'_, f64> {
        Factors {
            links: &self.links,
            bodies: &self.bodies,
            at_base: &self.at_base,
            carried: &self.carried,
        }
    }

    /// Where the last solution had the proximal end of a limb on its parent.
    #[must_use]
    pub fn proximal(&self, limb: usize) -> Place {
        self.ends[limb][0].place
    }

    /// Where the last solution had the distal end of a limb on what it carries.
    #[must_use]
    pub fn distal(&self, limb: usize) -> Place {
        self.ends[limb][1].place
    }

    /// The force with which each limb held what it carries in a solution with these accelerations, N.
    pub fn holds(&self, tree: &KinematicTree, found: &Accelerations, holds: &mut Vec<DVec3>) {
        holds.clear();
        for (index, limb) in tree.limbs.iter().enumerate() {
            let distal = &self.ends[index][1];
            let at = distal.place.motion(found.bodies[limb.child]) + distal.centripetal;
            let bias = &self.body_biases[limb.child];
            holds.push(self.carried[index].times(at) + bias.passed_on);
        }
    }

    /// Adds to `found` what `loads` on bodies and tips do besides; they are used up.
    pub fn respond(
        &mut self,
        tree: &KinematicTree,
        loads: &mut [Twist],
        found: &mut Accelerations,
    ) {
        for (index, limb) in tree.limbs.iter().enumerate().rev() {
            let child = limb.child;
            let load = std::mem::take(&mut loads[child]);
            let bias = self.bodies[child].inward(-load, DVec3::ZERO);
            self.body_biases[child] = bias;
            let mut force = bias.passed_on;
            for link in limb.links.clone().rev() {
                let bias = self.links[link].inward(force, 0.0);
                self.biases[link] = bias;
                force = bias.passed_on;
            }
            if let Some(parent) = limb.parent {
                let push = self.ends[index][0].place.load(force);
                loads[parent].linear -= push.linear;
                loads[parent].angular -= push.angular;
            }
        }
        for &base in &tree.bases {
            let load = std::mem::take(&mut loads[base]);
            let bias = self.bodies[base].inward(-load, DVec3::ZERO);
            let motion = self.bodies[base].free(&bias, &self.at_base[base]);
            self.motions[base] = motion.unwrap_or_default();
        }
        for (index, limb) in tree.limbs.iter().enumerate() {
            let proximal = self.ends[index][0].place;
            let mut at = limb
                .parent
                .map_or(DVec3::ZERO, |parent| proximal.motion(self.motions[parent]));
            for (k, link) in limb.links.clone().enumerate() {
                let (distal, tension) = self.links[link].outward(&self.biases[link], at);
                found.span_m_s2[link] += distal - at;
                found.tension_n[link] += tension;
                found.point_m_s2[limb.distal_point(k)] += distal;
                at = distal;
            }
            let child = limb.child;
            self.motions[child] = self.bodies[child].outward(&self.body_biases[child], at);
        }
        for (body, more) in found.bodies.iter_mut().zip(&self.motions) {
            body.linear += more.linear;
            body.angular += more.angular;
        }
    }
}
