//! The marginals that a series is fitted with, each with two numbers.
//!
//! | marginal | a | b | x of a velocity y |
//! |---|---|---|---|
//! | normal | mean | ln standard deviation | (y - a) / e^b |
//! | lognormal | ln median | ln of the standard deviation of ln y | (ln y - a) / e^b |
//! | Weibull | ln scale | ln shape | P^-1(1 - e^-h), h = (y / e^a)^(e^b) |
//!
//! The density of the velocities is that of the normal parent times |dx/dy| of each.

use std::f64::consts::PI;

use crate::stochastic::marginal::Marginal;
use crate::stochastic::normal_distribution::{inverse, log_density};

/// Euler's constant: minus the mean of the logarithm of an exponential variate.
const EULER: f64 = 0.577_215_664_901_532_9;

/// A kind of distribution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Normal.
    Normal,
    /// Normal logarithm.
    Lognormal,
    /// Weibull's.
    Weibull,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Normal, Self::Lognormal, Self::Weibull];

    /// Its name for a person.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Normal => "normal",
            Self::Lognormal => "lognormal",
            Self::Weibull => "Weibull",
        }
    }

    /// The field of a scene that a and b stand for; b as e^b, and a as e^a where `a_is_log`.
    #[must_use]
    pub fn fields(self) -> [&'static str; 2] {
        match self {
            Self::Normal => ["mean_m_s", "standard_deviation_m_s"],
            Self::Lognormal => ["median_m_s", "log_standard_deviation"],
            Self::Weibull => ["scale_m_s", "shape"],
        }
    }

    /// Whether velocities must be above zero, and a is a logarithm.
    #[must_use]
    pub fn is_of_positive(self) -> bool {
        self != Self::Normal
    }

    /// Where to start: what mean and spread of the velocities, or of their logarithms, say.
    pub(super) fn start(self, speeds: &[f64]) -> [f64; 2] {
        let seen = |y: &f64| {
            if self.is_of_positive() {
                libm::log(*y)
            } else {
                *y
            }
        };
        let count = speeds.len() as f64;
        let mean = speeds.iter().map(seen).sum::<f64>() / count;
        let square = speeds
            .iter()
            .map(|y| (seen(y) - mean) * (seen(y) - mean))
            .sum::<f64>()
            / count;
        let spread = square.sqrt().max(f64::MIN_POSITIVE);
        match self {
            Self::Normal | Self::Lognormal => [mean, libm::log(spread)],
            Self::Weibull => {
                let shape = PI / (6.0_f64.sqrt() * spread);
                [mean + EULER / shape, libm::log(shape)]
            }
        }
    }

    /// Writes x of every velocity; the sum of ln |dx/dy|.
    pub(super) fn parents(self, [a, b]: [f64; 2], speeds: &[f64], x: &mut Vec<f64>) -> f64 {
        x.clear();
        let spread = libm::exp(b);
        let mut sum = -b * speeds.len() as f64;
        match self {
            Self::Normal => x.extend(speeds.iter().map(|y| (y - a) / spread)),
            Self::Lognormal => {
                for y in speeds {
                    let log = libm::log(*y);
                    x.push((log - a) / spread);
                    sum -= log;
                }
            }
            Self::Weibull => {
                sum = 0.0;
                for y in speeds {
                    let log = libm::log(*y);
                    let log_hazard = spread * (log - a);
                    let hazard = libm::exp(log_hazard);
                    let value = inverse(-libm::expm1(-hazard), libm::exp(-hazard));
                    sum += b + log_hazard - log - hazard - log_density(value);
                    x.push(value);
                }
            }
        }
        sum
    }

    /// The mean of the velocity.
    pub(super) fn mean(self, [a, b]: [f64; 2]) -> f64 {
        let (scale, spread) = (libm::exp(a), libm::exp(b));
        let marginal = match self {
            Self::Normal => return a,
            Self::Lognormal => Marginal::Lognormal {
                median_m_s: scale,
                log_standard_deviation: spread,
            },
            Self::Weibull => Marginal::Weibull {
                scale_m_s: scale,
                shape: spread,
            },
        };
        marginal.mean_m_s()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The map to the parent undoes that from it, and its slope is the one it states.
    #[test]
    fn parents_are_those_of_the_marginal() {
        let step = 1e-5;
        for (kind, [a, b], marginal) in [
            (
                Kind::Weibull,
                [libm::log(0.8), libm::log(1.9)],
                Marginal::Weibull {
                    scale_m_s: 0.8,
                    shape: 1.9,
                },
            ),
            (
                Kind::Lognormal,
                [libm::log(2.0), libm::log(0.6)],
                Marginal::Lognormal {
                    median_m_s: 2.0,
                    log_standard_deviation: 0.6,
                },
            ),
        ] {
            let mut x = Vec::new();
            for expected in [-3.0, -0.5, 0.0, 1.0, 4.0] {
                let slope = kind.parents([a, b], &[marginal.at(expected)], &mut x);
                assert!((x[0] - expected).abs() < 1e-10);
                let secant =
                    (marginal.at(expected + step) - marginal.at(expected - step)) / (2.0 * step);
                assert!(
                    (slope + libm::log(secant)).abs() < 1e-7,
                    "{kind:?} {expected}"
                );
            }
        }
    }
}
