//! The sweeps of a stage: from what it is given to loads, inward with these, and outward with the answer.

use glam::DVec3;

use super::{LinkStages, hung};
use crate::linearised_motion::body_block::Twist;
use crate::linearised_motion::derivatives::Derivatives;

impl LinkStages {
    /// Carries displacements `r_x` and velocities `r_v` of joints outward to bodies and points: leaves the
    /// loads of a stage.
    pub(super) fn load(&mut self, derivatives: &Derivatives, r_x: &[f64], r_v: &[f64]) {
        let g = self.g;
        for &base in &self.tree.bases {
            self.motions[base] = self.base_twist(base, r_x);
            self.speeds[base] = self.base_twist(base, r_v);
        }
        for (index, limb) in self.tree.limbs.iter().enumerate() {
            let (proximal, distal) = self.places(limb, derivatives);
            let of = |motions: &[Twist]| {
                limb.parent
                    .map_or(DVec3::ZERO, |body| proximal.motion(motions[body]))
            };
            let (mut shift, mut speed) = (of(&self.motions), of(&self.speeds));
            let coupling_kg = self.tree.kinds[index].coupling_kg;
            for (k, link) in limb.links.clone().enumerate() {
                let at = self.places.first_link + 3 * link;
                let (x, v) = (DVec3::from_slice(&r_x[at..]), DVec3::from_slice(&r_v[at..]));
                self.flows[link] = g * coupling_kg * v - self.stiffness[link].times(x);
                shift += x;
                speed += v;
                let point = &derivatives.points[limb.distal_point(k)];
                self.loads[link] = g * point.mass_kg * speed - g * g * point.stiffness.times(shift);
            }
            let rotation = self.places.bodies[limb.child].1;
            self.motions[limb.child] = hung(shift, &distal, rotation, r_x);
            self.speeds[limb.child] = hung(speed, &distal, rotation, r_v);
        }
        let motions = self.motions.iter().zip(&self.speeds);
        let bodies = derivatives.bodies.iter().zip(motions);
        for (load, (body, (shift, speed))) in self.body_loads.iter_mut().zip(bodies) {
            *load = body.stage_load(g, *shift, *speed);
        }
        self.load_points(derivatives);
        self.note_given_gaps();
    }

    pub(super) fn base_twist(&self, base: usize, r: &[f64]) -> Twist {
        let part = |at: Option<usize>| at.map_or(DVec3::ZERO, |at| DVec3::from_slice(&r[at..]));
        let (displacement, rotation) = self.places.bodies[base];
        Twist {
            linear: part(displacement),
            angular: part(rotation.filter(|_| self.turns(base))),
        }
    }

    pub(super) fn sweep_inward(&mut self, derivatives: &Derivatives) {
        for limb in self.tree.limbs.iter().rev() {
            let (proximal, _) = self.places(limb, derivatives);
            let child = limb.child;
            let bias = self.bodies[child].inward(-self.body_loads[child], DVec3::ZERO);
            self.body_biases[child] = bias;
            let mut force = bias.passed_on;
            for (k, link) in limb.links.clone().enumerate().rev() {
                let flow = self.flows[link];
                let bias = self.links[link].inward(force - flow, 0.0);
                self.biases[link] = bias;
                force = bias.passed_on + flow;
                if k > 0 {
                    force -= self.loads[link - 1];
                }
            }
            if let Some(parent) = limb.parent {
                let push = proximal.load(force);
                self.body_loads[parent].linear -= push.linear;
                self.body_loads[parent].angular -= push.angular;
            }
        }
    }

    /// Hands over V of all joints with their places in the state.
    pub(super) fn sweep_outward(
        &mut self,
        derivatives: &Derivatives,
        mut take: impl FnMut(usize, DVec3),
    ) {
        for &base in &self.tree.bases {
            let bias = self.bodies[base].inward(-self.body_loads[base], DVec3::ZERO);
            let motion = self.bodies[base].free(&bias, &self.at_base[base]);
            self.motions[base] = motion.unwrap_or_default();
            let (displacement, rotation) = self.places.bodies[base];
            if let Some(at) = displacement {
                take(at, self.motions[base].linear);
            }
            if let Some(at) = rotation {
                take(at, self.motions[base].angular);
            }
        }
        for limb in &self.tree.limbs {
            let (proximal, _) = self.places(limb, derivatives);
            let mut at = limb
                .parent
                .map_or(DVec3::ZERO, |body| proximal.motion(self.motions[body]));
            for link in limb.links.clone() {
                let (distal, _) = self.links[link].outward(&self.biases[link], at);
                take(self.places.first_link + 3 * link, distal - at);
                at = distal;
            }
            let child = limb.child;
            self.motions[child] = self.bodies[child].outward(&self.body_biases[child], at);
            if let Some(place) = self.places.bodies[child].1 {
                take(place, self.motions[child].angular);
            }
        }
    }
}
