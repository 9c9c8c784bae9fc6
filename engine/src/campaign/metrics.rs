//! Metrics: one number of a run each, latched while the run goes on.
//!
//! Between two recorded instants a quantity is taken as a straight line.

use aerobot_components::scene_component::FieldReport;
use serde::Deserialize;

use super::quantity::Quantity;
use crate::recording::frame::Frame;

/// One number of a run, of what is recorded of an entity.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename = "metric", deny_unknown_fields)]
pub enum MetricSpec {
    /// The last recorded value.
    Final {
        /// Name of the entity or tether.
        entity: String,
        /// Name of the channel or column.
        channel: String,
        /// Segment of a tether, from 1.
        #[serde(default)]
        segment: Option<u32>,
    },
    /// The largest recorded value.
    Largest {
        /// Name of the entity or tether.
        entity: String,
        /// Name of the channel or column.
        channel: String,
        /// Segment of a tether, from 1.
        #[serde(default)]
        segment: Option<u32>,
    },
    /// The smallest recorded value.
    Smallest {
        /// Name of the entity or tether.
        entity: String,
        /// Name of the channel or column.
        channel: String,
        /// Segment of a tether, from 1.
        #[serde(default)]
        segment: Option<u32>,
    },
    /// The mean over time, by the trapezoidal rule.
    Mean {
        /// Name of the entity or tether.
        entity: String,
        /// Name of the channel or column.
        channel: String,
        /// Segment of a tether, from 1.
        #[serde(default)]
        segment: Option<u32>,
    },
    /// How long the value was from `low` to `high`, s.
    TimeWithin {
        /// Name of the entity or tether.
        entity: String,
        /// Name of the channel or column.
        channel: String,
        /// Segment of a tether, from 1.
        #[serde(default)]
        segment: Option<u32>,
        /// Lower limit, in the channel's unit.
        low: f64,
        /// Upper limit, in the channel's unit.
        high: f64,
    },
    /// When the value was first at or above, or at or below, a limit, s; nothing if it never was.
    FirstTime {
        /// Name of the entity or tether.
        entity: String,
        /// Name of the channel or column.
        channel: String,
        /// Segment of a tether, from 1.
        #[serde(default)]
        segment: Option<u32>,
        /// The limit from below, in the channel's unit.
        #[serde(default)]
        above: Option<f64>,
        /// The limit from above, in the channel's unit.
        #[serde(default)]
        below: Option<f64>,
    },
}

impl MetricSpec {
    /// What it looks at.
    #[must_use]
    pub fn quantity(&self) -> Quantity {
        let (Self::Final {
            entity,
            channel,
            segment,
        }
        | Self::Largest {
            entity,
            channel,
            segment,
        }
        | Self::Smallest {
            entity,
            channel,
            segment,
        }
        | Self::Mean {
            entity,
            channel,
            segment,
        }
        | Self::TimeWithin {
            entity,
            channel,
            segment,
            ..
        }
        | Self::FirstTime {
            entity,
            channel,
            segment,
            ..
        }) = self;
        Quantity {
            entity: entity.clone(),
            channel: channel.clone(),
            segment: *segment,
        }
    }

    /// The unit of its value, as it stands at the end of names; empty if it has none.
    #[must_use]
    pub fn unit(&self) -> String {
        match self {
            Self::TimeWithin { .. } | Self::FirstTime { .. } => "s".to_owned(),
            _ => self.quantity().unit().to_owned(),
        }
    }

    /// Reports limits that make no sense.
    pub fn check(&self, report: &mut FieldReport) {
        match self {
            Self::TimeWithin { low, high, .. } if low >= high => {
                let message = format!("the limits are crossed: {low} is not below {high}");
                report.add("high", message, "`low` is the lower one");
            }
            Self::FirstTime { above, below, .. } if above.is_some() == below.is_some() => report
                .add(
                    "",
                    "`FirstTime` waits for one limit",
                    "give `above` or `below`, and not both",
                ),
            _ => {}
        }
    }
}

/// A metric on its way.
#[derive(Clone, Debug)]
pub struct Latch {
    specification: MetricSpec,
    quantity: Quantity,
    first_s: f64,
    last: Option<(f64, f64)>,
    /// The extreme, integral, duration or time so far.
    found: Option<f64>,
}

impl Latch {
    /// Of a metric, before the run.
    #[must_use]
    pub fn new(specification: &MetricSpec) -> Self {
        Self {
            quantity: specification.quantity(),
            specification: specification.clone(),
            first_s: 0.0,
            last: None,
            found: None,
        }
    }

    /// Takes the rows of an instant.
    pub fn take(&mut self, frame: &Frame) {
        if let Some(value) = self.quantity.read(frame) {
            self.add(frame.time_s, value);
        }
    }

    /// Takes a value (in the channel's unit) at a time, s.
    fn add(&mut self, time_s: f64, value: f64) {
        let (before_s, before) = self.last.unwrap_or_else(|| {
            self.first_s = time_s;
            (time_s, value)
        });
        let step_s = time_s - before_s;
        let sum = self.found.unwrap_or(0.0);
        self.found = match self.specification {
            MetricSpec::Final { .. } => Some(value),
            MetricSpec::Largest { .. } => Some(self.found.map_or(value, |most| most.max(value))),
            MetricSpec::Smallest { .. } => Some(self.found.map_or(value, |least| least.min(value))),
            MetricSpec::Mean { .. } => Some(sum + step_s * (0.5 * before + 0.5 * value)),
            MetricSpec::TimeWithin { low, high, .. } => {
                Some(sum + step_s * share_within((before, value), (low, high)))
            }
            MetricSpec::FirstTime { above, below, .. } => self.found.or_else(|| {
                let (limit, sign) =
                    above.map_or((below.unwrap_or(0.0), -1.0), |limit| (limit, 1.0));
                let (past, past_before) = (sign * (value - limit), sign * (before - limit));
                if past < 0.0 {
                    None
                } else if past_before >= 0.0 {
                    Some(time_s)
                } else {
                    Some(before_s + step_s * (-past_before / (past - past_before)))
                }
            }),
        };
        self.last = Some((time_s, value));
    }

    /// The number; `None` if there was nothing, or what was waited for did not happen.
    #[must_use]
    pub fn value(&self) -> Option<f64> {
        let (last_s, last) = self.last?;
        let span_s = last_s - self.first_s;
        let value = match self.specification {
            MetricSpec::Mean { .. } if span_s > 0.0 => self.found.map(|sum| sum / span_s),
            MetricSpec::Mean { .. } => Some(last),
            _ => self.found,
        };
        value.filter(|value| value.is_finite())
    }
}

/// The part of a straight way from one value to another that is within limits.
fn share_within((from, to): (f64, f64), (low, high): (f64, f64)) -> f64 {
    let (least, most) = (from.min(to), from.max(to));
    if least == most {
        return if low <= least && least <= high {
            1.0
        } else {
            0.0
        };
    }
    ((most.min(high) - least.max(low)) / (most - least)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(specification: &str, values: &[(f64, f64)]) -> Option<f64> {
        let text = specification.replacen('(', "(entity: \"a\", channel: \"x_m\", ", 1);
        let mut latch = Latch::new(&ron::from_str(&text).unwrap());
        values
            .iter()
            .for_each(|(time_s, value)| latch.add(*time_s, *value));
        latch.value()
    }

    /// A triangle 0, 4, 0 in 2 s and 2 s, cut by hand.
    #[test]
    fn metrics_of_a_triangle() {
        let triangle = [(1.0, 0.0), (3.0, 4.0), (5.0, 0.0)];
        assert_eq!(of("Final()", &triangle), Some(0.0));
        assert_eq!(of("Largest()", &triangle), Some(4.0));
        assert_eq!(of("Smallest()", &triangle), Some(0.0));
        assert_eq!(of("Mean()", &triangle), Some(2.0));
        assert_eq!(of("TimeWithin(low: 1, high: 3)", &triangle), Some(2.0));
        assert_eq!(of("TimeWithin(low: 3, high: 9)", &triangle), Some(1.0));
        assert_eq!(of("FirstTime(above: Some(3))", &triangle), Some(2.5));
        assert_eq!(of("FirstTime(above: Some(5))", &triangle), None);
        assert_eq!(of("FirstTime(below: Some(0))", &triangle), Some(1.0));
        assert_eq!(of("Mean()", &triangle[..1]), Some(0.0));
        assert_eq!(of("Mean()", &[]), None);
    }
}
