//! A design search as it was finished: how its best value came about.

use std::fs;
use std::path::Path;

use aerobot_engine::campaign::CampaignError;
use aerobot_engine::campaign::quantity::{unit_of, unit_symbol};
use aerobot_engine::design_search::results::{EVALUATIONS_FILE, SUMMARY_FILE};
use serde::Deserialize;

use super::figures::axis_label;
use super::tables::Table;
use crate::figure::{Axis, Figure, Mark, Panel, Series};

/// A finished design search.
#[derive(Clone, Debug, PartialEq)]
pub struct SearchRecord {
    /// What readers call it: the name of its folder.
    pub label: String,
    /// Its name.
    pub name: String,
    /// Whether the objective is to be small.
    pub minimises: bool,
    /// Unit of the objective, as it stands at the end of names.
    pub unit: String,
    /// Limits of the constraints.
    pub limits: Vec<Limit>,
    /// The designs, in the order in which they were evaluated.
    pub evaluations: Vec<EvaluatedDesign>,
}

/// A constraint of a search.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Limit {
    /// Its name, which ends with its unit.
    pub name: String,
    /// The largest value that is allowed.
    pub at_most: Option<f64>,
    /// The smallest value that is allowed.
    pub at_least: Option<f64>,
}

/// A design that was evaluated.
#[derive(Clone, Debug, PartialEq)]
pub struct EvaluatedDesign {
    /// The number of its evaluation.
    pub evaluation: u64,
    /// Its objective; nothing if it failed.
    pub objective: Option<f64>,
    /// What it makes of the constraints, in their order.
    pub constraints: Vec<Option<f64>>,
    /// Whether it keeps to all of them.
    pub is_feasible: bool,
}

/// What is read of `summary.json`.
#[derive(Deserialize)]
struct Summary {
    search: String,
    best: Option<Design>,
    least_infeasible: Option<Design>,
}

#[derive(Deserialize)]
struct Design {
    objective: Objective,
    constraints: Vec<Limit>,
}

#[derive(Deserialize)]
struct Objective {
    goal: String,
    unit: String,
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
        let Some(design) = summary.best.or(summary.least_infeasible) else {
            let message = format!("every design of `{}` failed", summary.search);
            return Err(CampaignError::refused(message, ""));
        };
        let label = folder.file_name().unwrap_or(folder.as_os_str());
        let table = Table::open(&folder.join(EVALUATIONS_FILE))?;
        Ok(Self {
            label: label.to_string_lossy().into_owned(),
            name: summary.search,
            minimises: design.objective.goal == "minimise",
            unit: design.objective.unit,
            evaluations: read_evaluations(table, &design.constraints)?,
            limits: design.constraints,
        })
    }

    /// The best objective of feasible designs so far, at each of them that is better than all before, and at the end.
    #[must_use]
    pub fn best_so_far(&self) -> Vec<(u64, f64)> {
        let mut found: Vec<(u64, f64)> = Vec::new();
        let feasible = self.evaluations.iter().filter(|design| design.is_feasible);
        for design in feasible {
            let Some(objective) = design.objective else {
                continue;
            };
            let is_better = |best: f64| (objective < best) == self.minimises && objective != best;
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

    /// The figure `search`: objective and constraints of every design, and the best so far.
    #[must_use]
    pub fn figure(&self) -> Figure {
        let objective = |design: &EvaluatedDesign| design.objective;
        let mut series = self.points(&objective);
        series.push(Series::line("best so far", steps(&self.best_so_far())).with_tone(2));
        let goal = match self.minimises {
            true => "objective, the less the better",
            false => "objective, the more the better",
        };
        let label = match self.unit.as_str() {
            "" => goal.to_owned(),
            unit => format!("{goal} [{}]", unit_symbol(unit)),
        };
        let mut panels = vec![panel(label, series)];
        for (place, limit) in self.limits.iter().enumerate() {
            let value = |design: &EvaluatedDesign| design.constraints.get(place).copied()?;
            let mut series = self.points(&value);
            let end = self
                .evaluations
                .last()
                .map_or(0.0, |last| last.evaluation as f64);
            for at in limit.at_least.iter().chain(&limit.at_most) {
                series.push(Series::line("limit", [(0.0, *at), (end, *at)]).with_tone(2));
            }
            panels.push(panel(axis_label(&limit.name, unit_of(&limit.name)), series));
        }
        Figure {
            name: "search".to_owned(),
            title: format!("{}: the search for the best design", self.name),
            caption: "Every design in the order of the search; those that failed have no value."
                .to_owned(),
            panels,
        }
    }

    /// A value of feasible designs, and of others.
    fn points(&self, value: &dyn Fn(&EvaluatedDesign) -> Option<f64>) -> Vec<Series> {
        let of = |name: &str, is_feasible: bool, tone: usize| {
            let designs = self.evaluations.iter();
            let designs = designs.filter(move |design| design.is_feasible == is_feasible);
            let points = designs.filter_map(|of| Some((of.evaluation as f64, value(of)?)));
            Series::line(name, points)
                .with_mark(Mark::Points)
                .with_tone(tone)
        };
        vec![of("infeasible", false, 1), of("feasible", true, 0)]
    }
}

fn panel(label: String, series: Vec<Series>) -> Panel {
    Panel {
        x: Axis::new("evaluation"),
        y: Axis::new(label),
        series,
        ..Panel::default()
    }
}

/// A value that stays until the next comes.
fn steps(values: &[(u64, f64)]) -> Vec<(f64, f64)> {
    let mut found = Vec::new();
    for (evaluation, value) in values {
        let x = *evaluation as f64;
        if let Some((_, before)) = found.last().copied() {
            found.push((x, before));
        }
        found.push((x, *value));
    }
    found
}

fn read_summary(file: &Path) -> Result<Summary, CampaignError> {
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
    limits: &[Limit],
) -> Result<Vec<EvaluatedDesign>, CampaignError> {
    let evaluation = table.column("evaluation")?;
    // After the objective and the constraints come how it went and why.
    let outcome = table.column("outcome")?;
    let Some(objective) = outcome.checked_sub(limits.len() + 1) else {
        return Err(table.refuse("columns are missing"));
    };
    let mut found = Vec::new();
    while let Some(row) = table.next()? {
        let numbers = row[objective..outcome].iter();
        let numbers = numbers.map(|text| table.number(text));
        let mut numbers = numbers.collect::<Result<Vec<_>, _>>()?;
        let constraints = numbers.split_off(1);
        found.push(EvaluatedDesign {
            evaluation: table.whole(&row[evaluation])?,
            objective: numbers[0],
            constraints,
            is_feasible: row[outcome] == "feasible",
        });
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

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
            name: "lightest".to_owned(),
            minimises: true,
            unit: "kg".to_owned(),
            limits: Vec::new(),
            evaluations: designs
                .map(|(place, (objective, is_feasible))| EvaluatedDesign {
                    evaluation: place as u64,
                    objective: Some(*objective),
                    constraints: Vec::new(),
                    is_feasible: *is_feasible,
                })
                .collect(),
        };
        assert_eq!(record.best_so_far(), [(0, 5.0), (3, 4.0), (4, 4.0)]);
        record.minimises = false;
        assert_eq!(record.best_so_far(), [(0, 5.0), (2, 7.0), (4, 7.0)]);
        let panel = &record.figure().panels[0];
        assert_eq!(panel.y.label, "objective, the more the better [kg]");
        let best = &panel.series[2];
        assert_eq!(best.x, [0.0, 2.0, 2.0, 4.0, 4.0]);
        assert_eq!(best.y, [5.0, 5.0, 7.0, 7.0, 7.0]);
    }
}
