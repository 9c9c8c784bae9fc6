//! What commands share that build a scene, find something about it, print that and may write it to a file.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use aerobot_engine::plugin::Simulator;
use aerobot_engine::scene::Scene;
use aerobot_engine::simulation::Simulation;
use aerobot_engine::trim::scene_file::check_target;

use super::{FindArguments, REFUSED, complain, say};

/// Loads and builds the scene; refused where the file to be written must not be.
///
/// # Errors
/// The message for the user.
pub(super) fn build(
    simulator: &Simulator,
    arguments: &FindArguments,
    out: Option<&Path>,
) -> Result<(Scene, Simulation), String> {
    if let Some(file) = out {
        check_target(file, arguments.force).map_err(|error| error.to_string())?;
    }
    let scene = simulator
        .load(&arguments.scene, &arguments.overrides.as_overrides())
        .map_err(|error| error.to_string())?;
    let simulation = simulator.build(&scene).map_err(|error| error.to_string())?;
    Ok((scene, simulation))
}

/// What was found, for the user.
pub(super) struct Found {
    pub(super) warnings: Vec<String>,
    pub(super) text: String,
    /// What the file is that was written.
    pub(super) written: &'static str,
}

/// Prints what was found, or why nothing was.
pub(super) fn tell(
    found: Result<Found, String>,
    arguments: &FindArguments,
    out: Option<&Path>,
) -> ExitCode {
    tell_found(found, arguments.quiet, out)
}

/// The same for a command with arguments of its own.
pub(super) fn tell_found(
    found: Result<Found, String>,
    quiet: bool,
    out: Option<&Path>,
) -> ExitCode {
    match found {
        Ok(found) => {
            for warning in &found.warnings {
                complain(format_args!("warning: {warning}"));
            }
            if !quiet {
                say(found.text.trim_end());
                if let Some(file) = out {
                    say(format_args!("{}: `{}`", found.written, file.display()));
                }
            }
            ExitCode::SUCCESS
        }
        Err(message) => {
            complain(message);
            ExitCode::from(REFUSED)
        }
    }
}

/// Writes a file whole or not at all.
///
/// # Errors
/// The message for the user.
pub(super) fn write_whole(
    file: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), String> {
    let mut part = file.as_os_str().to_owned();
    part.push(".part");
    let part = PathBuf::from(part);
    File::create(&part)
        .and_then(|mut out| write(&mut out))
        .and_then(|()| fs::rename(&part, file))
        .map_err(|error| {
            let _ = fs::remove_file(&part);
            format!("error: cannot write `{}`: {error}", file.display())
        })
}
