//! Thrust and power of rotors by momentum theory.
//!
//! ```text
//! v_h^2 = T / (2 rho A)
//! v_i sqrt(V_e^2 + (V_a + v_i)^2) = v_h^2
//! P = T (V_a + v_i) / FM
//! ```
//!
//! T thrust (N), rho density (kg/m^3), A area of all discs (m^2), v_h induced velocity in hover, v_i that in flight,
//! V_a velocity of the rotor through the air along its thrust (climb), V_e across it (m/s), P shaft power (W), FM
//! figure of merit. The largest thrust is the least of what the blades can give,
//! T <= c_T rho A V_tip^2, and of what the motors can drive, P <= P_max.
//!
//! Source: Glauert (1926), ARC R&M 1026 (1111); Leishman (2006), Principles of Helicopter Aerodynamics, ch. 2.
//!
//! Assumptions: discs apart from each other, induced velocity even over them, profile power in the figure of merit;
//! descent slower than v_h (beyond, in the wake that the rotors have made, there is no such theory). Power that the
//! air would give back counts as none.

use aerobot_components::rotorcraft::Rotorcraft;

/// More steps than Newton's method ever takes from above.
const STEPS: usize = 60;

/// How the rotors move through the air.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inflow {
    /// Density, kg/m^3.
    pub density_kg_m3: f64,
    /// Along the thrust, m/s.
    pub axial_m_s: f64,
    /// Across it, m/s.
    pub edgewise_m_s: f64,
}

/// Velocity that the discs add to the air, m/s; `hover_m_s` is that in hover.
#[must_use]
pub fn induced_velocity_m_s(hover_m_s: f64, inflow: &Inflow) -> f64 {
    let (axial, edge) = (inflow.axial_m_s, inflow.edgewise_m_s);
    let wanted = hover_m_s * hover_m_s;
    // The product is convex above the largest root, so that Newton's method comes down to it.
    let mut v = hover_m_s + (-axial).max(0.0);
    for _ in 0..STEPS {
        let through = (edge * edge + (axial + v) * (axial + v)).sqrt();
        let slope = through + v * (axial + v) / through;
        if through <= 0.0 || slope <= 0.0 {
            break;
        }
        let next = v - (v * through - wanted) / slope;
        if next >= v {
            break;
        }
        v = next.max(0.0);
    }
    v
}

/// Shaft power of a thrust (N), W.
#[must_use]
pub fn shaft_power_w(rotorcraft: &Rotorcraft, thrust_n: f64, inflow: &Inflow) -> f64 {
    if thrust_n <= 0.0 || inflow.density_kg_m3 <= 0.0 {
        return 0.0;
    }
    let discs = 2.0 * inflow.density_kg_m3 * rotorcraft.disc_area_m2();
    let induced_m_s = induced_velocity_m_s((thrust_n / discs).sqrt(), inflow);
    thrust_n * (inflow.axial_m_s + induced_m_s).max(0.0) / rotorcraft.figure_of_merit
}

/// The largest thrust that blades and motors can give, N.
#[must_use]
pub fn largest_thrust_n(rotorcraft: &Rotorcraft, inflow: &Inflow) -> f64 {
    let tip_m_s = rotorcraft.tip_speed_m_s;
    let pressure_pa = inflow.density_kg_m3 * tip_m_s * tip_m_s;
    let by_blades_n = rotorcraft.thrust_coefficient * rotorcraft.disc_area_m2() * pressure_pa;
    if shaft_power_w(rotorcraft, by_blades_n, inflow) <= rotorcraft.motor_power_w {
        return by_blades_n;
    }
    let (mut low_n, mut high_n) = (0.0, by_blades_n);
    for _ in 0..STEPS {
        let middle_n = 0.5 * (low_n + high_n);
        if shaft_power_w(rotorcraft, middle_n, inflow) <= rotorcraft.motor_power_w {
            low_n = middle_n;
        } else {
            high_n = middle_n;
        }
    }
    low_n
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rotorcraft::rotor_forces::test_support::drone;

    const WEIGHT_N: f64 = 6.0 * 8.87;

    fn inflow(axial_m_s: f64, edgewise_m_s: f64) -> Inflow {
        Inflow {
            density_kg_m3: 1.03,
            axial_m_s,
            edgewise_m_s,
        }
    }

    /// In hover P = T^(3/2) / (FM sqrt(2 rho A)): 470 W for 6 kg on four rotors of 0.5 m where the density is
    /// 1.03 kg/m^3.
    #[test]
    fn hover_takes_the_power_of_momentum_theory() {
        let area_m2 = std::f64::consts::PI * 0.25;
        let expected = WEIGHT_N.powf(1.5) / (0.65 * (2.0 * 1.03 * area_m2).sqrt());
        let found = shaft_power_w(&drone(), WEIGHT_N, &inflow(0.0, 0.0));
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
        assert!((found - 470.0).abs() < 1.0, "{found}");
    }

    /// Straight up v_i = -V/2 + sqrt(V^2/4 + v_h^2), straight down the same with V below zero; edgewise
    /// v_i^2 = -V^2/2 + sqrt(V^4/4 + v_h^4).
    #[test]
    fn induced_velocities_are_those_of_closed_forms() {
        let hover = 5.7_f64;
        for v in [0.5, 2.0, 10.0, -0.5, -2.0] {
            let expected = -0.5 * v + (0.25 * v * v + hover * hover).sqrt();
            let found = induced_velocity_m_s(hover, &inflow(v, 0.0));
            assert!((found - expected).abs() < 1e-12, "{v}: {found} {expected}");
        }
        for v in [0.5_f64, 4.5, 30.0] {
            let expected = (-0.5 * v * v + (0.25 * v.powi(4) + hover.powi(4)).sqrt()).sqrt();
            let found = induced_velocity_m_s(hover, &inflow(0.0, v));
            assert!((found - expected).abs() < 1e-10, "{v}: {found} {expected}");
        }
    }

    /// Motors: T = (FM P)^(2/3) (2 rho A)^(1/3) in hover. Blades: c_T rho A V_tip^2, in thin air less than that.
    #[test]
    fn the_largest_thrust_is_that_of_motors_or_of_blades() {
        let drone = drone();
        let area_m2 = std::f64::consts::PI * 0.25;
        let by_motors = (0.65_f64 * drone.motor_power_w).powf(2.0 / 3.0)
            * (2.0 * 1.03 * area_m2).powf(1.0 / 3.0);
        let found = largest_thrust_n(&drone, &inflow(0.0, 0.0));
        assert!((found / by_motors - 1.0).abs() < 1e-12);
        let thin = Inflow {
            density_kg_m3: 0.1,
            ..Inflow::default()
        };
        let by_blades = 0.012 * 0.1 * area_m2 * 150.0 * 150.0;
        assert!((largest_thrust_n(&drone, &thin) / by_blades - 1.0).abs() < 1e-12);
    }
}
