//! Runs a campaign, or a shard of it, from where it is.

use std::collections::BTreeMap;

use super::CampaignError;
use super::definition::Campaign;
use super::finished_runs::FinishedRuns;
use super::journal::{open_journal, scan};
use super::line_journal::LineJournal;
use super::record::{Record, RecordLine};
use super::run_set::RunSet;
use super::shards::Shard;
use super::statistics::mean_interval_width;
use super::worker_pool::do_all;
use crate::plugin::Simulator;

/// Runs between two looks at a precision.
pub const LOOK_EVERY: u64 = 50;

/// When a campaign is precise enough.
#[derive(Clone, Debug, PartialEq)]
pub struct Precision {
    /// The metric whose mean counts.
    pub metric: String,
    /// Largest width of the 95 % interval of its mean, in its unit.
    pub width: f64,
}

/// How the work is done.
#[derive(Clone, Debug, PartialEq)]
pub struct Work {
    /// Number of threads.
    pub workers: usize,
    /// When to stop before the last run: looked at after every [`LOOK_EVERY`] runs, in the order of their
    /// indices, whatever order they finish in.
    pub precision: Option<Precision>,
}

/// What is known of a shard while it runs: which runs are finished, and the metric of a precision.
struct Finished {
    runs: RunSet,
    /// The place of the metric, and its value by index, of runs that have it.
    metric: Option<(usize, BTreeMap<u64, f64>)>,
}

impl Finished {
    fn new(shard: Shard, metric: Option<usize>) -> Self {
        Self {
            runs: RunSet::new(shard),
            metric: metric.map(|place| (place, BTreeMap::new())),
        }
    }

    fn take(&mut self, index: u64, value: impl FnOnce(usize) -> Option<f64>) {
        if self.runs.insert(index)
            && let Some((place, values)) = &mut self.metric
            && let Some(value) = value(*place)
        {
            values.insert(index, value);
        }
    }

    fn take_line(&mut self, line: &RecordLine) {
        self.take(line.index, |place| line.metrics().nth(place).flatten());
    }

    /// Whether the interval of the mean over runs before an index is narrow enough.
    fn is_precise(&self, end: u64, precision: &Precision) -> bool {
        let values = self
            .metric
            .iter()
            .flat_map(|(_, values)| values.range(..end));
        let values: Vec<f64> = values.map(|(_, value)| *value).collect();
        mean_interval_width(&values).is_some_and(|found| found <= precision.width)
    }
}

/// Runs what is missing of a shard; one that is finished is left alone. `progress` hears of how many of how many
/// runs are finished, first of what was there. Gives how many runs of the shard count, in the order of their
/// indices: all of them, or those up to where a precision is reached.
///
/// # Errors
/// The journal cannot be written, another process is at it, or there is no such metric.
pub fn run_shard(
    simulator: &Simulator,
    campaign: &Campaign,
    shard: Shard,
    work: &Work,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<u64, CampaignError> {
    let mut finished = Finished::new(shard, metric_place(campaign, work)?);
    let finished_file = shard.finished_file(&campaign.folder);
    let mut journal = open(campaign, shard, &mut finished)?;
    let runs = campaign.plan.runs;
    let total = shard.indices(runs).count() as u64;
    progress(finished.runs.len(), total);
    let stride = work.precision.as_ref().map_or(total.max(1), |_| LOOK_EVERY);
    for start in (0..total).step_by(stride as usize) {
        let before = finished.runs.clone();
        let batch = shard.indices(runs).skip(start as usize);
        let missing = batch
            .take(stride as usize)
            .filter(move |index| !before.contains(*index));
        if let Some(journal) = &mut journal {
            let job = |index| campaign.run(simulator, index);
            let mut take = |record: Record| -> Result<(), CampaignError> {
                journal.add(&record.to_line())?;
                finished.take(record.index, |place| record.metrics.get(place).copied()?);
                progress(finished.runs.len(), total);
                Ok(())
            };
            do_all(missing, work.workers, job, &mut take)?;
        }
        let counted = start + stride;
        let end = shard.number - 1 + counted * shard.count;
        if let Some(precision) = &work.precision
            && counted < total
            && finished.is_precise(end, precision)
        {
            return Ok(counted);
        }
    }
    let mut indices = shard.indices(runs);
    if let Some(index) = indices.find(|index| !finished.runs.contains(*index)) {
        let message = format!("run {index} is missing in `{}`", finished_file.display());
        return Err(CampaignError::refused(
            message,
            "remove the file, and run the shard again",
        ));
    }
    if let Some(journal) = journal {
        journal.finish(&finished_file)?;
    }
    Ok(total)
}

/// The journal to go on with, none if the shard is finished; `finished` hears of what there is.
fn open(
    campaign: &Campaign,
    shard: Shard,
    finished: &mut Finished,
) -> Result<Option<LineJournal>, CampaignError> {
    let finished_file = shard.finished_file(&campaign.folder);
    let part_file = shard.part_file(&campaign.folder);
    if !finished_file.exists() {
        let journal = open_journal(campaign, &part_file, &mut |line| finished.take_line(line))?;
        // Another process may have finished it since.
        if !finished_file.exists() {
            return Ok(Some(journal));
        }
        let _ = std::fs::remove_file(part_file);
    }
    scan(campaign, &finished_file, &mut |_, line| {
        finished.take_line(line)
    })?;
    Ok(None)
}

fn metric_place(campaign: &Campaign, work: &Work) -> Result<Option<usize>, CampaignError> {
    let Some(precision) = &work.precision else {
        return Ok(None);
    };
    if campaign.plan.saltelli().is_some() {
        let message =
            "`--until-ci` takes runs as independent, and those of a Saltelli plan are not";
        return Err(CampaignError::refused(message, "leave it out"));
    }
    let metrics = &campaign.specification.metrics.0;
    let place = metrics
        .iter()
        .position(|(name, _)| *name == precision.metric);
    if place.is_none() {
        let names: Vec<String> = metrics
            .iter()
            .map(|(name, _)| format!("`{name}`"))
            .collect();
        let message = format!("`--of {}`: there is no such metric", precision.metric);
        return Err(CampaignError::refused(
            message,
            &format!("there is {}", names.join(", ")),
        ));
    }
    if !(precision.width.is_finite() && precision.width > 0.0) {
        let message = format!("`--until-ci {}`: a width is above zero", precision.width);
        return Err(CampaignError::refused(message, ""));
    }
    Ok(place)
}

/// The runs of all shards, which have to be finished.
///
/// # Errors
/// Which shards are not, or that a journal has not what it should.
pub fn merged(campaign: &Campaign) -> Result<FinishedRuns, CampaignError> {
    let shards = campaign.shards();
    let missing = shards.filter(|shard| !shard.finished_file(&campaign.folder).exists());
    let missing: Vec<String> = missing.map(|shard| shard.number.to_string()).collect();
    if !missing.is_empty() {
        let message = format!(
            "{} of {} shards are not finished: {}",
            missing.len(),
            campaign.manifest.shards,
            missing.join(", ")
        );
        let help = "`aerobot campaign run DIR --shard K/N` runs one of them";
        return Err(CampaignError::refused(message, help));
    }
    FinishedRuns::read(campaign, campaign.plan.runs)
}
