//! A campaign as its folder defines it.

use std::fs;
use std::path::{Path, PathBuf};

use super::CampaignError;
use super::manifest::{INPUT, Manifest, fingerprint_of};
use super::plan::Plan;
use super::plan_tables::read_tables;
use super::preparation::{CAMPAIGN_FILE, SCENE_FILE};
use super::specification::{CampaignSpec, Faults, read_specification};

/// A campaign, ready to run any of its runs. It can be shared by threads.
pub struct Campaign {
    /// Its folder.
    pub folder: PathBuf,
    /// What the folder is of.
    pub manifest: Manifest,
    /// The campaign as written.
    pub specification: CampaignSpec,
    /// The inputs of each run.
    pub plan: Plan,
    /// The scene with what all runs have in common.
    pub(super) scene_text: String,
}

impl Campaign {
    /// Opens a folder.
    ///
    /// # Errors
    /// It is no folder of a campaign, or what it holds is not what it was made of.
    pub fn open(folder: &Path) -> Result<Self, CampaignError> {
        let manifest = Manifest::open(folder)?;
        let input = folder.join(INPUT);
        let mut files = Vec::new();
        for name in &manifest.files {
            let path = input.join(name);
            let text = fs::read_to_string(&path)
                .map_err(|error| CampaignError::unreadable(&path, &error))?;
            files.push((name.clone(), text));
        }
        if fingerprint_of(&files) != manifest.fingerprint {
            let message = format!("the files in `{}` have been changed", input.display());
            let help = "put them back, or make a new campaign of the changed ones";
            return Err(CampaignError::refused(message, help));
        }
        let text_of = |name: &str| {
            let file = files.iter().find(|(file, _)| file == name);
            file.map(|(_, text)| text.clone()).unwrap_or_default()
        };
        let shown = input.join(CAMPAIGN_FILE).display().to_string();
        let (specification, source) = read_specification(&shown, &text_of(CAMPAIGN_FILE))?;
        let mut faults = Faults::default();
        let read = |name: &str| {
            let file = manifest.tables.get(name);
            Ok(file.map(|file| text_of(file)).unwrap_or_default())
        };
        let (tables, _) = read_tables(&specification, &read, &mut faults);
        let plan = Plan::new(&specification, tables, &mut faults);
        faults.into_result(&source)?;
        let scene_text = text_of(SCENE_FILE);
        match plan {
            Some(plan) if plan.runs == manifest.runs => Ok(Self {
                folder: folder.to_owned(),
                manifest,
                specification,
                plan,
                scene_text,
            }),
            _ => {
                let message = format!(
                    "the manifest in `{}` does not fit its input",
                    folder.display()
                );
                Err(CampaignError::refused(message, ""))
            }
        }
    }

    /// How many metrics and envelopes there are.
    #[must_use]
    pub fn counts(&self) -> (usize, usize) {
        let specification = &self.specification;
        (
            specification.metrics.0.len(),
            specification.envelopes.0.len(),
        )
    }

    /// Folder of the inputs, in which tables of the scene are.
    #[must_use]
    pub fn input_folder(&self) -> PathBuf {
        self.folder.join(INPUT)
    }
}
