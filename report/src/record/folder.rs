//! The folder of a run.

use std::fs;
use std::path::Path;

use aerobot_engine::plugin::Simulator;
use aerobot_engine::recording::summary::{Summary, VERSION};
use aerobot_engine::scene::Scene;
use serde::de::DeserializeOwned;

use super::{Record, RecordError, Tables, csv, parquet_file};

impl Record {
    /// Reads the folder of a run; its scene with the components that `simulator` knows. Of a run that was
    /// killed, or is under way, there is what has been written of it.
    ///
    /// # Errors
    /// What is missing or cannot be read.
    pub fn read(simulator: &Simulator, folder: &Path) -> Result<Self, RecordError> {
        let is_there = |name: &str| folder.join(name).is_file();
        let missing = match (is_there("scene.ron"), is_there("states.parquet")) {
            (false, _) => Some("scene.ron"),
            (true, false) if !is_there("states.csv") => Some("states.csv"),
            _ => None,
        };
        if let Some(missing) = missing {
            return Err(RecordError::NotARun {
                folder: folder.to_owned(),
                missing,
            });
        }
        let scene = simulator.load(&folder.join("scene.ron"), &[])?;
        let geometry = simulator.geometry(&scene)?;
        let mut tables = Tables::default();
        let states = match is_there("states.parquet") {
            true if !is_there("summary.json") => {
                return Err(RecordError::Unfinished {
                    folder: folder.to_owned(),
                });
            }
            true => {
                parquet_file::read(folder, &mut tables)?;
                "states.parquet"
            }
            false => {
                csv::read(folder, &mut tables)?;
                "states.csv"
            }
        };
        if let Some(stranger) = stranger(&scene, &tables) {
            return Err(RecordError::Unreadable {
                file: folder.join(states),
                reason: format!("its entity `{stranger}` is not in `scene.ron`"),
            });
        }
        let timing = folder.join("timing.json");
        let label = folder.file_name().unwrap_or(folder.as_os_str());
        Ok(Self {
            label: label.to_string_lossy().into_owned(),
            summary: if is_there("summary.json") {
                read_json(&folder.join("summary.json"))?
            } else {
                unfinished(&scene, &tables)
            },
            scene,
            geometry,
            timing: if timing.is_file() {
                Some(read_json(&timing)?)
            } else {
                None
            },
            tables,
        })
    }
}

/// An entity of the states that the scene does not have; nodes are named after their tether.
fn stranger<'a>(scene: &Scene, tables: &'a Tables) -> Option<&'a str> {
    let is_known = |name: &str| {
        let ends = name.match_indices('/').map(|(place, _)| &name[..place]);
        scene.entity(name).is_some() || ends.into_iter().any(|own| scene.entity(own).is_some())
    };
    let mut names = tables.states.iter().map(|track| track.name.as_str());
    names.find(|name| !is_known(name))
}

/// What can be said of a run that has not come to its end.
fn unfinished(scene: &Scene, tables: &Tables) -> Summary {
    Summary {
        version: VERSION.into(),
        scene: scene.name.clone(),
        seed: scene.run.seed,
        formulation: scene.run.formulation.name().into(),
        integrator: "not known".to_owned(),
        stable_step_s: None,
        stiffest_segment: None,
        steps: 0,
        implicit_steps: 0,
        rejected_steps: 0,
        evaluations: 0,
        simulated_s: tables.span_s().map_or(0.0, |span| span.end),
        outcome: "killed, or under way: there is no summary".into(),
        stopped: None,
        largest_tension: None,
        events: Vec::new(),
        events_dropped: 0,
        final_states: Vec::new(),
        warnings: Vec::new(),
    }
}

fn read_json<T: DeserializeOwned>(file: &Path) -> Result<T, RecordError> {
    let unreadable = |reason: String| RecordError::Unreadable {
        file: file.to_owned(),
        reason,
    };
    let text = fs::read_to_string(file).map_err(|error| unreadable(error.to_string()))?;
    serde_json::from_str(&text).map_err(|error| unreadable(error.to_string()))
}
