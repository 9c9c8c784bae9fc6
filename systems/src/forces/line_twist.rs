//! The twist of a line between two bodies, and how it changes with everything it depends on.
//!
//! The chain of unit vectors e_0 (axis of the body at `from`), e_1 .. e_n (directions of the segments),
//! e_{n+1} (axis of the body at `to`) carries a direction across e_0 by parallel transport, the least turn
//! that takes each to the next:
//!
//! ```text
//! P_k w = w - (w . e_k) / (1 + e_{k-1} . e_k) (e_{k-1} + e_k)
//! ```
//!
//! The twist phi is the angle about e_{n+1} from what arrives to the direction that the body at `to` holds.
//! With the arms c_k = (e_{k-1} + e_k) / (1 + e_{k-1} . e_k), Omega the angular velocities of the bodies and
//! v_k that of point k,
//!
//! ```text
//! dphi/dt = Omega_to . c_{n+1} - Omega_from . c_1 + sum g_k . (v_k - v_{k-1})
//! g_k     = (c_k - c_{k+1}) x e_k / L_k
//! ```
//!
//! g_k gradient by the vector of segment k (1/m), L_k its length (m): half the difference of the curvature
//! binormals at its ends (Bergou, Wardetzky, Robinson, Audoly and Grinspun 2008, ACM Trans. Graph. 27,
//! 63). The arms sum up so that no torque is left: c_{n+1} - c_1 + sum (c_k - c_{k+1}) = 0.
//!
//! Where one direction is the opposite of the next the twist is not defined. Segments without length are
//! passed over.

use std::f64::consts::TAU;

use glam::DVec3;

/// 1 + e . e' below this, two directions count as opposite.
const LEAST_ALIGNMENT: f64 = 1e-12;

/// An end of a line as it is held: unit vectors and angular velocity of its body, inertial frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldEnd {
    /// The axis along which the line leaves or arrives.
    pub axis: DVec3,
    /// The direction across the axis that is carried or met.
    pub across: DVec3,
    /// Angular velocity, rad/s.
    pub rate_rad_s: DVec3,
}

/// The twist of a line as it stands.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LineTwist {
    /// Twist but for whole turns, rad, in [-pi, pi].
    pub angle_rad: f64,
    /// Its rate, rad/s.
    pub rate_rad_s: f64,
    /// c_1.
    pub from_arm: DVec3,
    /// c_{n+1}.
    pub to_arm: DVec3,
}

/// The arm `(a + b) / (1 + a . b)` between two unit vectors.
#[inline]
fn arm(a: DVec3, b: DVec3) -> DVec3 {
    (a + b) / (1.0 + a.dot(b)).max(LEAST_ALIGNMENT)
}

/// What `across` the first of two unit vectors becomes by the least turn to the second, of which `arm` is
/// the arm.
#[inline]
fn transported(across: DVec3, to: DVec3, arm: DVec3) -> DVec3 {
    across - across.dot(to) * arm
}

/// Carries a direction `across` the axis `from_axis` along the points (m) to the axis `to_axis`.
#[must_use]
pub fn carried(across: DVec3, from_axis: DVec3, points_m: &[DVec3], to_axis: DVec3) -> DVec3 {
    let directions = points_m
        .windows(2)
        .filter_map(|pair| (pair[1] - pair[0]).try_normalize())
        .chain([to_axis]);
    let (mut before, mut across) = (from_axis, across);
    for direction in directions {
        across = transported(across, direction, arm(before, direction));
        before = direction;
    }
    across
}

/// The twist of a line through points (m) that move (m/s); writes g_k (1/m) to `gradient`, one for each
/// segment.
pub fn line_twist(
    from: &HeldEnd,
    to: &HeldEnd,
    points_m: &[DVec3],
    velocities_m_s: &[DVec3],
    gradient: &mut Vec<DVec3>,
) -> LineTwist {
    gradient.clear();
    gradient.resize(points_m.len().saturating_sub(1), DVec3::ZERO);
    let mut before = from.axis;
    let mut across = from.across;
    let mut from_arm = None;
    // Of the segment behind: its place, the arm at its beginning, and 1 / L.
    let mut behind: Option<(usize, DVec3, f64)> = None;
    for (k, pair) in points_m.windows(2).enumerate() {
        let span = pair[1] - pair[0];
        let length_m = span.length_squared().sqrt();
        if length_m <= 0.0 {
            continue;
        }
        let per_length = 1.0 / length_m;
        let direction = span * per_length;
        let here = arm(before, direction);
        across = transported(across, direction, here);
        if let Some((at, start, per_length)) = behind {
            gradient[at] = (start - here).cross(before) * per_length;
        }
        from_arm.get_or_insert(here);
        behind = Some((k, here, per_length));
        before = direction;
    }
    let to_arm = arm(before, to.axis);
    across = transported(across, to.axis, to_arm);
    if let Some((at, start, per_length)) = behind {
        gradient[at] = (start - to_arm).cross(before) * per_length;
    }
    let from_arm = from_arm.unwrap_or(to_arm);
    let mut rate_rad_s = to.rate_rad_s.dot(to_arm) - from.rate_rad_s.dot(from_arm);
    for (g, pair) in gradient.iter().zip(velocities_m_s.windows(2)) {
        rate_rad_s += g.dot(pair[1] - pair[0]);
    }
    let sine = to.axis.dot(across.cross(to.across));
    LineTwist {
        angle_rad: libm::atan2(sine, across.dot(to.across)),
        rate_rad_s,
        from_arm,
        to_arm,
    }
}

/// `angle_rad` with as many turns as bring it nearest to `near_rad`.
#[must_use]
pub fn with_turns(angle_rad: f64, near_rad: f64) -> f64 {
    angle_rad + TAU * ((near_rad - angle_rad) / TAU).round()
}

#[cfg(test)]
mod tests;
