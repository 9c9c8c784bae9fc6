//! `aerobot wind`: its commands and what they take.

use std::path::PathBuf;
use std::process::ExitCode;

use aerobot_engine::plugin::Simulator;
use clap::{Args, Subcommand, ValueEnum};

mod fit;
mod sample;

#[derive(Args)]
pub(super) struct WindArguments {
    #[command(subcommand)]
    command: WindCommand,
}

#[derive(Subcommand)]
enum WindCommand {
    /// Fit a stochastic gust to a measured series, and write it as a scene has it.
    Fit(FitArguments),
    /// Draw the wind of a scene, and set the statistics of its gusts beside the theory.
    Sample(SampleArguments),
}

#[derive(Args)]
struct FitArguments {
    /// The series, a CSV file: `time_s` and a column of velocities, m/s; empty fields are gaps.
    file: PathBuf,
    /// The column of velocities, where there are several.
    #[arg(long, value_name = "NAME")]
    column: Option<String>,
    /// The axis that the gust is written for.
    #[arg(long, value_enum, default_value_t = AxisName::Zonal)]
    axis: AxisName,
    /// The marginal; the likeliest unless given.
    #[arg(long, value_enum)]
    marginal: Option<MarginalName>,
    /// File for the gust.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Overwrite a file that exists.
    #[arg(long)]
    force: bool,
    /// Print nothing but errors and warnings.
    #[arg(long)]
    quiet: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum AxisName {
    /// Along x.
    Zonal,
    /// Along y.
    Meridional,
    /// Along z.
    Vertical,
}

#[derive(Clone, Copy, ValueEnum)]
enum MarginalName {
    /// Normal.
    Normal,
    /// Lognormal; velocities above zero.
    Lognormal,
    /// Weibull; velocities above zero.
    Weibull,
}

#[derive(Args)]
struct SampleArguments {
    /// The scene, a RON file.
    scene: PathBuf,
    /// Override a field of the scene: `--set environment.wind.0.zonal.decay_per_s=0.1`; the value is RON.
    #[arg(long = "set", value_name = "PATH=RON")]
    set: Vec<String>,
    /// Seed of the random draws.
    #[arg(long, allow_negative_numbers = true)]
    seed: Option<u64>,
    /// Length of the realisation, s; that of the run unless given.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    duration: Option<f64>,
    /// Time between rows of the file, s; the finest grid of the gusts unless given.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    every: Option<f64>,
    /// An altitude of the file, m, where the wind depends on it; may be given more than once. The lowest,
    /// the middle and the highest of a gust's altitudes unless given.
    #[arg(long, value_name = "METRES", allow_negative_numbers = true)]
    altitude: Vec<f64>,
    /// CSV file for the realisation.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Overwrite a file that exists.
    #[arg(long)]
    force: bool,
    /// Print nothing but errors and warnings.
    #[arg(long)]
    quiet: bool,
}

pub(super) fn wind(simulator: &Simulator, arguments: &WindArguments) -> ExitCode {
    match &arguments.command {
        WindCommand::Fit(arguments) => fit::fit(arguments),
        WindCommand::Sample(arguments) => sample::sample(simulator, arguments),
    }
}
