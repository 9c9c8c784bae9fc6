//! `summary.json` of a search, and the same for the terminal.

use std::borrow::Cow;
use std::fmt::Write as _;

use serde::{Deserialize, Serialize};

use super::definition::DesignSearch;
use super::evaluation::Evaluation;
use super::searching::SearchOutcome;
use super::specification::Objective;
use crate::recording::number::number_text;
use crate::recording::summary::VERSION;

/// The summary of a search.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct SearchSummary {
    /// Version of the program.
    pub version: String,
    /// Name of the search.
    pub search: String,
    /// Fingerprint of what it was made of.
    pub fingerprint: String,
    /// Seed of the search.
    pub seed: u64,
    /// Runs of each design.
    pub runs_of_design: u64,
    /// Designs that were evaluated.
    pub evaluations: u64,
    /// Those of them that keep to every constraint.
    pub feasible: u64,
    /// Those of them that were refused, or of which a run stopped or has no value.
    pub failed: u64,
    /// Whether the search came to its end before the most evaluations.
    pub complete: bool,
    /// The best feasible design.
    pub best: Option<DesignSummary>,
    /// Where none is feasible: the one that breaks constraints the least, in parts of how much they differ among all.
    pub least_infeasible: Option<DesignSummary>,
    /// How the result is meant.
    pub notes: Vec<String>,
}

/// A design in a summary.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct DesignSummary {
    /// Number of its evaluation.
    pub evaluation: u64,
    /// The objective.
    pub objective: ObjectiveSummary,
    /// The variables, in the order of the file.
    pub variables: Vec<VariableSummary>,
    /// The fields of the scene that follow from them.
    pub sets: Vec<FieldSummary>,
    /// The constraints, in the order of the file.
    pub constraints: Vec<ConstraintSummary>,
}

/// The objective of a design.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct ObjectiveSummary {
    /// `minimise` or `maximise`.
    pub goal: Cow<'static, str>,
    /// Its value.
    pub value: f64,
    /// Its unit; empty if it has none.
    pub unit: String,
}

/// A variable of a design.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct VariableSummary {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// `lower` or `upper` if it is at a bound.
    pub at_bound: Option<Cow<'static, str>>,
}

/// A field that a design sets.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct FieldSummary {
    /// Its path.
    pub path: String,
    /// Its value, as text of the scene language.
    pub value: String,
}

/// What a design makes of a constraint.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct ConstraintSummary {
    /// Its name.
    pub name: String,
    /// The value.
    pub value: f64,
    /// The largest value that is allowed.
    pub at_most: Option<f64>,
    /// The smallest value that is allowed.
    pub at_least: Option<f64>,
    /// Whether it is kept to.
    pub kept: bool,
}

/// Sums up a search.
#[must_use]
pub fn summarise_search(search: &DesignSearch, outcome: &SearchOutcome) -> SearchSummary {
    let specification = &search.specification;
    let all = &outcome.evaluations;
    let count = |is: &dyn Fn(&&Evaluation) -> bool| all.iter().filter(is).count() as u64;
    let design = |place: Option<usize>| design_summary(search, all.get(place?)?);
    SearchSummary {
        version: VERSION.to_owned(),
        search: specification.name.clone(),
        fingerprint: search.runs.manifest.fingerprint.clone(),
        seed: specification.seed,
        runs_of_design: search.runs_of_design(),
        evaluations: all.len() as u64,
        feasible: count(&|of| of.is_feasible(specification)),
        failed: count(&|of| of.found.is_err()),
        complete: outcome.is_complete,
        best: design(outcome.best),
        least_infeasible: design(outcome.least_infeasible),
        notes: notes(search, outcome),
    }
}

fn design_summary(search: &DesignSearch, of: &Evaluation) -> Option<DesignSummary> {
    let specification = &search.specification;
    let found = of.found.as_ref().ok()?;
    let variables = specification.variables.0.iter().zip(&of.design.values);
    let constraints = specification.constraints.0.iter().zip(&found.constraints);
    Some(DesignSummary {
        evaluation: of.index,
        objective: ObjectiveSummary {
            goal: match specification.objective {
                Objective::Minimise(_) => "minimise".into(),
                Objective::Maximise(_) => "maximise".into(),
            },
            value: found.objective,
            unit: specification.objective.measure().unit(specification),
        },
        variables: variables
            .map(|((name, variable), value)| VariableSummary {
                name: name.clone(),
                value: *value,
                at_bound: if *value == variable.from {
                    Some("lower".into())
                } else if *value == variable.to {
                    Some("upper".into())
                } else {
                    None
                },
            })
            .collect(),
        sets: (of.design.fields.iter())
            .map(|(path, value)| FieldSummary {
                path: path.clone(),
                value: value.clone(),
            })
            .collect(),
        constraints: constraints
            .map(|((name, limit), value)| ConstraintSummary {
                name: name.clone(),
                value: *value,
                at_most: limit.at_most,
                at_least: limit.at_least,
                kept: limit.violation(*value) == 0.0,
            })
            .collect(),
    })
}

fn notes(search: &DesignSearch, outcome: &SearchOutcome) -> Vec<String> {
    let mut notes = vec![
        "The best design is the best of those that were evaluated and keep to every constraint; local searches from \
         several starts do not prove that there is no better one."
            .to_owned(),
    ];
    if !search.specification.is_once() {
        notes.push(
            "All designs have the same runs: the same inputs and seeds. Other seeds shift statistics of few runs, and \
             with them the best design."
                .to_owned(),
        );
    }
    if !outcome.is_complete {
        notes.push(
            "The search ended at the most evaluations; with more of them it goes on from there."
                .to_owned(),
        );
    }
    notes
}

impl SearchSummary {
    /// As lines of text.
    #[must_use]
    pub fn describe(&self) -> String {
        let mut text = String::new();
        let Self {
            evaluations,
            feasible,
            failed,
            runs_of_design,
            ..
        } = self;
        let runs = if *runs_of_design == 1 {
            "1 run".to_owned()
        } else {
            format!("{runs_of_design} runs")
        };
        let _ = writeln!(
            text,
            "{}: {evaluations} designs of {runs} each, {feasible} feasible, {failed} failed",
            self.search
        );
        let end = if self.complete {
            ""
        } else {
            " so far: the search ended at the most evaluations"
        };
        match (&self.best, &self.least_infeasible) {
            (Some(best), _) => {
                let _ = writeln!(text, "best design{end}, evaluation {}:", best.evaluation);
                best.describe(&mut text);
            }
            (None, Some(least)) => {
                let _ = writeln!(
                    text,
                    "no design keeps to every constraint{end}; the least infeasible, evaluation {}:",
                    least.evaluation
                );
                least.describe(&mut text);
            }
            (None, None) => {
                let _ = writeln!(text, "every design failed{end}: `evaluations.csv` says why");
            }
        }
        text
    }
}

impl DesignSummary {
    fn describe(&self, text: &mut String) {
        let objective = &self.objective;
        let mut rows = vec![[
            objective.goal.to_string(),
            format!("{} {}", short(objective.value), objective.unit)
                .trim_end()
                .to_owned(),
            String::new(),
        ]];
        for variable in &self.variables {
            let bound = variable
                .at_bound
                .as_ref()
                .map(|bound| format!("at its {bound} bound"));
            let bound = bound.unwrap_or_default();
            rows.push([variable.name.clone(), short(variable.value), bound]);
        }
        for limit in &self.constraints {
            let most = limit
                .at_most
                .map(|most| format!("at most {}", number_text(most)));
            let least = limit
                .at_least
                .map(|least| format!("at least {}", number_text(least)));
            let limits: Vec<String> = least.into_iter().chain(most).collect();
            let broken = if limit.kept { "" } else { ", BROKEN" };
            let limits = format!("{}{broken}", limits.join(", "));
            rows.push([limit.name.clone(), short(limit.value), limits]);
        }
        let width = |column: usize| rows.iter().map(|row| row[column].len()).max().unwrap_or(0);
        let (first, second) = (width(0), width(1));
        for [name, value, remark] in &rows {
            let line = format!("  {name:first$}  {value:second$}  {remark}");
            let _ = writeln!(text, "{}", line.trim_end());
        }
    }
}

/// With six digits, for reading.
fn short(value: f64) -> String {
    let rounded = format!("{value:.5e}").parse::<f64>();
    number_text(rounded.unwrap_or(value))
}
