//! What a latch makes of two motions when it closes: the two bodies move as one, with the momentum and the angular
//! momentum that they had.
//!
//! ```text
//! M v + omega x S + m u                        = M' v' + omega' x S'
//! J omega + S x v + r x (m u) + A K w          = J' omega' + S' x v'
//! M' = M + m,  S' = S + m r,  J' = J + m (r^2 I - r r') + A K A'
//! ```
//!
//! everything in the frame of the carrier and about its centre of mass, as in [`crate::dynamics::rigid_body`]: M, S, J
//! of the carrier with what it carries, v and omega its velocity and angular velocity; m, K mass and inertia of the
//! rider, u its velocity, w its angular velocity in its own frame, r the place of its centre of mass, A its attitude
//! against the carrier; primes mark what follows. Kinetic energy is lost (Carnot's theorem): of all motions that the
//! latch allows, this is the nearest in the norm of kinetic energy.
//!
//! Where links hold the carrier, this is the motion that the joints' impulses then change
//! ([`crate::denoc::impulse`]); they leave momentum as it is.
//!
//! Source: Goldstein, Poole and Safko (2002), ch. 5; Pars (1965), A Treatise on Analytical Dynamics, ch. 14.

use glam::{DMat3, DQuat, DVec3};

use crate::dynamics::rigid_body::{CarriedMass, accelerations};

/// A body that carries, with everything that it carries; its own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carrier {
    /// Mass with added mass and what is carried, kg.
    pub mass_kg: f64,
    /// Of what is carried, kg m.
    pub first_moment_kg_m: DVec3,
    /// About the centre of mass, with what is carried, kg m^2.
    pub inertia_kg_m2: DMat3,
    /// Of the centre of mass, m/s.
    pub velocity_m_s: DVec3,
    /// Angular velocity, rad/s.
    pub rate_rad_s: DVec3,
}

/// A body that is taken on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rider {
    /// Mass, kg.
    pub mass_kg: f64,
    /// About its centre of mass, its own frame, kg m^2.
    pub inertia_kg_m2: DMat3,
    /// Where it is, frame of the carrier, m.
    pub offset_m: DVec3,
    /// Its frame to that of the carrier.
    pub attitude: DQuat,
    /// Its velocity, frame of the carrier, m/s.
    pub velocity_m_s: DVec3,
    /// Its angular velocity, its own frame, rad/s.
    pub rate_rad_s: DVec3,
}

/// What a rider of this mass (kg), inertia (kg m^2, its own frame), place (m) and attitude is to its carrier.
#[must_use]
pub fn carried(
    mass_kg: f64,
    inertia_kg_m2: DMat3,
    offset_m: DVec3,
    attitude: DQuat,
) -> CarriedMass {
    let mut carried = CarriedMass::default();
    carried.add(mass_kg, offset_m);
    let turn = DMat3::from_quat(attitude);
    carried.inertia_kg_m2 += turn * inertia_kg_m2 * turn.transpose();
    carried
}

/// Velocity (m/s) and angular velocity (rad/s) of the carrier once the rider is joined to it, in its frame.
#[must_use]
pub fn joined_motion(carrier: &Carrier, rider: &Rider) -> (DVec3, DVec3) {
    let momentum = carrier.mass_kg * carrier.velocity_m_s
        + carrier.rate_rad_s.cross(carrier.first_moment_kg_m);
    let about_centre = carrier.inertia_kg_m2 * carrier.rate_rad_s
        + carrier.first_moment_kg_m.cross(carrier.velocity_m_s);
    let taken = rider.mass_kg * rider.velocity_m_s;
    let spin = rider.attitude * (rider.inertia_kg_m2 * rider.rate_rad_s);
    let added = carried(
        rider.mass_kg,
        rider.inertia_kg_m2,
        rider.offset_m,
        rider.attitude,
    );
    // Of bodies at rest, momenta are to velocities what forces are to accelerations.
    accelerations(
        carrier.mass_kg + rider.mass_kg,
        carrier.first_moment_kg_m + added.first_moment_kg_m,
        carrier.inertia_kg_m2 + added.inertia_kg_m2,
        DVec3::ZERO,
        momentum + taken,
        about_centre + rider.offset_m.cross(taken) + spin,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two bodies that fly apart from each other before and as one afterwards: sums over the two, about a place
    /// that is neither's centre, and the energy of what was lost.
    #[test]
    fn momentum_and_angular_momentum_stay_and_energy_falls() {
        let (carrier_kg, carrier_j) = (100.0, DMat3::from_diagonal(DVec3::new(16.0, 17.0, 18.0)));
        let rider = Rider {
            mass_kg: 6.0,
            inertia_kg_m2: DMat3::from_diagonal(DVec3::new(0.3, 0.4, 0.6)),
            offset_m: DVec3::new(-1.2, 0.1, -0.3),
            attitude: DQuat::from_scaled_axis(DVec3::new(0.1, -0.2, 0.3)),
            velocity_m_s: DVec3::new(0.4, -0.1, 0.05),
            rate_rad_s: DVec3::new(0.3, 0.1, -0.2),
        };
        let carrier = Carrier {
            mass_kg: carrier_kg,
            first_moment_kg_m: DVec3::ZERO,
            inertia_kg_m2: carrier_j,
            velocity_m_s: DVec3::new(0.02, 0.3, -0.1),
            rate_rad_s: DVec3::new(0.05, -0.02, 0.1),
        };
        let (velocity, rate) = joined_motion(&carrier, &rider);
        let turn = rider.attitude;
        let at_rider = velocity + rate.cross(rider.offset_m);
        let pivot = DVec3::new(3.0, -1.0, 2.0);
        let sums = |v: DVec3, w: DVec3, u: DVec3, own: DVec3| {
            let linear = carrier_kg * v + rider.mass_kg * u;
            let angular = carrier_j * w
                + (-pivot).cross(carrier_kg * v)
                + turn * (rider.inertia_kg_m2 * own)
                + (rider.offset_m - pivot).cross(rider.mass_kg * u);
            let energy = carrier_kg * v.length_squared()
                + w.dot(carrier_j * w)
                + rider.mass_kg * u.length_squared()
                + own.dot(rider.inertia_kg_m2 * own);
            (linear, angular, 0.5 * energy)
        };
        let before = sums(
            carrier.velocity_m_s,
            carrier.rate_rad_s,
            rider.velocity_m_s,
            rider.rate_rad_s,
        );
        let after = sums(velocity, rate, at_rider, turn.conjugate() * rate);
        assert!((before.0 - after.0).length() < 1e-14 * before.0.length());
        assert!((before.1 - after.1).length() < 1e-13 * before.1.length());
        assert!(after.2 < before.2 - 0.1, "{} {}", before.2, after.2);
    }

    /// Two points in a line: v' = (M v + m u) / (M + m), and the loss is that of the reduced mass.
    #[test]
    fn a_central_impact_is_that_of_two_points() {
        let carrier = Carrier {
            mass_kg: 3.0,
            first_moment_kg_m: DVec3::ZERO,
            inertia_kg_m2: DMat3::IDENTITY,
            velocity_m_s: DVec3::X,
            rate_rad_s: DVec3::ZERO,
        };
        let rider = Rider {
            mass_kg: 1.0,
            inertia_kg_m2: DMat3::IDENTITY,
            offset_m: DVec3::X,
            attitude: DQuat::IDENTITY,
            velocity_m_s: -DVec3::X,
            rate_rad_s: DVec3::ZERO,
        };
        let (velocity, rate) = joined_motion(&carrier, &rider);
        assert!((velocity - 0.5 * DVec3::X).length() < 1e-15 && rate.length() < 1e-15);
        let lost = 0.5 * (3.0 + 1.0) - 0.5 * 4.0 * 0.25;
        assert!((lost - 0.5 * (3.0 / 4.0) * 4.0_f64).abs() < 1e-15);
    }
}
