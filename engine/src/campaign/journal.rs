//! The journal of a shard: a line for each finished run, in the order in which they finish.

use std::path::Path;

use super::CampaignError;
use super::definition::Campaign;
use super::line_journal::{Heading, LineJournal};
use super::manifest::Study;
use super::record::{Record, RecordLine};

fn heading(campaign: &Campaign) -> Heading {
    Heading {
        study: Study::Campaign,
        fingerprint: campaign.manifest.fingerprint.clone(),
    }
}

/// Hands every whole line of a journal to `take`, with its place in bytes; none if there is no file.
///
/// # Errors
/// The file cannot be read, or is of another campaign.
pub fn scan(
    campaign: &Campaign,
    path: &Path,
    take: &mut dyn FnMut(u64, &RecordLine),
) -> Result<(), CampaignError> {
    let counts = campaign.counts();
    heading(campaign).scan(path, &mut |place, line| {
        if let Some(found) = RecordLine::of_line(line, counts) {
            take(place, &found);
        }
    })
}

/// What a journal has of a run.
///
/// # Errors
/// As [`scan`].
pub fn find_record(
    campaign: &Campaign,
    path: &Path,
    index: u64,
) -> Result<Option<Record>, CampaignError> {
    let mut found = None;
    scan(campaign, path, &mut |_, line| {
        if line.index == index && found.is_none() {
            found = Some(line.record());
        }
    })?;
    Ok(found)
}

/// Opens a journal to go on with it, or begins one; `take` gets the whole lines that it has.
///
/// # Errors
/// Another process is at it, it is of another campaign, or the file system refused something.
pub fn open_journal(
    campaign: &Campaign,
    path: &Path,
    take: &mut dyn FnMut(&RecordLine),
) -> Result<LineJournal, CampaignError> {
    let counts = campaign.counts();
    LineJournal::open(&heading(campaign), path, &mut |line| {
        if let Some(found) = RecordLine::of_line(line, counts) {
            take(&found);
        }
    })
}
