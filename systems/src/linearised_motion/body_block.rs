//! What one body adds to the linearised motion: 6x6 blocks in 3x3 parts, and places on the body.
//!
//! Unknowns of a body are its velocity in the inertial frame and its angular velocity in the body
//! frame. A place r on it (body frame, m) moves with `J w`, `J = [I, -R [r]]`, R body to inertial; a
//! force F there acts on the body as `J' F`.

use glam::{DMat3, DQuat, DVec3};

/// A velocity, displacement or force with its angular part.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twist {
    /// Linear part, inertial frame.
    pub linear: DVec3,
    /// Angular part, body frame.
    pub angular: DVec3,
}

impl std::ops::Neg for Twist {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            linear: -self.linear,
            angular: -self.angular,
        }
    }
}

/// The cross-product matrix `[v]`: `[v] w = v x w`.
#[must_use]
pub fn cross_matrix(v: DVec3) -> DMat3 {
    DMat3::from_cols(
        DVec3::new(0.0, v.z, -v.y),
        DVec3::new(-v.z, 0.0, v.x),
        DVec3::new(v.y, -v.x, 0.0),
    )
}

/// A place on a body: `J = [I, turn]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// `-R [r]`, m.
    pub turn: DMat3,
}

impl Place {
    /// The place `offset_m` (body frame, m) on a body of this attitude.
    #[must_use]
    pub fn new(attitude: DQuat, offset_m: DVec3) -> Self {
        Self {
            turn: -(DMat3::from_quat(attitude) * cross_matrix(offset_m)),
        }
    }

    /// How the place moves with the body.
    #[inline]
    #[must_use]
    pub fn motion(&self, body: Twist) -> DVec3 {
        body.linear + self.turn * body.angular
    }

    /// What a force at the place is on the body.
    #[inline]
    #[must_use]
    pub fn load(&self, force: DVec3) -> Twist {
        Twist {
            linear: force,
            angular: self.turn.transpose() * force,
        }
    }
}

/// A 6x6 matrix of a body, or between two bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyBlock {
    /// Force by linear motion.
    pub linear: DMat3,
    /// Force by turning.
    pub linear_by_turn: DMat3,
    /// Torque by linear motion.
    pub turn_by_linear: DMat3,
    /// Torque by turning.
    pub turn: DMat3,
}

impl BodyBlock {
    /// All zero. (There is no default: that of a matrix in glam is the identity.)
    pub const ZERO: Self = Self {
        linear: DMat3::ZERO,
        linear_by_turn: DMat3::ZERO,
        turn_by_linear: DMat3::ZERO,
        turn: DMat3::ZERO,
    };

    /// `J_row' S J_column`: the matrix S between two places, seen by their bodies.
    #[must_use]
    pub fn between(row: &Place, s: DMat3, column: &Place) -> Self {
        let s_turn = s * column.turn;
        let turn_s = row.turn.transpose() * s;
        Self {
            linear: s,
            linear_by_turn: s_turn,
            turn_by_linear: turn_s,
            turn: turn_s * column.turn,
        }
    }

    /// Mass matrix of a point, kg.
    #[must_use]
    pub fn point(mass_kg: f64) -> Self {
        Self {
            linear: DMat3::from_diagonal(DVec3::splat(mass_kg)),
            ..Self::ZERO
        }
    }

    /// Mass matrix: `mass_kg` in all, the first moment of what is carried off the centre (kg m, body
    /// frame), and the inertia about the centre of mass (kg m^2, body frame).
    #[must_use]
    pub fn mass(mass_kg: f64, first_moment_kg_m: DVec3, inertia: DMat3, attitude: DQuat) -> Self {
        let coupling = -(DMat3::from_quat(attitude) * cross_matrix(first_moment_kg_m));
        Self {
            linear: DMat3::from_diagonal(DVec3::splat(mass_kg)),
            linear_by_turn: coupling,
            turn_by_linear: coupling.transpose(),
            turn: inertia,
        }
    }

    /// With rows and columns exchanged.
    #[must_use]
    pub fn transposed(&self) -> Self {
        Self {
            linear: self.linear.transpose(),
            linear_by_turn: self.turn_by_linear.transpose(),
            turn_by_linear: self.linear_by_turn.transpose(),
            turn: self.turn.transpose(),
        }
    }

    /// Adds `scale` times `other`.
    pub fn add(&mut self, other: &Self, scale: f64) {
        self.linear += other.linear * scale;
        self.linear_by_turn += other.linear_by_turn * scale;
        self.turn_by_linear += other.turn_by_linear * scale;
        self.turn += other.turn * scale;
    }

    /// The product with a twist.
    #[inline]
    #[must_use]
    pub fn times(&self, w: Twist) -> Twist {
        Twist {
            linear: self.linear * w.linear + self.linear_by_turn * w.angular,
            angular: self.turn_by_linear * w.linear + self.turn * w.angular,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_moves_and_loads_as_mechanics_says() {
        let attitude = DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -1.1, 0.7);
        let offset = DVec3::new(0.4, -0.2, 1.3);
        let place = Place::new(attitude, offset);
        let body = Twist {
            linear: DVec3::new(1.0, 2.0, 3.0),
            angular: DVec3::new(-0.5, 0.8, 0.1),
        };
        let expected = body.linear + attitude * body.angular.cross(offset);
        assert!((place.motion(body) - expected).length() < 1e-14);
        let force = DVec3::new(-2.0, 0.5, 4.0);
        let torque = offset.cross(attitude.conjugate() * force);
        assert!((place.load(force).angular - torque).length() < 1e-14);
    }

    /// Two masses bolted on: momentum and kinetic energy of the block are those of the parts.
    #[test]
    fn the_mass_matrix_gives_the_kinetic_energy_of_the_parts() {
        let attitude = DQuat::from_euler(glam::EulerRot::ZYX, 0.9, 0.2, -0.4);
        let inertia = DMat3::from_diagonal(DVec3::new(3.0, 4.0, 5.0));
        let parts = [
            (0.7, DVec3::new(0.3, -0.2, 1.1)),
            (0.4, DVec3::new(-0.5, 0.6, -0.9)),
        ];
        let w = Twist {
            linear: DVec3::new(1.0, -2.0, 0.5),
            angular: DVec3::new(0.4, -1.2, 0.8),
        };
        let mut carried = crate::dynamics::rigid_body::CarriedMass::default();
        let mut energy = 0.5 * 6.0 * w.linear.length_squared();
        energy += 0.5 * w.angular.dot(inertia * w.angular);
        for (mass, offset) in parts {
            carried.add(mass, offset);
            let velocity = w.linear + attitude * w.angular.cross(offset);
            energy += 0.5 * mass * velocity.length_squared();
        }
        let block = BodyBlock::mass(
            6.0 + carried.mass_kg,
            carried.first_moment_kg_m,
            inertia + carried.inertia_kg_m2,
            attitude,
        );
        let p = block.times(w);
        let found = 0.5 * (p.linear.dot(w.linear) + p.angular.dot(w.angular));
        assert!((found - energy).abs() < 1e-13 * energy);
    }
}
