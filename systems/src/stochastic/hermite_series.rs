//! What a memoryless function of a normal process does to its autocorrelation, and back.
//!
//! ```text
//! Y = g(X),  X standard normal with correlation rho_X
//! b_k = E[g(X) h_k(X)],  h_k = He_k / sqrt(k!)      E[Y] = b_0,  var Y = sum_(k >= 1) b_k^2
//! rho_Y = sum_(k >= 1) a_k rho_X^k,   a_k = b_k^2 / var Y
//! ```
//!
//! He_k: Hermite polynomials with the weight e^(-x^2/2). rho_Y grows with rho_X where g is monotone, so
//! that it can be inverted; it does not fall below its value at rho_X = -1.
//!
//! Source: Mehler (1866), J. reine angew. Math. 66, 161-176; Nataf (1962), C. R. Acad. Sci. Paris 225,
//! 42-43; Grigoriu (1995), Applied Non-Gaussian Processes, 3.1.
//!
//! Assumptions: g has a variance. Expectations are sums over equidistant points, whose error is below
//! round-off for a smooth g. What is left of the variance after 60 terms goes to the next power.

use super::normal_distribution::density;

/// Number of terms.
const TERMS: usize = 60;
/// Points of the sums: up to this from zero, and so many per unit.
const FARTHEST: i32 = 20;
const PER_UNIT: i32 = 64;
/// Halvings of the interval of correlations: to the last bit.
const HALVINGS: usize = 60;

/// The series of one function.
#[derive(Clone, Debug, PartialEq)]
pub struct HermiteSeries {
    /// `E[Y]`.
    pub mean: f64,
    /// var Y.
    pub variance: f64,
    /// a_1, a_2 and so on; their sum is 1.
    pub weights: Vec<f64>,
}

/// A correlation that no correlation of the normal process leads to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unreachable {
    /// The least that can be reached, at rho_X = -1.
    pub least: f64,
}

impl HermiteSeries {
    /// The series of `function`.
    #[must_use]
    pub fn of(function: impl Fn(f64) -> f64) -> Self {
        let mut coefficients = [0.0; TERMS + 1];
        let mut square = 0.0;
        for index in -FARTHEST * PER_UNIT..=FARTHEST * PER_UNIT {
            let x = f64::from(index) / f64::from(PER_UNIT);
            let value = function(x);
            let weighted = value * density(x) / f64::from(PER_UNIT);
            square += value * weighted;
            let (mut last, mut polynomial) = (0.0, 1.0);
            for (k, coefficient) in coefficients.iter_mut().enumerate() {
                *coefficient += weighted * polynomial;
                let k = k as f64;
                let next = (x * polynomial - k.sqrt() * last) / (k + 1.0).sqrt();
                (last, polynomial) = (polynomial, next);
            }
        }
        let mean = coefficients[0];
        let variance = (square - mean * mean).max(0.0);
        let parts = coefficients[1..].iter().map(|b| match variance {
            0.0 => 0.0,
            variance => b * b / variance,
        });
        let mut weights: Vec<f64> = parts.collect();
        let rest = 1.0 - weights.iter().sum::<f64>();
        weights.push(rest.max(0.0));
        Self {
            mean,
            variance,
            weights,
        }
    }

    /// rho_Y of a rho_X.
    #[must_use]
    pub fn bend(&self, correlation: f64) -> f64 {
        let sum = self.weights.iter().rev();
        sum.fold(0.0, |sum, weight| (sum + weight) * correlation)
    }

    /// The least rho_Y that there is, for a monotone function.
    #[must_use]
    pub fn least(&self) -> f64 {
        self.bend(-1.0)
    }

    /// The rho_X of a rho_Y, for a monotone function.
    ///
    /// # Errors
    /// Where there is none.
    pub fn unbend(&self, correlation: f64) -> Result<f64, Unreachable> {
        let least = self.least();
        if correlation < least {
            return Err(Unreachable { least });
        }
        if correlation >= 1.0 {
            return Ok(1.0);
        }
        let (mut low, mut high) = (-1.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if self.bend(middle) < correlation {
                low = middle;
            } else {
                high = middle;
            }
        }
        Ok(0.5 * (low + high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stochastic::marginal::Marginal;

    #[test]
    fn a_weibull_of_shape_two_has_the_weights_computed_apart() {
        let weibull = Marginal::Weibull {
            scale_m_s: 3.0,
            shape: 2.0,
        };
        let series = HermiteSeries::of(|x| weibull.at(x));
        for (weight, expected) in series.weights.iter().zip([0.972468, 0.026440, 0.001047]) {
            assert!((weight - expected).abs() < 1e-6, "{weight} {expected}");
        }
        assert!((series.bend(0.5) - 0.49298).abs() < 1e-5);
        assert!((series.mean - weibull.mean_m_s()).abs() < 1e-12);
        assert!((series.variance - weibull.variance_m2_s2()).abs() < 1e-12);
    }

    #[test]
    fn a_lognormal_has_the_closed_form() {
        for sigma in [0.3_f64, 1.0, 2.0] {
            let lognormal = Marginal::Lognormal {
                median_m_s: 1.0,
                log_standard_deviation: sigma,
            };
            let series = HermiteSeries::of(|x| lognormal.at(x));
            let square = sigma * sigma;
            for rho in [-1.0, -0.4, 0.1, 0.5, 0.99, 1.0] {
                let expected = libm::expm1(square * rho) / libm::expm1(square);
                assert!((series.bend(rho) - expected).abs() < 1e-10, "{sigma} {rho}");
                let back = series.unbend(expected).unwrap();
                assert!(
                    (back - rho).abs() < 1e-7 / libm::exp(square * (rho - 1.0)),
                    "{back} {rho}"
                );
            }
            let least = libm::expm1(-square) / libm::expm1(square);
            let refused = series.unbend(least - 1e-3).unwrap_err();
            assert!((refused.least - least).abs() < 1e-10);
        }
    }

    #[test]
    fn a_linear_function_bends_nothing() {
        let series = HermiteSeries::of(|x| 3.0 * x - 1.0);
        assert!((series.mean + 1.0).abs() < 1e-13 && (series.variance - 9.0).abs() < 1e-12);
        assert!((series.bend(-0.7) + 0.7).abs() < 1e-13);
    }
}
