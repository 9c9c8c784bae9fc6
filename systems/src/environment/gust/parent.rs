//! Draws the normal process behind a gust, knot by knot, at all its levels.
//!
//! ```text
//! over altitude:  xi_k = e^(-d/L) xi_(k-1) + sqrt(1 - e^(-2 d/L)) n_k      independent n_k, for every knot
//! over time:      either the exact step of the complex Ornstein-Uhlenbeck process, of which this is the
//!                 real part, or the best linear prediction for any autocorrelation; with the noise xi
//! ```
//!
//! Every level goes through the same filter, so that correlations of levels and of times multiply. Both
//! start stationary.
//!
//! Source: [`ComplexOrnsteinUhlenbeck`](crate::stochastic::complex_ornstein_uhlenbeck) and
//! [`LinearPrediction`](crate::stochastic::linear_prediction).

use crate::stochastic::complex_ornstein_uhlenbeck::ExactStep;
use crate::stochastic::linear_prediction::LinearPrediction;
use crate::stochastic::normal_draws::NormalDraws;

/// The process, ready to give its next knot.
#[derive(Clone, Debug)]
pub struct Parent {
    draws: NormalDraws,
    levels: usize,
    across: Across,
    filter: Filter,
}

/// How the noise of a level follows from that of the one below.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Across {
    /// e^(-d/L).
    pub kept: f64,
    /// sqrt(1 - e^(-2 d/L)).
    pub added: f64,
}

/// How the values at a knot follow from those before.
#[derive(Clone, Debug)]
enum Filter {
    /// Z at the last knot, of each level; empty before the first.
    Exact { step: ExactStep, z: Vec<[f64; 2]> },
    /// The knots before, as rows of all levels, the last one at the end.
    Predicted {
        prediction: LinearPrediction,
        past: Vec<f64>,
    },
}

impl Parent {
    /// The real part of a complex Ornstein-Uhlenbeck process at so many levels.
    #[must_use]
    pub fn exact(step: ExactStep, levels: usize, across: Across, draws: NormalDraws) -> Self {
        let filter = Filter::Exact {
            step,
            z: Vec::new(),
        };
        Self {
            draws,
            levels,
            across,
            filter,
        }
    }

    /// A process of the autocorrelation that `prediction`, of order 0 still, belongs to.
    #[must_use]
    pub fn predicted(
        prediction: LinearPrediction,
        levels: usize,
        across: Across,
        draws: NormalDraws,
    ) -> Self {
        let filter = Filter::Predicted {
            prediction,
            past: Vec::new(),
        };
        Self {
            draws,
            levels,
            across,
            filter,
        }
    }

    /// Draws the next knot and appends it to `row`, a standard normal number for each level.
    pub fn next(&mut self, row: &mut Vec<f64>) {
        let Self {
            draws,
            levels,
            across,
            filter,
        } = self;
        match filter {
            Filter::Exact { step, z } => {
                let is_first = z.is_empty();
                z.resize(*levels, [0.0; 2]);
                let mut noise = [0.0; 2];
                for (level, z) in z.iter_mut().enumerate() {
                    noise = across.follow(level, noise, draws);
                    *z = if is_first {
                        noise
                    } else {
                        step.advance(*z, noise)
                    };
                    row.push(z[0]);
                }
            }
            Filter::Predicted { prediction, past } => {
                let from = row.len();
                predict(prediction, past, *levels, row);
                let spread = prediction.variance().sqrt();
                let mut noise = [0.0; 2];
                for (level, x) in row[from..].iter_mut().enumerate() {
                    noise = across.follow(level, noise, draws);
                    *x += spread * noise[0];
                }
                remember(past, &row[from..], prediction.coefficients().len());
                // Checked when the gust was designed; beyond the last order it stays as it is.
                let _ = prediction.grow();
            }
        }
    }

    /// Y of Z = X + iY at the last knot and the lowest level, where the process has one.
    #[must_use]
    pub fn quadrature(&self) -> Option<f64> {
        match &self.filter {
            Filter::Exact { z, .. } => z.first().map(|z| z[1]),
            Filter::Predicted { .. } => None,
        }
    }
}

impl Across {
    #[inline]
    fn follow(&self, level: usize, below: [f64; 2], draws: &mut NormalDraws) -> [f64; 2] {
        let [a, b] = draws.pair();
        if level == 0 {
            return [a, b];
        }
        [
            self.kept * below[0] + self.added * a,
            self.kept * below[1] + self.added * b,
        ]
    }
}

/// Appends what is expected at the next knot.
fn predict(prediction: &LinearPrediction, past: &[f64], levels: usize, row: &mut Vec<f64>) {
    let from = row.len();
    row.resize(from + levels, 0.0);
    let rows = past.rchunks_exact(levels);
    for (coefficient, values) in prediction.coefficients().iter().zip(rows) {
        for (x, value) in row[from..].iter_mut().zip(values) {
            *x += coefficient * value;
        }
    }
}

/// Adds a row to the past; of the oldest, what no order needs goes now and then.
fn remember(past: &mut Vec<f64>, row: &[f64], order: usize) {
    let needed = (order + 1) * row.len();
    if past.len() >= 2 * needed {
        past.drain(..past.len() - needed);
    }
    past.extend_from_slice(row);
}
