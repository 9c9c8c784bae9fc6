//! From the file of a design search to what its folder holds: everything is checked against the scene before a
//! byte is written.

use std::fs;
use std::io;
use std::path::Path;

use super::definition::SearchManifest;
use super::design::Design;
use super::journal::JOURNAL;
use super::results::RESULT_FILES;
use super::specification::{SearchSpec, read_search};
use super::variable_check::law_path;
use crate::campaign::CampaignError;
use crate::campaign::manifest::{INPUT, MANIFEST};
use crate::campaign::preparation::{Checked, add, check};
use crate::campaign::specification::{Faults, entry_path};
use crate::plugin::Simulator;
use crate::scene::SceneError;
use crate::scene::source::Source;

/// Name of the search in `input/`.
pub const SEARCH_FILE: &str = "search.ron";

/// A search that is in order, and the files that its folder will hold.
pub struct PreparedSearch {
    /// What the folder is of.
    pub manifest: SearchManifest,
    /// Names and texts of the files in `input/`.
    pub files: Vec<(String, String)>,
}

/// Reads the file of a search and everything that it names, and checks it.
///
/// # Errors
/// Everything that is wrong, rendered.
pub fn prepare_search(simulator: &Simulator, file: &Path) -> Result<PreparedSearch, SceneError> {
    let text = fs::read_to_string(file).map_err(|error| {
        SceneError::plain(format_args!("cannot read `{}`: {error}", file.display()))
    })?;
    let (search, source) = read_search(&file.display().to_string(), &text)?;
    let folder = file.parent().unwrap_or_else(|| Path::new("."));
    let runs = search.as_campaign();
    let checked = check(simulator, folder, &runs, &source)?;
    check_scene(
        simulator,
        (&search, &source),
        &folder.join(&search.scene),
        &checked,
    )?;
    let prepared = checked.into_prepared(SEARCH_FILE, text, &runs, 1)?;
    let taken = |name: &&String| RESULT_FILES.contains(&name.as_str()) || **name == *JOURNAL;
    if let Some(name) = prepared.manifest.files.iter().find(taken) {
        return Err(SceneError::plain(format_args!(
            "a table of the scene is called `{name}`, as a result of the search is: give it another name"
        )));
    }
    Ok(PreparedSearch {
        manifest: SearchManifest {
            design_search: prepared.manifest,
        },
        files: prepared.files,
    })
}

/// A field is in order if the scene takes one of three values along its bounds: designs that make no sense are no
/// fault of the file.
fn check_scene(
    simulator: &Simulator,
    (search, source): (&SearchSpec, &Source),
    scene: &Path,
    checked: &Checked,
) -> Result<(), SceneError> {
    let set: Vec<String> = (search.set.0.iter())
        .map(|(path, value)| format!("{path}={}", value.0))
        .collect();
    let variables = &search.variables.0;
    let designs = [0.5, 0.0, 1.0].map(|part| Design::at(search, &vec![part; variables.len()]));
    let names = variables.iter().flat_map(|(name, variable)| {
        let own = variable.sets.0.is_empty();
        let own = own.then(|| entry_path("variables", name));
        let laws = variable.sets.0.iter().map(|(path, _)| law_path(name, path));
        own.into_iter().chain(laws)
    });
    let mut faults = Faults::default();
    for (number, place) in names.enumerate() {
        let mut refused = None;
        for design in &designs {
            let Some((path, value)) = design.fields.get(number) else {
                continue;
            };
            let change = format!("{path}={value}");
            let changes: Vec<String> = set.iter().cloned().chain([change.clone()]).collect();
            match simulator.load(scene, &changes) {
                Ok(_) => {
                    refused = None;
                    break;
                }
                Err(error) => refused = refused.or(Some((change, error))),
            }
        }
        if let Some((change, error)) = refused {
            add(&mut faults, &place, &change, &error);
        }
    }
    for (path, measure) in search.measures() {
        let report = &mut faults.0;
        report.within(&path, |report| measure.check_scene(&checked.scene, report));
    }
    faults.into_result(source)
}

impl PreparedSearch {
    /// Makes the folder, or makes sure that it is of this search.
    ///
    /// # Errors
    /// The folder holds something else; then nothing was written.
    pub fn into_folder(self, folder: &Path) -> Result<(), CampaignError> {
        let Some(there) = SearchManifest::read(folder)? else {
            let is_free = match fs::read_dir(folder) {
                Ok(mut entries) => entries.next().is_none(),
                Err(_) => !folder.exists(),
            };
            if !is_free {
                let message = format!("`{}` exists, and has no `{MANIFEST}`", folder.display());
                let help = "name another folder with `--out`";
                return Err(CampaignError::refused(message, help));
            }
            return self.create(folder);
        };
        let (there, wanted) = (there.design_search, self.manifest.design_search);
        if there.fingerprint == wanted.fingerprint {
            return Ok(());
        }
        let what = if there.campaign == wanted.campaign {
            "its file, its scene or a table of them has changed since".to_owned()
        } else {
            let (there, wanted) = (there.campaign, wanted.campaign);
            format!("that one is `{there}`, this one `{wanted}`")
        };
        let message = format!("`{}` belongs to another search: {what}", folder.display());
        Err(CampaignError::refused(
            message,
            "name another folder with `--out`",
        ))
    }

    /// Whole or not at all: it is filled beside its place and renamed.
    fn create(self, folder: &Path) -> Result<(), CampaignError> {
        let refused = |error: &io::Error| {
            let message = format!("cannot write `{}`: {error}", folder.display());
            CampaignError::refused(message, "")
        };
        let Some(name) = folder.file_name() else {
            return Err(refused(&io::ErrorKind::InvalidFilename.into()));
        };
        let new = folder.with_file_name(format!(".{}.new", name.to_string_lossy()));
        let filled = self.fill(&new).and_then(|()| fs::rename(&new, folder));
        filled.map_err(|error| {
            let _ = fs::remove_dir_all(&new);
            refused(&error)
        })
    }

    fn fill(&self, folder: &Path) -> io::Result<()> {
        // Left over from a program that was ended here.
        if folder.exists() {
            fs::remove_dir_all(folder)?;
        }
        fs::create_dir_all(folder.join(INPUT))?;
        for (name, text) in &self.files {
            fs::write(folder.join(INPUT).join(name), text)?;
        }
        let mut text = serde_json::to_string_pretty(&self.manifest)?;
        text.push('\n');
        fs::write(folder.join(MANIFEST), text)
    }
}
