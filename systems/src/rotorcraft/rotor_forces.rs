//! Forces of the rotors on the body.
//!
//! ```text
//! F = T z_b,  T' = (T_c - T) / tau
//! Q = -J (w_n^2 e + 2 w_n omega) + omega x (J omega),   |Q_i| <= Q_max
//! ```
//!
//! T thrust, T_c the one commanded (N), tau its time constant (s), z_b the body's z axis; Q torque about the centre of
//! mass (N m), J inertia (kg m^2), omega angular velocity (rad/s), e rotation vector from the commanded attitude to
//! that of the body (rad), all in the body frame; w_n = 2 / (attitude lag) (rad/s). For small angles and below the
//! largest torque the attitude follows its command as a critically damped oscillator, whose answer to a slow
//! command is late by 2 / w_n.
//!
//! Assumptions: the attitude is known to the drone as it is, and its loop is fast against the commands'; rotors have no
//! angular momentum (they turn in pairs), and no drag of their own.

use aerobot_components::rotorcraft::{RotorCommand, Rotorcraft};
use aerobot_components::state::{
    AngularVelocity, Attitude, FirstOrderState, Force, Inertia, Torque,
};
use bevy_ecs::system::Query;
use glam::{DMat3, DQuat, DVec3};

/// Adds thrust and torque, and finds how the thrust changes.
pub fn rotor_forces(
    mut bodies: Query<(
        &Rotorcraft,
        &RotorCommand,
        (&Attitude, &AngularVelocity, &Inertia),
        &mut FirstOrderState,
        (&mut Force, &mut Torque),
    )>,
) {
    for (rotorcraft, command, (attitude, rate, inertia), mut thrust, (mut force, mut torque)) in
        &mut bodies
    {
        let wanted_n = if command.is_idle {
            0.0
        } else {
            command.thrust_n
        };
        thrust.rate_per_s = (wanted_n - thrust.value) / rotorcraft.thrust_lag_s;
        force.0 += thrust.value * (attitude.0 * DVec3::Z);
        if !command.is_idle {
            let error_rad = rotation_vector(command.attitude.conjugate() * attitude.0);
            torque.0 += attitude.0 * control_torque(rotorcraft, inertia.0, error_rad, rate.0);
        }
    }
}

/// Torque in the body frame, N m, of a rotation vector (rad) away from the command and an angular velocity (rad/s),
/// body frame, for a tensor of inertia in kg m^2.
#[must_use]
pub fn control_torque(
    rotorcraft: &Rotorcraft,
    inertia: DMat3,
    error_rad: DVec3,
    rate_rad_s: DVec3,
) -> DVec3 {
    let frequency = 2.0 / rotorcraft.attitude_lag_s;
    let wanted = -(frequency * frequency * error_rad + 2.0 * frequency * rate_rad_s);
    let torque = inertia * wanted + rate_rad_s.cross(inertia * rate_rad_s);
    let limit = DVec3::splat(rotorcraft.largest_torque_n_m);
    torque.clamp(-limit, limit)
}

/// The rotation vector of a unit quaternion, rad: the shorter way round.
#[must_use]
pub fn rotation_vector(turn: DQuat) -> DVec3 {
    let turn = if turn.w < 0.0 { -turn } else { turn };
    let axis = turn.xyz();
    let sine = axis.length();
    if sine < 1e-12 {
        2.0 * axis
    } else {
        (2.0 * libm::atan2(sine, turn.w) / sine) * axis
    }
}

#[cfg(test)]
pub(crate) mod test_support {
    use aerobot_components::rotorcraft::{Course, Rotorcraft};

    /// Four rotors of 0.5 m.
    pub(crate) fn drone() -> Rotorcraft {
        Rotorcraft {
            rotors: 4,
            rotor_diameter_m: 0.5,
            motor_power_w: 1200.0,
            figure_of_merit: 0.65,
            thrust_coefficient: 0.012,
            tip_speed_m_s: 150.0,
            thrust_lag_s: 0.05,
            attitude_lag_s: 0.15,
            largest_torque_n_m: 10.0,
            largest_tilt_rad: 0.5,
            position_gain_per_s: 0.6,
            velocity_gain_per_s: 2.0,
            largest_speed_m_s: 3.0,
            period_s: 0.05,
            course: Course::Hold,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotation_vectors_are_those_of_their_turns() {
        for vector in [
            DVec3::new(0.3, -0.2, 1.1),
            DVec3::new(0.0, 1e-9, 0.0),
            DVec3::new(2.0, 2.0, 0.1),
        ] {
            let turn = DQuat::from_scaled_axis(vector);
            assert!((rotation_vector(turn) - vector).length() < 1e-14);
            assert!((rotation_vector(-turn) - vector).length() < 1e-14);
        }
    }
}
