//! The folder of a run.

use std::fs;
use std::path::Path;

use aerobot_engine::plugin::Simulator;
use serde::de::DeserializeOwned;

use super::{Record, RecordError, Tables, csv, parquet_file};

impl Record {
    /// Reads the folder of a run; its scene with the components that `simulator` knows.
    ///
    /// # Errors
    /// What is missing or cannot be read.
    pub fn read(simulator: &Simulator, folder: &Path) -> Result<Self, RecordError> {
        for missing in ["scene.ron", "summary.json"] {
            if !folder.join(missing).is_file() {
                return Err(RecordError::NotARun {
                    folder: folder.to_owned(),
                    missing,
                });
            }
        }
        let scene = simulator.load(&folder.join("scene.ron"), &[])?;
        let geometry = simulator.geometry(&scene)?;
        let mut tables = Tables::default();
        if folder.join("states.parquet").is_file() {
            parquet_file::read(folder, &mut tables)?;
        } else {
            csv::read(folder, &mut tables)?;
        }
        let timing = folder.join("timing.json");
        let label = folder.file_name().unwrap_or(folder.as_os_str());
        Ok(Self {
            label: label.to_string_lossy().into_owned(),
            scene,
            geometry,
            summary: read_json(&folder.join("summary.json"))?,
            timing: if timing.is_file() {
                Some(read_json(&timing)?)
            } else {
                None
            },
            tables,
        })
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
