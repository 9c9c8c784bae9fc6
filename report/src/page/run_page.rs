//! The page of a run, or of two runs beside each other.

use aerobot_engine::plugin::Simulator;
use aerobot_engine::recording::number::number_text;

use super::{Block, Page, Row, Section, TextTable};
use crate::animation::Animation;
use crate::record::Record;
use crate::run_figures::KINDS;

/// Numbers of positions that a page holds for its view: what is more is thinned in time.
const MOST_NUMBERS: usize = 600_000;
/// Frames of a view at most.
const MOST_FRAMES: usize = 2400;
/// And at least, however many things there are.
const LEAST_FRAMES: usize = 60;
/// Events that are listed.
const MOST_EVENTS: usize = 200;

/// The page.
#[must_use]
pub fn run_page(simulator: &Simulator, records: &[Record]) -> Page {
    let names: Vec<&str> = records
        .iter()
        .map(|record| record.scene.name.as_str())
        .collect();
    let mut sections = vec![Section::new("What was run", facts(records)), view(records)];
    sections.extend(figures(simulator, records));
    sections.push(Section::new("The scene as run", scenes(records)));
    let mut distinct = names.clone();
    distinct.dedup();
    Page {
        title: distinct.join(" and "),
        about: records
            .first()
            .map_or_else(String::new, |record| record.scene.about.clone()),
        sections,
        zooms_by_section: false,
    }
}

/// The section that plays, or why there is nothing to play.
#[must_use]
pub fn view(records: &[Record]) -> Section {
    let runs = records.iter().map(|record| {
        (
            record.label.clone(),
            Animation::of(record, most_frames(record)),
        )
    });
    let runs: Vec<(String, Animation)> = runs.collect();
    let block = match runs.iter().all(|(_, animation)| animation.is_empty()) {
        true => Block::Text(
            "There is nothing to play: neither bodies nor nodes were recorded (`run.record`)."
                .to_owned(),
        ),
        false => Block::View(runs),
    };
    Section::new("In motion", vec![block])
}

fn most_frames(record: &Record) -> usize {
    let bodies = record.tables.bodies().count();
    let nodes = record.tables.states.len() - bodies;
    let numbers = 10 * bodies + 4 * nodes;
    (MOST_NUMBERS / numbers.max(1)).clamp(LEAST_FRAMES, MOST_FRAMES)
}

fn facts(records: &[Record]) -> Vec<Block> {
    let labels = records.iter().map(|record| record.label.clone());
    let head = match records.len() {
        1 => Vec::new(),
        _ => [String::new()].into_iter().chain(labels).collect(),
    };
    let row = |name: &str, value: &dyn Fn(&Record) -> String| Row {
        fields: [name.to_owned()]
            .into_iter()
            .chain(records.iter().map(value))
            .collect(),
        holds: None,
    };
    let rows = vec![
        row("scene", &|r| r.scene.name.clone()),
        row("version", &|r| r.summary.version.to_string()),
        row("seed", &|r| r.summary.seed.to_string()),
        row("formulation", &|r| r.summary.formulation.to_string()),
        row("integrator", &|r| r.summary.integrator.clone()),
        row("outcome", &|r| match &r.summary.stopped {
            Some(stop) => stop.to_string(),
            None => r.summary.outcome.to_string(),
        }),
        row("simulated time", &|r| {
            format!("{} s", number_text(r.summary.simulated_s))
        }),
        row("steps", &steps),
        row("evaluations", &|r| r.summary.evaluations.to_string()),
        row("time taken", &time_taken),
        row("largest tension", &largest_tension),
    ];
    let mut blocks = vec![Block::Table(TextTable { head, rows })];
    for record in records {
        blocks.extend(cut_short(record).map(Block::Text));
        for warning in &record.summary.warnings {
            blocks.push(Block::Text(format!("Warning: {warning}.")));
        }
    }
    blocks.extend(records.iter().filter_map(events));
    blocks
}

/// What is said of tables that end before the run did: the last row of each stands at its end.
fn cut_short(record: &Record) -> Option<String> {
    if record.summary.outcome != "done" {
        return None;
    }
    let end_s = record.summary.simulated_s;
    let tables = &record.tables;
    let last = |times: &mut dyn Iterator<Item = &Vec<f64>>| {
        let ends = times.filter_map(|times| times.last().copied());
        ends.reduce(f64::max)
    };
    let segments = tables.tethers.iter().flat_map(|tether| &tether.segments);
    let ends_s = [
        (
            "states",
            last(&mut tables.states.iter().map(|track| &track.times_s)),
        ),
        ("tethers", last(&mut segments.map(|track| &track.times_s))),
    ];
    let (name, last_s) = ends_s
        .into_iter()
        .filter_map(|(name, last_s)| Some((name, last_s?)))
        .find(|(_, last_s)| *last_s < end_s * (1.0 - 1e-9))?;
    Some(format!(
        "Warning: the table `{name}` of {} ends at {} s, and the run at {} s: the file has been cut.",
        record.label,
        number_text(last_s),
        number_text(end_s)
    ))
}

fn steps(record: &Record) -> String {
    let summary = &record.summary;
    format!(
        "{} ({} implicit), {} rejected",
        summary.steps, summary.implicit_steps, summary.rejected_steps
    )
}

fn time_taken(record: &Record) -> String {
    record.timing.map_or_else(
        || "not known".to_owned(),
        |timing| {
            format!(
                "{:.3} s on the clock, {:.3} s of CPU time: {:.0} simulated seconds a second",
                timing.wall_s, timing.cpu_s, timing.simulated_s_per_cpu_s
            )
        },
    )
}

fn largest_tension(record: &Record) -> String {
    record.summary.largest_tension.as_ref().map_or_else(
        || "no tether".to_owned(),
        |most| {
            format!(
                "{:.4} N at {:.3} s in segment {} of `{}`",
                most.tension_n, most.time_s, most.segment, most.tether
            )
        },
    )
}

fn events(record: &Record) -> Option<Block> {
    let events = &record.summary.events;
    if events.is_empty() {
        return None;
    }
    let rows = events.iter().take(MOST_EVENTS).map(|event| Row {
        fields: vec![
            format!("{:.3}", event.time_s),
            event.entity.clone(),
            event.kind.clone(),
        ],
        holds: None,
    });
    let more = events.len().saturating_sub(MOST_EVENTS) as u64 + record.summary.events_dropped;
    let mut rows: Vec<Row> = rows.collect();
    if more > 0 {
        rows.push(Row {
            fields: vec![String::new(), String::new(), format!("and {more} more")],
            holds: None,
        });
    }
    Some(Block::Table(TextTable {
        head: ["time [s]", "entity", "event"].map(str::to_owned).into(),
        rows,
    }))
}

/// A section of time histories, one of other figures, and what could not be shown.
fn figures(simulator: &Simulator, records: &[Record]) -> Vec<Section> {
    let references: Vec<&Record> = records.iter().collect();
    let mut histories = Vec::new();
    let mut others = Vec::new();
    let mut missing = Vec::new();
    for kind in KINDS.iter().filter(|kind| kind.in_report) {
        match kind.figure(simulator, &references) {
            Ok(figure) => {
                let is_history = figure.panels.iter().all(|panel| panel.x.is_time);
                let place = if is_history {
                    &mut histories
                } else {
                    &mut others
                };
                place.push(Block::Figure(Box::new(figure)));
            }
            Err(reason) => missing.push(format!("{}: {reason}", kind.name)),
        }
    }
    if !missing.is_empty() {
        others.push(Block::Folded {
            summary: "Figures that there are not, and why".to_owned(),
            text: missing.join("\n"),
        });
    }
    vec![
        Section::new("Time histories", histories),
        Section::new("Shapes, spectra, winds", others),
    ]
}

fn scenes(records: &[Record]) -> Vec<Block> {
    let fold = |record: &Record| Block::Folded {
        summary: format!("scene.ron of {}", record.label),
        text: record.scene.source.text().to_owned(),
    };
    records.iter().map(fold).collect()
}
