//! A campaign as its folder defines it.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use super::CampaignError;
use super::manifest::{INPUT, Manifest, Study, fingerprint_of};
use super::plan::Plan;
use super::plan_tables::read_tables;
use super::preparation::{CAMPAIGN_FILE, SCENE_FILE};
use super::specification::{CampaignSpec, Faults, read_specification};
use crate::scene::source::Source;
use crate::scene::{Scene, SceneError};

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
    pub(crate) scene_text: String,
    /// The scene itself, if nothing but the seed varies: then it is read once.
    pub(super) common_scene: OnceLock<Result<Scene, SceneError>>,
}

impl Campaign {
    /// Opens a folder.
    ///
    /// # Errors
    /// It is no folder of a campaign, or what it holds is not what it was made of.
    pub fn open(folder: &Path) -> Result<Self, CampaignError> {
        let manifest = Manifest::open(folder, Study::Campaign)?;
        let files = read_input(folder, &manifest)?;
        let shown = folder.join(INPUT).join(CAMPAIGN_FILE).display().to_string();
        let (specification, source) = read_specification(&shown, text_of(&files, CAMPAIGN_FILE))?;
        Self::of_input(folder, manifest, (specification, &source), &files)
    }

    /// Of a specification, whose text is `source`, and the files that its folder has in `input/`.
    pub(crate) fn of_input(
        folder: &Path,
        manifest: Manifest,
        (specification, source): (CampaignSpec, &Source),
        files: &[(String, String)],
    ) -> Result<Self, CampaignError> {
        let mut faults = Faults::default();
        let read = |name: &str| {
            let file = manifest.tables.get(name);
            Ok(file.map_or_else(String::new, |file| text_of(files, file).to_owned()))
        };
        let (tables, _) = read_tables(&specification, &read, &mut faults);
        let plan = Plan::new(&specification, tables, &mut faults);
        faults.into_result(source)?;
        let scene_text = text_of(files, SCENE_FILE).to_owned();
        match plan {
            Some(plan) if plan.runs == manifest.runs => Ok(Self {
                folder: folder.to_owned(),
                manifest,
                specification,
                plan,
                scene_text,
                common_scene: OnceLock::new(),
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

/// Names and texts of the files in `input/`, which have to be those of the manifest.
pub(crate) fn read_input(
    folder: &Path,
    manifest: &Manifest,
) -> Result<Vec<(String, String)>, CampaignError> {
    let input = folder.join(INPUT);
    let mut files = Vec::new();
    for name in &manifest.files {
        let path = input.join(name);
        let text =
            fs::read_to_string(&path).map_err(|error| CampaignError::unreadable(&path, &error))?;
        files.push((name.clone(), text));
    }
    if fingerprint_of(&files) != manifest.fingerprint {
        let message = format!("the files in `{}` have been changed", input.display());
        let help = "put them back, or begin anew with the changed ones in another folder";
        return Err(CampaignError::refused(message, help));
    }
    Ok(files)
}

/// The text of a file; empty if there is none.
pub(crate) fn text_of<'a>(files: &'a [(String, String)], name: &str) -> &'a str {
    let file = files.iter().find(|(file, _)| file == name);
    file.map_or("", |(_, text)| text)
}
