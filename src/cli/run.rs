//! `aerobot run`.

use std::io::IsTerminal;
use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

use aerobot_engine::plugin::Simulator;
use aerobot_engine::recording::summary::{Summary, Timing};
use aerobot_engine::recording::table_format::TableFormat;
use aerobot_engine::run_folder::{Destination, run_into_as};
use indicatif::{ProgressBar, ProgressStyle};

use super::report::write_beside;
use super::{FormatName, REFUSED, RunArguments, STOPPED, complain, say};

pub(super) fn run(simulator: &Simulator, arguments: &RunArguments) -> ExitCode {
    let scene = match simulator.load(&arguments.scene, &arguments.overrides.as_overrides()) {
        Ok(scene) => scene,
        Err(error) => {
            complain(error);
            return ExitCode::from(REFUSED);
        }
    };
    let folder = arguments
        .out
        .clone()
        .unwrap_or_else(|| Path::new("runs").join(&scene.name));
    let destination = Destination {
        folder,
        overwrite: arguments.force,
    };
    let bar = progress_bar(scene.run.duration_s, arguments.quiet);
    let format = match arguments.format {
        FormatName::Csv => TableFormat::Csv,
        FormatName::Parquet => TableFormat::Parquet,
    };
    let finished = run_into_as(simulator, &scene, &destination, format, &mut |time_s| {
        bar.set_position(milliseconds(time_s));
    });
    bar.finish_and_clear();
    let finished = match finished {
        Ok(finished) => finished,
        Err(error) => {
            complain(error);
            return ExitCode::from(REFUSED);
        }
    };
    for warning in &finished.summary.warnings {
        complain(format_args!("warning: {warning}"));
    }
    if !arguments.quiet {
        say(line(
            &finished.summary,
            &finished.timing,
            &destination.folder,
        ));
    }
    let mut is_reported = true;
    if arguments.report {
        match write_beside(simulator, &destination.folder) {
            Ok(file) if !arguments.quiet => say(format_args!("report in `{}`", file.display())),
            Ok(_) => {}
            Err(message) => {
                complain(message);
                is_reported = false;
            }
        }
    }
    match &finished.summary.stopped {
        None if is_reported => ExitCode::SUCCESS,
        None => ExitCode::from(STOPPED),
        Some(stop) => {
            complain(format_args!("error: {stop}"));
            complain(format_args!(
                "  = note: what was recorded is in `{}`",
                destination.folder.display()
            ));
            ExitCode::from(STOPPED)
        }
    }
}

fn milliseconds(time_s: f64) -> u64 {
    (time_s * 1e3) as u64
}

/// A bar of simulated time on a terminal, nothing elsewhere.
fn progress_bar(duration_s: f64, quiet: bool) -> ProgressBar {
    if quiet || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(milliseconds(duration_s));
    let style =
        ProgressStyle::with_template("{bar:40} {percent:>3} % of simulated time, {eta} left");
    if let Ok(style) = style {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

/// The one line at the end.
fn line(summary: &Summary, timing: &Timing, folder: &Path) -> String {
    let stable = match (summary.stable_step_s, &summary.stiffest_segment) {
        (Some(step_s), Some(segment)) => format!(", stable step {step_s:.3e} s (`{segment}`)"),
        _ => String::new(),
    };
    // What `Auto` chose.
    let methods = match summary.implicit_steps {
        0 => " (all explicit)".to_owned(),
        implicit if implicit == summary.steps => " (all implicit)".to_owned(),
        implicit => format!(" ({implicit} implicit)"),
    };
    format!(
        "{}: {} s simulated in {:.3} s ({:.0} times real time); {}, {} steps{methods}, {} rejected, \
         {} evaluations{stable}; results in `{}`",
        summary.scene,
        summary.simulated_s,
        timing.wall_s,
        if timing.wall_s > 0.0 {
            summary.simulated_s / timing.wall_s
        } else {
            0.0
        },
        summary.integrator,
        summary.steps,
        summary.rejected_steps,
        summary.evaluations,
        folder.display()
    )
}
