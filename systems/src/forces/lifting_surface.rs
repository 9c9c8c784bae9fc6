//! Lift and drag of a thin symmetric surface.
//!
//! ```text
//! C_L = a alpha              C_D = C_D0 + C_L^2/(pi AR e)                          attached
//! C_L = 2 sin^2 alpha cos alpha sign(alpha)     C_D = C_D0 + 2 |sin alpha|^3       flat plate
//! ```
//!
//! alpha incidence (rad), a slope of lift (1/rad), AR aspect ratio, e Oswald's number. Beyond the angle of
//! stall alpha_0 the first goes over to the second with the weight
//! sigma = 1 - s(M (alpha_0 - alpha)) s(M (alpha_0 + alpha)), s the logistic function and M the sharpness: the
//! weight of Beard and McLain (2012, eq. 4.10), written so that nothing overflows.

use aerobot_components::sail::LiftingSurface;

/// Coefficients of lift and drag of `surface` at an incidence in rad in (-pi, pi], with the angle (rad) and
/// sharpness (1/rad) of its stall.
#[must_use]
pub fn coefficients(
    surface: &LiftingSurface,
    incidence_rad: f64,
    stall: Option<(f64, f64)>,
) -> (f64, f64) {
    let lift = surface.lift_slope_per_rad * incidence_rad;
    let drag = surface.zero_lift_drag + surface.induced_drag * lift * lift;
    let Some((angle_rad, sharpness)) = stall else {
        return (lift, drag);
    };
    let sine = libm::sin(incidence_rad);
    let plate_lift = 2.0 * sine * sine.abs() * libm::cos(incidence_rad);
    let plate_drag = surface.zero_lift_drag
        + if surface.has_drag {
            2.0 * sine.abs() * sine * sine
        } else {
            0.0
        };
    let attached = logistic(sharpness * (angle_rad - incidence_rad))
        * logistic(sharpness * (angle_rad + incidence_rad));
    (
        plate_lift + attached * (lift - plate_lift),
        plate_drag + attached * (drag - plate_drag),
    )
}

/// 1/(1 + e^-x).
fn logistic(x: f64) -> f64 {
    1.0 / (1.0 + libm::exp(-x))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use glam::DVec3;

    use super::*;

    fn surface() -> LiftingSurface {
        LiftingSurface {
            area_m2: 3.0,
            lift_slope_per_rad: 4.5,
            zero_lift_drag: 0.02,
            induced_drag: 0.09,
            has_drag: true,
            centre_m: DVec3::ZERO,
        }
    }

    #[test]
    fn a_stalled_surface_is_a_flat_plate_and_an_attached_one_is_not() {
        let stall = Some((0.26, 50.0));
        let (lift, drag) = coefficients(&surface(), 0.05, stall);
        assert!(
            (lift - 4.5 * 0.05).abs() < 1e-4 && (drag - (0.02 + 0.09 * lift * lift)).abs() < 1e-4
        );
        let (lift, drag) = coefficients(&surface(), FRAC_PI_2, stall);
        assert!(
            lift.abs() < 1e-12 && (drag - 2.02).abs() < 1e-12,
            "{lift} {drag}"
        );
        // 2 sin^2 cos at 45 degrees.
        let (lift, _) = coefficients(&surface(), PI / 4.0, stall);
        assert!((lift - 0.5_f64.sqrt()).abs() < 1e-9);
    }

    /// The textbook form of the weight, where it does not overflow.
    #[test]
    fn the_weight_is_that_of_the_book() {
        let (angle, sharpness) = (0.3, 20.0);
        for incidence in [-0.5_f64, -0.28, 0.0, 0.1, 0.31, 0.8] {
            let p = (-sharpness * (incidence - angle)).exp();
            let n = (sharpness * (incidence + angle)).exp();
            let sigma = (1.0 + p + n) / ((1.0 + p) * (1.0 + n));
            let plate = 2.0 * incidence.sin().powi(2) * incidence.cos() * incidence.signum();
            let expected = (1.0 - sigma) * 4.5 * incidence + sigma * plate;
            let (lift, _) = coefficients(&surface(), incidence, Some((angle, sharpness)));
            assert!((lift - expected).abs() < 1e-13, "at {incidence}");
        }
    }

    /// Lift is odd and drag even in incidence, and both are finite however sharp the stall.
    #[test]
    fn both_sides_are_alike() {
        for stall in [None, Some((0.2, 30.0)), Some((0.2, 1e6))] {
            for incidence in [1e-9, 0.1, 0.3, 1.0, 2.5, PI] {
                let (lift, drag) = coefficients(&surface(), incidence, stall);
                let (other, same) = coefficients(&surface(), -incidence, stall);
                assert!(lift.is_finite() && (lift + other).abs() < 1e-12);
                assert!(drag > 0.0 && (drag - same).abs() < 1e-12);
            }
        }
    }
}
