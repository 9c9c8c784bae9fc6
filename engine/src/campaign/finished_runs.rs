//! The finished runs of a campaign, in the order of their indices: of each its outcome, its metrics, and where its
//! line is, 17 bytes and 8 for each metric. All else stays in the journals, and is read from there when it is
//! needed.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufRead, BufReader, Seek, SeekFrom};
use std::path::PathBuf;

use super::CampaignError;
use super::definition::Campaign;
use super::journal::scan;
use super::record::{Outcome, Record, RecordLine};
use super::summary::{Failure, without_numbers};

/// The place of a line that there is not.
const NOWHERE: u64 = u64::MAX;

/// The first so many runs of a campaign.
pub struct FinishedRuns {
    /// By the number of the shard less one.
    journals: Vec<PathBuf>,
    /// Where the line of a run begins in its journal.
    places: Vec<u64>,
    outcomes: Vec<Outcome>,
    simulated_s: Vec<f64>,
    /// Values of each metric; NaN of a run without it.
    metrics: Vec<Vec<f64>>,
    /// The largest number of values of each envelope.
    times: Vec<usize>,
    failures: BTreeMap<String, (u64, u64)>,
}

impl FinishedRuns {
    /// Reads the journals for the first so many runs, which must all be there.
    ///
    /// # Errors
    /// A journal cannot be read, or lacks a run.
    pub fn read(campaign: &Campaign, runs: u64) -> Result<Self, CampaignError> {
        let count = usize::try_from(runs).unwrap_or(usize::MAX);
        let specification = &campaign.specification;
        let shards = campaign.shards();
        let mut found = Self {
            journals: shards.map(|shard| shard.file(&campaign.folder)).collect(),
            places: vec![NOWHERE; count],
            outcomes: vec![Outcome::Refused; count],
            simulated_s: vec![0.0; count],
            metrics: vec![vec![f64::NAN; count]; specification.metrics.0.len()],
            times: vec![0; specification.envelopes.0.len()],
            failures: BTreeMap::new(),
        };
        let shards = campaign.manifest.shards;
        for (number, journal) in found.journals.clone().iter().enumerate() {
            scan(campaign, journal, &mut |place, line| {
                if line.index % shards == number as u64 {
                    found.take(place, line);
                }
            })?;
        }
        match found.places.iter().position(|place| *place == NOWHERE) {
            None => Ok(found),
            Some(index) => {
                let message = format!("run {index} is in no journal of its shard");
                Err(CampaignError::refused(
                    message,
                    "remove that journal, and run the shard again",
                ))
            }
        }
    }

    /// Takes a line; the first one of a run counts.
    fn take(&mut self, place: u64, line: &RecordLine) {
        let index = line.index as usize;
        let Some(own) = self.places.get_mut(index).filter(|own| **own == NOWHERE) else {
            return;
        };
        *own = place;
        self.outcomes[index] = line.outcome;
        self.simulated_s[index] = line.simulated_s;
        for (column, value) in self.metrics.iter_mut().zip(line.metrics()) {
            column[index] = value.unwrap_or(f64::NAN);
        }
        if line.outcome == Outcome::Done {
            for (place, times) in self.times.iter_mut().enumerate() {
                *times = (*times).max(line.envelope(place).count());
            }
        } else {
            let word = line.outcome.word();
            let reason = format!("{word}: {}", without_numbers(&line.reason()));
            let (runs, first) = self.failures.entry(reason).or_insert((0, line.index));
            *runs += 1;
            *first = line.index.min(*first);
        }
    }

    /// Number of runs.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.places.len() as u64
    }

    /// Number of runs that got to their end.
    #[must_use]
    pub fn done(&self) -> u64 {
        let done = self.outcomes.iter().filter(|of| **of == Outcome::Done);
        done.count() as u64
    }

    /// How a run ended.
    #[must_use]
    pub fn outcome(&self, index: u64) -> Option<Outcome> {
        self.outcomes.get(index as usize).copied()
    }

    /// Simulated time of a run, s.
    #[must_use]
    pub fn simulated_s(&self, index: u64) -> Option<f64> {
        self.simulated_s.get(index as usize).copied()
    }

    /// The value of a metric (by its place in the campaign) of a run, if it has one.
    #[must_use]
    pub fn metric(&self, index: u64, place: usize) -> Option<f64> {
        let value = self.metrics.get(place)?.get(index as usize).copied();
        value.filter(|value| !value.is_nan())
    }

    /// The runs that failed by reason, the most frequent first.
    pub(super) fn failures(&self, campaign: &Campaign) -> Vec<Failure> {
        let failure =
            |(reason, counts): (&String, &(u64, u64))| Failure::new(campaign, reason, *counts);
        let mut found: Vec<Failure> = self.failures.iter().map(failure).collect();
        found.sort_by_key(|failure| std::cmp::Reverse(failure.runs));
        found
    }

    /// The largest number of values that a run has of each envelope.
    #[must_use]
    pub fn times(&self) -> &[usize] {
        &self.times
    }

    /// All that is kept of a run, from its journal.
    ///
    /// # Errors
    /// The journal cannot be read any more.
    pub fn record(&self, campaign: &Campaign, index: u64) -> Result<Record, CampaignError> {
        let shard = (index % campaign.manifest.shards) as usize;
        let path = &self.journals[shard];
        let mut line = String::new();
        let place = self.places.get(index as usize).copied();
        let read = File::open(path).and_then(|file| {
            let mut file = BufReader::new(file);
            file.seek(SeekFrom::Start(place.unwrap_or(NOWHERE)))?;
            file.read_line(&mut line)
        });
        read.map_err(|error| CampaignError::unreadable(path, &error))?;
        let line = RecordLine::of_line(line.trim_end_matches('\n'), campaign.counts());
        line.map(|line| line.record()).ok_or_else(|| {
            let message = format!("`{}` has been changed", path.display());
            CampaignError::refused(message, "do it again")
        })
    }

    /// Reads all runs that got to their end once more, in the order of the journals.
    ///
    /// # Errors
    /// A journal cannot be read any more.
    pub(super) fn each_done(
        &self,
        campaign: &Campaign,
        take: &mut dyn FnMut(&RecordLine),
    ) -> Result<(), CampaignError> {
        for (number, journal) in self.journals.iter().enumerate() {
            scan(campaign, journal, &mut |place, line| {
                let is_own = line.index % self.journals.len() as u64 == number as u64
                    && self.places.get(line.index as usize) == Some(&place);
                if is_own && line.outcome == Outcome::Done {
                    take(line);
                }
            })?;
        }
        Ok(())
    }
}
