//! Distributions of a velocity at any one time, as functions of a standard normal number.
//!
//! ```text
//! Y = F^-1(P(X)):    normal      sigma X
//!                    lognormal   m e^(s X)
//!                    Weibull     lambda (-ln Q(X))^(1/k)
//!                    empirical   the quantile P(X) of a sample
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | P, Q | standard normal probability below, above | 1 |
//! | sigma | standard deviation | m/s |
//! | m, s | median, standard deviation of the logarithm | m/s, 1 |
//! | lambda, k | scale, shape | m/s, 1 |
//!
//! Source: definitions. The quantile of a sample of n is linear between its values, of which the i-th
//! stands at (i - 1/2)/n (Hazen 1914, Trans. ASCE 77, 1539-1640), so that its mean is that of the sample.

use std::sync::Arc;

use super::normal_distribution::{above, below};

/// A distribution.
#[derive(Clone, Debug, PartialEq)]
pub enum Marginal {
    /// Normal, about zero.
    Normal {
        /// sigma, m/s.
        standard_deviation_m_s: f64,
    },
    /// A normal logarithm.
    Lognormal {
        /// m, m/s.
        median_m_s: f64,
        /// s, 1.
        log_standard_deviation: f64,
    },
    /// Weibull's.
    Weibull {
        /// lambda, m/s.
        scale_m_s: f64,
        /// k, 1.
        shape: f64,
    },
    /// That of a sample, m/s, increasing, of two values at least.
    Empirical(Arc<[f64]>),
}

impl Marginal {
    /// The distribution of a sample (m/s), in any order.
    #[must_use]
    pub fn of_sample(mut sample_m_s: Vec<f64>) -> Self {
        sample_m_s.sort_by(f64::total_cmp);
        Self::Empirical(sample_m_s.into())
    }

    /// Y of a standard normal X, m/s.
    #[inline]
    #[must_use]
    pub fn at(&self, x: f64) -> f64 {
        match self {
            Self::Normal {
                standard_deviation_m_s,
            } => standard_deviation_m_s * x,
            Self::Lognormal {
                median_m_s,
                log_standard_deviation,
            } => median_m_s * libm::exp(log_standard_deviation * x),
            Self::Weibull { scale_m_s, shape } => {
                // From the smaller tail, which has its own digits.
                let hazard = if x < 0.0 {
                    -libm::log1p(-below(x))
                } else {
                    -libm::log(above(x))
                };
                scale_m_s * libm::pow(hazard, 1.0 / shape)
            }
            Self::Empirical(sample) => quantile(sample, below(x)),
        }
    }

    /// `E[Y]`, m/s.
    #[must_use]
    pub fn mean_m_s(&self) -> f64 {
        match self {
            Self::Normal { .. } => 0.0,
            Self::Lognormal {
                median_m_s,
                log_standard_deviation,
            } => median_m_s * libm::exp(0.5 * log_standard_deviation * log_standard_deviation),
            Self::Weibull { scale_m_s, shape } => scale_m_s * libm::tgamma(1.0 + 1.0 / shape),
            Self::Empirical(sample) => sample.iter().sum::<f64>() / sample.len() as f64,
        }
    }

    /// var Y, m^2/s^2.
    #[must_use]
    pub fn variance_m2_s2(&self) -> f64 {
        match self {
            Self::Normal {
                standard_deviation_m_s,
            } => standard_deviation_m_s * standard_deviation_m_s,
            Self::Lognormal {
                log_standard_deviation,
                ..
            } => {
                let mean = self.mean_m_s();
                mean * mean * libm::expm1(log_standard_deviation * log_standard_deviation)
            }
            Self::Weibull { scale_m_s, shape } => {
                let mean = self.mean_m_s();
                scale_m_s * scale_m_s * libm::tgamma(1.0 + 2.0 / shape) - mean * mean
            }
            Self::Empirical(sample) => sample_variance(sample, self.mean_m_s()),
        }
    }
}

/// The quantile of a probability, linear between the values of an increasing sample.
fn quantile(sample: &[f64], probability: f64) -> f64 {
    let last = sample.len() - 1;
    let place = (probability * sample.len() as f64 - 0.5).clamp(0.0, last as f64);
    let index = (place as usize).min(last.saturating_sub(1));
    let part = place - index as f64;
    match sample.get(index + 1) {
        Some(next) => sample[index] + part * (next - sample[index]),
        None => sample[index],
    }
}

/// The variance of [`quantile`] at a probability that is uniform on [0, 1].
fn sample_variance(sample: &[f64], mean: f64) -> f64 {
    let off = |value: &f64| value - mean;
    let between = sample.windows(2).map(|pair| {
        let (a, b) = (off(&pair[0]), off(&pair[1]));
        (a * a + a * b + b * b) / 3.0
    });
    let ends = [sample.first(), sample.last()];
    let ends = ends
        .into_iter()
        .flatten()
        .map(|end| 0.5 * off(end) * off(end));
    (between.sum::<f64>() + ends.sum::<f64>()) / sample.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stochastic::hermite_series::HermiteSeries;

    /// Quantiles: P(Y <= y) of the definitions gives back the probability of x.
    #[test]
    fn the_probability_below_is_kept() {
        for x in [-6.0, -2.0, -0.3, 0.0, 0.5, 1.0, 4.0, 8.0] {
            let y = Marginal::Weibull {
                scale_m_s: 0.8,
                shape: 1.9,
            }
            .at(x);
            let tail = libm::exp(-libm::pow(y / 0.8, 1.9));
            assert!(
                (tail / above(x) - 1.0).abs() < 1e-12,
                "{x}: {tail} {}",
                above(x)
            );
        }
    }

    #[test]
    fn moments_are_those_of_the_function() {
        let sample: Vec<f64> = (0..50).map(|k| f64::from(k * k % 37)).collect();
        for marginal in [
            Marginal::Weibull {
                scale_m_s: 0.8,
                shape: 1.9,
            },
            Marginal::Lognormal {
                median_m_s: 2.0,
                log_standard_deviation: 0.7,
            },
            Marginal::of_sample(sample),
        ] {
            let series = HermiteSeries::of(|x| marginal.at(x));
            // The kinks of a sample's quantiles cost the sum its last digits.
            let tolerance = match marginal {
                Marginal::Empirical(_) => 2e-4,
                _ => 1e-10,
            };
            let mean = marginal.mean_m_s();
            assert!(
                (series.mean / mean - 1.0).abs() < tolerance,
                "{marginal:?} {series:?}"
            );
            let variance = marginal.variance_m2_s2();
            assert!(
                (series.variance / variance - 1.0).abs() < tolerance,
                "{marginal:?}"
            );
        }
    }

    #[test]
    fn a_sample_is_met_at_its_own_places() {
        let marginal = Marginal::of_sample(vec![3.0, -1.0, 2.0, 8.0]);
        let at = |probability: f64| {
            marginal.at(super::super::normal_distribution::inverse(
                probability,
                1.0 - probability,
            ))
        };
        for (probability, value) in [(0.125, -1.0), (0.375, 2.0), (0.625, 3.0), (0.875, 8.0)] {
            assert!((at(probability) - value).abs() < 1e-12);
        }
        assert_eq!((at(1e-9), at(1.0 - 1e-9)), (-1.0, 8.0));
        assert!((at(0.5) - 2.5).abs() < 1e-12);
    }
}
