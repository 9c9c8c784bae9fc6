//! Why a gust that a scene describes cannot be, where it says so, and what would do.

use thiserror::Error;

use super::design::DEFAULT_LOSS;

/// More levels than this are a slip of the pen.
pub(super) const MOST_LEVELS: f64 = 20_000.0;

/// Why there is no such gust.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum GustError {
    /// A grid in time or over altitude loses too much.
    #[error("{knots} {step} {unit} apart lose {percent:.2} % of the variance on average")]
    LosesTooMuch {
        /// The distance of knots.
        step: f64,
        /// Its unit.
        unit: &'static str,
        /// What they are.
        knots: &'static str,
        /// All that is lost, in percent.
        percent: f64,
        /// What would be chosen if none were given.
        enough: f64,
    },
    /// Velocities of this marginal cannot be anticorrelated that much.
    #[error(
        "the autocorrelation is {wanted:.4} at {lag_s} s, and this marginal cannot have less than {least:.4}"
    )]
    Unreachable {
        /// The lag, s.
        lag_s: f64,
        /// What is stated there.
        wanted: f64,
        /// The least there is.
        least: f64,
    },
    /// The corrected autocorrelation is that of no process.
    #[error(
        "no normal process leads to this autocorrelation: corrected for the marginal it is impossible at \
         the lag of {lag_s} s"
    )]
    NotPositiveDefinite {
        /// The lag, s.
        lag_s: f64,
    },
    /// Too many lags to correct.
    #[error(
        "{grid_s} s is too fine a grid to correct the autocorrelation on: it takes {lags:.0} lags"
    )]
    TooManyLags {
        /// The grid, s.
        grid_s: f64,
        /// How many there would be.
        lags: f64,
        /// What would do, s.
        enough: f64,
    },
    /// Too many levels.
    #[error("the altitudes take {count:e} levels of {level_m} m, more than {MOST_LEVELS:e}")]
    TooManyLevels {
        /// How many there would be.
        count: f64,
        /// Their distance, m.
        level_m: f64,
    },
}

impl GustError {
    /// The field at fault.
    #[must_use]
    pub fn field(&self) -> GustField {
        match self {
            Self::LosesTooMuch {
                knots: "levels", ..
            }
            | Self::TooManyLevels { .. } => GustField::OfSource("coherence.level_m"),
            Self::LosesTooMuch { .. } | Self::TooManyLags { .. } => GustField::OfAxis("grid_s"),
            Self::Unreachable { .. } | Self::NotPositiveDefinite { .. } => {
                GustField::OfAxis("autocorrelation")
            }
        }
    }

    /// What would do.
    #[must_use]
    pub fn help(&self) -> String {
        match self {
            Self::LosesTooMuch {
                knots,
                unit,
                enough,
                ..
            } => {
                let field = if *knots == "levels" { "level_m" } else { "grid_s" };
                format!(
                    "{enough} {unit}, which `{field}` is unless given, loses at most {} %; with \
                     `allow_loss: true` any grid is taken",
                    100.0 * DEFAULT_LOSS
                )
            }
            Self::Unreachable { .. } | Self::NotPositiveDefinite { .. } => {
                "with `autocorrelation: Parent` the normal process behind the gust has the stated one; a \
                 larger `decay_per_s` or a less skewed marginal may do too"
                    .to_owned()
            }
            Self::TooManyLags { enough, .. } => {
                format!("give a grid of {enough:.3} s or more, or `autocorrelation: Parent`")
            }
            Self::TooManyLevels { .. } => {
                "give a larger `level_m`, or altitudes closer to where the flight goes".to_owned()
            }
        }
    }
}

/// Where a field stands in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GustField {
    /// Below the source of wind.
    OfSource(&'static str),
    /// Below the axis.
    OfAxis(&'static str),
}
