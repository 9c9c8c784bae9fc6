//! One body of the recursion: from its own inertia and all that it carries to what it passes on at the
//! joint that carries it.
//!
//! Unknown are the acceleration a of its centre of mass and its angular acceleration alpha (body frame);
//! the joint P at the place J = [I, t] accelerates by a_P = a + t alpha + c. With the blocks of the
//! body, its tethers included, and no torque at the joint:
//!
//! ```text
//! [A11 A12; A21 A22] [a; alpha] + [b1; b2] = J' R
//! E = A21 - t' A11     F = A12 - A11 t     D = A22 - t' A12 - E t     beta = b2 - t' b1 - E c
//! alpha = -D^-1 (E a_P + beta)
//! R = (A11 - F D^-1 E) a_P + b1 - A11 c - F D^-1 beta
//! ```
//!
//! A point has no alpha. A body that nothing carries is solved at its centre of mass, with R = 0.

use glam::{DMat3, DVec3};

use crate::linearised_motion::body_block::{BodyBlock, Place, Twist};
use crate::linearised_motion::symmetric3::Symmetric3;

/// A body with what it carries eliminated.
#[derive(Clone, Copy, Debug)]
pub struct ArticulatedBody {
    place: Place,
    /// A11.
    linear: DMat3,
    /// E.
    torque_by_joint: DMat3,
    /// -D^-1; zero for a point.
    pub(super) turning: DMat3,
    /// F.
    force_by_turn: DMat3,
}

impl Default for ArticulatedBody {
    /// Nothing. (Not derived: the default of a matrix in glam is the identity.)
    fn default() -> Self {
        Self {
            place: CENTRE,
            linear: DMat3::ZERO,
            torque_by_joint: DMat3::ZERO,
            turning: DMat3::ZERO,
            force_by_turn: DMat3::ZERO,
        }
    }
}

/// The centre of mass as a place.
pub const CENTRE: Place = Place { turn: DMat3::ZERO };

/// The part of a body's sweep that does not depend on how its joint accelerates.
#[derive(Clone, Copy, Debug, Default)]
pub struct BodyBias {
    /// beta.
    torque: DVec3,
    /// c.
    centripetal: DVec3,
    /// What is passed on at the joint.
    pub passed_on: DVec3,
}

impl BodyBias {
    /// Of both loads together.
    #[inline]
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            torque: self.torque + other.torque,
            centripetal: self.centripetal + other.centripetal,
            passed_on: self.passed_on + other.passed_on,
        }
    }
}

impl ArticulatedBody {
    /// Eliminates the turning of a body with this `block`, carried at `place`; a body that does not turn
    /// is a point. With what it passes on.
    #[must_use]
    pub fn new(block: &BodyBlock, place: Place, turns: bool) -> (Self, Symmetric3) {
        if !turns {
            let body = Self {
                place,
                linear: block.linear,
                ..Self::default()
            };
            return (body, Symmetric3::part_of(block.linear));
        }
        let t = place.turn;
        let torque_by_joint = block.turn_by_linear - t.transpose() * block.linear;
        let force_by_turn = block.linear_by_turn - block.linear * t;
        let d = block.turn - t.transpose() * block.linear_by_turn - torque_by_joint * t;
        let turning = -d.inverse();
        let passed_on = block.linear + force_by_turn * turning * torque_by_joint;
        let body = Self {
            place,
            linear: block.linear,
            torque_by_joint,
            turning,
            force_by_turn,
        };
        (body, Symmetric3::part_of(passed_on))
    }

    /// The sweep inward: `bias` is [b1; b2], `centripetal` c.
    #[inline]
    #[must_use]
    pub fn inward(&self, bias: Twist, centripetal: DVec3) -> BodyBias {
        let at_joint = bias.angular
            - self.place.turn.transpose() * bias.linear
            - self.torque_by_joint * centripetal;
        let turned = self.force_by_turn * (self.turning * at_joint);
        BodyBias {
            torque: at_joint,
            centripetal,
            passed_on: bias.linear - self.linear * centripetal + turned,
        }
    }

    /// The sweep outward: how the body accelerates where its joint accelerates by `joint`.
    #[inline]
    #[must_use]
    pub fn outward(&self, bias: &BodyBias, joint: DVec3) -> Twist {
        let angular = self.turning * (self.torque_by_joint * joint + bias.torque);
        Twist {
            linear: joint - self.place.turn * angular - bias.centripetal,
            angular,
        }
    }

    /// How a body that nothing carries accelerates: the sweep at its centre of mass, where `passed_on` is
    /// what it would pass on; `None` where that is singular.
    #[must_use]
    pub fn free(&self, bias: &BodyBias, passed_on: &Symmetric3) -> Option<Twist> {
        let (inverse, positive) = passed_on.inverse();
        positive.then(|| self.outward(bias, -inverse.times(bias.passed_on)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    #[test]
    fn a_body_obeys_its_equations() {
        let attitude = DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -1.1, 0.7);
        let inertia = DMat3::from_diagonal(DVec3::new(3.0, 4.0, 5.0));
        let block = BodyBlock::mass(7.0, DVec3::new(0.3, -0.2, 1.1), inertia, attitude);
        let place = Place::new(attitude, DVec3::new(0.1, 0.4, -0.6));
        let (body, passed_on) = ArticulatedBody::new(&block, place, true);
        let bias = Twist {
            linear: DVec3::new(1.0, -3.0, 0.2),
            angular: DVec3::new(0.5, 0.1, -0.9),
        };
        let centripetal = DVec3::new(0.3, 0.6, -0.2);
        let swept = body.inward(bias, centripetal);
        let joint = DVec3::new(-0.4, 0.8, 1.5);
        let motion = body.outward(&swept, joint);
        assert!((place.motion(motion) + centripetal - joint).length() < 1e-14);
        let reaction = passed_on.times(joint) + swept.passed_on;
        let left = block.times(motion);
        let load = place.load(reaction);
        assert!((left.linear + bias.linear - load.linear).length() < 1e-13);
        assert!((left.angular + bias.angular - load.angular).length() < 1e-13);
        let (root, at_centre) = ArticulatedBody::new(&block, CENTRE, true);
        let free = root
            .free(&root.inward(bias, DVec3::ZERO), &at_centre)
            .unwrap_or_default();
        let left = block.times(free);
        assert!((left.linear + bias.linear).length() < 1e-13);
        assert!((left.angular + bias.angular).length() < 1e-13);
    }
}
