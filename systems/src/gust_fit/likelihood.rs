//! The likelihood of a series whose normal parent is the real part of a complex Ornstein-Uhlenbeck process.
//!
//! X is observed, Y of Z = X + iY is not. Between observations Z moves as it does exactly, over whatever
//! time, so that gaps and uneven times cost nothing. Given all X so far, Y is normal with the mean m and the
//! variance p (Kalman's filter, of which one number is left since X is known):
//!
//! ```text
//! c, s = e^(-alpha h) cos(omega h), e^(-alpha h) sin(omega h),   q = 1 - e^(-2 alpha h)
//! X expected at c x - s m with the variance v = s^2 p + q;   e = what comes less that
//! m <- s x + c m - (s c p / v) e,    p <- c^2 p + q - (s c p)^2 / v
//! ln likelihood = -1/2 sum ln(2 pi v) + e^2/v
//! ```
//!
//! Source: Kalman (1960), J. Basic Eng. 82, 35-45; Schweppe (1965), IEEE Trans. Inf. Theory 11, 61-70.

use std::f64::consts::TAU;

use crate::stochastic::complex_ornstein_uhlenbeck::ComplexOrnsteinUhlenbeck;

/// Steps that differ by less than this part of them are the same: times are decimal fractions.
const SAME_STEP: f64 = 1e-9;

/// ln of the probability density of the values `x` of the standard parent at `times_s` (s).
#[must_use]
pub fn log_likelihood(process: &ComplexOrnsteinUhlenbeck, times_s: &[f64], x: &[f64]) -> f64 {
    let Some(first) = x.first() else {
        return 0.0;
    };
    let mut sum = libm::log(TAU) + first * first;
    let (mut m, mut p) = (0.0, 1.0);
    let mut step_s = 0.0;
    let mut step = process.step(0.0);
    for (times, x) in times_s.windows(2).zip(x.windows(2)) {
        let h = times[1] - times[0];
        if (h - step_s).abs() > SAME_STEP * h {
            step_s = h;
            step = process.step(h);
        }
        let (c, s, q) = (step.cosine, step.sine, step.noise * step.noise);
        let v = s * s * p + q;
        let shared = s * c * p;
        let e = x[1] - (c * x[0] - s * m);
        sum += libm::log(TAU * v) + e * e / v;
        m = s * x[0] + c * m - shared / v * e;
        p = c * c * p + q - shared * shared / v;
    }
    -0.5 * sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// The density of all values at once, with the whole matrix of their correlations.
    #[test]
    fn it_is_the_density_of_the_multivariate_normal_distribution() {
        let process = ComplexOrnsteinUhlenbeck {
            decay_per_s: 0.13,
            frequency_rad_s: 0.7,
        };
        let times_s = [0.0, 0.5, 1.0, 1.5, 4.0, 4.1, 9.0, 30.0];
        let x = [0.3, -0.2, 1.1, 0.9, -1.7, -1.5, 0.4, 2.0];
        let matrix = DMatrix::from_fn(8, 8, |i, j| {
            let lag_s: f64 = times_s[i] - times_s[j];
            (-0.13 * lag_s.abs()).exp() * (0.7 * lag_s).cos()
        });
        let values = DVector::from_row_slice(&x);
        let factor = matrix.cholesky().unwrap();
        let square = values.dot(&factor.solve(&values));
        let expected = -0.5 * (8.0 * TAU.ln() + factor.determinant().ln() + square);
        let found = log_likelihood(&process, &times_s, &x);
        assert!((found - expected).abs() < 1e-10, "{found} {expected}");
    }
}
