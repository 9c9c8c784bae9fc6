//! The standard normal distribution and its inverse.
//!
//! ```text
//! phi(x) = e^(-x^2/2) / sqrt(2 pi)     P(x) = erfc(-x / sqrt 2) / 2     Q(x) = 1 - P(x) = P(-x)
//! ```
//!
//! Source: definitions; the start of the inverse is Hastings' (Abramowitz and Stegun 1964, 26.2.22, good
//! to 3e-3), which Halley's method then carries to round-off.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Smaller tails are taken for this one: sqrt and log of it are still of full precision.
const LEAST_TAIL: f64 = 1e-300;
/// Each triples the number of right digits.
const HALLEY_STEPS: usize = 3;

/// phi(x).
#[must_use]
pub fn density(x: f64) -> f64 {
    libm::exp(log_density(x))
}

/// ln phi(x).
#[must_use]
pub fn log_density(x: f64) -> f64 {
    -0.5 * (x * x + libm::log(2.0 * PI))
}

/// P(x), the probability of a value below x.
#[must_use]
pub fn below(x: f64) -> f64 {
    0.5 * libm::erfc(-x * FRAC_1_SQRT_2)
}

/// Q(x), the probability of a value above x, right in its own digits however small.
#[must_use]
pub fn above(x: f64) -> f64 {
    below(-x)
}

/// The x with `below` below it and `above` above it; the two make one, and the smaller is used.
#[must_use]
pub fn inverse(below: f64, above: f64) -> f64 {
    if below < above {
        -upper_tail(below)
    } else {
        upper_tail(above)
    }
}

/// The x with `u` below it, above 0 and below 1.
#[must_use]
pub fn quantile(u: f64) -> f64 {
    inverse(u, 1.0 - u)
}

/// The x >= 0 with Q(x) = `tail`, a probability up to 1/2.
fn upper_tail(tail: f64) -> f64 {
    let tail = tail.clamp(LEAST_TAIL, 0.5);
    let t = (-2.0 * libm::log(tail)).sqrt();
    let mut x = t - (2.30753 + 0.27061 * t) / (1.0 + t * (0.99229 + 0.04481 * t));
    for _ in 0..HALLEY_STEPS {
        // Q'' / Q' = -x.
        let newton = (above(x) - tail) / density(x);
        x += newton / (1.0 + 0.5 * x * newton);
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_quantiles() {
        // NIST/SEMATECH e-Handbook of Statistical Methods, 1.3.6.7.1, and symmetry.
        assert!((inverse(0.975, 0.025) - 1.959_963_984_540_054).abs() < 1e-14);
        assert!((inverse(0.001, 0.999) + 3.090_232_306_167_813_5).abs() < 1e-14);
        assert!(inverse(0.5, 0.5).abs() < 1e-15);
        // By programs of arbitrary precision.
        for (u, x) in [
            (0.841_344_746_068_542_9, 1.0),
            (0.995, 2.575_829_303_548_900_4),
            (1e-10, -6.361_340_902_404_056),
        ] {
            assert!((quantile(u) - x).abs() < 1e-13 * (1.0 + f64::abs(x)), "{u}");
        }
    }

    #[test]
    fn the_inverse_gives_back_every_probability() {
        for x in [-37.0, -12.0, -3.0, -0.1, 0.3, 2.0, 8.0, 30.0] {
            let found = inverse(below(x), above(x));
            assert!((found - x).abs() < 1e-12 * (1.0 + x.abs()), "{x} {found}");
        }
    }
}
