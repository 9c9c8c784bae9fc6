//! `aerobot report`, and `--report` of `aerobot run`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use aerobot_engine::campaign::manifest::Study;
use aerobot_engine::campaign::results::KEPT;
use aerobot_engine::plugin::Simulator;
use aerobot_report::campaign::{CampaignRecord, SearchRecord};
use aerobot_report::page::campaign_page::campaign_page;
use aerobot_report::page::run_page::run_page;
use aerobot_report::page::search_page::search_page;
use aerobot_report::page::{Page, is_page};
use aerobot_report::record::Record;

use super::{REFUSED, ReportArguments, complain, say};

/// Name of the report in the folder of its run.
pub(super) const REPORT_FILE: &str = "report.html";
/// Runs that a campaign has kept and that get reports of their own, at most.
const MOST_KEPT: usize = 8;
/// More runs than this in one report are not told apart.
const MOST_RUNS: usize = 4;

pub(super) fn report(simulator: &Simulator, arguments: &ReportArguments) -> ExitCode {
    match write(simulator, arguments) {
        Ok(file) => {
            if !arguments.quiet {
                say(format_args!("wrote `{}`", file.display()));
            }
            ExitCode::SUCCESS
        }
        Err(message) => {
            complain(message);
            ExitCode::from(REFUSED)
        }
    }
}

/// Writes the report of a run into its folder.
pub(super) fn write_beside(simulator: &Simulator, folder: &Path) -> Result<PathBuf, String> {
    let file = folder.join(REPORT_FILE);
    let page = page(simulator, &[folder.to_owned()])?;
    write_page(&file, &page)?;
    Ok(file)
}

fn write(simulator: &Simulator, arguments: &ReportArguments) -> Result<PathBuf, String> {
    let folders = &arguments.folders;
    if folders.len() > MOST_RUNS {
        return Err(format!(
            "error: {} runs in one report\n  = help: at most {MOST_RUNS} are told apart",
            folders.len()
        ));
    }
    let file = arguments
        .out
        .clone()
        .unwrap_or_else(|| folders[0].join(default_name(folders)));
    check_target(&file, arguments.force)?;
    let page = page(simulator, folders)?;
    write_page(&file, &page)?;
    Ok(file)
}

/// `report.html`, or `report_with_B.html` of several.
fn default_name(folders: &[PathBuf]) -> String {
    let others = folders
        .iter()
        .skip(1)
        .filter_map(|folder| folder.file_name());
    let others: Vec<String> = others
        .map(|name| name.to_string_lossy().into_owned())
        .collect();
    match others.as_slice() {
        [] => REPORT_FILE.to_owned(),
        others => format!("report_with_{}.html", others.join("_")),
    }
}

/// A report may be made anew; anything else is not written over unasked.
fn check_target(file: &Path, force: bool) -> Result<(), String> {
    let is_ours = || is_page(&fs::read(file).unwrap_or_default());
    if force || !file.exists() || is_ours() {
        return Ok(());
    }
    Err(format!(
        "error: `{}` exists and is not a report\n  = help: name another with `--out`, or overwrite it with `--force`",
        file.display()
    ))
}

fn page(simulator: &Simulator, folders: &[PathBuf]) -> Result<Page, String> {
    let studies = folders
        .iter()
        .filter_map(|folder| Some((folder, Study::of_folder(folder)?)));
    if let Some((folder, study)) = studies.into_iter().next() {
        return match (folders, study) {
            ([_], Study::Campaign) => of_campaign(simulator, folder),
            ([_], Study::DesignSearch) => of_search(folder),
            _ => Err(format!(
                "error: `{}` is the folder of a {}, and a report has one\n  = help: name it alone",
                folder.display(),
                study.word()
            )),
        };
    }
    check_once(folders)?;
    let records = folders
        .iter()
        .map(|folder| Record::read(simulator, folder))
        .collect::<Result<Vec<_>, _>>()
        .map_err(|error| error.to_string())?;
    Ok(run_page(simulator, &with_distinct_labels(records, folders)))
}

/// Refuses a run that is named twice: its lines would lie under each other.
fn check_once(folders: &[PathBuf]) -> Result<(), String> {
    let mut found = Vec::new();
    for folder in folders {
        let place = folder.canonicalize().unwrap_or_else(|_| folder.clone());
        if found.contains(&place) {
            return Err(format!(
                "error: `{}` is named twice\n  = help: a report of several runs lays each over the others",
                folder.display()
            ));
        }
        found.push(place);
    }
    Ok(())
}

/// The page of a design search.
fn of_search(folder: &Path) -> Result<Page, String> {
    let record = SearchRecord::read(folder).map_err(|error| error.to_string())?;
    Ok(search_page(&record))
}

/// The page of a campaign; runs that it has kept get reports of their own.
fn of_campaign(simulator: &Simulator, folder: &Path) -> Result<Page, String> {
    let record = CampaignRecord::read(folder).map_err(|error| error.to_string())?;
    let mut names: Vec<String> = fs::read_dir(folder.join(KEPT))
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    let mut kept = Vec::new();
    for name in names.into_iter().take(MOST_KEPT) {
        write_beside(simulator, &folder.join(KEPT).join(&name))?;
        kept.push((name.clone(), format!("{KEPT}/{name}/{REPORT_FILE}")));
    }
    Ok(campaign_page(&record, &kept))
}

/// Two folders of one name in different places are told apart by their paths.
fn with_distinct_labels(mut records: Vec<Record>, folders: &[PathBuf]) -> Vec<Record> {
    let labels: Vec<String> = records.iter().map(|record| record.label.clone()).collect();
    for (record, folder) in records.iter_mut().zip(folders) {
        if labels
            .iter()
            .filter(|label| **label == record.label)
            .count()
            > 1
        {
            record.label = folder.display().to_string();
        }
    }
    records
}

/// Writes a page whole or not at all.
pub(super) fn write_page(file: &Path, page: &Page) -> Result<(), String> {
    super::finding::write_whole(file, |out| out.write_all(page.html().as_bytes()))
}
