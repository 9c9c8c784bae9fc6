//! What a search writes: `evaluations.csv`, `summary.json`, and `best.ron`, the best design as `aerobot run` takes it.

use std::fs;
use std::io;

use super::definition::DesignSearch;
use super::searching::SearchOutcome;
use super::summary::{SearchSummary, summarise_search};
use crate::campaign::CampaignError;
use crate::campaign::comma_separated::quoted;
use crate::campaign::paired_table::write_whole;
use crate::plugin::Simulator;
use crate::recording::number::number_text;
use crate::run_folder::scene_as_run;

/// Name of the table of evaluations.
pub const EVALUATIONS_FILE: &str = "evaluations.csv";
/// Name of the summary.
pub const SUMMARY_FILE: &str = "summary.json";
/// Name of the scene of the best design; tables that it reads stand beside it.
pub const BEST_FILE: &str = "best.ron";
/// All of them.
pub(super) const RESULT_FILES: [&str; 3] = [EVALUATIONS_FILE, SUMMARY_FILE, BEST_FILE];

/// Writes everything, each file whole or not at all.
///
/// # Errors
/// What the file system refused; the journal is not touched.
pub fn write_search_results(
    simulator: &Simulator,
    search: &DesignSearch,
    outcome: &SearchOutcome,
) -> Result<SearchSummary, CampaignError> {
    let write = |name: &str, text: &str| {
        let path = search.folder.join(name);
        write_whole(&path, text)
    };
    write(EVALUATIONS_FILE, &evaluation_table(search, outcome))?;
    let best = outcome
        .best
        .and_then(|place| outcome.evaluations.get(place));
    match best {
        Some(best) => {
            let scene = search.scene(simulator, &best.design)?;
            let as_run = scene_as_run(&scene)?;
            for (name, text) in &as_run.tables {
                write(name, text)?;
            }
            write(BEST_FILE, &as_run.text)?;
        }
        // Left from more evaluations.
        None => {
            let path = search.folder.join(BEST_FILE);
            match fs::remove_file(&path) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => {
                    return Err(CampaignError::unwritten(&path, &error));
                }
                _ => {}
            }
        }
    }
    let summary = summarise_search(search, outcome);
    let path = search.folder.join(SUMMARY_FILE);
    let text = serde_json::to_string_pretty(&summary)
        .map_err(|error| CampaignError::unwritten(&path, &error.into()))?;
    write(SUMMARY_FILE, &(text + "\n"))?;
    Ok(summary)
}

/// A row for each design: its number, what the search did, the variables, the fields that follow from those with names
/// of their own, objective and constraints, and whether it is feasible, or why not.
fn evaluation_table(search: &DesignSearch, outcome: &SearchOutcome) -> String {
    let specification = &search.specification;
    let variables = &specification.variables.0;
    let unit = specification.objective.measure().unit(specification);
    let objective = if unit.is_empty() {
        "objective".to_owned()
    } else {
        format!("objective_{unit}")
    };
    let laws = variables.iter().flat_map(|(_, variable)| &variable.sets.0);
    let mut head = vec!["evaluation".to_owned(), "stage".to_owned()];
    head.extend(variables.iter().map(|(name, _)| quoted(name)));
    head.extend(laws.map(|(path, _)| quoted(path)));
    head.push(objective);
    head.extend(
        specification
            .constraints
            .0
            .iter()
            .map(|(name, _)| name.clone()),
    );
    head.extend(["outcome", "reason"].map(str::to_owned));
    let mut text = head.join(",");
    text.push('\n');
    for of in &outcome.evaluations {
        let mut row = vec![of.index.to_string(), of.stage.to_owned()];
        row.extend(of.design.values.iter().map(|value| number_text(*value)));
        let is_variable = |path: &String| variables.iter().any(|(name, _)| name == path);
        let fields = of.design.fields.iter();
        let fields = fields.filter(|(path, _)| !is_variable(path));
        row.extend(fields.map(|(_, value)| quoted(value)));
        match &of.found {
            Ok(found) => {
                row.push(number_text(found.objective));
                row.extend(found.constraints.iter().map(|value| number_text(*value)));
            }
            Err(_) => row.extend(vec![String::new(); specification.constraints.0.len() + 1]),
        }
        let outcome = match (&of.found, of.is_feasible(specification)) {
            (Err(_), _) => "failed",
            (Ok(_), true) => "feasible",
            (Ok(_), false) => "infeasible",
        };
        row.extend([outcome.to_owned(), quoted(&of.reason(specification))]);
        text.push_str(&row.join(","));
        text.push('\n');
    }
    text
}
