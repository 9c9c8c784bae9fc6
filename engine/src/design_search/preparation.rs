//! From the file of a design search to what its folder holds: everything is checked against the scene before a
//! byte is written.

use std::fs;
use std::path::Path;

use super::design::Design;
use super::journal::JOURNAL;
use super::results::RESULT_FILES;
use super::specification::{SearchSpec, read_search};
use super::variable_check::law_path;
use crate::campaign::manifest::Study;
use crate::campaign::preparation::{Checked, Prepared, add, check};
use crate::campaign::specification::{Faults, entry_path};
use crate::plugin::Simulator;
use crate::scene::SceneError;
use crate::scene::source::Source;

/// Name of the search in `input/`.
pub const SEARCH_FILE: &str = "search.ron";

/// Reads the file of a search and everything that it names, and checks it.
///
/// # Errors
/// Everything that is wrong, rendered.
pub fn prepare_search(simulator: &Simulator, file: &Path) -> Result<Prepared, SceneError> {
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
    let prepared = checked.into_prepared(Study::DesignSearch, (SEARCH_FILE, text), &runs, 1)?;
    let taken = |name: &&String| RESULT_FILES.contains(&name.as_str()) || **name == *JOURNAL;
    if let Some(name) = prepared.manifest.files.iter().find(taken) {
        return Err(SceneError::plain(format_args!(
            "a table of the scene is called `{name}`, as a result of the search is: give it another name"
        )));
    }
    Ok(prepared)
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
