//! `aerobot check`.

use std::path::Path;
use std::process::ExitCode;

use aerobot_engine::plugin::Simulator;
use aerobot_engine::scene::SceneError;

use super::{CheckArguments, REFUSED, complain, say};

pub(super) fn check(simulator: &Simulator, arguments: &CheckArguments) -> ExitCode {
    let overrides = arguments.overrides.as_overrides();
    let mut refused = false;
    for scene in &arguments.scenes {
        match describe(simulator, scene, &overrides) {
            Ok(text) => say(text.trim_end()),
            Err(error) => {
                complain(error);
                refused = true;
            }
        }
    }
    if refused {
        ExitCode::from(REFUSED)
    } else {
        ExitCode::SUCCESS
    }
}

/// Loads and builds a scene, and says what it contains.
fn describe(
    simulator: &Simulator,
    file: &Path,
    overrides: &[String],
) -> Result<String, SceneError> {
    let scene = simulator.load(file, overrides)?;
    let mut simulation = simulator.build(&scene)?;
    let mut text = format!("{}: {}\n", scene.name, scene.about);
    for line in simulation.contents(&scene) {
        text.push_str(&format!("  {line}\n"));
    }
    Ok(text)
}
