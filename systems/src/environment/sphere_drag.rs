//! Drag coefficient of a smooth sphere against the Reynolds number, through the drag crisis.
//!
//! ```text
//! C_d = 24 / Re + 2.6 (Re / 5) / (1 + (Re / 5)^1.52)
//!     + 0.411 x^0.06 / (1 + x^8) + 0.25 (Re / 1e6) / (1 + Re / 1e6),     x = Re / 2.63e5
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `C_d` | drag coefficient, by the area pi R^2 | 1 |
//! | Re | Reynolds number by the diameter, rho v 2R / mu | 1 |
//!
//! Source: Morrison (2016), Data Correlation for Drag Coefficient for Sphere, Michigan
//! Technological University. Its third term, 0.411 x^-7.94 / (1 + x^-8), is multiplied by x^8
//! above and below here, so that it does not overflow for small Re.
//!
//! Assumptions: a smooth sphere in steady incompressible flow, Re up to 1e6; beyond it `C_d` is
//! held at its value there. The drag itself falls with speed between about 2.4e5 and 3.5e5.

/// The highest Reynolds number of the correlation; beyond it the coefficient is held.
pub const HIGHEST_REYNOLDS: f64 = 1e6;

/// Drag coefficient at a Reynolds number (not negative). Infinite at 0: see [`drag_factor`].
#[inline]
pub fn drag_coefficient(reynolds: f64) -> f64 {
    let re = held(reynolds);
    24.0 / re + inertial_coefficient(re)
}

/// `C_d` Re at a Reynolds number (not negative): 24 at 0 (Stokes), finite everywhere.
///
/// With it the drag `1/2 rho C_d S v^2 = 1/2 (C_d Re) S mu v / (2R)` needs no division by the speed.
#[inline]
pub fn drag_factor(reynolds: f64) -> f64 {
    if reynolds > HIGHEST_REYNOLDS {
        drag_coefficient(HIGHEST_REYNOLDS) * reynolds
    } else {
        24.0 + inertial_coefficient(reynolds) * reynolds
    }
}

/// A comparison instead of `f64::min`, which would turn NaN into a number.
#[inline]
fn held(reynolds: f64) -> f64 {
    if reynolds > HIGHEST_REYNOLDS {
        HIGHEST_REYNOLDS
    } else {
        reynolds
    }
}

/// All terms but Stokes'. Zero at Re = 0.
#[inline]
fn inertial_coefficient(re: f64) -> f64 {
    let fifth = re / 5.0;
    let x = re / 2.63e5;
    let x2 = x * x;
    let x4 = x2 * x2;
    let millionth = re / 1e6;
    2.6 * fifth / (1.0 + libm::pow(fifth, 1.52))
        + 0.411 * libm::pow(x, 0.06) / (1.0 + x4 * x4)
        + 0.25 * millionth / (1.0 + millionth)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The correlation in its printed form, computed apart, to six digits.
    const REFERENCE: [(f64, f64); 17] = [
        (0.1, 240.221),
        (1.0, 24.6729),
        (10.0, 3.96757),
        (100.0, 1.03813),
        (1e3, 0.483761),
        (1e4, 0.392602),
        (2e4, 0.39306),
        (5e4, 0.406044),
        (1e5, 0.425712),
        (1.5e5, 0.437967),
        (2e5, 0.415938),
        (2.5e5, 0.30532),
        (3e5, 0.173436),
        (4e5, 0.0930471),
        (5e5, 0.0924007),
        (7e5, 0.108631),
        (1e6, 0.129589),
    ];

    #[test]
    fn agrees_with_the_printed_form() {
        for (re, expected) in REFERENCE {
            let coefficient = drag_coefficient(re);
            assert!(
                (coefficient / expected - 1.0).abs() < 6e-6,
                "{coefficient} at Re {re}, expected {expected}"
            );
        }
    }

    #[test]
    fn the_factor_is_the_coefficient_times_re_and_24_at_rest() {
        for (re, _) in REFERENCE {
            let ratio = drag_factor(re) / (drag_coefficient(re) * re);
            assert!((ratio - 1.0).abs() < 1e-14);
        }
        assert_eq!(drag_factor(0.0), 24.0);
        assert!((drag_factor(1e-300) - 24.0).abs() < 1e-12);
        assert!((drag_factor(1e-6) - 24.0).abs() < 1e-5);
    }

    #[test]
    fn the_coefficient_is_held_beyond_the_correlation() {
        let highest = drag_coefficient(HIGHEST_REYNOLDS);
        for re in [1.000_001e6, 1e7, 1e300, f64::INFINITY] {
            assert_eq!(drag_coefficient(re), highest);
        }
        assert_eq!(drag_factor(1e7), highest * 1e7);
    }

    #[test]
    fn drag_falls_with_speed_in_the_crisis_only() {
        let drag = |re: f64| drag_factor(re) * re;
        assert!(drag(3.4e5) < drag(2.5e5));
        for re in [1.0, 1e3, 1e5, 2.2e5, 3.8e5, 9e5] {
            assert!(drag(re * 1.01) > drag(re), "at Re {re}");
        }
    }

    #[test]
    fn nan_stays_nan() {
        assert!(drag_coefficient(f64::NAN).is_nan());
        assert!(drag_factor(f64::NAN).is_nan());
    }
}
