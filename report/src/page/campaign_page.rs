//! The page of a campaign: what was run, percentiles, where the ends lie, what drives what, and what failed.

use aerobot_engine::campaign::summary::MetricSummary;
use aerobot_engine::recording::number::number_text;

use super::{Block, Page, Row, Section, TextTable};
use crate::campaign::{CampaignFigure, CampaignRecord};

/// Failures that are listed one by one.
const MOST_FAILURES: usize = 100;

/// The page; `kept` are runs of which there is a report, with its place from the page.
#[must_use]
pub fn campaign_page(record: &CampaignRecord, kept: &[(String, String)]) -> Page {
    let summary = &record.summary;
    let mut sections = vec![Section::new("What was run", facts(record))];
    let mut missing = Vec::new();
    for (title, kinds) in [
        ("Over time", &[CampaignFigure::Envelope][..]),
        ("How often", &[CampaignFigure::Histogram]),
        ("Where the ends lie", &[CampaignFigure::Ellipse]),
        ("What drives what", &[CampaignFigure::Tornado]),
        ("How sure the means are", &[CampaignFigure::Convergence]),
    ] {
        let mut blocks = Vec::new();
        for kind in kinds {
            match record.figure(*kind) {
                Ok(mut figure) => {
                    kind.name().clone_into(&mut figure.name);
                    blocks.push(Block::Figure(Box::new(figure)));
                }
                Err(reason) => missing.push(format!("{kind}: {reason}")),
            }
        }
        if !blocks.is_empty() {
            sections.push(Section::new(title, blocks));
        }
    }
    sections.push(Section::new("What failed", failures(record)));
    if !kept.is_empty() {
        let links = kept.iter().map(|(text, to)| Block::Link {
            text: text.clone(),
            to: to.clone(),
        });
        sections.push(Section::new("Runs that were kept", links.collect()));
    }
    if !missing.is_empty() {
        let fold = Block::Folded {
            summary: "Figures that there are not, and why".to_owned(),
            text: missing.join("\n"),
        };
        sections.push(Section::new("Not shown", vec![fold]));
    }
    Page {
        title: summary.campaign.clone(),
        about: record.specification.about.clone(),
        sections,
        zooms_by_section: false,
    }
}

fn facts(record: &CampaignRecord) -> Vec<Block> {
    let summary = &record.summary;
    let facts = [
        ("version", summary.version.clone()),
        ("seed", summary.seed.to_string()),
        ("fingerprint", summary.fingerprint.clone()),
        ("runs planned", summary.runs_planned.to_string()),
        ("runs counted", summary.runs.to_string()),
        ("runs that got to their end", summary.runs_done.to_string()),
    ];
    let facts = facts.map(|(name, value)| (name.to_owned(), value));
    let mut blocks = vec![
        Block::Table(TextTable::of_facts(facts)),
        Block::Table(metrics(&summary.metrics)),
    ];
    blocks.extend(summary.notes.iter().map(|note| Block::Text(note.clone())));
    blocks
}

fn metrics(metrics: &[MetricSummary]) -> TextTable {
    let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), four_digits);
    let estimate = |value: Option<f64>, interval: Option<[f64; 2]>| match interval {
        Some([low, high]) => {
            format!(
                "{} ({} to {})",
                number(value),
                four_digits(low),
                four_digits(high)
            )
        }
        None => number(value),
    };
    let rows = metrics.iter().map(|metric| Row {
        fields: vec![
            metric.name.clone(),
            metric.runs.to_string(),
            estimate(metric.mean, metric.mean_interval_95),
            number(metric.standard_deviation),
            number(metric.smallest.map(|(value, _)| value)),
            number(metric.largest.map(|(value, _)| value)),
        ],
        holds: None,
    });
    let head = [
        "metric",
        "runs",
        "mean (95 % interval)",
        "standard deviation",
        "smallest",
        "largest",
    ];
    TextTable {
        head: head.map(str::to_owned).into(),
        rows: rows.collect(),
    }
}

fn four_digits(value: f64) -> String {
    format!("{value:.3e}")
        .parse::<f64>()
        .map_or_else(|_| String::new(), number_text)
}

fn failures(record: &CampaignRecord) -> Vec<Block> {
    let failed = record.failures();
    if failed.is_empty() {
        return vec![Block::Text("Every run got to its end.".to_owned())];
    }
    let rows = failed.iter().take(MOST_FAILURES).map(|failure| Row {
        fields: vec![
            failure.run.to_string(),
            failure.outcome.clone(),
            failure.reason.clone(),
            failure.replay.clone(),
        ],
        holds: None,
    });
    let mut blocks = vec![Block::Text(format!(
        "{} of {} runs. The command repeats one with everything that it writes.",
        failed.len(),
        record.summary.runs
    ))];
    blocks.push(Block::Table(TextTable {
        head: ["run", "outcome", "reason", "replay"]
            .map(str::to_owned)
            .into(),
        rows: rows.collect(),
    }));
    blocks
}
