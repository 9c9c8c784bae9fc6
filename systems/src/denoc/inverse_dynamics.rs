//! Inverse dynamics in linear time: from accelerations to the joint torques that they ask for, by the
//! recursive Newton-Euler equations (Luh, Walker and Paul 1980; Saha 1999, eq. 23).
//!
//! Every link is here a rigid rod with mass, centre of mass and moment of inertia of its own, so that the
//! equations share nothing with those of [`super::forward_dynamics`]:
//!
//! ```text
//! outward   a_Q = a_P + d''           a of the middle = (a_P + a_Q)/2
//! inward    f_P = f_Q + m a - w       n_P = n_Q + d x f_Q + (d/2) x m a + I alpha
//! ```
//!
//! f and n: force and moment that the link takes at a joint; d span; I alpha = m/12 d x d''. A joint
//! carries no moment across its link: what is left of n there is its torque tau, zero for a solution.

use glam::DVec3;

use super::forward_dynamics::{Accelerations, Loads};
use super::kinematics::{BodyState, LimbOffsets, LinkStates};
use super::tree::KinematicTree;
use crate::linearised_motion::body_block::Twist;

/// What the joints would have to exert.
#[derive(Clone, Debug, Default)]
pub struct JointLoads {
    /// Of each link, by its place in the tree: torque across the link, inertial frame, N m.
    pub link_n_m: Vec<DVec3>,
    /// Of each body that a limb carries: torque at the joint, inertial frame, N m. Of a base: zero.
    pub body_n_m: Vec<DVec3>,
    /// Of each base, by body: force (N) and torque (N m, inertial frame) about its centre of mass.
    pub base: Vec<Twist>,
}

impl JointLoads {
    /// The largest torque at a joint, or of a base, N m; a force on a base counts at an arm of `arm_m`.
    #[must_use]
    pub fn largest_n_m(&self, arm_m: f64) -> f64 {
        let torques = self.link_n_m.iter().chain(&self.body_n_m);
        let bases = self
            .base
            .iter()
            .map(|load| (load.linear.length() * arm_m).max(load.angular.length()));
        torques
            .map(|torque| torque.length())
            .chain(bases)
            .fold(0.0, |a, b| if b > a || b.is_nan() { b } else { a })
    }
}

/// Finds the joint torques that `motion` asks for under `loads`; of `motion` the accelerations of the
/// spans and the angular ones of bodies are read, and the linear ones of bases.
#[must_use]
pub fn inverse_dynamics(
    tree: &KinematicTree,
    states: (&LinkStates, &[BodyState]),
    offsets: &[LimbOffsets],
    loads: &Loads,
    motion: &Accelerations,
) -> JointLoads {
    let bodies = tree.carried_by.len();
    let mut found = JointLoads {
        link_n_m: vec![DVec3::ZERO; tree.links],
        body_n_m: vec![DVec3::ZERO; bodies],
        base: vec![Twist::default(); bodies],
    };
    let accelerations = accelerate_outward(tree, states.1, offsets, loads, motion);
    // What each body takes at its centre of mass for itself, and then for what it carries.
    let mut wrenches: Vec<Twist> = (0..bodies)
        .map(|body| own_wrench(body, states.1, loads, accelerations[body], motion))
        .collect();
    for (index, limb) in tree.limbs.iter().enumerate().rev() {
        let child = limb.child;
        let attitude = states.1[child].attitude;
        let arm = attitude * offsets[index].distal_m;
        let wrench = wrenches[child];
        found.body_n_m[child] = wrench.angular - arm.cross(wrench.linear);
        let mut force = wrench.linear;
        let kind = &tree.kinds[index];
        let rod_kg = -6.0 * kind.coupling_kg;
        let first = limb_start(tree, index, states.1, offsets, loads, &accelerations);
        let spans = &motion.span_m_s2[limb.links.clone()];
        let mut proximal: Vec<DVec3> = Vec::with_capacity(spans.len());
        let mut at = first;
        for span in spans {
            proximal.push(at);
            at += *span;
        }
        for k in (0..spans.len()).rev() {
            let span = states.0.span_m[limb.links.start + k];
            // The halves of a rod's mass stand with the points and with the bodies: here they are taken
            // out again, and the rod put in whole.
            let distal = proximal[k] + spans[k];
            let half = 0.5 * rod_kg;
            let middle = rod_kg * (proximal[k] + 0.5 * spans[k]);
            let turning = (rod_kg / 12.0) * span.cross(spans[k]);
            let at_distal = force - half * distal;
            found.link_n_m[limb.links.start + k] = across(
                span.cross(at_distal) + 0.5 * span.cross(middle) + turning,
                span,
            );
            force = at_distal + middle - half * proximal[k];
            if k > 0 {
                force += kind.joint_mass_kg * proximal[k];
                force -= loads.point_n[limb.distal_point(k - 1)];
            }
        }
        if let Some(parent) = limb.parent {
            let arm = states.1[parent].attitude * offsets[index].proximal_m;
            wrenches[parent].linear += force;
            wrenches[parent].angular += arm.cross(force);
        }
    }
    for &base in &tree.bases {
        found.base[base] = wrenches[base];
    }
    found
}

/// A rod has no inertia along itself, and no joint holds it there.
fn across(torque: DVec3, span: DVec3) -> DVec3 {
    torque - span * (torque.dot(span) / span.length_squared())
}

/// Acceleration of the proximal end of a limb.
fn limb_start(
    tree: &KinematicTree,
    index: usize,
    bodies: &[BodyState],
    offsets: &[LimbOffsets],
    loads: &Loads,
    accelerations: &[Twist],
) -> DVec3 {
    match tree.limbs[index].parent {
        Some(parent) => place_acceleration(
            &bodies[parent],
            offsets[index].proximal_m,
            accelerations[parent],
        ),
        None => loads.anchor_m_s2[index],
    }
}

fn place_acceleration(body: &BodyState, offset_m: DVec3, motion: Twist) -> DVec3 {
    let rate = body.rate_rad_s;
    motion.linear
        + body.attitude * (motion.angular.cross(offset_m) + rate.cross(rate.cross(offset_m)))
}

/// Accelerations of all bodies from those of the joints.
fn accelerate_outward(
    tree: &KinematicTree,
    bodies: &[BodyState],
    offsets: &[LimbOffsets],
    loads: &Loads,
    motion: &Accelerations,
) -> Vec<Twist> {
    let mut found = motion.bodies.clone();
    for (index, limb) in tree.limbs.iter().enumerate() {
        let mut at = limb_start(tree, index, bodies, offsets, loads, &found);
        for span in &motion.span_m_s2[limb.links.clone()] {
            at += *span;
        }
        let child = limb.child;
        let turning = Twist {
            linear: DVec3::ZERO,
            angular: found[child].angular,
        };
        let of_place = place_acceleration(&bodies[child], offsets[index].distal_m, turning);
        found[child].linear = at - of_place;
    }
    found
}

/// What a body's own inertia takes, less its loads; force and torque about its centre of mass, inertial
/// frame.
fn own_wrench(
    body: usize,
    states: &[BodyState],
    loads: &Loads,
    acceleration: Twist,
    motion: &Accelerations,
) -> Twist {
    let load = &loads.bodies[body];
    let angular = if load.turns {
        motion.bodies[body].angular
    } else {
        DVec3::ZERO
    };
    let inertia = load.mass.times(Twist {
        linear: acceleration.linear,
        angular,
    });
    Twist {
        linear: inertia.linear - load.load.linear,
        angular: states[body].attitude * (inertia.angular - load.load.angular),
    }
}
