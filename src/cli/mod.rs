//! The commands: arguments in, messages and an exit code out.
//!
//! Exit codes: 0 done, 2 refused (nothing written), 3 stopped, or nothing found that keeps to the constraints
//! (what was recorded is kept).

mod campaign;
mod campaign_submit;
mod check;
mod compare;
mod comparison_text;
mod export;
mod finding;
mod modes;
mod optimise;
mod plot;
mod progress;
mod report;
mod reproduce;
mod run;
mod trim;
mod wind;

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use aerobot_engine::plugin::{Plugin, Simulator};
use clap::{Args, Parser, Subcommand, ValueEnum};

/// Nothing was run.
const REFUSED: u8 = 2;
/// The run stopped before its end.
const STOPPED: u8 = 3;

/// A flight simulator for tethered balloon systems in the atmosphere of Venus.
#[derive(Parser)]
#[command(name = "aerobot", version)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Run a scene and write its results into a folder.
    Run(RunArguments),
    /// Check scenes and print what they contain, without running them.
    Check(CheckArguments),
    /// Run a scene in both formulations and print how far apart they are and what each costs.
    Compare(CompareArguments),
    /// Write a report of a finished run, or of several beside each other: one HTML file that plays and plots.
    Report(ReportArguments),
    /// Draw a figure of a finished run as SVG.
    Plot(PlotArguments),
    /// Compute cases of the paper anew and set them beside what it shows.
    Reproduce(ReproduceArguments),
    /// Find the steady state of a scene in its wind, and write a scene that starts there.
    Trim(TrimArguments),
    /// Find the modes of small motions about the steady state: frequencies, damping, and who moves how.
    Modes(ModesArguments),
    /// Fit stochastic gusts to measured winds, and draw them.
    Wind(wind::WindArguments),
    /// Run a scene many times with inputs that vary, here or in shards, and fold what comes out.
    #[command(subcommand)]
    Campaign(campaign::CampaignCommand),
    /// Find the best values of fields of a scene within bounds and constraints.
    Optimise(optimise::OptimiseArguments),
    /// Write how a run moved for other programs: glTF, VTK.
    Export(export::ExportArguments),
}

/// What every command that reads a scene takes.
#[derive(Args)]
struct SceneArguments {
    #[command(flatten)]
    changes: ChangeArguments,
    /// Formulation of the tethers' dynamics.
    #[arg(long, value_enum)]
    formulation: Option<FormulationName>,
}

/// Changes of a scene, whatever its formulation.
#[derive(Args)]
struct ChangeArguments {
    /// Override a field of the scene: `--set entities.tether.Tether.nodes=20`; the value is RON.
    #[arg(long = "set", value_name = "PATH=RON")]
    set: Vec<String>,
    /// Seed of the random draws.
    #[arg(long, allow_negative_numbers = true)]
    seed: Option<u64>,
    /// Simulated time at which to end, s.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    until: Option<f64>,
}

#[derive(Clone, Copy, ValueEnum)]
enum FormulationName {
    /// Point masses joined by springs and dampers.
    LumpedMass,
    /// Chains of rigid links.
    Denoc,
}

#[derive(Clone, Copy, ValueEnum)]
enum FormatName {
    /// Text, row by row as the run goes.
    Csv,
    /// Apache Parquet, typed, complete at the end of the run.
    Parquet,
}

#[derive(Args)]
struct RunArguments {
    /// The scene, a RON file.
    scene: PathBuf,
    #[command(flatten)]
    overrides: SceneArguments,
    /// Folder for the results; `runs/<name of the scene>` unless given.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Format of the tables.
    #[arg(long, value_enum, default_value = "csv")]
    format: FormatName,
    /// Write `report.html` beside the results.
    #[arg(long)]
    report: bool,
    /// Write into a folder that exists.
    #[arg(long)]
    force: bool,
    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
}

#[derive(Args)]
struct ReportArguments {
    /// Folders of runs, or that of a campaign or of a design search.
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// File for the report; `report.html` in the first folder unless given.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Overwrite a file that exists and is not a report.
    #[arg(long)]
    force: bool,
    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
}

#[derive(Args)]
struct PlotArguments {
    /// Folder of the run, of the campaign, of the design search, or of a table.
    #[arg(value_name = "DIR")]
    folder: Option<PathBuf>,
    /// What to draw.
    kind: Option<String>,
    /// List the kinds of figures and do nothing else.
    #[arg(long, conflicts_with_all = ["folder", "kind", "with", "out"])]
    list: bool,
    /// Folder of another run whose lines are drawn beside those of the first.
    #[arg(long, value_name = "DIR")]
    with: Vec<PathBuf>,
    /// File for the figure; `KIND.svg` in the folder unless given.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Overwrite the file of `--out` if it exists; `KIND.svg` is made anew in any case.
    #[arg(long)]
    force: bool,
    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
}

#[derive(Args)]
struct CheckArguments {
    /// The scenes, RON files.
    #[arg(required = true)]
    scenes: Vec<PathBuf>,
    #[command(flatten)]
    overrides: SceneArguments,
}

#[derive(Args)]
struct CompareArguments {
    /// The scene, a RON file.
    scene: PathBuf,
    #[command(flatten)]
    changes: ChangeArguments,
    /// Folder for the results; `runs/<name of the scene>-comparison` unless given.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write into a folder that exists.
    #[arg(long)]
    force: bool,
    /// Print nothing but errors and warnings.
    #[arg(long)]
    quiet: bool,
}

#[derive(Args)]
struct ReproduceArguments {
    /// The case; all of them unless given.
    case: Option<String>,
    /// List the cases and do nothing else.
    #[arg(long)]
    list: bool,
    /// Folder for the tables; `runs/reproduce` unless given.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write into a folder that exists.
    #[arg(long)]
    force: bool,
    /// Number of nodes of each tether, the largest where a case goes through many; the case's own
    /// unless given.
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    nodes: Option<u32>,
    /// Simulated time at which runs end, s; the case's own unless given.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    until: Option<f64>,
    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
}

/// What commands take that find something about a scene, and may write it to a file.
#[derive(Args)]
struct FindArguments {
    /// The scene, a RON file.
    scene: PathBuf,
    #[command(flatten)]
    overrides: SceneArguments,
    /// Overwrite a file that exists.
    #[arg(long)]
    force: bool,
    /// Print nothing but errors and warnings.
    #[arg(long)]
    quiet: bool,
}

#[derive(Args)]
struct TrimArguments {
    #[command(flatten)]
    find: FindArguments,
    /// File for the scene that starts in its steady state.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

#[derive(Args)]
struct ModesArguments {
    #[command(flatten)]
    find: FindArguments,
    /// Number of modes, the slowest first.
    #[arg(long, value_name = "K", default_value_t = 12, value_parser = clap::value_parser!(u32).range(1..=1000))]
    count: u32,
    /// CSV file for all numbers.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

impl SceneArguments {
    /// All overrides as `PATH=RON`, those of `--set` first.
    fn as_overrides(&self) -> Vec<String> {
        let mut overrides = self.changes.as_overrides();
        if let Some(formulation) = self.formulation {
            let name = match formulation {
                FormulationName::LumpedMass => "LumpedMass",
                FormulationName::Denoc => "Denoc",
            };
            overrides.push(format!("run.formulation={name}"));
        }
        overrides
    }
}

impl ChangeArguments {
    /// All overrides as `PATH=RON`, those of `--set` first.
    fn as_overrides(&self) -> Vec<String> {
        let mut overrides = self.set.clone();
        overrides.extend(self.seed.map(|seed| format!("run.seed={seed}")));
        overrides.extend(self.until.map(|until| format!("run.duration_s={until:?}")));
        overrides
    }
}

/// Prints a line, if anyone listens: a closed pipe is no reason to fail.
fn say(line: impl std::fmt::Display) {
    let _ = writeln!(std::io::stdout(), "{line}");
}

/// Prints a line to stderr, if anyone listens.
fn complain(line: impl std::fmt::Display) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

/// Runs the command line with plugins beside the built-in ones.
#[must_use]
pub fn main(plugins: &[&dyn Plugin]) -> ExitCode {
    let arguments = Arguments::parse();
    let mut simulator = Simulator::new();
    for plugin in plugins {
        simulator.add_plugin(*plugin);
    }
    match arguments.command {
        Command::Run(arguments) => run::run(&simulator, &arguments),
        Command::Check(arguments) => check::check(&simulator, &arguments),
        Command::Compare(arguments) => compare::compare(&simulator, &arguments),
        Command::Report(arguments) => report::report(&simulator, &arguments),
        Command::Plot(arguments) => plot::plot(&simulator, &arguments),
        Command::Reproduce(arguments) => reproduce::reproduce(&simulator, &arguments),
        Command::Trim(arguments) => trim::trim(&simulator, &arguments),
        Command::Modes(arguments) => modes::modes(&simulator, &arguments),
        Command::Wind(arguments) => wind::wind(&simulator, &arguments),
        Command::Campaign(command) => campaign::campaign(&simulator, &command),
        Command::Optimise(arguments) => optimise::optimise(&simulator, &arguments),
        Command::Export(arguments) => export::export(&simulator, &arguments),
    }
}
