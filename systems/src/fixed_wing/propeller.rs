//! Thrust and torque of a propeller on an electric motor, both at once in balance.
//!
//! ```text
//! V_in  = V_max delta_t
//! 0     = a Omega^2 + b Omega + c
//! a     = C_Q0 rho D^5/(2 pi)^2
//! b     = C_Q1 rho D^4 V_a/(2 pi) + K_Q K_V/R
//! c     = C_Q2 rho D^3 V_a^2 - K_Q V_in/R + K_Q i_0
//! n     = Omega/(2 pi)
//! T     = rho D^4 (C_T0 n^2 + C_T1 n V_a/D + C_T2 (V_a/D)^2)
//! Q     = rho D^5 (C_Q0 n^2 + C_Q1 n V_a/D + C_Q2 (V_a/D)^2)
//! ```
//!
//! delta_t throttle, V_in and V_max voltage at the motor and of the battery (V), Omega speed of the propeller
//! (rad/s), rho density (kg/m^3), D diameter (m), V_a airspeed (m/s), K_V = K_Q constant of the motor
//! (V s/rad), R its resistance (ohm), i_0 its current without load (A), T thrust (N), Q torque of the motor on
//! the propeller (N m). With the advance ratio J = V_a/(n D) these are C_T(J) rho n^2 D^4 and
//! C_Q(J) rho n^2 D^5, written so that a propeller may stand still.
//!
//! Source: Beard and McLain, sec. 4.3 in the revision of 2018. Assumptions: motor and propeller have no inertia
//! (their balance is reached at once), the air meets the propeller along its axis with the airspeed. A propeller
//! does not turn backward: where the balance would have it so it stands still and drags.

use std::f64::consts::TAU;

use aerobot_components::fixed_wing::aircraft::Propulsion;

/// What a propeller does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Thrust {
    /// Thrust along the axis, forward, N.
    pub thrust_n: f64,
    /// Torque of the motor on the propeller, N m.
    pub torque_n_m: f64,
    /// Speed of the propeller, rad/s.
    pub speed_rad_s: f64,
}

/// Thrust and torque at a density in kg/m^3, an airspeed in m/s and a throttle.
#[must_use]
pub fn thrust(
    propulsion: &Propulsion,
    density_kg_m3: f64,
    airspeed_m_s: f64,
    throttle: f64,
) -> Thrust {
    let (rho, d) = (density_kg_m3, propulsion.diameter_m);
    let (torque_0, torque_1, torque_2) = propulsion.torque;
    let (thrust_0, thrust_1, thrust_2) = propulsion.thrust;
    let motor = propulsion.motor_constant_v_s;
    let per_resistance = motor / propulsion.resistance_ohm;
    let d3 = d * d * d;
    let a = torque_0 * rho * d3 * d * d / (TAU * TAU);
    let b = torque_1 * rho * d3 * d * airspeed_m_s / TAU + per_resistance * motor;
    let c = torque_2 * rho * d3 * airspeed_m_s * airspeed_m_s
        - per_resistance * propulsion.battery_v * throttle
        + motor * propulsion.no_load_current_a;
    let discriminant = b * b - 4.0 * a * c;
    // 2c/(-b - ..) is the same root, and holds in a vacuum, where a is zero.
    let speed_rad_s = if discriminant > 0.0 {
        (-2.0 * c / (b + discriminant.sqrt())).max(0.0)
    } else {
        0.0
    };
    let turns = speed_rad_s / TAU;
    let advance = airspeed_m_s / d;
    let law = |zero: f64, one: f64, two: f64| {
        zero * turns * turns + one * turns * advance + two * advance * advance
    };
    Thrust {
        thrust_n: rho * d3 * d * law(thrust_0, thrust_1, thrust_2),
        torque_n_m: rho * d3 * d * d * law(torque_0, torque_1, torque_2),
        speed_rad_s,
    }
}

#[cfg(test)]
mod tests {
    use aerobot_components::fixed_wing::aircraft::AEROSONDE;

    use super::*;

    /// The motor's torque K_Q (i - i_0), from Ohm's law at the speed that was found, is the propeller's.
    #[test]
    fn motor_and_propeller_are_in_balance() {
        let propulsion = &AEROSONDE.propulsion;
        for (throttle, airspeed) in [(1.0, 0.0), (0.5, 10.0), (0.8, 25.0), (0.3, 25.0)] {
            let found = thrust(propulsion, 1.03, airspeed, throttle);
            let back_v = propulsion.motor_constant_v_s * found.speed_rad_s;
            let current = (propulsion.battery_v * throttle - back_v) / propulsion.resistance_ohm;
            let torque = propulsion.motor_constant_v_s * (current - propulsion.no_load_current_a);
            assert!((torque - found.torque_n_m).abs() < 1e-10, "{throttle}");
        }
    }

    #[test]
    fn a_propeller_without_power_drags_and_one_in_a_vacuum_does_nothing() {
        let propulsion = &AEROSONDE.propulsion;
        assert!(thrust(propulsion, 1.2, 25.0, 0.0).thrust_n < 0.0);
        assert_eq!(thrust(propulsion, 1.2, 0.0, 0.0).thrust_n, 0.0);
        let vacuum = thrust(propulsion, 0.0, 25.0, 1.0);
        assert_eq!((vacuum.thrust_n, vacuum.torque_n_m), (0.0, 0.0));
        assert!(vacuum.speed_rad_s > 600.0);
    }
}
