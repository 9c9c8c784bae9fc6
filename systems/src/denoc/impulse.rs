//! From a motion that joints do not allow to the one that they make of it: the joints' impulses.
//!
//! Velocities v* of points and bodies (of a scene, or after a latch has closed) need not keep the links'
//! lengths. Impulses of the joints, which do no work on what these allow, change them to N u with
//!
//! ```text
//! N' M N u = N' M v*
//! ```
//!
//! which are the equations of forward dynamics with velocities for accelerations, momenta for forces and no
//! velocity terms. Momentum is conserved, whatever body the tree grows from; of all motions that the joints
//! allow, this is the nearest to v* in the norm of kinetic energy (Gauss' principle of least constraint, for
//! impulses).

use glam::DVec3;

use super::closed_dynamics::{ClosedDynamics, Motion, Offsets};
use super::forward_dynamics::{Accelerations, Loads, Massless};
use super::kinematics::{BodyState, LinkStates, PointState};
use super::tree::KinematicTree;
use crate::linearised_motion::body_block::{Place, Twist};

/// Finds the motion that the joints make of `points` and `bodies`, whose masses are in `loads`: rates of the
/// links' spans, and of bodies velocity and angular velocity (body frame), where `out` has accelerations.
/// `ties_m_s` are the velocities of the anchors of closures. Leaves the factors of this state in `dynamics`.
///
/// # Errors
/// [`Massless`].
pub fn allowed_motion(
    tree: &KinematicTree,
    dynamics: &mut ClosedDynamics,
    span_m: &[DVec3],
    (points, bodies): (&[PointState], &[BodyState]),
    (offsets, ties_m_s): (&Offsets, &[DVec3]),
    loads: &Loads,
    out: &mut Accelerations,
) -> Result<(), Massless> {
    let links = LinkStates {
        span_m: span_m.to_vec(),
        rate_m_s: vec![DVec3::ZERO; tree.links],
    };
    let mut still = bodies.to_vec();
    let mut momenta = loads.clone();
    let each = still.iter_mut().zip(&mut momenta.bodies);
    for (body, momentum) in each {
        let motion = Twist {
            linear: body.centre.velocity_m_s,
            angular: body.rate_rad_s,
        };
        momentum.load = momentum.mass.times(motion);
        body.rate_rad_s = DVec3::ZERO;
    }
    momenta.tie_m_s2.copy_from_slice(ties_m_s);
    momenta.are_momenta = true;
    for (index, (limb, kind)) in tree.limbs.iter().zip(&tree.kinds).enumerate() {
        let first = limb.proximal_point();
        momenta.anchor_m_s2[index] = points[first].velocity_m_s;
        for k in 1..limb.links.len() {
            let joint = limb.distal_point(k - 1);
            momenta.point_n[joint] = kind.joint_mass_kg * points[joint].velocity_m_s;
        }
        let mut before = first;
        for k in 0..limb.links.len() {
            let here = limb.distal_point(k);
            let between =
                kind.coupling_kg * (points[here].velocity_m_s - points[before].velocity_m_s);
            // What a rod's ends do to one another: at joints, and at the bodies at its ends.
            let mut add = |at_end: bool, point: usize, body: Option<usize>, r: DVec3, p: DVec3| {
                if !at_end {
                    momenta.point_n[point] += p;
                } else if let Some(body) = body {
                    let load = Place::new(bodies[body].attitude, r).load(p);
                    momenta.bodies[body].load.linear += load.linear;
                    momenta.bodies[body].load.angular += load.angular;
                }
            };
            let is_last = k + 1 == limb.links.len();
            let (near, far) = (
                offsets.limbs[index].proximal_m,
                offsets.limbs[index].distal_m,
            );
            add(k == 0, before, limb.parent, near, -between);
            add(is_last, here, Some(limb.child), far, between);
            before = here;
        }
    }
    let motion = Motion {
        links: &links,
        bodies: &still,
        ties: &[],
    };
    dynamics.solve(tree, motion, offsets, &momenta, out)
}
