//! A run as it was recorded: scene, summary and tables, from its folder or from memory.

mod csv;
mod folder;
mod parquet_file;
mod tables;

use std::path::PathBuf;

use aerobot_engine::geometry::Geometry;
use aerobot_engine::recording::summary::{Summary, Timing};
use aerobot_engine::scene::{Scene, SceneError};
use thiserror::Error;

pub use tables::{ChannelTrack, SegmentTrack, StateTrack, Tables, TetherTrack};

/// A run as it was recorded.
#[derive(Clone)]
pub struct Record {
    /// What readers call it: the name of its folder.
    pub label: String,
    /// The scene as run.
    pub scene: Scene,
    /// Its dimensions.
    pub geometry: Geometry,
    /// What was run and how it ended.
    pub summary: Summary,
    /// What it took, if that is known.
    pub timing: Option<Timing>,
    /// What was recorded.
    pub tables: Tables,
}

/// Why a run cannot be read.
#[derive(Debug, Error)]
pub enum RecordError {
    /// There is no such folder, or it is not one of a run.
    #[error(
        "error: `{folder}` is not the folder of a run: it has no `{missing}`\n  = help: `aerobot run SCENE --out DIR` makes one"
    )]
    NotARun {
        /// The folder.
        folder: PathBuf,
        /// What is missing.
        missing: &'static str,
    },
    /// A run in Parquet that has not come to its end.
    #[error(
        "error: the run in `{folder}` was killed or is under way, and its tables in Parquet can be read once a run is \
         over\n  = help: a run in CSV can be read as far as it got (`--format csv`)"
    )]
    Unfinished {
        /// The folder.
        folder: PathBuf,
    },
    /// A file cannot be read.
    #[error(
        "error: cannot read `{file}`: {reason}\n  = help: it is not as the run wrote it; run the scene again"
    )]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// Why.
        reason: String,
    },
    /// A line of a table is not as a run writes it.
    #[error("error: {file}:{line}: {reason}")]
    Line {
        /// The file.
        file: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// The scene is refused.
    #[error("{0}")]
    Scene(#[from] SceneError),
}
