//! From the axes of scenes (x downwind, y left, z up) to those of glTF (y up, z towards the viewer):
//! (x, y, z) becomes (-y, z, -x), which is a rotation. Local axes of nodes are turned the same way.

use glam::{DQuat, DVec3};

/// A vector in the axes of glTF.
pub(super) fn vector(ours: DVec3) -> DVec3 {
    DVec3::new(-ours.y, ours.z, -ours.x)
}

/// A rotation in the axes of glTF: its axis is turned, its angle stays.
pub(super) fn rotation(ours: DQuat) -> DQuat {
    let axis = vector(DVec3::new(ours.x, ours.y, ours.z));
    DQuat::from_xyzw(axis.x, axis.y, axis.z, ours.w)
}

/// Scales along the axes of glTF.
pub(super) fn scale(ours: DVec3) -> DVec3 {
    DVec3::new(ours.y, ours.z, ours.x)
}

/// In single precision, without the sign of zero.
pub(super) fn single<const N: usize>(values: [f64; N]) -> [f32; N] {
    values.map(|value| value as f32 + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotations_and_vectors_turn_together() {
        let turn = DQuat::from_xyzw(0.1, -0.5, 0.7, 0.3).normalize();
        for ours in [DVec3::X, DVec3::Y, DVec3::Z] {
            let there = rotation(turn) * vector(ours);
            assert!((there - vector(turn * ours)).length() < 1e-15);
        }
        assert_eq!(
            vector(DVec3::X).cross(vector(DVec3::Y)),
            vector(DVec3::Z),
            "a mirror image"
        );
    }
}
