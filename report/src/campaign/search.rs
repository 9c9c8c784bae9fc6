//! A design search as it was finished: its designs, and how its best value came about.

use std::fs;
use std::ops::Range;
use std::path::Path;

use aerobot_engine::campaign::CampaignError;
use aerobot_engine::design_search::results::{EVALUATIONS_FILE, SUMMARY_FILE};
use aerobot_engine::design_search::summary::{DesignSummary, SearchSummary};

use super::tables::Table;

/// A finished design search.
#[derive(Clone, Debug, PartialEq)]
pub struct SearchRecord {
    /// What readers call it: the name of its folder.
    pub label: String,
    /// What it wrote as its summary.
    pub summary: SearchSummary,
    /// The designs, in the order in which they were evaluated.
    pub evaluations: Vec<EvaluatedDesign>,
}

/// A design that was evaluated.
#[derive(Clone, Debug, PartialEq)]
pub struct EvaluatedDesign {
    /// The number of its evaluation.
    pub evaluation: u64,
    /// Its variables, in their order.
    pub variables: Vec<f64>,
    /// Its objective; nothing if it failed.
    pub objective: Option<f64>,
    /// What it makes of the constraints, in their order.
    pub constraints: Vec<Option<f64>>,
    /// Whether it keeps to all of them.
    pub is_feasible: bool,
    /// Why it failed or what it breaks; empty if it is feasible.
    pub reason: String,
}

impl SearchRecord {
    /// Reads the folder of a finished search.
    ///
    /// # Errors
    /// It is not one, all of its designs failed, or what is in it cannot be read.
    pub fn read(folder: &Path) -> Result<Self, CampaignError> {
        for needed in [EVALUATIONS_FILE, SUMMARY_FILE] {
            if !folder.join(needed).is_file() {
                let message = format!(
                    "`{}` is not the folder of a finished design search: it has no `{needed}`",
                    folder.display()
                );
                let help = "`aerobot optimise FILE --out DIR` makes one";
                return Err(CampaignError::refused(message, help));
            }
        }
        let summary = read_summary(&folder.join(SUMMARY_FILE))?;
        let Some(design) = told_design(&summary) else {
            let message = format!("every design of `{}` failed", summary.search);
            return Err(CampaignError::refused(message, ""));
        };
        let label = folder.file_name().unwrap_or(folder.as_os_str());
        let table = Table::open(&folder.join(EVALUATIONS_FILE))?;
        Ok(Self {
            label: label.to_string_lossy().into_owned(),
            evaluations: read_evaluations(table, design)?,
            summary,
        })
    }

    /// The design that the search tells of: the best, or the one that breaks constraints the least.
    #[must_use]
    pub fn design(&self) -> Option<&DesignSummary> {
        told_design(&self.summary)
    }

    /// Whether the objective is to be small.
    #[must_use]
    pub fn minimises(&self) -> bool {
        self.design()
            .is_some_and(|design| design.objective.goal == "minimise")
    }

    /// The best objective of feasible designs so far, at each of them that is better than all before, and at the end.
    #[must_use]
    pub fn best_so_far(&self) -> Vec<(u64, f64)> {
        let minimises = self.minimises();
        let mut found: Vec<(u64, f64)> = Vec::new();
        let feasible = self.evaluations.iter().filter(|design| design.is_feasible);
        for design in feasible {
            let Some(objective) = design.objective else {
                continue;
            };
            let is_better = |best: f64| (objective < best) == minimises && objective != best;
            if found.last().is_none_or(|(_, best)| is_better(*best)) {
                found.push((design.evaluation, objective));
            }
        }
        let end = self.evaluations.last().map(|design| design.evaluation);
        if let (Some(end), Some((last, best))) = (end, found.last().copied())
            && last < end
        {
            found.push((end, best));
        }
        found
    }
}

fn told_design(summary: &SearchSummary) -> Option<&DesignSummary> {
    summary.best.as_ref().or(summary.least_infeasible.as_ref())
}

fn read_summary(file: &Path) -> Result<SearchSummary, CampaignError> {
    let text = fs::read_to_string(file);
    let text = text.map_err(|error| CampaignError::unreadable(file, &error))?;
    serde_json::from_str(&text).map_err(|error| {
        let message = format!(
            "{}:{}:{}: this is not the summary of a design search: {error}",
            file.display(),
            error.line(),
            error.column()
        );
        CampaignError::refused(message, "")
    })
}

fn read_evaluations(
    mut table: Table,
    design: &DesignSummary,
) -> Result<Vec<EvaluatedDesign>, CampaignError> {
    let evaluation = table.column("evaluation")?;
    // After what the search did come the variables; after the objective and the constraints, how it went and why.
    let variables = table.column("stage")? + 1;
    let variables = variables..variables + design.variables.len();
    let outcome = table.column("outcome")?;
    let reason = table.column("reason")?;
    let objective = outcome.checked_sub(design.constraints.len() + 1);
    let Some(objective) = objective.filter(|place| variables.end <= *place) else {
        return Err(table.refuse("columns are missing"));
    };
    let mut found = Vec::new();
    while let Some(row) = table.next()? {
        let numbers = |places: Range<usize>| {
            let texts = row[places].iter();
            texts.map(|text| table.number(text)).collect()
        };
        let mut values: Vec<Option<f64>> = numbers(objective..outcome)?;
        let constraints = values.split_off(1);
        let of_variables: Result<Vec<Option<f64>>, _> = numbers(variables.clone());
        found.push(EvaluatedDesign {
            evaluation: table.whole(&row[evaluation])?,
            variables: of_variables?.into_iter().flatten().collect(),
            objective: values[0],
            constraints,
            is_feasible: row[outcome] == "feasible",
            reason: row[reason].clone(),
        });
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use aerobot_engine::design_search::summary::ObjectiveSummary;

    #[test]
    fn the_best_so_far_is_of_feasible_designs() {
        let objectives = [
            (5.0, true),
            (1.0, false),
            (7.0, true),
            (4.0, true),
            (4.5, true),
        ];
        let designs = objectives.iter().enumerate();
        let mut record = SearchRecord {
            label: String::new(),
            summary: summary("minimise"),
            evaluations: designs
                .map(|(place, (objective, is_feasible))| EvaluatedDesign {
                    evaluation: place as u64,
                    variables: Vec::new(),
                    objective: Some(*objective),
                    constraints: Vec::new(),
                    is_feasible: *is_feasible,
                    reason: String::new(),
                })
                .collect(),
        };
        assert_eq!(record.best_so_far(), [(0, 5.0), (3, 4.0), (4, 4.0)]);
        record.summary = summary("maximise");
        assert_eq!(record.best_so_far(), [(0, 5.0), (2, 7.0), (4, 7.0)]);
        let panel = &record.search().panels[0];
        assert_eq!(panel.y.label, "objective, the more the better [kg]");
        let best = &panel.series[2];
        assert_eq!(best.x, [0.0, 2.0, 2.0, 4.0, 4.0]);
        assert_eq!(best.y, [5.0, 5.0, 7.0, 7.0, 7.0]);
    }

    fn summary(goal: &'static str) -> SearchSummary {
        let design = DesignSummary {
            evaluation: 0,
            objective: ObjectiveSummary {
                goal: goal.into(),
                value: 0.0,
                unit: "kg".to_owned(),
            },
            variables: Vec::new(),
            sets: Vec::new(),
            constraints: Vec::new(),
        };
        SearchSummary {
            version: String::new(),
            search: "lightest".to_owned(),
            fingerprint: String::new(),
            seed: 0,
            runs_of_design: 1,
            evaluations: 5,
            feasible: 4,
            failed: 0,
            complete: true,
            best: Some(design),
            least_infeasible: None,
            notes: Vec::new(),
        }
    }
}
