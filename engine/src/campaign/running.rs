//! Runs a campaign, or a shard of it, from where it is.

use std::collections::BTreeMap;
use std::path::Path;

use super::CampaignError;
use super::definition::Campaign;
use super::journal::{Journal, read_journal};
use super::record::Record;
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

/// Records by index.
pub type Records = BTreeMap<u64, Record>;

/// Runs what is missing of a shard; one that is finished is left alone. `progress` hears of how many of how many
/// runs are finished, first of what was there. Gives the records of the shard, in their order and without a gap
/// as far as they count: all of them, or those up to where a precision is reached.
///
/// # Errors
/// The journal cannot be written, another process is at it, or there is no such metric.
pub fn run_shard(
    simulator: &Simulator,
    campaign: &Campaign,
    shard: Shard,
    work: &Work,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Records, CampaignError> {
    let metric = metric_place(campaign, work)?;
    let finished_file = shard.finished_file(&campaign.folder);
    let part_file = shard.part_file(&campaign.folder);
    let indices: Vec<u64> = shard.indices(campaign.plan.runs).collect();
    let (mut journal, mut records) = open(campaign, &part_file, &finished_file)?;
    let total = indices.len() as u64;
    progress(records.len() as u64, total);
    let stride = match metric {
        Some(_) => LOOK_EVERY as usize,
        None => indices.len().max(1),
    };
    for (number, batch) in indices.chunks(stride).enumerate() {
        let missing: Vec<u64> = batch
            .iter()
            .copied()
            .filter(|index| !records.contains_key(index))
            .collect();
        if let Some(journal) = &mut journal {
            let job = |index| campaign.run(simulator, index);
            do_all(
                &missing,
                work.workers,
                job,
                |record| -> Result<(), CampaignError> {
                    journal.add(&record)?;
                    records.insert(record.index, record);
                    progress(records.len() as u64, total);
                    Ok(())
                },
            )?;
        }
        let count = ((number + 1) * stride).min(indices.len());
        let counted = &indices[..count];
        if let (Some(place), Some(precision)) = (metric, &work.precision)
            && count < indices.len()
            && is_precise(&records, counted, place, precision.width)
        {
            let last = counted.last().copied().unwrap_or(0);
            records.retain(|index, _| *index <= last);
            return Ok(records);
        }
    }
    if let Some(index) = indices.iter().find(|index| !records.contains_key(index)) {
        let message = format!("run {index} is missing in `{}`", finished_file.display());
        return Err(CampaignError::refused(
            message,
            "remove the file, and run the shard again",
        ));
    }
    if let Some(journal) = journal {
        journal.finish(&finished_file)?;
    }
    Ok(records)
}

/// The journal to go on with, none if the shard is finished, and the records that there are.
fn open(
    campaign: &Campaign,
    part_file: &Path,
    finished_file: &Path,
) -> Result<(Option<Journal>, Records), CampaignError> {
    if finished_file.exists() {
        return Ok((None, read_journal(campaign, finished_file)?));
    }
    let (journal, records) = Journal::open(campaign, part_file)?;
    // Another process may have finished it since.
    if finished_file.exists() {
        let _ = std::fs::remove_file(part_file);
        return Ok((None, read_journal(campaign, finished_file)?));
    }
    Ok((Some(journal), records))
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

/// Whether the interval of the mean over the counted runs is narrow enough.
fn is_precise(records: &Records, counted: &[u64], place: usize, width: f64) -> bool {
    let values: Vec<f64> = counted
        .iter()
        .filter_map(|index| records.get(index)?.metrics.get(place).copied()?)
        .collect();
    mean_interval_width(&values).is_some_and(|found| found <= width)
}

/// The records of all shards, which have to be finished.
///
/// # Errors
/// Which shards are not, or that a journal has not what it should.
pub fn merged(campaign: &Campaign) -> Result<Records, CampaignError> {
    let mut records = Records::new();
    let mut missing = Vec::new();
    for shard in campaign.shards() {
        let file = shard.finished_file(&campaign.folder);
        if file.exists() {
            records.extend(read_journal(campaign, &file)?);
        } else {
            missing.push(shard.number.to_string());
        }
    }
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
    match (0..campaign.plan.runs).find(|index| !records.contains_key(index)) {
        None => Ok(records),
        Some(index) => {
            let message = format!("run {index} is in no journal of its shard");
            Err(CampaignError::refused(
                message,
                "remove that journal, and run the shard again",
            ))
        }
    }
}
