//! How a gust along one axis is drawn: its grid in time, its levels, the process behind it, and what
//! interpolation loses.
//!
//! ```text
//! var of a line between two knots of correlation rho, at the part p of the way:
//!     1 - 2 p (1 - p) (1 - rho),   on average 1 - (1 - rho)/3
//! ```
//!
//! Where the velocity itself is to have the stated autocorrelation, that of the normal process is corrected
//! for what the marginal does to it ([`HermiteSeries`]), as far as the lag at which e^(-alpha tau) is
//! a thousandth; it need not exist.

use std::sync::Arc;

use super::parent::{Across, Parent};
use super::refusal::{GustError, MOST_LEVELS};
use crate::stochastic::complex_ornstein_uhlenbeck::ComplexOrnsteinUhlenbeck;
use crate::stochastic::hermite_series::HermiteSeries;
use crate::stochastic::linear_prediction::LinearPrediction;
use crate::stochastic::marginal::Marginal;
use crate::stochastic::normal_draws::NormalDraws;

/// The part of the variance that a grid may lose without being asked to.
pub const MOST_LOSS: f64 = 0.01;
/// What a grid that was not given loses in time, and over altitude, at most.
pub(super) const DEFAULT_LOSS: f64 = 0.005;
/// A corrected autocorrelation is exact down to this part of its envelope.
const FORGOTTEN: f64 = 1e-3;
/// More lags than this would cost more than the flight.
const MOST_LAGS: f64 = 10_000.0;

/// What a scene says about a gust along one axis; numbers are checked.
#[derive(Clone, Debug, PartialEq)]
pub struct GustParameters {
    /// 0 along x, 1 along y, 2 along z of the inertial frame.
    pub axis: usize,
    /// The autocorrelation.
    pub process: ComplexOrnsteinUhlenbeck,
    /// The distribution at any one time.
    pub marginal: Marginal,
    /// To which mean the marginal is moved, m/s.
    pub mean_m_s: Option<f64>,
    /// Whether the velocity has the autocorrelation, and not the normal process behind it.
    pub is_target: bool,
    /// Time between knots, s.
    pub grid_s: Option<f64>,
    /// Correlation over altitude.
    pub layers: Option<Layers>,
    /// Whether interpolation may lose more than [`MOST_LOSS`].
    pub allow_loss: bool,
    /// Which random numbers it draws, beside its axis.
    pub stream: u32,
    /// The most knots that a step may pass; 0 is any number.
    pub knots_per_step: u32,
}

/// A gust that depends on altitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layers {
    /// L, m.
    pub decay_length_m: f64,
    /// Lowest altitude, m.
    pub from_m: f64,
    /// Highest altitude, m.
    pub to_m: f64,
    /// Distance of levels, m.
    pub level_m: Option<f64>,
}

/// Altitudes at which a gust is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Levels {
    /// The lowest, m.
    pub lowest_m: f64,
    /// From each to the next, m.
    pub spacing_m: f64,
    /// The highest altitude that is asked for, m, at or below the last level.
    pub highest_m: f64,
    count: usize,
}

impl Levels {
    /// How many there are, two at least.
    #[inline]
    #[must_use]
    pub fn count(&self) -> usize {
        self.count
    }

    /// The level below an altitude (m) and the part of the way to the next; `None` outside.
    #[inline]
    #[must_use]
    pub fn place(&self, altitude_m: f64) -> Option<(usize, f64)> {
        // Not so for NaN either.
        if !(altitude_m >= self.lowest_m && altitude_m <= self.highest_m) {
            return None;
        }
        let place = (altitude_m - self.lowest_m) / self.spacing_m;
        let level = (place as usize).min(self.count - 2);
        Some((level, place - level as f64))
    }
}

/// A gust along one axis, ready to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct GustDesign {
    /// What was asked for.
    pub parameters: GustParameters,
    /// Time between knots, s.
    pub grid_s: f64,
    /// The altitudes at which it is drawn; `None` if it is the same everywhere.
    pub levels: Option<Levels>,
    /// What the marginal does to correlations.
    pub series: HermiteSeries,
    /// Added to the marginal, m/s.
    shift_m_s: f64,
    across: Across,
    /// Of the normal process at the lags 0, 1, .. of the grid, where it is corrected.
    corrected: Option<Arc<[f64]>>,
}

impl GustDesign {
    /// The design for some parameters.
    ///
    /// # Errors
    /// What is impossible.
    pub fn new(parameters: GustParameters) -> Result<Self, GustError> {
        let series = series_of(&parameters.marginal);
        let shift_m_s = parameters
            .mean_m_s
            .map_or(0.0, |mean_m_s| mean_m_s - parameters.marginal.mean_m_s());
        let mut design = Self {
            grid_s: 1.0,
            levels: None,
            series,
            shift_m_s,
            across: Across {
                kept: 1.0,
                added: 0.0,
            },
            corrected: None,
            parameters,
        };
        let enough_s = design.default_grid_s();
        design.grid_s = design.parameters.grid_s.unwrap_or(enough_s);
        if let Some(layers) = design.parameters.layers {
            design.lay(layers)?;
        }
        design.check_loss(enough_s)?;
        design.correct()?;
        Ok(design)
    }

    /// Mean of the velocity, m/s.
    #[must_use]
    pub fn mean_m_s(&self) -> f64 {
        self.parameters.marginal.mean_m_s() + self.shift_m_s
    }

    /// The velocity (m/s) of a standard normal number.
    #[inline]
    #[must_use]
    pub fn velocity_m_s(&self, x: f64) -> f64 {
        self.parameters.marginal.at(x) + self.shift_m_s
    }

    /// Autocorrelation of the velocity at the knots for a lag in s.
    #[must_use]
    pub fn autocorrelation(&self, lag_s: f64) -> f64 {
        let stated = self.parameters.process.autocorrelation(lag_s);
        if self.parameters.is_target {
            stated
        } else {
            self.series.bend(stated)
        }
    }

    /// Autocorrelation of the normal process behind it, at lags of whole steps of the grid.
    #[must_use]
    pub fn parent_autocorrelation(&self, lag: usize) -> f64 {
        match &self.corrected {
            Some(corrected) => corrected.get(lag).copied().unwrap_or(0.0),
            None => {
                let lag_s = lag as f64 * self.grid_s;
                self.parameters.process.autocorrelation(lag_s)
            }
        }
    }

    /// Whether the normal process behind it was corrected, and so is no Ornstein-Uhlenbeck process.
    #[must_use]
    pub fn is_corrected(&self) -> bool {
        self.corrected.is_some()
    }

    /// The part of the variance that a line between knots loses on average.
    #[must_use]
    pub fn loss_in_time(&self) -> f64 {
        self.loss_of_grid(self.grid_s)
    }

    /// The part of the variance that a line between levels loses on average.
    #[must_use]
    pub fn loss_in_altitude(&self) -> f64 {
        let (Some(levels), Some(layers)) = (&self.levels, &self.parameters.layers) else {
            return 0.0;
        };
        self.loss_of_levels(levels.spacing_m, layers.decay_length_m)
    }

    /// The normal process behind it, before its first knot.
    #[must_use]
    pub fn parent(&self, seed: u64) -> Parent {
        let stream = (u64::from(self.parameters.stream) << 2) | self.parameters.axis as u64;
        let draws = NormalDraws::new(seed, stream);
        let levels = self.levels.as_ref().map_or(1, Levels::count);
        match &self.corrected {
            Some(autocorrelation) => {
                let prediction = LinearPrediction::new(Arc::clone(autocorrelation));
                Parent::predicted(prediction, levels, self.across, draws)
            }
            None => {
                let step = self.parameters.process.step(self.grid_s);
                Parent::exact(step, levels, self.across, draws)
            }
        }
    }

    /// Lags (s) at which its correlations are worth looking at: 1, 2.5, 5 and 10 times the largest of 1, 2 and 5
    /// times a power of ten that is not above 1/|-alpha + i omega|.
    #[must_use]
    pub fn telling_lags_s(&self) -> [f64; 4] {
        let process = &self.parameters.process;
        let rate = libm::hypot(process.decay_per_s, process.frequency_rad_s);
        let base_s = largest_round(1.0 / rate, |_| true);
        [1.0, 2.5, 5.0, 10.0].map(|times| times * base_s)
    }

    fn loss_of_grid(&self, grid_s: f64) -> f64 {
        // Beyond half a period knots meet again what lies between them.
        let half_period_s = std::f64::consts::PI / self.parameters.process.frequency_rad_s;
        (1.0 - self.autocorrelation(grid_s.min(half_period_s))) / 3.0
    }

    fn loss_of_levels(&self, level_m: f64, decay_length_m: f64) -> f64 {
        (1.0 - self.series.bend(libm::exp(-level_m / decay_length_m))) / 3.0
    }

    fn default_grid_s(&self) -> f64 {
        let ComplexOrnsteinUhlenbeck {
            decay_per_s,
            frequency_rad_s,
        } = self.parameters.process;
        let longest_s = (1.0 / decay_per_s).min(1.0 / frequency_rad_s);
        largest_round(longest_s, |grid_s| {
            self.loss_of_grid(grid_s) <= DEFAULT_LOSS
        })
    }

    fn default_level_m(&self, decay_length_m: f64) -> f64 {
        largest_round(decay_length_m, |level_m| {
            self.loss_of_levels(level_m, decay_length_m) <= DEFAULT_LOSS
        })
    }

    fn lay(&mut self, layers: Layers) -> Result<(), GustError> {
        let enough_m = self.default_level_m(layers.decay_length_m);
        let level_m = layers.level_m.unwrap_or(enough_m);
        let count = ((layers.to_m - layers.from_m) / level_m).ceil() + 1.0;
        if count.is_nan() || count > MOST_LEVELS {
            return Err(GustError::TooManyLevels { count, level_m });
        }
        let ratio = level_m / layers.decay_length_m;
        self.across = Across {
            kept: libm::exp(-ratio),
            added: (-libm::expm1(-2.0 * ratio)).sqrt(),
        };
        self.levels = Some(Levels {
            lowest_m: layers.from_m,
            spacing_m: level_m,
            highest_m: layers.to_m,
            count: (count as usize).max(2),
        });
        Ok(())
    }

    fn check_loss(&self, enough_s: f64) -> Result<(), GustError> {
        let (in_time, in_altitude) = (self.loss_in_time(), self.loss_in_altitude());
        let loss = 1.0 - (1.0 - in_time) * (1.0 - in_altitude);
        if self.parameters.allow_loss || loss <= MOST_LOSS {
            return Ok(());
        }
        let percent = 100.0 * loss;
        match (&self.levels, &self.parameters.layers) {
            (Some(levels), Some(layers)) if in_altitude > in_time => Err(GustError::LosesTooMuch {
                step: levels.spacing_m,
                unit: "m",
                knots: "levels",
                percent,
                enough: self.default_level_m(layers.decay_length_m),
            }),
            _ => Err(GustError::LosesTooMuch {
                step: self.grid_s,
                unit: "s",
                knots: "knots",
                percent,
                enough: enough_s,
            }),
        }
    }

    /// Finds the autocorrelation that the normal process needs.
    fn correct(&mut self) -> Result<(), GustError> {
        let GustParameters {
            process, marginal, ..
        } = &self.parameters;
        if !self.parameters.is_target || matches!(marginal, Marginal::Normal { .. }) {
            return Ok(());
        }
        let memory_s = -libm::log(FORGOTTEN) / process.decay_per_s;
        let lags = (memory_s / self.grid_s).ceil();
        if lags.is_nan() || lags > MOST_LAGS {
            return Err(GustError::TooManyLags {
                grid_s: self.grid_s,
                lags,
                enough: memory_s / MOST_LAGS,
            });
        }
        let mut autocorrelation = vec![1.0];
        for lag in 1..=lags as usize {
            let lag_s = lag as f64 * self.grid_s;
            let wanted = process.autocorrelation(lag_s);
            let needed = self.series.unbend(wanted);
            autocorrelation.push(needed.map_err(|refused| GustError::Unreachable {
                lag_s,
                wanted,
                least: refused.least,
            })?);
        }
        let autocorrelation: Arc<[f64]> = autocorrelation.into();
        LinearPrediction::check(&autocorrelation).map_err(|refused| {
            GustError::NotPositiveDefinite {
                lag_s: refused.lag as f64 * self.grid_s,
            }
        })?;
        self.corrected = Some(autocorrelation);
        Ok(())
    }
}

fn series_of(marginal: &Marginal) -> HermiteSeries {
    match marginal {
        Marginal::Normal { .. } => HermiteSeries {
            mean: marginal.mean_m_s(),
            variance: marginal.variance_m2_s2(),
            weights: vec![1.0],
        },
        _ => HermiteSeries::of(|x| marginal.at(x)),
    }
}

/// The largest of 1, 2 and 5 times a power of ten that is not above `most` and is good enough.
fn largest_round(most: f64, is_enough: impl Fn(f64) -> bool) -> f64 {
    // Powers of ten as they are read, not as they are multiplied up.
    let round = |digit: u8, exponent: i32| {
        let text = format!("{digit}e{exponent}");
        text.parse().unwrap_or(most)
    };
    let top = libm::log10(most).ceil().clamp(-300.0, 300.0) as i32;
    for exponent in (top - 12..=top).rev() {
        for digit in [5, 2, 1] {
            let step = round(digit, exponent);
            if step <= most && is_enough(step) {
                return step;
            }
        }
    }
    round(1, top - 12)
}
