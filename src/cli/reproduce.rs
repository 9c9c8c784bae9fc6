//! `aerobot reproduce`.

use std::fs;
use std::path::Path;
use std::process::ExitCode;

use aerobot_engine::plugin::Simulator;
use aerobot_engine::run_folder::RunError;
use aerobot_engine::scene::source::nearest;

use super::progress::PartBar;
use super::{REFUSED, ReproduceArguments, STOPPED, complain, say};
use crate::reproduce::{Case, Settings, cases};

pub(super) fn reproduce(simulator: &Simulator, arguments: &ReproduceArguments) -> ExitCode {
    if arguments.list {
        for case in cases() {
            say(format_args!("{:<12} {}", case.name(), case.about()));
        }
        return ExitCode::SUCCESS;
    }
    let chosen = match choose(arguments.case.as_deref()) {
        Ok(chosen) => chosen,
        Err(message) => {
            complain(message);
            return ExitCode::from(REFUSED);
        }
    };
    let folder = arguments
        .out
        .clone()
        .unwrap_or_else(|| Path::new("runs").join("reproduce"));
    let is_new = !folder.exists();
    if let Err(error) = open(&folder, arguments.force) {
        complain(error);
        return ExitCode::from(REFUSED);
    }
    let settings = Settings {
        nodes: arguments.nodes,
        duration_s: arguments.until,
    };
    let mut worst = ExitCode::SUCCESS;
    let mut written = false;
    for case in chosen {
        match run(simulator, &*case, &settings, &folder, arguments.quiet) {
            Ok(finished) => {
                written = true;
                if !finished {
                    worst = ExitCode::from(STOPPED);
                }
            }
            Err(message) => {
                complain(message);
                if is_new && !written {
                    // Refused means that nothing was written.
                    let _ = fs::remove_dir(&folder);
                }
                return ExitCode::from(REFUSED);
            }
        }
    }
    worst
}

/// The case of a name, or all.
fn choose(name: Option<&str>) -> Result<Vec<Box<dyn Case>>, String> {
    let Some(name) = name else {
        return Ok(cases());
    };
    let mut all = cases();
    if let Some(place) = all.iter().position(|case| case.name() == name) {
        return Ok(vec![all.swap_remove(place)]);
    }
    let help = nearest(name, all.iter().map(|case| case.name())).map_or_else(
        || "`aerobot reproduce --list` shows them".to_owned(),
        |near| format!("did you mean `{near}`?"),
    );
    Err(format!(
        "error: there is no case `{name}`\n  = help: {help}"
    ))
}

/// Makes sure before anything is computed that there is a folder to write into.
fn open(folder: &Path, force: bool) -> Result<(), RunError> {
    if folder.exists() && !force {
        return Err(RunError::Exists(folder.to_owned()));
    }
    fs::create_dir_all(folder).map_err(|error| RunError::Io(folder.to_owned(), error))
}

/// Computes a case, prints its text and writes its tables; whether every run came to its end.
fn run(
    simulator: &Simulator,
    case: &dyn Case,
    settings: &Settings,
    folder: &Path,
    quiet: bool,
) -> Result<bool, String> {
    let bar = PartBar::new(quiet);
    let report = case.run(simulator, settings, &mut |what, part| bar.show(what, part));
    bar.clear();
    let report = report.map_err(|error| error.to_string())?;
    report
        .write(folder)
        .map_err(|error| RunError::Io(folder.to_owned(), error).to_string())?;
    if !quiet {
        say(report.text.trim_end());
        let files: Vec<&str> = report.tables.iter().map(|table| table.file_name).collect();
        say(format_args!(
            "\n{}: wrote {} into `{}`",
            case.name(),
            files.join(", "),
            folder.display()
        ));
    }
    for stopped in &report.stopped {
        complain(format_args!("error: {stopped}"));
    }
    Ok(report.stopped.is_empty())
}
