//! What a campaign writes when it is finished: `runs.csv`, `envelopes.csv`, `summary.json`, and everything of the
//! runs that are kept.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

use super::CampaignError;
use super::comma_separated::quoted;
use super::definition::Campaign;
use super::envelopes::envelope_table;
use super::record::Outcome;
use super::running::Records;
use super::summary::{CampaignSummary, summarise};
use crate::plugin::Simulator;
use crate::recording::number::number_text;
use crate::run_folder::Destination;

/// Name of the table of runs.
pub const RUNS_FILE: &str = "runs.csv";
/// Name of the table of envelopes.
pub const ENVELOPES_FILE: &str = "envelopes.csv";
/// Name of the summary.
pub const SUMMARY_FILE: &str = "summary.json";
/// Name of the folder of runs that are kept.
pub const KEPT: &str = "kept";

/// Writes everything, each file whole or not at all. The records are those of the first runs, without a gap.
///
/// # Errors
/// What the file system refused; journals are not touched.
pub fn write_results(
    simulator: &Simulator,
    campaign: &Campaign,
    records: &Records,
) -> Result<CampaignSummary, CampaignError> {
    let write = |name: &str, text: &str| {
        let path = campaign.folder.join(name);
        write_whole(&path, text).map_err(|error| CampaignError::unwritten(&path, &error))
    };
    write(RUNS_FILE, &run_table(campaign, records))?;
    let envelopes = &campaign.specification.envelopes.0;
    if !envelopes.is_empty() {
        let names = envelopes
            .iter()
            .map(|(name, envelope)| (name.clone(), envelope.every_s));
        let done = records
            .values()
            .filter(|record| record.outcome == Outcome::Done);
        let values: Vec<&[Vec<f64>]> = done.map(|record| record.envelopes.as_slice()).collect();
        write(
            ENVELOPES_FILE,
            &envelope_table(&names.collect::<Vec<_>>(), &values),
        )?;
    }
    let summary = summarise(campaign, records);
    keep(simulator, campaign, records, &summary)?;
    let path = campaign.folder.join(SUMMARY_FILE);
    let text = serde_json::to_string_pretty(&summary)
        .map_err(|error| CampaignError::unwritten(&path, &error.into()))?;
    write(SUMMARY_FILE, &(text + "\n"))?;
    Ok(summary)
}

pub(crate) fn write_whole(path: &Path, text: &str) -> io::Result<()> {
    let mut part = path.as_os_str().to_owned();
    part.push(".part");
    let part = Path::new(&part);
    let written = File::create(part).and_then(|mut file| {
        file.write_all(text.as_bytes())?;
        file.sync_all()
    });
    written
        .and_then(|()| fs::rename(part, path))
        .inspect_err(|_| {
            let _ = fs::remove_file(part);
        })
}

/// A row for each run: its index, its seed, what varies, how it ended and why, and the metrics.
fn run_table(campaign: &Campaign, records: &Records) -> String {
    let fields = campaign.plan.field_names().into_iter().map(quoted);
    let metrics = campaign
        .specification
        .metrics
        .0
        .iter()
        .map(|(name, _)| name.clone());
    let head = ["run".to_owned(), "seed".to_owned()]
        .into_iter()
        .chain(fields);
    let middle = ["outcome", "reason", "simulated_s"].map(str::to_owned);
    let mut text = head
        .chain(middle)
        .chain(metrics)
        .collect::<Vec<_>>()
        .join(",");
    text.push('\n');
    for (index, record) in records {
        let inputs = campaign.plan.inputs(*index);
        let mut row = vec![index.to_string(), inputs.seed];
        row.extend(inputs.fields.iter().map(|(_, value)| quoted(value)));
        row.extend([record.outcome.word().to_owned(), quoted(&record.reason)]);
        row.push(number_text(record.simulated_s));
        let number = |value: &Option<f64>| value.map_or_else(String::new, number_text);
        row.extend(record.metrics.iter().map(number));
        text.push_str(&row.join(","));
        text.push('\n');
    }
    text
}

/// The runs of which everything is kept.
fn kept(campaign: &Campaign, records: &Records, summary: &CampaignSummary) -> BTreeSet<u64> {
    let keep = &campaign.specification.keep;
    let mut wanted: BTreeSet<u64> = keep.runs.iter().copied().collect();
    if let Some(every) = keep.every {
        wanted.extend(records.keys().filter(|index| *index % every == 0));
    }
    if keep.failures {
        let failed = records
            .values()
            .filter(|record| record.outcome == Outcome::Stopped);
        wanted.extend(failed.map(|record| record.index));
    }
    for metric in &summary.metrics {
        if keep.extremes_of.contains(&metric.name) {
            let extremes = [metric.smallest, metric.largest].into_iter().flatten();
            wanted.extend(extremes.map(|(_, index)| index));
        }
    }
    // What was refused has nothing to keep.
    let was_run = |index: &u64| {
        let record = records.get(index);
        record.is_some_and(|record| record.outcome != Outcome::Refused)
    };
    wanted.into_iter().filter(was_run).collect()
}

/// Runs once more what is kept and not there yet, each folder whole or not at all.
fn keep(
    simulator: &Simulator,
    campaign: &Campaign,
    records: &Records,
    summary: &CampaignSummary,
) -> Result<(), CampaignError> {
    let wanted = kept(campaign, records, summary);
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
        let renamed = match records.get(&index) == Some(&repeated) {
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
