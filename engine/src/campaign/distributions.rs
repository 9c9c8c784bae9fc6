//! How a field varies: distributions by their quantile functions, and values in steps.

use aerobot_components::scene_component::FieldReport;
use aerobot_systems::stochastic::normal_distribution;
use serde::Deserialize;

use super::ordered::RonText;

/// The most levels of a field.
const MOST_LEVELS: u32 = 1_000_000;

/// How a field of the scene varies. Parameters have the unit of the field unless said otherwise.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename = "distribution", deny_unknown_fields)]
pub enum Distribution {
    /// All values between two alike.
    Uniform(
        /// Lowest value.
        f64,
        /// Highest value.
        f64,
    ),
    /// All whole numbers between two alike, both among them.
    UniformInteger(
        /// Lowest value.
        i64,
        /// Highest value.
        i64,
    ),
    /// Gauss' distribution.
    Normal {
        /// Mean.
        mean: f64,
        /// Standard deviation.
        standard_deviation: f64,
    },
    /// A normal distribution of which only what lies within limits is kept.
    TruncatedNormal {
        /// Mean before the cut.
        mean: f64,
        /// Standard deviation before the cut.
        standard_deviation: f64,
        /// Lowest value.
        low: f64,
        /// Highest value.
        high: f64,
    },
    /// Its logarithm is normally distributed.
    Lognormal {
        /// Median.
        median: f64,
        /// Standard deviation of the natural logarithm, without a unit.
        log_standard_deviation: f64,
    },
    /// 1 - exp(-(x / scale)^shape) lies below x.
    Weibull {
        /// The value below which 63.2 % lie.
        scale: f64,
        /// Shape, without a unit.
        shape: f64,
    },
    /// One of several values, all alike: any value of the scene language.
    Choice(
        /// The values.
        Vec<RonText>,
    ),
    /// A number out of a column of a CSV file, all rows alike.
    Measured {
        /// The file, relative to the campaign's own folder.
        file: String,
        /// Name of the column in the first row.
        column: String,
    },
    /// These values, one after the other: for `Lists` and `Grid`.
    List(
        /// The values.
        Vec<RonText>,
    ),
    /// Evenly spaced values, both ends among them: for `Lists` and `Grid`.
    Levels {
        /// First value.
        from: f64,
        /// Last value.
        to: f64,
        /// Number of values.
        count: u32,
    },
}

impl Distribution {
    /// Reports parameters that make no distribution.
    pub fn check(&self, report: &mut FieldReport) {
        match self {
            Self::Uniform(low, high) => check_order((*low, "0"), (*high, "1"), report),
            Self::UniformInteger(low, high) => {
                if low > high {
                    let message = format!("the bounds are crossed: {low} is above {high}");
                    report.add("1", message, "the lower one stands first");
                } else if high.checked_sub(*low).is_none_or(|span| span >= 1 << 52) {
                    report.add("1", "the bounds are more than 2^52 apart", "");
                }
            }
            Self::Normal {
                standard_deviation, ..
            } => report.positive("standard_deviation", *standard_deviation),
            Self::TruncatedNormal {
                mean,
                standard_deviation,
                low,
                high,
            } => {
                report.positive("standard_deviation", *standard_deviation);
                check_order((*low, "low"), (*high, "high"), report);
                let share = truncated_share(*mean, *standard_deviation, *low, *high);
                if *standard_deviation > 0.0 && low < high && share < 1e-12 {
                    report.add(
                        "low",
                        format!("only {share:.1e} of the normal distribution is within the limits"),
                        "the limits are too far from the mean to be a cut of it",
                    );
                }
            }
            Self::Lognormal {
                median,
                log_standard_deviation,
            } => {
                report.positive("median", *median);
                report.positive("log_standard_deviation", *log_standard_deviation);
            }
            Self::Weibull { scale, shape } => {
                report.positive("scale", *scale);
                report.positive("shape", *shape);
            }
            Self::Choice(values) | Self::List(values) => {
                if values.is_empty() {
                    report.add("", "there is no value to take", "");
                }
            }
            Self::Measured { .. } => {}
            Self::Levels { from, to, count } => {
                if *count < 2 {
                    report.add(
                        "count",
                        format!("{count} levels are too few"),
                        "two or more",
                    );
                }
                if *count > MOST_LEVELS {
                    let message = format!("{count} levels are more than {MOST_LEVELS}");
                    report.add("count", message, "");
                }
                if from == to {
                    report.add("to", "all levels are the same", "");
                }
            }
        }
    }

    /// The values of what goes in steps; `None` of what is drawn.
    #[must_use]
    pub fn steps(&self) -> Option<Vec<String>> {
        match self {
            Self::List(values) => Some(values.iter().map(|value| value.0.clone()).collect()),
            Self::Levels { from, to, count } => {
                let last = f64::from(count.saturating_sub(1).max(1));
                let level = |k: u32| from + (to - from) * (f64::from(k) / last);
                Some(
                    (0..(*count).min(MOST_LEVELS))
                        .map(|k| format!("{:?}", level(k)))
                        .collect(),
                )
            }
            _ => None,
        }
    }

    /// The value below which the part `u` lies, `0 < u < 1`, as text of the scene language; `measured` are
    /// the numbers of a `Measured`, sorted.
    #[must_use]
    pub fn value(&self, u: f64, measured: &[f64]) -> String {
        match self {
            Self::UniformInteger(low, high) => {
                let part = (u * ((high - low) as f64 + 1.0)) as i64;
                (low + part.min(high - low)).to_string()
            }
            Self::Choice(values) | Self::List(values) => values
                .get(place(u, values.len()))
                .map_or_else(String::new, |value| value.0.clone()),
            Self::Measured { .. } => measured
                .get(place(u, measured.len()))
                .map_or_else(String::new, |value| format!("{value:?}")),
            _ => format!("{:?}", self.number(u)),
        }
    }

    /// The quantile function of the continuous ones.
    fn number(&self, u: f64) -> f64 {
        match *self {
            // Not low + u (high - low), which overflows before it must.
            Self::Uniform(low, high) => (low * (1.0 - u) + high * u).clamp(low, high),
            Self::Normal {
                mean,
                standard_deviation,
            } => mean + standard_deviation * normal_distribution::quantile(u),
            Self::TruncatedNormal {
                mean,
                standard_deviation,
                low,
                high,
            } => truncated(u, mean, standard_deviation, (low, high)),
            Self::Lognormal {
                median,
                log_standard_deviation,
            } => median * libm::exp(log_standard_deviation * normal_distribution::quantile(u)),
            Self::Weibull { scale, shape } => scale * libm::pow(-libm::log1p(-u), 1.0 / shape),
            _ => 0.0,
        }
    }
}

/// The place of `u` among so many equal parts.
fn place(u: f64, count: usize) -> usize {
    ((u * count as f64) as usize).min(count.saturating_sub(1))
}

fn check_order((low, _): (f64, &str), (high, field): (f64, &str), report: &mut FieldReport) {
    if low >= high {
        let message = format!("the bounds are crossed: {low} is not below {high}");
        report.add(field, message, "the lower one stands first");
    }
}

/// Bounds in standard deviations, mirrored where they lie above the mean: the lower tail has its digits.
fn standard_bounds(mean: f64, deviation: f64, low: f64, high: f64) -> (f64, f64, bool) {
    let (a, b) = ((low - mean) / deviation, (high - mean) / deviation);
    if a > 0.0 {
        (-b, -a, true)
    } else {
        (a, b, false)
    }
}

fn truncated_share(mean: f64, deviation: f64, low: f64, high: f64) -> f64 {
    let (a, b, _) = standard_bounds(mean, deviation, low, high);
    normal_distribution::below(b) - normal_distribution::below(a)
}

fn truncated(u: f64, mean: f64, deviation: f64, (low, high): (f64, f64)) -> f64 {
    let (a, b, mirrored) = standard_bounds(mean, deviation, low, high);
    let part = if mirrored { 1.0 - u } else { u };
    let (below_a, below_b) = (normal_distribution::below(a), normal_distribution::below(b));
    let standard = normal_distribution::quantile(below_a + part * (below_b - below_a));
    let value = if mirrored { -standard } else { standard };
    (mean + deviation * value).clamp(low, high)
}

#[cfg(test)]
mod tests;
