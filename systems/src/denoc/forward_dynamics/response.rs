//! What more forces on bodies and tips do to a tree that has been solved: the same sweeps with the factors of
//! the last solution.

use glam::DVec3;

use super::{Accelerations, ForwardDynamics, Loads};
use crate::denoc::articulated_body::BodyBias;
use crate::denoc::articulated_link::LinkBias;
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
            biases: &self.biases,
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

    /// What the last sweep inward left at bodies and tips.
    #[must_use]
    pub fn body_biases(&self) -> &[BodyBias] {
        &self.body_biases
    }

    /// By how much the proximal end of a limb accelerates besides the motion of its parent, m/s^2.
    #[must_use]
    pub fn centripetal(&self, tree: &KinematicTree, limb: usize, loads: &Loads) -> DVec3 {
        match tree.limbs[limb].parent {
            Some(_) => self.ends[limb][0].centripetal,
            None => loads.anchor_m_s2[limb],
        }
    }

    /// Sweeps more `loads` on bodies and tips inward, on top of those that were; they are used up. Adds what they
    /// do to the accelerations of bases.
    pub fn sweep_more_inward(
        &mut self,
        tree: &KinematicTree,
        loads: &mut [Twist],
        found: &mut Accelerations,
    ) {
        self.sweep_loads_inward(
            tree,
            loads,
            |old, more| *old = old.plus(&more),
            |old, more| {
                *old = old.plus(&more);
            },
        );
        for &base in &tree.bases {
            found.bodies[base].linear += self.motions[base].linear;
            found.bodies[base].angular += self.motions[base].angular;
        }
    }

    /// Finds what `loads` on bodies and tips alone do; they are used up.
    pub fn respond(
        &mut self,
        tree: &KinematicTree,
        loads: &mut [Twist],
        found: &mut Accelerations,
    ) {
        self.sweep_loads_inward(tree, loads, |old, new| *old = new, |old, new| *old = new);
        for (index, limb) in tree.limbs.iter().enumerate() {
            let proximal = self.ends[index][0].place;
            let mut at = limb
                .parent
                .map_or(DVec3::ZERO, |parent| proximal.motion(self.motions[parent]));
            for (k, link) in limb.links.clone().enumerate() {
                let (distal, tension) = self.links[link].outward(&self.biases[link], at);
                found.span_m_s2[link] = distal - at;
                found.tension_n[link] = tension;
                found.point_m_s2[limb.distal_point(k)] = distal;
                at = distal;
            }
            let child = limb.child;
            self.motions[child] = self.bodies[child].outward(&self.body_biases[child], at);
        }
        found.bodies.copy_from_slice(&self.motions);
    }

    /// Sweeps loads inward and hands what they leave at links and at bodies over; leaves the motions of bases.
    fn sweep_loads_inward(
        &mut self,
        tree: &KinematicTree,
        loads: &mut [Twist],
        mut at_link: impl FnMut(&mut LinkBias, LinkBias),
        mut at_body: impl FnMut(&mut BodyBias, BodyBias),
    ) {
        for (index, limb) in tree.limbs.iter().enumerate().rev() {
            let child = limb.child;
            let load = std::mem::take(&mut loads[child]);
            let bias = self.bodies[child].inward(-load, DVec3::ZERO);
            at_body(&mut self.body_biases[child], bias);
            let mut force = bias.passed_on;
            for link in limb.links.clone().rev() {
                let bias = self.links[link].inward(force, 0.0);
                at_link(&mut self.biases[link], bias);
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
    }
}
