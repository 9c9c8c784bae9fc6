//! `aerobot optimise`.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread::available_parallelism;
use std::time::Instant;

use aerobot_engine::campaign::CampaignError;
use aerobot_engine::design_search::definition::DesignSearch;
use aerobot_engine::design_search::preparation::prepare_search;
use aerobot_engine::design_search::results::{BEST_FILE, write_search_results};
use aerobot_engine::design_search::searching::{SearchOutcome, SearchWork, search_designs};
use aerobot_engine::plugin::Simulator;
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};

use super::{REFUSED, STOPPED, complain, say};

#[derive(Args)]
pub(super) struct OptimiseArguments {
    /// The design search, a RON file, or the folder of one that was begun.
    search: PathBuf,
    /// Folder for the results; `runs/<name of the search>` unless given.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Number of threads; all that there are unless given.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    workers: Option<u32>,
    /// The most designs to evaluate, those that were evaluated before among them; as the file says unless given.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    evaluations: Option<u64>,
    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
}

pub(super) fn optimise(simulator: &Simulator, arguments: &OptimiseArguments) -> ExitCode {
    search(simulator, arguments).unwrap_or_else(|error| {
        complain(&error);
        ExitCode::from(if error.begun { STOPPED } else { REFUSED })
    })
}

fn search(simulator: &Simulator, arguments: &OptimiseArguments) -> Result<ExitCode, CampaignError> {
    let folder = folder_of(simulator, arguments)?;
    let search = DesignSearch::open(&folder)?;
    let (outcome, rate) = search_with_bar(simulator, &search, arguments)?;
    let summary = write_search_results(simulator, &search, &outcome)?;
    let is_found = summary.best.is_some();
    if !arguments.quiet {
        say(summary.describe().trim_end());
        let folder = folder.display();
        if is_found {
            say(format_args!("`aerobot run {folder}/{BEST_FILE}` runs it"));
        }
        say(format_args!("results in `{folder}`{rate}"));
    }
    if is_found {
        return Ok(ExitCode::SUCCESS);
    }
    complain("error: no design keeps to every constraint");
    Ok(ExitCode::from(STOPPED))
}

/// The folder of the search, made of its file if that is what was given.
fn folder_of(
    simulator: &Simulator,
    arguments: &OptimiseArguments,
) -> Result<PathBuf, CampaignError> {
    let given = &arguments.search;
    if given.is_dir() {
        if arguments.out.is_some() {
            let message = format!(
                "`{}` is a folder, and has its results in itself",
                given.display()
            );
            let help = "leave out `--out`, or name the file of the search";
            return Err(CampaignError::refused(message, help));
        }
        return Ok(given.clone());
    }
    let prepared = prepare_search(simulator, given)?;
    let folder = arguments.out.clone();
    let name = &prepared.manifest.campaign;
    let folder = folder.unwrap_or_else(|| Path::new("runs").join(name));
    prepared.into_folder(&folder)?;
    Ok(folder)
}

/// Searches with a bar on a terminal; gives what was found and how fast runs came, in words.
fn search_with_bar(
    simulator: &Simulator,
    search: &DesignSearch,
    arguments: &OptimiseArguments,
) -> Result<(SearchOutcome, String), CampaignError> {
    let bar = if arguments.quiet || !std::io::stderr().is_terminal() {
        ProgressBar::hidden()
    } else {
        ProgressBar::new(0)
    };
    if let Ok(style) =
        ProgressStyle::with_template("{bar:40} {pos} of at most {len} designs, {msg}")
    {
        bar.set_style(style);
    }
    let workers = arguments.workers.map_or_else(
        || available_parallelism().map_or(1, usize::from),
        |workers| workers as usize,
    );
    let work = SearchWork {
        workers,
        evaluations: arguments.evaluations,
    };
    let started = Instant::now();
    let mut new_runs = 0;
    let outcome = search_designs(simulator, search, work, &mut |progress| {
        bar.set_length(progress.most);
        bar.set_position(progress.evaluations);
        bar.set_message(progress.best.map_or_else(
            || format!("{} runs, none feasible yet", progress.new_runs),
            |best| format!("{} runs, best {best:.6}", progress.new_runs),
        ));
        new_runs = progress.new_runs;
    });
    bar.finish_and_clear();
    let wall_s = started.elapsed().as_secs_f64();
    let rate = format!(
        "; {new_runs} runs now in {wall_s:.2} s, {:.0} per second",
        new_runs as f64 / wall_s
    );
    Ok((outcome?, if new_runs > 0 { rate } else { String::new() }))
}
