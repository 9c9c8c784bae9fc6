//! `aerobot compare`.

use std::path::Path;
use std::process::ExitCode;

use aerobot_engine::plugin::Simulator;
use aerobot_engine::run_folder::Destination;

use super::comparison_text::describe;
use super::progress::PartBar;
use super::{CompareArguments, REFUSED, STOPPED, complain, say};
use crate::comparison::{CompareError, Comparison, FORMULATIONS, Pair};

pub(super) fn compare(simulator: &Simulator, arguments: &CompareArguments) -> ExitCode {
    let (comparison, destination) = match run(simulator, arguments) {
        Ok(finished) => finished,
        Err(error) => {
            complain(error);
            return ExitCode::from(REFUSED);
        }
    };
    for run in &comparison.runs {
        for warning in &run.summary.warnings {
            complain(format_args!("warning: `{}`: {warning}", run.name));
        }
    }
    if !arguments.quiet {
        say(describe(&comparison).trim_end());
        say(format_args!(
            "\nresults in `{}`",
            destination.folder.display()
        ));
    }
    if comparison.is_complete() {
        return ExitCode::SUCCESS;
    }
    complain_of_stops(&comparison, &destination.folder);
    ExitCode::from(STOPPED)
}

/// Runs both; the comparison and where it went.
fn run(
    simulator: &Simulator,
    arguments: &CompareArguments,
) -> Result<(Comparison, Destination), CompareError> {
    let overrides = arguments.changes.as_overrides();
    let pair = Pair::load(simulator, &arguments.scene, &overrides, FORMULATIONS)?;
    let default_folder = || Path::new("runs").join(format!("{}-comparison", pair.scene_name()));
    let destination = Destination {
        folder: arguments.out.clone().unwrap_or_else(default_folder),
        overwrite: arguments.force,
    };
    let bar = PartBar::new(arguments.quiet);
    let comparison = pair.run_into(&destination, &mut |name, part| bar.show(name, part));
    bar.clear();
    Ok((comparison?, destination))
}

fn complain_of_stops(comparison: &Comparison, folder: &Path) {
    for run in &comparison.runs {
        if let Some(stop) = &run.summary.stopped {
            complain(format_args!("error: `{}` {stop}", run.name));
        }
    }
    if let Some(reason) = &comparison.not_written {
        complain(format_args!(
            "error: the tables cannot be written: {reason}"
        ));
    }
    let until = comparison.compared_until_s().map_or_else(
        || "nothing was compared".to_owned(),
        |time_s| format!("compared up to {time_s} s"),
    );
    complain(format_args!(
        "  = note: {until}; what was recorded is in `{}`",
        folder.display()
    ));
}
