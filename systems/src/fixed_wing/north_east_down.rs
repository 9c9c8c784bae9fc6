//! Between the axes of a scene (x north, y west, z up; body: forward, left, up) and those of the
//! aircraft's equations (north, east, down; body: forward, right, down).
//!
//! Both changes are half a turn about the first axis, C = diag(1, -1, -1), its own inverse: so each function
//! goes both ways. v' = C v, R' = C R C, J' = C J C; a quaternion's vector part changes as a vector.

use glam::{DMat3, DQuat, DVec3};

/// A vector of either pair of frames in the other's axes.
#[inline]
#[must_use]
pub fn vector(v: DVec3) -> DVec3 {
    DVec3::new(v.x, -v.y, -v.z)
}

/// An attitude, body to inertial, of either pair of frames in the other.
#[inline]
#[must_use]
pub fn attitude(q: DQuat) -> DQuat {
    DQuat::from_xyzw(q.x, -q.y, -q.z, q.w)
}

/// A tensor of inertia of either body frame in the other.
#[must_use]
pub fn tensor(j: DMat3) -> DMat3 {
    let turn = DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0));
    turn * j * turn
}

/// Roll, pitch and yaw of an attitude, forward-right-down to north-east-down, rad: yaw about down, then
/// pitch about the turned right axis, then roll.
#[must_use]
pub fn roll_pitch_yaw(q: DQuat) -> DVec3 {
    let (x, y, z, w) = (q.x, q.y, q.z, q.w);
    DVec3::new(
        libm::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
        libm::asin((2.0 * (w * y - z * x)).clamp(-1.0, 1.0)),
        libm::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)),
    )
}

/// The attitude of roll, pitch and yaw, the inverse of [`roll_pitch_yaw`].
#[must_use]
pub fn from_roll_pitch_yaw(angles_rad: DVec3) -> DQuat {
    let half = 0.5 * angles_rad;
    let (sr, cr) = libm::sincos(half.x);
    let (sp, cp) = libm::sincos(half.y);
    let (sy, cy) = libm::sincos(half.z);
    DQuat::from_xyzw(
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A climbing right-hand turn to the north-east, told in the words of either frame.
    #[test]
    fn a_climbing_turn_is_the_same_in_both_frames() {
        let ned = from_roll_pitch_yaw(DVec3::new(0.4, 0.2, 0.7));
        let scene = attitude(ned);
        let nose = scene * DVec3::X;
        assert!(nose.z > 0.0, "the nose points up");
        assert!(
            nose.y < 0.0,
            "east is to the right of north, where y is negative"
        );
        assert!((nose.z - libm::sin(0.2)).abs() < 1e-15);
        assert!((libm::atan2(nose.y, nose.x) + 0.7).abs() < 1e-15);
        let left_wing = scene * DVec3::Y;
        assert!(
            left_wing.z > 0.0,
            "in a right-hand turn the left wing is up"
        );
        let wind = DVec3::new(3.0, -2.0, 1.0);
        let body = DVec3::new(0.3, 0.8, -0.5);
        assert!((vector(ned * body) - scene * vector(body)).length() < 1e-15);
        assert_eq!(vector(vector(wind)), wind);
        assert_eq!(attitude(attitude(scene)), scene);
    }

    #[test]
    fn angles_come_back() {
        for angles in [
            DVec3::new(0.1, -0.4, 3.0),
            DVec3::new(-3.0, 1.2, -2.0),
            DVec3::new(1.5, 0.0, 0.0),
        ] {
            let found = roll_pitch_yaw(from_roll_pitch_yaw(angles));
            assert!((found - angles).length() < 1e-14, "{found}");
        }
    }

    /// Half the kinetic energy of a rotation does not depend on the frame.
    #[test]
    fn a_tensor_keeps_its_energy() {
        let tensor_scene = DMat3::from_cols(
            DVec3::new(0.8, 0.01, 0.12),
            DVec3::new(0.01, 1.1, -0.03),
            DVec3::new(0.12, -0.03, 1.7),
        );
        let rate = DVec3::new(0.3, -1.0, 0.6);
        let there = vector(rate).dot(tensor(tensor_scene) * vector(rate));
        assert!((there - rate.dot(tensor_scene * rate)).abs() < 1e-15);
    }
}
