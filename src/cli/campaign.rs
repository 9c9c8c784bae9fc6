//! `aerobot campaign`.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread::available_parallelism;
use std::time::{Duration, Instant};

use aerobot_engine::campaign::definition::Campaign;
use aerobot_engine::campaign::finished_runs::FinishedRuns;
use aerobot_engine::campaign::journal::find_record;
use aerobot_engine::campaign::line_journal::wait_for;
use aerobot_engine::campaign::preparation::prepare;
use aerobot_engine::campaign::record::Record;
use aerobot_engine::campaign::results::write_results;
use aerobot_engine::campaign::running::{Precision, Work, merged, run_shard};
use aerobot_engine::campaign::shards::Shard;
use aerobot_engine::campaign::{CampaignError, manifest::MANIFEST};
use aerobot_engine::plugin::Simulator;
use aerobot_engine::run_folder::Destination;
use clap::{Args, Subcommand};
use indicatif::{ProgressBar, ProgressStyle};

use super::campaign_submit::{SubmitArguments, submit};
use super::{REFUSED, STOPPED, complain, say};

/// Commands on campaigns.
#[derive(Subcommand)]
pub(super) enum CampaignCommand {
    /// Run a campaign, or a shard of a planned one; what is finished already is not run again.
    Run(RunCampaignArguments),
    /// Check a campaign and make its folder, for shards that are run wherever it can be read.
    Plan(PlanArguments),
    /// Submit the missing shards of a planned campaign to a scheduler.
    Submit(SubmitArguments),
    /// Say how far the shards of a campaign are.
    Status(FolderArguments),
    /// Fold the finished shards of a campaign into its results.
    Merge(MergeArguments),
    /// Repeat one run with everything that `aerobot run` writes.
    Replay(ReplayArguments),
}

#[derive(Args)]
pub(super) struct RunCampaignArguments {
    /// The campaign, a RON file, or the folder of a planned one.
    campaign: PathBuf,
    /// Folder for the results of a campaign file; `runs/<name of the campaign>` unless given.
    #[arg(long, value_name = "DIR", conflicts_with = "shard")]
    out: Option<PathBuf>,
    /// The shard to run of a planned campaign: `K/N`, or `auto` from the array variables of a scheduler, or
    /// `auto+M` for M more than they say.
    #[arg(long, value_name = "K/N")]
    shard: Option<String>,
    /// Seconds to wait for another process that is at work on it.
    #[arg(long, value_name = "SECONDS", default_value_t = 0)]
    wait: u64,
    /// Number of threads; all that there are unless given.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    workers: Option<u32>,
    /// Stop when the 95 % interval of the mean of a metric is at most so wide, in the metric's unit.
    #[arg(
        long,
        value_name = "WIDTH",
        requires = "of",
        conflicts_with = "shard",
        allow_negative_numbers = true
    )]
    until_ci: Option<f64>,
    /// The metric of `--until-ci`.
    #[arg(long, value_name = "METRIC", requires = "until_ci")]
    of: Option<String>,
    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
}

#[derive(Args)]
pub(super) struct PlanArguments {
    /// The campaign, a RON file.
    campaign: PathBuf,
    /// The folder to make.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Number of shards.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=99_999))]
    shards: u64,
}

#[derive(Args)]
pub(super) struct FolderArguments {
    /// The folder of the campaign.
    folder: PathBuf,
}

#[derive(Args)]
pub(super) struct MergeArguments {
    /// The folder of the campaign.
    folder: PathBuf,
    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
}

#[derive(Args)]
pub(super) struct ReplayArguments {
    /// The folder of the campaign.
    folder: PathBuf,
    /// Index of the run, from 0.
    #[arg(long, value_name = "INDEX")]
    run: u64,
    /// Folder for the results; `DIR/replays/run-INDEX` unless given.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
}

pub(super) fn campaign(simulator: &Simulator, command: &CampaignCommand) -> ExitCode {
    let done = match command {
        CampaignCommand::Run(arguments) => run(simulator, arguments),
        CampaignCommand::Plan(arguments) => plan(simulator, arguments),
        CampaignCommand::Submit(arguments) => submit(arguments),
        CampaignCommand::Status(arguments) => status(&arguments.folder),
        CampaignCommand::Merge(arguments) => merge(simulator, arguments),
        CampaignCommand::Replay(arguments) => replay(simulator, arguments),
    };
    done.unwrap_or_else(|error| {
        complain(&error);
        ExitCode::from(if error.begun { STOPPED } else { REFUSED })
    })
}

type Done = Result<ExitCode, CampaignError>;

fn run(simulator: &Simulator, arguments: &RunCampaignArguments) -> Done {
    let folder = folder_of(simulator, arguments)?;
    let campaign = Campaign::open(&folder)?;
    let count = campaign.manifest.shards;
    let shard = match &arguments.shard {
        Some(text) => Shard::of_text(text, count, &|name| std::env::var(name).ok())?,
        None if count == 1 => Shard {
            number: 1,
            count: 1,
        },
        None => {
            let message = format!("the campaign in `{}` has {count} shards", folder.display());
            let help = "say which one to run: `--shard K/N`, or `--shard auto` in an array of jobs";
            return Err(CampaignError::refused(message, help));
        }
    };
    let workers = arguments.workers.map_or_else(
        || available_parallelism().map_or(1, usize::from),
        |workers| workers as usize,
    );
    let precision = arguments.until_ci.zip(arguments.of.clone());
    let work = Work {
        workers,
        precision: precision.map(|(width, metric)| Precision { metric, width }),
    };
    wait_for(
        &shard.part_file(&folder),
        Duration::from_secs(arguments.wait),
    )?;
    let (runs, rate) = run_with_bar(simulator, &campaign, shard, &work, arguments.quiet)?;
    if arguments.shard.is_some() {
        if !arguments.quiet {
            let Shard { number, count } = shard;
            say(format_args!("shard {number}/{count}: {runs} runs{rate}"));
        }
        return Ok(ExitCode::SUCCESS);
    }
    let runs = FinishedRuns::read(&campaign, runs)?;
    let summary = write_results(simulator, &campaign, &runs)?;
    if !arguments.quiet {
        let folder = folder.display().to_string();
        say(summary.describe(&folder).trim_end());
        say(format_args!("results in `{folder}`{rate}"));
    }
    Ok(ExitCode::SUCCESS)
}

/// The folder of the campaign, made of its file if that is what was given.
fn folder_of(
    simulator: &Simulator,
    arguments: &RunCampaignArguments,
) -> Result<PathBuf, CampaignError> {
    let given = &arguments.campaign;
    if given.is_dir() {
        if arguments.out.is_some() {
            let message = format!(
                "`{}` is a folder, and has its results in itself",
                given.display()
            );
            return Err(CampaignError::refused(
                message,
                "leave out `--out`, or name the campaign file",
            ));
        }
        return Ok(given.clone());
    }
    if arguments.shard.is_some() && given.exists() {
        let message = format!(
            "`{}` is not the folder of a planned campaign",
            given.display()
        );
        let help = "`aerobot campaign plan FILE --out DIR --shards N` makes one";
        return Err(CampaignError::refused(message, help));
    }
    let prepared = prepare(simulator, given, 1)?;
    let folder = arguments.out.clone();
    let folder = folder.unwrap_or_else(|| Path::new("runs").join(&prepared.manifest.campaign));
    prepared.into_folder(&folder)?;
    Ok(folder)
}

/// Runs a shard with a bar on a terminal; gives how many of its runs count, and how fast they came, in words.
fn run_with_bar(
    simulator: &Simulator,
    campaign: &Campaign,
    shard: Shard,
    work: &Work,
    quiet: bool,
) -> Result<(u64, String), CampaignError> {
    let bar = if quiet || !std::io::stderr().is_terminal() {
        ProgressBar::hidden()
    } else {
        ProgressBar::new(0)
    };
    let template = "{bar:40} {pos} of {len} runs, {per_sec}, {eta} left";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    let started = Instant::now();
    let (mut first, mut last) = (None, 0);
    let done = run_shard(simulator, campaign, shard, work, &mut |finished, total| {
        if first.is_none() {
            bar.set_length(total);
            // The rate is that of this time, not of what was there before.
            bar.set_position(finished);
            bar.reset_eta();
            first = Some(finished);
        }
        bar.set_position(finished);
        last = finished;
    });
    bar.finish_and_clear();
    let new = last - first.unwrap_or(0);
    let wall_s = started.elapsed().as_secs_f64();
    let rate = format!(
        "; {new} of them now in {wall_s:.2} s, {:.0} per second",
        new as f64 / wall_s
    );
    Ok((done?, if new > 0 { rate } else { String::new() }))
}

fn plan(simulator: &Simulator, arguments: &PlanArguments) -> Done {
    let PlanArguments { out, shards, .. } = arguments;
    let prepared = prepare(simulator, &arguments.campaign, *shards)?;
    let runs = prepared.manifest.runs;
    prepared.into_folder(out)?;
    let folder = out.display();
    say(format_args!(
        "{runs} runs in {shards} shards: `{folder}/{MANIFEST}`"
    ));
    say(format_args!(
        "run each with `aerobot campaign run {folder} --shard K/{shards}`, then"
    ));
    say(format_args!("`aerobot campaign merge {folder}`"));
    Ok(ExitCode::SUCCESS)
}

fn status(folder: &Path) -> Done {
    let campaign = Campaign::open(folder)?;
    let all = campaign.status()?;
    for status in &all {
        let Shard { number, count } = status.shard;
        let state = match (status.is_finished, status.finished) {
            (true, _) => "finished",
            (false, 0) => "not begun",
            (false, _) => "begun",
        };
        let (finished, runs, failed) = (status.finished, status.runs, status.failed);
        say(format_args!(
            "shard {number}/{count}: {state}, {finished} of {runs} runs, {failed} failed"
        ));
    }
    let finished: u64 = all.iter().map(|status| status.finished).sum();
    let failed: u64 = all.iter().map(|status| status.failed).sum();
    let missing = all.iter().filter(|status| !status.is_finished).count();
    let runs = campaign.plan.runs;
    say(format_args!(
        "{finished} of {runs} runs, {failed} failed, {missing} shards missing"
    ));
    Ok(ExitCode::SUCCESS)
}

fn merge(simulator: &Simulator, arguments: &MergeArguments) -> Done {
    let campaign = Campaign::open(&arguments.folder)?;
    let runs = merged(&campaign)?;
    let summary = write_results(simulator, &campaign, &runs)?;
    if !arguments.quiet {
        let folder = arguments.folder.display().to_string();
        say(summary.describe(&folder).trim_end());
        say(format_args!("results in `{folder}`"));
    }
    Ok(ExitCode::SUCCESS)
}

fn replay(simulator: &Simulator, arguments: &ReplayArguments) -> Done {
    let campaign = Campaign::open(&arguments.folder)?;
    let index = arguments.run;
    let replays = || {
        arguments
            .folder
            .join("replays")
            .join(format!("run-{index:08}"))
    };
    let destination = Destination {
        folder: arguments.out.clone().unwrap_or_else(replays),
        overwrite: false,
    };
    let (finished, record) = campaign.replay(simulator, index, &destination, &mut |_| {})?;
    let before = recorded(&campaign, index)?;
    if !arguments.quiet {
        let metrics = campaign.specification.metrics.0.iter().zip(&record.metrics);
        for ((name, _), value) in metrics {
            match value {
                Some(value) => say(format_args!("{name} = {value}")),
                None => say(format_args!("{name} =")),
            }
        }
        say(format_args!(
            "run {index}: results in `{}`",
            destination.folder.display()
        ));
    }
    if before.is_some_and(|before| before != record) {
        complain(format_args!(
            "error: run {index} ended in another way than it did in the campaign\n  = help: was it run by another \
             build of the program?"
        ));
        return Ok(ExitCode::from(STOPPED));
    }
    if let Some(stop) = &finished.summary.stopped {
        complain(format_args!("error: {stop}"));
        return Ok(ExitCode::from(STOPPED));
    }
    Ok(ExitCode::SUCCESS)
}

/// The record of a run in the journal of its shard, if it has been run.
fn recorded(campaign: &Campaign, index: u64) -> Result<Option<Record>, CampaignError> {
    let count = campaign.manifest.shards;
    let shard = Shard {
        number: index % count + 1,
        count,
    };
    find_record(campaign, &shard.file(&campaign.folder), index)
}
