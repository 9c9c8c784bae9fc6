//! Envelopes: percentiles over all runs of a quantity at fixed times.
//!
//! A run keeps its values at those times, and nothing between them; percentiles are exact, of the values of
//! all runs, and not of a sketch. What it takes is eight bytes for each run and time.

use aerobot_components::scene_component::FieldReport;
use serde::Deserialize;

use super::quantity::Quantity;
use super::statistics::percentile;
use crate::recording::frame::Frame;

/// Percentiles of an envelope.
pub const PERCENTILES: [f64; 7] = [0.0, 5.0, 25.0, 50.0, 75.0, 95.0, 100.0];

/// The most times of an envelope.
const MOST_TIMES: f64 = 1e5;

/// A quantity at fixed times.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename = "envelope", deny_unknown_fields)]
pub struct EnvelopeSpec {
    /// Name of the entity or tether.
    pub entity: String,
    /// Name of the channel or column.
    pub channel: String,
    /// Segment of a tether, from 1; the largest of all segments unless given.
    #[serde(default)]
    pub segment: Option<u32>,
    /// Time between values, s, from 0; what is recorded less often is taken as straight between.
    pub every_s: f64,
}

impl EnvelopeSpec {
    /// What it looks at.
    #[must_use]
    pub fn quantity(&self) -> Quantity {
        Quantity {
            entity: self.entity.clone(),
            channel: self.channel.clone(),
            segment: self.segment,
        }
    }

    /// Reports a period that makes no sense in a run of `duration_s`.
    pub fn check(&self, duration_s: f64, report: &mut FieldReport) {
        report.positive("every_s", self.every_s);
        if self.every_s > 0.0 && duration_s / self.every_s > MOST_TIMES {
            let message = format!(
                "{duration_s} s in steps of {} s are more than {MOST_TIMES:e} times",
                self.every_s
            );
            report.add("every_s", message, "");
        }
    }
}

/// Takes the values of one run.
pub struct EnvelopeSampler {
    quantity: Quantity,
    every_s: f64,
    last: Option<(f64, f64)>,
    values: Vec<f64>,
}

impl EnvelopeSampler {
    /// Of an envelope, before the run.
    #[must_use]
    pub fn new(specification: &EnvelopeSpec) -> Self {
        Self {
            quantity: specification.quantity(),
            every_s: specification.every_s,
            last: None,
            values: Vec::new(),
        }
    }

    /// Takes the rows of an instant.
    pub fn take(&mut self, frame: &Frame) {
        let Some(value) = self.quantity.read(frame) else {
            return;
        };
        let time_s = frame.time_s;
        let (before_s, before) = self.last.unwrap_or((time_s, value));
        // A time that misses a row by round-off is that of the row.
        while self.values.len() as f64 * self.every_s <= time_s + 1e-9 * self.every_s {
            let due_s = self.values.len() as f64 * self.every_s;
            let part = if due_s >= time_s || time_s <= before_s {
                1.0
            } else {
                ((due_s - before_s) / (time_s - before_s)).max(0.0)
            };
            let between = if part == 1.0 {
                value
            } else {
                before + part * (value - before)
            };
            self.values.push(between + 0.0);
        }
        self.last = Some((time_s, value));
    }

    /// The values, one for each time.
    #[must_use]
    pub fn into_values(self) -> Vec<f64> {
        self.values
    }
}

/// The [`PERCENTILES`] of the values of all runs at a time, which are sorted for it.
#[must_use]
pub fn percentiles_of(values: &mut [f64]) -> [Option<f64>; PERCENTILES.len()] {
    values.sort_unstable_by(f64::total_cmp);
    PERCENTILES.map(|percent| percentile(values, percent))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::frame::ChannelRow;

    /// Rows every 0.1 s of a straight line, values every 0.25 s: on the line.
    #[test]
    fn values_stand_at_their_times() {
        let specification: EnvelopeSpec =
            ron::from_str("(entity: \"a\", channel: \"h_m\", every_s: 0.25)").unwrap();
        let mut sampler = EnvelopeSampler::new(&specification);
        for k in 0..=10 {
            let time_s = f64::from(k) * 0.1;
            let row = ChannelRow {
                entity: "a".into(),
                channel: "h_m",
                value: 3.0 - 2.0 * time_s,
            };
            sampler.take(&Frame {
                time_s,
                channels: vec![row],
                ..Frame::default()
            });
        }
        let values = sampler.into_values();
        assert_eq!(values.len(), 5);
        for (k, value) in values.iter().enumerate() {
            assert!((value - (3.0 - 0.5 * k as f64)).abs() < 1e-12);
        }
    }

    #[test]
    fn percentiles_by_hand() {
        let found = percentiles_of(&mut [4.0, 0.0]);
        assert_eq!(found, [0.0, 0.2, 1.0, 2.0, 3.0, 3.8, 4.0].map(Some));
        assert_eq!(percentiles_of(&mut []), [None; 7]);
    }
}
