//! The page of a design search: what was asked, the best design, how the search came to it, and what failed.

use aerobot_engine::design_search::summary::{ConstraintSummary, DesignSummary};
use aerobot_engine::recording::number::number_text;

use super::{Block, Page, Row, Section, TextTable};
use crate::campaign::{EvaluatedDesign, SearchRecord};

/// Failures that are listed one by one.
const MOST_FAILURES: usize = 100;

/// The page of a finished search.
#[must_use]
pub fn search_page(record: &SearchRecord) -> Page {
    let summary = &record.summary;
    let mut sections = vec![Section::new("What was searched", facts(record))];
    for (title, design) in [
        ("The best design", &summary.best),
        (
            "No design keeps to every constraint; the nearest to it",
            &summary.least_infeasible,
        ),
    ] {
        if let Some(design) = design {
            sections.push(Section::new(title, of_design(design)));
        }
    }
    sections.push(Section::new(
        "How it was found",
        vec![
            Block::Figure(Box::new(record.search())),
            Block::Figure(Box::new(record.variables())),
        ],
    ));
    sections.push(Section::new("What failed", failures(record)));
    Page {
        title: summary.search.clone(),
        about: String::new(),
        sections,
        zooms_by_section: false,
    }
}

fn facts(record: &SearchRecord) -> Vec<Block> {
    let summary = &record.summary;
    let end = match summary.complete {
        true => "it found nothing better nearby",
        false => "at the most evaluations that were allowed",
    };
    let facts = [
        ("version", summary.version.clone()),
        ("seed", summary.seed.to_string()),
        ("fingerprint", summary.fingerprint.clone()),
        ("runs of each design", summary.runs_of_design.to_string()),
        ("designs", summary.evaluations.to_string()),
        (
            "designs that keep to every constraint",
            summary.feasible.to_string(),
        ),
        ("designs that failed", summary.failed.to_string()),
        ("how it ended", end.to_owned()),
    ];
    let facts = facts.map(|(name, value)| (name.to_owned(), value));
    let mut blocks = vec![Block::Table(TextTable::of_facts(facts))];
    blocks.extend(summary.notes.iter().map(|note| Block::Text(note.clone())));
    blocks
}

fn of_design(design: &DesignSummary) -> Vec<Block> {
    let objective = &design.objective;
    let value = format!("{} {}", number_text(objective.value), objective.unit);
    let head = [
        ("evaluation".to_owned(), design.evaluation.to_string()),
        (
            format!("objective, to {}", objective.goal),
            value.trim_end().to_owned(),
        ),
    ];
    let variables = design.variables.iter().map(|variable| {
        let at_bound = variable.at_bound.as_ref();
        let bound = at_bound.map_or_else(String::new, |bound| format!(", at its {bound} bound"));
        (variable.name.clone(), number_text(variable.value) + &bound)
    });
    let is_variable = |path: &str| design.variables.iter().any(|own| own.name == path);
    let fields = design.sets.iter().filter(|field| !is_variable(&field.path));
    let fields = fields.map(|field| (field.path.clone(), field.value.clone()));
    let facts = head.into_iter().chain(variables).chain(fields);
    let mut blocks = vec![Block::Table(TextTable::of_facts(facts))];
    if !design.constraints.is_empty() {
        blocks.push(Block::Table(constraints(&design.constraints)));
    }
    blocks
}

fn constraints(constraints: &[ConstraintSummary]) -> TextTable {
    let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), number_text);
    let rows = constraints.iter().map(|constraint| Row {
        fields: vec![
            constraint.name.clone(),
            number_text(constraint.value),
            number(constraint.at_least),
            number(constraint.at_most),
        ],
        holds: Some(constraint.kept),
    });
    TextTable {
        head: ["constraint", "value", "at least", "at most"]
            .map(str::to_owned)
            .into(),
        rows: rows.collect(),
    }
}

fn failures(record: &SearchRecord) -> Vec<Block> {
    let failed = |design: &&EvaluatedDesign| design.objective.is_none();
    let failures: Vec<&EvaluatedDesign> = record.evaluations.iter().filter(failed).collect();
    if failures.is_empty() {
        return vec![Block::Text("Every design has a value.".to_owned())];
    }
    let design = record.design();
    let names = design.into_iter().flat_map(|design| &design.variables);
    let names = names.map(|variable| variable.name.clone());
    let head = ["evaluation".to_owned()].into_iter().chain(names);
    let rows = failures.iter().take(MOST_FAILURES).map(|of| {
        let mut fields = vec![of.evaluation.to_string()];
        fields.extend(of.variables.iter().map(|value| number_text(*value)));
        fields.push(of.reason.clone());
        Row {
            fields,
            holds: None,
        }
    });
    vec![Block::Table(TextTable {
        head: head.chain(["reason".to_owned()]).collect(),
        rows: rows.collect(),
    })]
}
