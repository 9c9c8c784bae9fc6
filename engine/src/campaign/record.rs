//! What is kept of a run: a line of text, with a sum over it that tells a torn line.

use super::fingerprint::{sealed, unsealed};
use crate::recording::number::number_text;

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// At its end.
    Done,
    /// Before its end.
    Stopped,
    /// It was not run: the scene makes no sense with these inputs.
    Refused,
}

impl Outcome {
    /// The word in tables.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Stopped => "stopped",
            Self::Refused => "refused",
        }
    }

    fn of_word(word: &str) -> Option<Self> {
        let all = [Self::Done, Self::Stopped, Self::Refused];
        all.into_iter().find(|outcome| outcome.word() == word)
    }
}

/// What is kept of a run. Numbers are finite.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Index of the run, from 0.
    pub index: u64,
    /// How it ended.
    pub outcome: Outcome,
    /// Why it did not get to its end; empty if it did.
    pub reason: String,
    /// Simulated time, s.
    pub simulated_s: f64,
    /// The metrics in the order of the campaign; nothing in a run that did not get to its end.
    pub metrics: Vec<Option<f64>>,
    /// Values of each envelope at its times; nothing in a run that did not get to its end.
    pub envelopes: Vec<Vec<f64>>,
}

impl Record {
    /// As a line with its end.
    #[must_use]
    pub fn to_line(&self) -> String {
        let metrics = self
            .metrics
            .iter()
            .map(|value| value.map_or_else(String::new, number_text));
        let values =
            |values: &Vec<f64>| joined(values.iter().map(|value| number_text(*value)), ",");
        let line = [
            self.index.to_string(),
            self.outcome.word().to_owned(),
            number_text(self.simulated_s),
            self.reason
                .replace('\\', "\\\\")
                .replace('\t', "\\t")
                .replace('\n', "\\n"),
            joined(metrics, ","),
            joined(self.envelopes.iter().map(values), ";"),
        ]
        .join("\t");
        sealed(&line)
    }
}

/// A line of a journal that is whole, of which no more is read than is asked for.
#[derive(Clone, Copy, Debug)]
pub struct RecordLine<'a> {
    /// Index of the run, from 0.
    pub index: u64,
    /// How it ended.
    pub outcome: Outcome,
    /// Simulated time, s.
    pub simulated_s: f64,
    reason: &'a str,
    metrics: &'a str,
    envelopes: &'a str,
    /// How many metrics and envelopes there are.
    counts: (usize, usize),
}

impl<'a> RecordLine<'a> {
    /// Of a line without its end, of a campaign with so many metrics and envelopes; `None` if it is not whole.
    #[must_use]
    pub fn of_line(line: &'a str, counts: (usize, usize)) -> Option<Self> {
        let mut parts = unsealed(line)?.split('\t');
        let mut part = || parts.next();
        let line = Self {
            index: part()?.parse().ok()?,
            outcome: Outcome::of_word(part()?)?,
            simulated_s: number(part()?)?,
            reason: part()?,
            metrics: part()?,
            envelopes: part()?,
            counts,
        };
        let found = (
            split(line.metrics, ',', counts.0).count(),
            split(line.envelopes, ';', counts.1).count(),
        );
        (parts.next().is_none() && found == counts).then_some(line)
    }

    /// Why the run did not get to its end.
    #[must_use]
    pub fn reason(&self) -> String {
        unescaped(self.reason)
    }

    /// The metrics in the order of the campaign.
    pub fn metrics(&self) -> impl Iterator<Item = Option<f64>> + 'a {
        split(self.metrics, ',', self.counts.0).map(number)
    }

    /// The values of an envelope as texts, by its place in the campaign.
    pub fn envelope(&self, place: usize) -> impl Iterator<Item = &'a str> + 'a {
        let values = split(self.envelopes, ';', self.counts.1).nth(place);
        let values = values.filter(|text| !text.is_empty());
        values.into_iter().flat_map(|text| text.split(','))
    }

    /// Everything that is in it.
    #[must_use]
    pub fn record(&self) -> Record {
        let envelope = |place| self.envelope(place).filter_map(number).collect();
        Record {
            index: self.index,
            outcome: self.outcome,
            reason: self.reason(),
            simulated_s: self.simulated_s,
            metrics: self.metrics().collect(),
            envelopes: (0..self.counts.1).map(envelope).collect(),
        }
    }
}

/// A finite number.
pub(super) fn number(text: &str) -> Option<f64> {
    text.parse::<f64>().ok().filter(|value| value.is_finite())
}

fn joined(parts: impl Iterator<Item = String>, between: &str) -> String {
    parts.collect::<Vec<_>>().join(between)
}

/// The parts of a text; none if there are to be none.
fn split(text: &str, between: char, count: usize) -> impl Iterator<Item = &str> {
    text.split(between).filter(move |_| count > 0)
}

fn unescaped(text: &str) -> String {
    let mut found = String::new();
    let mut characters = text.chars();
    while let Some(character) = characters.next() {
        match character {
            '\\' => match characters.next() {
                Some('t') => found.push('\t'),
                Some('n') => found.push('\n'),
                Some(other) => found.push(other),
                None => {}
            },
            _ => found.push(character),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_read_back_and_torn_ones_do_not() {
        let record = Record {
            index: 17,
            outcome: Outcome::Stopped,
            reason: "a\tb\\n\nc".to_owned(),
            simulated_s: 0.1 + 0.2,
            metrics: vec![Some(-1e-300), None],
            envelopes: vec![vec![1.0, 1.0 / 3.0], vec![]],
        };
        let line = record.to_line();
        let whole = line.trim_end_matches('\n');
        let read = RecordLine::of_line(whole, (2, 2)).unwrap();
        assert_eq!(read.record(), record);
        assert_eq!(
            read.envelope(0).collect::<Vec<_>>(),
            ["1", "0.3333333333333333"]
        );
        assert_eq!((read.envelope(1).count(), read.envelope(2).count()), (0, 0));
        for end in 0..whole.len() {
            assert!(RecordLine::of_line(&whole[..end], (2, 2)).is_none());
        }
        assert!(RecordLine::of_line(whole, (3, 2)).is_none());
    }
}
