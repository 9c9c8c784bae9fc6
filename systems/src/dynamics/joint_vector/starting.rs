//! From components that the joints do not allow to a state that they do: links keep their directions, what nothing
//! holds keeps its centre of mass, and momentum is conserved.

use bevy_ecs::world::World;
use glam::DVec3;

use super::JointVector;
use crate::denoc::impulse::allowed_motion;
use crate::denoc::joint_coordinates::LinkChart;
use crate::denoc::kinematics::PointState;
use crate::dynamics::link_mechanism::LinkMechanism;

/// Bodies whose links would move them by less than this, m, and rates along links below this, m/s, are
/// round-off.
const ROUND_OFF: f64 = 1e-9;

impl JointVector {
    /// Takes the links as the points have them for the centres of the charts, with their rates; whether
    /// some rate is one that a rigid link cannot have.
    pub(super) fn take_links(&mut self, world: &World) -> bool {
        let tree = &world.resource::<LinkMechanism>().tree;
        let mut is_stretching = false;
        for (limb, kind) in tree.limbs.iter().zip(&tree.kinds) {
            let mut before = self.components.points[limb.proximal_point()];
            for (k, link) in limb.links.clone().enumerate() {
                let here = self.components.points[limb.distal_point(k)];
                let span = here.position_m - before.position_m;
                let given = here.velocity_m_s - before.velocity_m_s;
                let (chart, rate) = LinkChart::around(span, given, kind);
                is_stretching |= rate.distance(given) > ROUND_OFF;
                self.charts[link] = chart;
                self.links.span_m[link] = chart.centre_m;
                self.links.rate_m_s[link] = rate;
                before = here;
            }
        }
        is_stretching
    }

    /// Moves bases so that what is free keeps its centre of mass where links put bodies elsewhere than they
    /// stood; whether they do.
    pub(super) fn keep_centres_of_mass(&mut self, world: &World) -> bool {
        let mechanism = world.resource::<LinkMechanism>();
        let given = self.components.bodies.clone();
        let given_points = self.components.points.clone();
        self.sweep(mechanism);
        self.close_at_start(mechanism);
        let mut base_of: Vec<Option<usize>> = vec![None; given.len()];
        for &base in &mechanism.tree.bases {
            base_of[base] = Some(base);
        }
        for limb in &mechanism.tree.limbs {
            base_of[limb.child] = limb.parent.and_then(|parent| base_of[parent]);
        }
        let mut moments = vec![(0.0, DVec3::ZERO); given.len()];
        let mut is_moved = false;
        let mut weigh = |base: Option<usize>, mass_kg: f64, given: PointState, now: PointState| {
            let shift = given.position_m - now.position_m;
            is_moved |= shift.length() > ROUND_OFF;
            if let Some(base) = base {
                moments[base].0 += mass_kg;
                moments[base].1 += mass_kg * shift;
            }
        };
        for (body, now) in self.components.bodies.iter().enumerate() {
            let mass_kg = mechanism.loads.bodies[body].mass.linear.x_axis.x;
            weigh(base_of[body], mass_kg, given[body].centre, now.centre);
        }
        for (limb, kind) in mechanism.tree.limbs.iter().zip(&mechanism.tree.kinds) {
            for joint in (1..limb.links.len()).map(|k| limb.distal_point(k - 1)) {
                let now = self.components.points[joint];
                weigh(
                    base_of[limb.child],
                    kind.joint_mass_kg,
                    given_points[joint],
                    now,
                );
            }
        }
        for &base in mechanism.tree.bases.iter().filter(|_| is_moved) {
            let (mass_kg, moment) = moments[base];
            self.components.bodies[base].centre.position_m += moment / mass_kg;
        }
        is_moved
    }

    /// Gives bodies and links the motion that impulses of the joints make of theirs.
    pub(super) fn take_impulses(&mut self, world: &World) {
        let mechanism = world.resource::<LinkMechanism>();
        let mut found = mechanism.accelerations.clone();
        let mut dynamics = mechanism.dynamics.clone();
        let offsets = &mechanism.entities.offsets;
        let ties = self.components.ties.iter().zip(&offsets.ties_m);
        let ties_m_s: Vec<DVec3> = ties
            .map(|(anchor, offset_m)| anchor.place(*offset_m).velocity_m_s)
            .collect();
        let allowed = allowed_motion(
            &mechanism.tree,
            &mut dynamics,
            &self.links.span_m,
            (&self.components.points, &self.components.bodies),
            (offsets, &ties_m_s),
            &mechanism.loads,
            &mut found,
        );
        // What has no mass has no momentum either, and is refused when it is to be accelerated.
        if allowed.is_ok() {
            self.links.rate_m_s.copy_from_slice(&found.span_m_s2);
            for (body, motion) in self.components.bodies.iter_mut().zip(&found.bodies) {
                body.centre.velocity_m_s = motion.linear;
                body.rate_rad_s = motion.angular;
            }
        }
    }
}
