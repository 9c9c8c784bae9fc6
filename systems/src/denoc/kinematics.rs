//! The sweep outward: from joint coordinates and rates to where every point is and how it moves.
//!
//! ```text
//! x_Q = x_P + d      v_Q = v_P + d'        d from P to Q of a link, |d| = L where it is rigid
//! ```

use glam::{DQuat, DVec3};

use super::tree::KinematicTree;

/// Links by their place in the tree, outward.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinkStates {
    /// d: from the proximal to the distal end, inertial frame, m.
    pub span_m: Vec<DVec3>,
    /// d', m/s.
    pub rate_m_s: Vec<DVec3>,
}

/// A place on a body or anchor, and how it moves, inertial frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PointState {
    /// Position, m.
    pub position_m: DVec3,
    /// Velocity, m/s.
    pub velocity_m_s: DVec3,
}

/// A body as the sweeps see it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyState {
    /// Of the centre of mass.
    pub centre: PointState,
    /// Attitude, body to inertial.
    pub attitude: DQuat,
    /// Angular velocity, body frame, rad/s.
    pub rate_rad_s: DVec3,
}

impl BodyState {
    /// A place on it, `offset_m` (m, body frame) from its centre of mass.
    #[must_use]
    pub fn place(&self, offset_m: DVec3) -> PointState {
        PointState {
            position_m: self.centre.position_m + self.attitude * offset_m,
            velocity_m_s: self.centre.velocity_m_s
                + self.attitude * self.rate_rad_s.cross(offset_m),
        }
    }

    /// Puts the body where its place `offset_m` (m, body frame) is and moves as `place`.
    pub fn hang_from(&mut self, place: PointState, offset_m: DVec3) {
        self.centre.position_m = place.position_m - self.attitude * offset_m;
        self.centre.velocity_m_s =
            place.velocity_m_s - self.attitude * self.rate_rad_s.cross(offset_m);
    }
}

/// Offsets of the two ends of a limb on what carries it and on what it carries, body frame, m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LimbOffsets {
    /// On the parent; of an anchor from its position.
    pub proximal_m: DVec3,
    /// On the child.
    pub distal_m: DVec3,
}

/// Places all points of a tree, and all bodies but the bases: `bodies` hold the states of the bases and the
/// attitudes and rates of all, `anchors` the state of the anchor of each limb that has one. The points are
/// written by their index.
pub fn sweep_outward(
    tree: &KinematicTree,
    links: &LinkStates,
    offsets: &[LimbOffsets],
    anchors: &[BodyState],
    bodies: &mut [BodyState],
    points: &mut [PointState],
) {
    for (index, limb) in tree.limbs.iter().enumerate() {
        let parent = limb.parent.map_or(&anchors[index], |body| &bodies[body]);
        let mut at = parent.place(offsets[index].proximal_m);
        points[limb.proximal_point()] = at;
        let spans = &links.span_m[limb.links.clone()];
        let rates = &links.rate_m_s[limb.links.clone()];
        for (k, (span, rate)) in spans.iter().zip(rates).enumerate() {
            at.position_m += *span;
            at.velocity_m_s += *rate;
            points[limb.distal_point(k)] = at;
        }
        bodies[limb.child].hang_from(at, offsets[index].distal_m);
    }
}
