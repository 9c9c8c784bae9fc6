//! `aerobot plot`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use aerobot_engine::campaign::manifest::Study;
use aerobot_engine::plugin::Simulator;
use aerobot_engine::scene::source::nearest;
use aerobot_engine::trim::scene_file::check_target;
use aerobot_report::campaign::{CampaignFigure, CampaignRecord, SearchRecord};
use aerobot_report::figure::Figure;
use aerobot_report::figure::thinning::MOST_POINTS;
use aerobot_report::record::Record;
use aerobot_report::{run_figures, table_figures};

use super::finding::write_whole;
use super::{PlotArguments, REFUSED, complain, say};

pub(super) fn plot(simulator: &Simulator, arguments: &PlotArguments) -> ExitCode {
    if arguments.list {
        for (name, about) in kinds() {
            say(format_args!("{name:<16} {about}"));
        }
        return ExitCode::SUCCESS;
    }
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

/// A figure of a design search: its name, what it shows, and what makes it.
type SearchFigure = (&'static str, &'static str, fn(&SearchRecord) -> Figure);

/// The figures of a design search.
const SEARCH: [SearchFigure; 2] = [
    (
        "search",
        "of a design search: the best value so far",
        SearchRecord::search,
    ),
    (
        "search-variables",
        "of a design search: the objective over each variable",
        SearchRecord::variables,
    ),
];

/// Names of all kinds and what they show.
fn kinds() -> Vec<(&'static str, &'static str)> {
    let campaigns = CampaignFigure::ALL.into_iter();
    let campaigns = campaigns.map(|kind| (kind.name(), kind.about()));
    let runs = run_figures::KINDS
        .iter()
        .map(|kind| (kind.name, kind.about));
    let tables = table_figures::KINDS
        .iter()
        .map(|kind| (kind.name, kind.about));
    runs.chain(campaigns)
        .chain(SEARCH.map(|(name, about, _)| (name, about)))
        .chain(tables)
        .collect()
}

fn write(simulator: &Simulator, arguments: &PlotArguments) -> Result<PathBuf, String> {
    let (Some(folder), Some(kind)) = (&arguments.folder, &arguments.kind) else {
        return Err(
            "error: a figure needs a folder and a kind: `aerobot plot DIR KIND`\n  = help: \
                    `aerobot plot --list` shows the kinds"
                .to_owned(),
        );
    };
    let file = arguments
        .out
        .clone()
        .unwrap_or_else(|| folder.join(format!("{kind}.svg")));
    if file.extension().is_none_or(|extension| extension != "svg") {
        return Err(format!(
            "error: `{}` does not end in `.svg`\n  = help: figures are written as SVG; `rsvg-convert` and Inkscape \
             make PNG and PDF of it",
            file.display()
        ));
    }
    let figure = figure(simulator, arguments, folder, kind)?;
    // A drawing of the same folder may be made anew.
    check_target(&file, arguments.force || arguments.out.is_none())
        .map_err(|error| error.to_string())?;
    let svg = figure
        .thinned(MOST_POINTS)
        .svg()
        .map_err(|reason| format!("error: {reason}"))?;
    write_whole(&file, |out| out.write_all(svg.as_bytes()))?;
    Ok(file)
}

fn figure(
    simulator: &Simulator,
    arguments: &PlotArguments,
    folder: &PathBuf,
    kind: &str,
) -> Result<Figure, String> {
    let nothing = |reason: String| {
        format!(
            "error: there is no figure `{kind}` of `{}`: {reason}",
            folder.display()
        )
    };
    let is_of_run = run_figures::RunFigureKind::of(kind).is_some();
    if !arguments.with.is_empty() && !is_of_run && kinds().iter().any(|(name, _)| *name == kind) {
        return Err(format!(
            "error: `--with` lays runs over each other, and `{kind}` is no figure of a run"
        ));
    }
    if let Some(kind) = table_figures::TableFigureKind::of(kind) {
        return kind.figure(folder).map_err(nothing);
    }
    if let Ok(kind) = kind.parse::<CampaignFigure>() {
        let record = CampaignRecord::read(folder).map_err(|error| error.to_string())?;
        return record.figure(kind).map_err(nothing);
    }
    if let Some((_, _, make)) = SEARCH.into_iter().find(|(name, ..)| *name == kind) {
        let record = SearchRecord::read(folder).map_err(|error| error.to_string())?;
        return Ok(make(&record));
    }
    let Some(kind) = run_figures::RunFigureKind::of(kind) else {
        let near = nearest(kind, kinds().into_iter().map(|(name, _)| name));
        let help = near.map_or_else(
            || "`aerobot plot --list` shows them".to_owned(),
            |near| format!("did you mean `{near}`?"),
        );
        return Err(format!(
            "error: there is no kind of figure `{kind}`\n  = help: {help}"
        ));
    };
    let folders = [folder].into_iter().chain(&arguments.with);
    for folder in folders.clone() {
        check_is_run(folder, kind.name)?;
    }
    let records = folders
        .map(|folder| Record::read(simulator, folder))
        .collect::<Result<Vec<_>, _>>()
        .map_err(|error| error.to_string())?;
    let references: Vec<&Record> = records.iter().collect();
    kind.figure(simulator, &references).map_err(nothing)
}

/// Refuses what has figures of its own.
fn check_is_run(folder: &Path, kind: &str) -> Result<(), String> {
    let Some(study) = Study::of_folder(folder) else {
        return Ok(());
    };
    let own: Vec<&str> = match study {
        Study::Campaign => CampaignFigure::ALL.map(CampaignFigure::name).into(),
        Study::DesignSearch => SEARCH.map(|(name, ..)| name).into(),
    };
    Err(format!(
        "error: `{}` is the folder of a {}, and `{kind}` is a figure of a run\n  = help: it has the figures {}",
        folder.display(),
        study.word(),
        own.iter()
            .map(|name| format!("`{name}`"))
            .collect::<Vec<_>>()
            .join(", ")
    ))
}
