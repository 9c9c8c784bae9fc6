//! A design search as its folder defines it.

use std::path::{Path, PathBuf};

use super::design::Design;
use super::preparation::SEARCH_FILE;
use super::specification::{SearchSpec, read_search};
use crate::campaign::CampaignError;
use crate::campaign::definition::{Campaign, read_input, text_of};
use crate::campaign::manifest::{INPUT, Manifest, Study};
use crate::campaign::record::Record;
use crate::plugin::Simulator;
use crate::scene::{Scene, SceneError};

/// A design search, ready to evaluate any design. It can be shared by threads.
pub struct DesignSearch {
    /// Its folder.
    pub folder: PathBuf,
    /// The search as written.
    pub specification: SearchSpec,
    /// The runs of a design; its scene has what all designs have in common.
    pub runs: Campaign,
}

impl DesignSearch {
    /// Opens a folder.
    ///
    /// # Errors
    /// It is no folder of a design search, or what it holds is not what it was made of.
    pub fn open(folder: &Path) -> Result<Self, CampaignError> {
        let manifest = Manifest::open(folder, Study::DesignSearch)?;
        let files = read_input(folder, &manifest)?;
        let shown = folder.join(INPUT).join(SEARCH_FILE).display().to_string();
        let (specification, source) = read_search(&shown, text_of(&files, SEARCH_FILE))?;
        let of_runs = (specification.as_campaign(), &source);
        Ok(Self {
            runs: Campaign::of_input(folder, manifest, of_runs, &files)?,
            folder: folder.to_owned(),
            specification,
        })
    }

    /// Number of runs of a design.
    #[must_use]
    pub fn runs_of_design(&self) -> u64 {
        self.runs.plan.runs
    }

    /// Does a run of a design, by its index from 0.
    #[must_use]
    pub fn run(&self, simulator: &Simulator, design: &Design, index: u64) -> Record {
        let mut overrides = design.overrides();
        if !self.specification.is_once() {
            overrides.extend(self.runs.plan.inputs(index).overrides());
        }
        self.runs.run_with(simulator, index, &overrides)
    }

    /// The scene of a design, with the seed that the scene has of its own.
    ///
    /// # Errors
    /// What the scene refuses of it, rendered.
    pub fn scene(&self, simulator: &Simulator, design: &Design) -> Result<Scene, SceneError> {
        self.runs.scene_with(simulator, &design.overrides())
    }
}
