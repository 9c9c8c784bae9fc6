//! What a campaign writes when it is finished: its tables, `summary.json`, and everything of the runs that are
//! kept.

use std::collections::BTreeSet;
use std::fs;
use std::io;

use super::CampaignError;
use super::definition::Campaign;
use super::envelope_table::write_envelopes;
use super::finished_runs::FinishedRuns;
use super::paired_table::write_whole;
use super::record::Outcome;
use super::run_table::write_runs;
use super::summary::{CampaignSummary, summarise};
use crate::plugin::Simulator;
use crate::run_folder::Destination;

/// Name of the summary.
pub const SUMMARY_FILE: &str = "summary.json";
/// Name of the folder of runs that are kept.
pub const KEPT: &str = "kept";

/// Writes everything, each file whole or not at all.
///
/// # Errors
/// What the file system refused; journals are not touched.
pub fn write_results(
    simulator: &Simulator,
    campaign: &Campaign,
    runs: &FinishedRuns,
) -> Result<CampaignSummary, CampaignError> {
    write_runs(campaign, runs)?;
    write_envelopes(campaign, runs)?;
    let summary = summarise(campaign, runs);
    keep(simulator, campaign, runs, &summary)?;
    let path = campaign.folder.join(SUMMARY_FILE);
    let text = serde_json::to_string_pretty(&summary)
        .map_err(|error| CampaignError::unwritten(&path, &error.into()))?;
    write_whole(&path, &(text + "\n"))?;
    Ok(summary)
}

/// The runs of which everything is kept.
fn kept(campaign: &Campaign, runs: &FinishedRuns, summary: &CampaignSummary) -> BTreeSet<u64> {
    let keep = &campaign.specification.keep;
    let mut wanted: BTreeSet<u64> = keep.runs.iter().copied().collect();
    if let Some(every) = keep.every {
        wanted.extend((0..runs.count()).step_by(usize::try_from(every).unwrap_or(usize::MAX)));
    }
    if keep.failures {
        let is_stopped = |index: &u64| runs.outcome(*index) == Some(Outcome::Stopped);
        wanted.extend((0..runs.count()).filter(is_stopped));
    }
    for metric in &summary.metrics {
        if keep.extremes_of.contains(&metric.name) {
            let extremes = [metric.smallest, metric.largest].into_iter().flatten();
            wanted.extend(extremes.map(|(_, index)| index));
        }
    }
    // What was refused has nothing to keep.
    let was_run = |index: &u64| {
        let outcome = runs.outcome(*index);
        outcome.is_some_and(|outcome| outcome != Outcome::Refused)
    };
    wanted.into_iter().filter(was_run).collect()
}

/// Runs once more what is kept and not there yet, each folder whole or not at all.
fn keep(
    simulator: &Simulator,
    campaign: &Campaign,
    runs: &FinishedRuns,
    summary: &CampaignSummary,
) -> Result<(), CampaignError> {
    let wanted = kept(campaign, runs, summary);
    let name = |index: &u64| format!("run-{index:08}");
    let names: BTreeSet<String> = wanted.iter().map(name).collect();
    // An extreme of fewer runs, from an end at a precision, and what a kill left.
    for entry in fs::read_dir(campaign.folder.join(KEPT))
        .into_iter()
        .flatten()
        .flatten()
    {
        let is_wanted = names.contains(&*entry.file_name().to_string_lossy());
        if !is_wanted {
            fs::remove_dir_all(entry.path())
                .map_err(|error| CampaignError::unwritten(&entry.path(), &error))?;
        }
    }
    for index in wanted {
        let folder = campaign.folder.join(KEPT).join(name(&index));
        if folder.exists() {
            continue;
        }
        let part = folder.with_extension("part");
        let destination = Destination {
            folder: part.clone(),
            overwrite: true,
        };
        let (_, repeated) = campaign.replay(simulator, index, &destination, &mut |_| {})?;
        let renamed = match runs.record(campaign, index)? == repeated {
            true => fs::rename(&part, &folder),
            // As on a disk that is full.
            false => Err(io::Error::other(
                "the run ended in another way when it was repeated",
            )),
        };
        renamed.map_err(|error| CampaignError::unwritten(&folder, &error))?;
    }
    Ok(())
}
