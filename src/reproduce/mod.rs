//! The cases of the paper, computed anew: each gives a text to read, tables to plot, and checks against answers
//! that do not come from the program.
//!
//! A program that wants the numbers and not the text calls the module of a case, such as
//! [`towing::compare`].

pub mod chains;
pub mod chase;
pub mod check;
pub mod comparison;
pub mod docking;
pub mod flight;
pub mod mojave;
pub mod pendulums;
pub mod performance;
mod running;
pub mod sail;
pub mod towing;
pub mod yaw;

use std::path::Path;
use std::{fs, io};

use aerobot_engine::plugin::Simulator;
use aerobot_engine::scene::SceneError;
use aerobot_systems::towed_cable::TowedCableError;
use thiserror::Error;

pub use check::{Answer, Check, Independent, Tolerance, Verdict};
pub use running::{Finished, run_cases};

/// A case of the paper.
pub trait Case: Sync {
    /// Its name on the command line, and the beginning of the names of its files.
    fn name(&self) -> &'static str;
    /// What it compares and where that stands in the paper, in one line.
    fn about(&self) -> &'static str;
    /// Whether it measures time, so that nothing else should run beside it.
    fn measures_time(&self) -> bool {
        false
    }
    /// Computes it; `progress` hears of what is under way and of the part of the whole that is done.
    ///
    /// # Errors
    /// Settings that make no sense, or a scene that cannot be built.
    fn run(
        &self,
        simulator: &Simulator,
        settings: &Settings,
        progress: &mut dyn FnMut(&str, f64),
    ) -> Result<Report, ReproduceError>;
}

/// All cases, in the order of the paper.
#[must_use]
pub fn cases() -> Vec<Box<dyn Case>> {
    vec![
        Box::new(comparison::FormulationComparison),
        Box::new(performance::Performance),
        Box::new(chains::Chains),
        Box::new(mojave::Mojave),
        Box::new(yaw::Yaw),
        Box::new(towing::Towing),
        Box::new(sail::SailCase),
        Box::new(chase::Chase),
        Box::new(docking::DockingCase),
    ]
}

/// What may be asked of a case; what is left open is as the case has it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settings {
    /// Number of nodes of each tether.
    pub nodes: Option<u32>,
    /// Simulated time of runs, s.
    pub duration_s: Option<f64>,
}

/// What comes out of a case.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// What the case is and where it stands in the paper, in a line.
    pub title: String,
    /// What the paper shows, in a few sentences.
    pub paper_shows: String,
    /// The text for a reader.
    pub text: String,
    /// What is claimed, and whether it holds; none where the settings leave too little to judge.
    pub checks: Vec<Check>,
    /// What it comes to.
    pub verdict: Verdict,
    /// The tables for other programs.
    pub tables: Vec<Table>,
    /// Runs that stopped before their end, and why.
    pub stopped: Vec<String>,
}

/// A table as text: a CSV file with a header that names units.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table {
    /// Name of the file.
    pub file_name: &'static str,
    /// Its content.
    pub text: String,
}

impl Report {
    /// Writes the tables into a folder that exists.
    ///
    /// # Errors
    /// As the file system.
    pub fn write(&self, folder: &Path) -> io::Result<()> {
        self.tables
            .iter()
            .try_for_each(|table| fs::write(folder.join(table.file_name), &table.text))
    }
}

/// Why a case cannot be computed.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ReproduceError {
    /// A scene is refused.
    #[error("{0}")]
    Scene(#[from] SceneError),
    /// A setting makes no sense.
    #[error("error: {0}")]
    Setting(String),
    /// The static cable has no shape.
    #[error("error: the continuous cable: {0}")]
    Cable(#[from] TowedCableError),
}
