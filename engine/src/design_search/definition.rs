//! A design search as its folder defines it.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::design::Design;
use super::preparation::SEARCH_FILE;
use super::specification::{SearchSpec, read_search};
use crate::campaign::CampaignError;
use crate::campaign::definition::{Campaign, read_input, text_of};
use crate::campaign::manifest::{INPUT, LAYOUT, MANIFEST, Manifest};
use crate::campaign::record::Record;
use crate::plugin::Simulator;
use crate::recording::summary::VERSION;
use crate::scene::{Scene, SceneError};

/// `manifest.json` of a design search: what its folder is of.
#[derive(Clone, Debug, Deserialize, PartialEq, Eq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct SearchManifest {
    /// The runs of a design as those of a campaign.
    pub design_search: Manifest,
}

impl SearchManifest {
    /// Reads that of a folder; `None` if there is no such file.
    ///
    /// # Errors
    /// The file is not the manifest of a design search, or one of another layout or version.
    pub fn read(folder: &Path) -> Result<Option<Self>, CampaignError> {
        let path = folder.join(MANIFEST);
        let text = match fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(CampaignError::unreadable(&path, &error)),
        };
        let manifest: Self = serde_json::from_str(&text).map_err(|error| {
            let message = format!(
                "{}:{}:{}: this is not the manifest of a design search: {error}",
                path.display(),
                error.line(),
                error.column()
            );
            CampaignError::refused(message, "name another folder with `--out`")
        })?;
        let found = &manifest.design_search;
        if (found.layout, found.version.as_str()) != (LAYOUT, VERSION) {
            let message = format!(
                "the search in `{}` is of version {}, this is {VERSION}",
                folder.display(),
                found.version
            );
            let help = "finish it with the version that began it, or name another folder";
            return Err(CampaignError::refused(message, help));
        }
        Ok(Some(manifest))
    }
}

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
        let Some(manifest) = SearchManifest::read(folder)? else {
            let message = format!(
                "`{}` is not the folder of a design search: it has no `{MANIFEST}`",
                folder.display()
            );
            return Err(CampaignError::refused(message, ""));
        };
        let manifest = manifest.design_search;
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
