//! Newton-Euler equations of a rigid body that carries point masses off its centre of mass.
//!
//! With the centre of mass of the body alone as reference point, everything in the body frame:
//!
//! ```text
//! M a + alpha x S + omega x (omega x S) = F
//! J alpha + S x a + omega x (J omega)   = T
//! ```
//!
//! m mass, m_a added mass (inertia without weight; no d(m_a)/dt term), m_i masses carried at offsets
//! r_i (the half segments of tethers), M = m + m_a + sum m_i, S = sum m_i r_i,
//! J = J_0 + sum m_i (r_i^2 I - r_i r_i'), a linear and alpha angular acceleration, omega angular
//! velocity, F and T force and torque about the reference point (Goldstein, Poole and Safko 2002,
//! ch. 5; paper, sec. 3.1.2 and 3.3). Eliminating a leaves a symmetric 3x3 system:
//!
//! ```text
//! (J + [S]^2 / M) alpha = T - omega x (J omega) - S x (F - omega x (omega x S)) / M
//! ```

use aerobot_components::aerodynamics::AddedVolume;
use aerobot_components::body::Anchor;
use aerobot_components::state::{
    Acceleration, AddedInertia, Air, AngularAcceleration, AngularVelocity, Attitude, Force,
    Inertia, Mass, Torque,
};
use bevy_ecs::component::Component;
use bevy_ecs::query::Without;
use bevy_ecs::system::Query;
use glam::{DMat3, DVec3};

/// Point masses that a body carries at offsets from its centre of mass, summed, body frame.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct CarriedMass {
    /// Sum of the masses, kg.
    pub mass_kg: f64,
    /// Sum of mass times offset S, kg m.
    pub first_moment_kg_m: DVec3,
    /// Sum of m (r^2 I - r r'), kg m^2.
    pub inertia_kg_m2: DMat3,
}

impl Default for CarriedMass {
    /// Nothing carried. (Not derived: the default of a matrix in glam is the identity.)
    fn default() -> Self {
        Self {
            mass_kg: 0.0,
            first_moment_kg_m: DVec3::ZERO,
            inertia_kg_m2: DMat3::ZERO,
        }
    }
}

impl CarriedMass {
    /// Adds a mass in kg at an offset in m from the centre of mass, body frame.
    pub fn add(&mut self, mass_kg: f64, offset_m: DVec3) {
        self.mass_kg += mass_kg;
        self.first_moment_kg_m += mass_kg * offset_m;
        let outer = DMat3::from_cols(
            offset_m * offset_m.x,
            offset_m * offset_m.y,
            offset_m * offset_m.z,
        );
        let square = DMat3::from_diagonal(DVec3::splat(offset_m.length_squared()));
        self.inertia_kg_m2 += mass_kg * (square - outer);
    }

    /// With all that `other` has besides.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            mass_kg: self.mass_kg + other.mass_kg,
            first_moment_kg_m: self.first_moment_kg_m + other.first_moment_kg_m,
            inertia_kg_m2: self.inertia_kg_m2 + other.inertia_kg_m2,
        }
    }
}

/// Finds the added mass of every body that has one: coefficient x rho x V.
pub fn added_mass(mut bodies: Query<(&AddedVolume, &Air, &mut AddedInertia)>) {
    for (volume, air, mut added) in &mut bodies {
        added.0 = air.density_kg_m3 * volume.0;
    }
}

/// Accelerates every free body; one without [`Inertia`] is a point and does not turn.
pub fn accelerate_bodies(
    mut bodies: Query<
        (
            &Mass,
            &AddedInertia,
            Option<&Inertia>,
            &CarriedMass,
            &Attitude,
            &AngularVelocity,
            &Force,
            &Torque,
            &mut Acceleration,
            &mut AngularAcceleration,
        ),
        Without<Anchor>,
    >,
) {
    for (mass, added, inertia, carried, attitude, rate, force, torque, mut linear, mut angular) in
        &mut bodies
    {
        let total = mass.0 + added.0 + carried.mass_kg;
        let Some(inertia) = inertia else {
            linear.0 = force.0 / total;
            continue;
        };
        let to_body = attitude.0.conjugate();
        let motion = accelerations(
            total,
            carried.first_moment_kg_m,
            inertia.0 + carried.inertia_kg_m2,
            rate.0,
            to_body * force.0,
            to_body * torque.0,
        );
        linear.0 = attitude.0 * motion.0;
        angular.0 = motion.1;
    }
}

/// Linear and angular acceleration in the body frame; arguments as in the head of this file, in
/// kg, kg m, kg m^2, rad/s, N and N m, body frame.
#[must_use]
pub fn accelerations(
    mass_kg: f64,
    first_moment_kg_m: DVec3,
    inertia_kg_m2: DMat3,
    rate_rad_s: DVec3,
    force_n: DVec3,
    torque_n_m: DVec3,
) -> (DVec3, DVec3) {
    let moment = first_moment_kg_m;
    let net_force = force_n - rate_rad_s.cross(rate_rad_s.cross(moment));
    let gyroscopic = rate_rad_s.cross(inertia_kg_m2 * rate_rad_s);
    let about_centre = torque_n_m - gyroscopic - moment.cross(net_force) / mass_kg;
    let reduced = inertia_kg_m2 + cross_matrix_squared(moment) * (1.0 / mass_kg);
    let angular = reduced.inverse() * about_centre;
    let linear = (net_force - angular.cross(moment)) / mass_kg;
    (linear, angular)
}

/// `[s]^2 = s s' - s^2 I`, the square of the cross-product matrix of `s`.
fn cross_matrix_squared(s: DVec3) -> DMat3 {
    DMat3::from_cols(s * s.x, s * s.y, s * s.z)
        - DMat3::from_diagonal(DVec3::splat(s.length_squared()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// m (r^2 I - r r') of two masses, by hand.
    #[test]
    fn carried_masses_add_up_from_nothing() {
        let mut carried = CarriedMass::default();
        carried.add(2.0, DVec3::new(1.0, 0.0, 0.0));
        carried.add(3.0, DVec3::new(0.0, 0.0, -2.0));
        assert_eq!(carried.mass_kg, 5.0);
        assert_eq!(carried.first_moment_kg_m, DVec3::new(2.0, 0.0, -6.0));
        let expected = DMat3::from_diagonal(DVec3::new(12.0, 2.0 + 12.0, 2.0));
        assert_eq!(carried.inertia_kg_m2, expected);
    }

    /// A body with masses bolted on must move as the equivalent body about its true centre of mass.
    #[test]
    fn carried_masses_move_as_one_body_about_the_true_centre() {
        let inertia = DMat3::from_diagonal(DVec3::new(3.0, 4.0, 5.0));
        let mut carried = CarriedMass::default();
        carried.add(0.7, DVec3::new(0.3, -0.2, 1.1));
        carried.add(0.4, DVec3::new(-0.5, 0.6, -0.9));
        let (body_mass, rate) = (6.0, DVec3::new(0.4, -1.2, 0.8));
        let (force, torque) = (DVec3::new(3.0, -2.0, 5.0), DVec3::new(-1.0, 0.5, 2.0));
        let total = body_mass + carried.mass_kg;
        let (linear, angular) = accelerations(
            total,
            carried.first_moment_kg_m,
            inertia + carried.inertia_kg_m2,
            rate,
            force,
            torque,
        );
        // Euler's equation about the true centre of mass c, with the parallel-axis theorem.
        let centre = carried.first_moment_kg_m / total;
        let about_reference = inertia + carried.inertia_kg_m2;
        let about_centre = about_reference + total * cross_matrix_squared(centre);
        let torque_centre = torque - centre.cross(force);
        let expected_angular =
            about_centre.inverse() * (torque_centre - rate.cross(about_centre * rate));
        let expected_linear =
            force / total - expected_angular.cross(centre) - rate.cross(rate.cross(centre));
        assert!((angular - expected_angular).length() < 1e-13);
        assert!((linear - expected_linear).length() < 1e-13);
    }
}
