//! Aerodynamic force and moment, with a wing that stalls.
//!
//! ```text
//! alpha = atan2(w, u)      beta = asin(v / V)      q = 1/2 rho V^2
//! sigma = (1 + e^(-M(alpha - alpha_0)) + e^(M(alpha + alpha_0)))
//!         / ((1 + e^(-M(alpha - alpha_0))) (1 + e^(M(alpha + alpha_0))))
//! C_L   = (1 - sigma) (C_L0 + C_La alpha) + sigma 2 sign(alpha) sin^2(alpha) cos(alpha)
//! C_D   = (1 - sigma) C_D(alpha)          + sigma 2 |sin(alpha)|^3
//! C_m   = C_m0 + C_ma alpha
//! F     = q S (R(alpha) (-(C_D + ..), C_Y + .., -(C_L + ..)))    M = q S (b C_l, c C_m, b C_n)
//! ```
//!
//! and to each the terms of its derivatives by rates (with c/(2V), b/(2V)) and deflections. u, v, w velocity
//! through the air, forward-right-down (m/s); V its magnitude; rho density (kg/m^3); S, b, c area, span and
//! chord (m^2, m, m); alpha angle of attack, beta sideslip (rad); sigma is 0 below and 1 beyond the stall at
//! alpha_0, M its sharpness. F force (N), M moment (N m), body axes; R turns stability axes to body axes about
//! the right wing.
//!
//! Source: Beard and McLain (2012), eqs. 4.6 to 4.18. Beyond the stall theirs leaves C_D as it is, negative
//! at -90 deg for a straight line; here it becomes that of a flat plate as C_L does. Below the stall the two
//! differ by less than 1e-8.
//!
//! Assumptions: no unsteadiness, no effect of the propeller's wake, air of one velocity over the whole
//! aircraft.

use aerobot_components::fixed_wing::aircraft::{
    Aircraft, DragLaw, LateralDerivatives, Longitudinal,
};
use aerobot_components::fixed_wing::controls::Controls;
use glam::DVec3;

use super::loads::Loads;

/// Angle of attack and sideslip of a velocity through the air, rad; zero without one.
#[must_use]
pub fn incidence_rad(velocity_m_s: DVec3) -> (f64, f64) {
    let speed = velocity_m_s.length();
    if speed == 0.0 {
        return (0.0, 0.0);
    }
    let alpha = libm::atan2(velocity_m_s.z, velocity_m_s.x);
    (alpha, libm::asin((velocity_m_s.y / speed).clamp(-1.0, 1.0)))
}

/// The part sigma of a flat plate in the wing at an angle of attack in rad, 0 to 1.
#[must_use]
pub fn stalled_part(wing: &Longitudinal, alpha_rad: f64) -> f64 {
    // Past e^50 either term is all or nothing; the bound keeps the quotient finite.
    let exponential = |x: f64| libm::exp(x.clamp(-50.0, 50.0));
    let above = exponential(-wing.stall_sharpness * (alpha_rad - wing.stall_rad));
    let below = exponential(wing.stall_sharpness * (alpha_rad + wing.stall_rad));
    (1.0 + above + below) / ((1.0 + above) * (1.0 + below))
}

/// Lift and drag coefficients of the wing without rates and deflections.
#[must_use]
pub fn lift_and_drag(aircraft: &Aircraft, alpha_rad: f64) -> (f64, f64) {
    let wing = &aircraft.longitudinal;
    let attached = wing.lift_zero + wing.lift_alpha * alpha_rad;
    let drag = match wing.drag {
        DragLaw::Line { zero, alpha } => zero + alpha * alpha_rad,
        DragLaw::Polar { parasitic, oswald } => {
            parasitic
                + attached * attached / (std::f64::consts::PI * oswald * aircraft.aspect_ratio())
        }
    };
    let sigma = stalled_part(wing, alpha_rad);
    let (sin, cos) = libm::sincos(alpha_rad);
    let plate_lift = 2.0 * sin * sin.abs() * cos;
    let plate_drag = 2.0 * sin * sin * sin.abs();
    (
        (1.0 - sigma) * attached + sigma * plate_lift,
        (1.0 - sigma) * drag + sigma * plate_drag,
    )
}

/// Force and moment in air of a density in kg/m^3, at a velocity through it in m/s, rates in rad/s and
/// deflections; forward-right-down throughout.
#[must_use]
pub fn aerodynamic_loads(
    aircraft: &Aircraft,
    density_kg_m3: f64,
    velocity_m_s: DVec3,
    rate_rad_s: DVec3,
    controls: &Controls,
) -> Loads {
    let (geometry, wing) = (&aircraft.geometry, &aircraft.longitudinal);
    let speed = velocity_m_s.length();
    let (alpha, beta) = incidence_rad(velocity_m_s);
    let pressure = 0.5 * density_kg_m3 * speed * speed;
    // q c/(2V) stays finite at rest, and its product with the pressure vanishes.
    let per_speed = if speed > 0.0 { 0.5 / speed } else { 0.0 };
    let pitching = geometry.chord_m * per_speed * rate_rad_s.y;
    let (rolling, yawing) = (
        geometry.span_m * per_speed * rate_rad_s.x,
        geometry.span_m * per_speed * rate_rad_s.z,
    );
    let elevator = controls.elevator_rad;
    let (lift, drag) = lift_and_drag(aircraft, alpha);
    let lift = lift + wing.lift_q * pitching + wing.lift_elevator * elevator;
    let drag = drag + wing.drag_q * pitching + wing.drag_elevator * elevator;
    let pitch = wing.pitch_zero
        + wing.pitch_alpha * alpha
        + wing.pitch_q * pitching
        + wing.pitch_elevator * elevator;
    let lateral = |of: &LateralDerivatives| {
        of.zero
            + of.beta * beta
            + of.p * rolling
            + of.r * yawing
            + of.aileron * controls.aileron_rad
            + of.rudder * controls.rudder_rad
    };
    let (sin, cos) = libm::sincos(alpha);
    let force = DVec3::new(
        -drag * cos + lift * sin,
        lateral(&aircraft.lateral.side),
        -drag * sin - lift * cos,
    );
    let moment = DVec3::new(
        geometry.span_m * lateral(&aircraft.lateral.roll),
        geometry.chord_m * pitch,
        geometry.span_m * lateral(&aircraft.lateral.yaw),
    );
    let scale = pressure * geometry.wing_area_m2;
    Loads {
        force_n: scale * force,
        moment_n_m: scale * moment,
    }
}

#[cfg(test)]
mod tests {
    use aerobot_components::fixed_wing::aircraft::AEROSONDE;

    use super::*;

    /// Attached flow below the stall, a flat plate beyond it on either side, smooth in between, and drag that
    /// never drives.
    #[test]
    fn the_wing_stalls_into_a_flat_plate() {
        let wing = &AEROSONDE.longitudinal;
        assert!(stalled_part(wing, 0.05) < 1e-8);
        assert!((stalled_part(wing, wing.stall_rad) - 0.5).abs() < 1e-9);
        for alpha in [1.2_f64, -1.2, 2.5, -3.0] {
            assert!(1.0 - stalled_part(wing, alpha) < 1e-15);
            let (lift, drag) = lift_and_drag(&AEROSONDE, alpha);
            // Normal force 2 sin^2 alpha against the plate: lift and drag are its parts.
            let normal = 2.0 * alpha.sin() * alpha.sin().abs();
            assert!((lift - normal * alpha.cos()).abs() < 1e-14);
            assert!((drag - normal * alpha.sin()).abs() < 1e-14);
        }
        let mut before = lift_and_drag(&AEROSONDE, -3.2);
        for step in -3199..3200 {
            let (lift, drag) = lift_and_drag(&AEROSONDE, f64::from(step) * 1e-3);
            assert!(drag > 0.0, "{step}");
            assert!((lift - before.0).abs() < 0.05, "{step}");
            before = (lift, drag);
        }
    }

    /// Air damps every rotation, and does nothing to an aircraft at rest in it.
    #[test]
    fn rates_are_damped_and_still_air_does_nothing() {
        let velocity = DVec3::new(25.0, 0.0, 1.2);
        let controls = Controls::default();
        let at = |rate| aerodynamic_loads(&AEROSONDE, 1.2, velocity, rate, &controls).moment_n_m;
        let still = at(DVec3::ZERO);
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            assert!((at(axis) - still).dot(axis) < 0.0, "{axis}");
        }
        let rest = aerodynamic_loads(&AEROSONDE, 1.2, DVec3::ZERO, DVec3::ONE, &controls);
        assert_eq!(rest, Loads::default());
    }
}
