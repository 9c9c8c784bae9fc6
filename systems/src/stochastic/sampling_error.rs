//! How far an average over one record is from what it estimates: standard errors of mean, variance,
//! autocorrelation, quadrature and of the time spent below a value.
//!
//! ```text
//! var(mean of a)   = var(a)/N sum_u rho_a(u)                     a = Y, (Y - E Y)^2, [Y <= y]
//! var(r_l)         = 1/N sum_u rho_u^2 + rho_(u+l) rho_(u-l) - 4 rho_l rho_u rho_(u-l) + 2 rho_l^2 rho_u^2
//! var(q_l)         = 1/N sum_u rho_u^2 + q_(l+u) q_(l-u)
//! ```
//!
//! N values, u over all integers, rho the autocorrelation and q the quadrature correlation. rho_a follows
//! from that of the normal parent by the Hermite series of a.
//!
//! Source: Bartlett (1946), J. R. Stat. Soc. Suppl. 8, 27-41; Isserlis (1918), Biometrika 12, 134-139.
//!
//! Assumptions: a record much longer than the correlation. The error of the autocorrelation is that of a
//! normal process, which another marginal changes somewhat.

use super::hermite_series::HermiteSeries;
use super::marginal::Marginal;
use super::normal_distribution::below;

/// What is known of the process: correlations at the lags 0, 1, 2, .. of a record, until nothing is left.
#[derive(Clone, Debug)]
pub struct SamplingError {
    /// Autocorrelation of the normal parent.
    parent: Vec<f64>,
    /// Number of values of the record.
    count: f64,
}

impl SamplingError {
    /// For a record of `count` values whose normal parent has these autocorrelations, from the lag 0 on.
    #[must_use]
    pub fn new(parent: Vec<f64>, count: usize) -> Self {
        let count = count.max(1) as f64;
        Self { parent, count }
    }

    /// The lag beyond which nothing is left.
    #[must_use]
    pub fn reach(&self) -> usize {
        self.parent.len()
    }

    /// Standard error of the mean of `function` of the parent.
    #[must_use]
    pub fn of_mean(&self, function: impl Fn(f64) -> f64) -> f64 {
        let series = HermiteSeries::of(function);
        let after = self.parent.iter().skip(1);
        let sum = 1.0 + 2.0 * after.map(|rho| series.bend(*rho)).sum::<f64>();
        (series.variance * sum / self.count).max(0.0).sqrt()
    }

    /// Standard error of the variance of a marginal, m^2/s^2.
    #[must_use]
    pub fn of_variance(&self, marginal: &Marginal) -> f64 {
        let mean = marginal.mean_m_s();
        self.of_mean(|x| {
            let off = marginal.at(x) - mean;
            off * off
        })
    }

    /// Standard error of the part of a record in which the parent is below `x`.
    #[must_use]
    pub fn of_part_below(&self, x: f64) -> f64 {
        let probability = below(x);
        let steps = self.parent.iter().skip(1);
        let sum = probability * (1.0 - probability)
            + 2.0 * steps.map(|rho| both_below(x, *rho)).sum::<f64>();
        (sum / self.count).max(0.0).sqrt()
    }

    /// Standard error of the autocorrelation at a lag, for a normal process of the autocorrelation `rho`.
    #[must_use]
    pub fn of_autocorrelation(&self, lag: usize, rho: impl Fn(i64) -> f64) -> f64 {
        let l = lag as i64;
        let reach = self.parent.len() as i64 + l;
        let at_lag = rho(l);
        let sum: f64 = (-reach..=reach)
            .map(|u| {
                let (here, before) = (rho(u), rho(u - l));
                here * here + rho(u + l) * before - 4.0 * at_lag * here * before
                    + 2.0 * at_lag * at_lag * here * here
            })
            .sum();
        (sum / self.count).max(0.0).sqrt()
    }

    /// Standard error of E[X(t + l) Y(t)] at a lag, of the correlations `rho` and `quadrature`.
    #[must_use]
    pub fn of_quadrature(
        &self,
        lag: usize,
        rho: impl Fn(i64) -> f64,
        quadrature: impl Fn(i64) -> f64,
    ) -> f64 {
        let l = lag as i64;
        let reach = self.parent.len() as i64 + l;
        let sum: f64 = (-reach..=reach)
            .map(|u| rho(u) * rho(u) + quadrature(l + u) * quadrature(l - u))
            .sum();
        (sum / self.count).max(0.0).sqrt()
    }
}

/// Covariance of [X1 <= x] and [X2 <= x] for a correlation: the integral over r from 0 to it of the density
/// of both at x, e^(-x^2/(1 + r)) / (2 pi sqrt(1 - r^2)) (Plackett 1954, Biometrika 41, 351-360), with r the
/// sine of an angle.
fn both_below(x: f64, rho: f64) -> f64 {
    const PANELS: u32 = 32;
    let end = libm::asin(rho.clamp(-1.0, 1.0));
    let step = end / f64::from(PANELS);
    let sum: f64 = (0..PANELS)
        .map(|panel| {
            let r = libm::sin((f64::from(panel) + 0.5) * step);
            libm::exp(-x * x / (1.0 + r))
        })
        .sum();
    sum * step / std::f64::consts::TAU
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stochastic::complex_ornstein_uhlenbeck::ComplexOrnsteinUhlenbeck;
    use crate::stochastic::hermite_series::HermiteSeries;

    const PROCESS: ComplexOrnsteinUhlenbeck = ComplexOrnsteinUhlenbeck {
        decay_per_s: 0.05,
        frequency_rad_s: 0.2,
    };
    const STEP_S: f64 = 0.05;

    /// One record of 3600 s, against the errors computed apart for a continuous one.
    #[test]
    fn errors_are_those_computed_apart() {
        let rho = |u: i64| PROCESS.autocorrelation(u as f64 * STEP_S);
        let parent: Vec<f64> = (0..12_000).map(rho).collect();
        let error = SamplingError::new(parent, 72_000);
        let normal = Marginal::Normal {
            standard_deviation_m_s: 1.0,
        };
        // 2 alpha/((alpha^2 + omega^2) T) and (2/T)(1/(2 alpha) + alpha/(2 (alpha^2 + omega^2))).
        let (of_mean, of_variance) = (error.of_mean(|x| x), error.of_variance(&normal));
        let expected = f64::sqrt(0.1 / (0.0425 * 3600.0));
        assert!(
            (of_mean / expected - 1.0).abs() < 1e-3,
            "{of_mean} {expected}"
        );
        let expected = f64::sqrt((10.0 + 0.025 / 0.0425) / 1800.0);
        assert!(
            (of_variance / expected - 1.0).abs() < 1e-3,
            "{of_variance} {expected}"
        );
        for (lag_s, expected) in [(2.0, 0.0074), (5.0, 0.0171), (10.0, 0.0291), (20.0, 0.0423)] {
            let lag = (lag_s / STEP_S) as usize;
            let found = error.of_autocorrelation(lag, rho);
            assert!(
                (found - expected).abs() < 1e-4,
                "{lag_s} s: {found} {expected}"
            );
        }
        // No quadrature at the lag 0, where both terms are squares of the correlations:
        // 1/T (int rho^2 - int q^2) = 1/T int e^(-2 alpha |u|) cos(2 omega u).
        let (alpha, omega) = (PROCESS.decay_per_s, PROCESS.frequency_rad_s);
        let expected = alpha / (alpha * alpha + omega * omega) / 3600.0;
        let q = |u: i64| PROCESS.quadrature(u as f64 * STEP_S);
        let found = error.of_quadrature(0, rho, q);
        assert!(
            (found / expected.sqrt() - 1.0).abs() < 0.01,
            "{found} {expected}"
        );
    }

    /// The sum of the indicator's own series, where that converges.
    #[test]
    fn the_covariance_of_two_indicators_is_that_of_their_series() {
        assert!((both_below(0.0, 0.5) - 0.5_f64.asin() / std::f64::consts::TAU).abs() < 1e-12);
        for (x, rho) in [(0.7, 0.3), (-1.5, -0.4), (1.2, 0.6)] {
            // A step at x stands midway between two points of the sum.
            let shifted = (x * 64.0_f64).round() / 64.0 + 1.0 / 128.0;
            let series = HermiteSeries::of(|y| f64::from(y <= shifted));
            let expected = series.variance * series.bend(rho);
            let found = both_below(shifted, rho);
            assert!(
                (found / expected - 1.0).abs() < 1e-3,
                "{x} {rho}: {found} {expected}"
            );
        }
    }
}
