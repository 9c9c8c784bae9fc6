//! Attitude in a local chart over one step: q = q_0 exp(theta), theta(0) = 0.
//!
//! theta rotation vector (rad), omega angular velocity in the body frame (rad/s):
//!
//! ```text
//! exp(theta) = (sin(|theta|/2) theta/|theta|, cos(|theta|/2))
//! theta' = omega + 1/2 theta x omega + b(|theta|) theta x (theta x omega)
//! b(t)   = (1 - (t/2) cot(t/2)) / t^2 = 1/12 + t^2/720 + ...
//! ```
//!
//! (Hairer, Lubich and Wanner 2006, sec. IV.7; Iserles et al. 2000). The quaternion is advanced once
//! per accepted step, so it has length one by construction, and position and attitude share the form
//! "rate = velocity" that an implicit method wants. The chart is regular below a full turn per step.

use glam::{DQuat, DVec3};

/// Below this angle, rad, the series is exact to round-off.
const SMALL_ANGLE_RAD: f64 = 1e-2;

/// The unit quaternion of a rotation vector in rad.
#[must_use]
pub fn exponential(rotation_rad: DVec3) -> DQuat {
    let square = rotation_rad.length_squared();
    let (scale, w) = if square < SMALL_ANGLE_RAD * SMALL_ANGLE_RAD {
        let series = 0.5 - square / 48.0 + square * square / 3840.0;
        (series, 1.0 - square / 8.0 + square * square / 384.0)
    } else {
        let angle = square.sqrt();
        let (sin, cos) = libm::sincos(0.5 * angle);
        (sin / angle, cos)
    };
    let v = rotation_rad * scale;
    DQuat::from_xyzw(v.x, v.y, v.z, w)
}

/// The rotation vector of a unit quaternion, rad, of length at most pi.
#[must_use]
pub fn logarithm(rotation: DQuat) -> DVec3 {
    let rotation = if rotation.w < 0.0 {
        -rotation
    } else {
        rotation
    };
    let vector = DVec3::new(rotation.x, rotation.y, rotation.z);
    let sine = vector.length();
    if sine < 1e-12 {
        return 2.0 * vector;
    }
    vector * (2.0 * libm::atan2(sine, rotation.w) / sine)
}

/// Rate of the rotation vector, rad/s, for an angular velocity in the body frame in rad/s.
#[must_use]
pub fn rotation_rate(rotation_rad: DVec3, rate_rad_s: DVec3) -> DVec3 {
    let square = rotation_rad.length_squared();
    if square == 0.0 {
        return rate_rad_s;
    }
    let coefficient = if square < SMALL_ANGLE_RAD * SMALL_ANGLE_RAD {
        1.0 / 12.0 + square / 720.0 + square * square / 30240.0
    } else {
        let half = 0.5 * square.sqrt();
        let (sin, cos) = libm::sincos(half);
        (1.0 - half * cos / sin) / square
    };
    let once = rotation_rad.cross(rate_rad_s);
    rate_rad_s + 0.5 * once + coefficient * rotation_rad.cross(once)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_meets_the_closed_form() {
        let axis = DVec3::new(0.3, -0.5, 0.8).normalize();
        let omega = DVec3::new(1.0, 2.0, -0.5);
        for angle in [0.999_999 * SMALL_ANGLE_RAD, 1.000_001 * SMALL_ANGLE_RAD] {
            let quaternion = exponential(angle * axis);
            let expected = DQuat::from_axis_angle(axis, angle);
            assert!((quaternion - expected).length() < 1e-15);
            assert!((quaternion.length() - 1.0).abs() < 1e-15);
            let rate = rotation_rate(angle * axis, omega);
            let nearby = rotation_rate(SMALL_ANGLE_RAD * axis, omega);
            assert!((rate - nearby).length() < 1e-7);
        }
    }

    #[test]
    fn the_logarithm_undoes_the_exponential() {
        for vector in [
            DVec3::ZERO,
            DVec3::new(1e-9, 0.0, 2e-9),
            DVec3::new(0.4, -1.3, 2.1),
        ] {
            assert!((logarithm(exponential(vector)) - vector).length() < 1e-14);
        }
    }

    /// d/dt exp(theta) = 1/2 exp(theta) (omega, 0), by a central difference along theta'.
    #[test]
    fn the_rate_is_that_of_the_quaternion() {
        let theta = DVec3::new(0.7, -1.1, 0.4);
        let omega = DVec3::new(-0.2, 0.9, 1.3);
        let rate = rotation_rate(theta, omega);
        let h = 1e-5;
        let difference =
            (exponential(theta + h * rate) - exponential(theta - h * rate)) * (0.5 / h);
        let product = exponential(theta) * DQuat::from_xyzw(omega.x, omega.y, omega.z, 0.0) * 0.5;
        assert!((difference - product).length() < 1e-9);
    }
}
