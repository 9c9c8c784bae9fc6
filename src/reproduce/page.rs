//! The page of cases: what the paper shows, what we compute, an independent answer, the verdict.

use aerobot_report::page::{Block, Page, Row, Section, TextTable};

use super::{Answer, Check, Finished};

/// The page of finished cases.
#[must_use]
pub fn page(cases: &[Finished]) -> Page {
    let mut sections = vec![Section::new(
        "Verdicts",
        vec![Block::Table(verdicts(cases))],
    )];
    sections.extend(cases.iter().map(section));
    Page {
        title: "The paper computed anew".to_owned(),
        about: "Vergari et al., Modeling and Analysis of Tethered System Dynamics for Venus Aerobots and Towed \
                Probes (IAC-24-A3,5,6): case by case what it shows, what we compute, and an answer from elsewhere."
            .to_owned(),
        sections,
        zooms_by_section: true,
    }
}

fn verdicts(cases: &[Finished]) -> TextTable {
    let rows = cases.iter().map(|case| {
        let report = &case.report;
        let independent = report
            .checks
            .iter()
            .filter(|check| check.independent.is_some());
        let (all, held) = (
            independent.clone().count(),
            independent.filter(|check| check.holds).count(),
        );
        Row {
            fields: vec![
                case.name.to_owned(),
                report.verdict.sentence.clone(),
                format!("{held} of {all}"),
                format!("{:.1} s", case.wall_s),
            ],
            holds: Some(report.verdict.holds),
        }
    });
    TextTable {
        head: [
            "case",
            "verdict",
            "independent checks that hold",
            "time taken",
        ]
        .map(str::to_owned)
        .into(),
        rows: rows.collect(),
    }
}

fn section(case: &Finished) -> Section {
    let report = &case.report;
    let mut blocks = vec![
        Block::Text(format!("The paper: {}", report.paper_shows)),
        Block::Verdict {
            holds: report.verdict.holds,
            sentence: report.verdict.sentence.clone(),
        },
    ];
    if !report.checks.is_empty() {
        blocks.push(Block::Table(checks(&report.checks)));
    }
    let stopped = report.stopped.iter();
    blocks.extend(stopped.map(|stopped| Block::Text(format!("Stopped: {stopped}"))));
    let figures = report.figures.iter();
    blocks.extend(figures.map(|figure| Block::Figure(Box::new(figure.clone()))));
    blocks.push(Block::Folded {
        summary: "As on the terminal".to_owned(),
        text: report.text.clone(),
    });
    blocks.push(Block::Text(format!("Time taken: {:.1} s.", case.wall_s)));
    blocks.push(Block::Command(format!("aerobot reproduce {}", case.name)));
    Section::new(report.title.clone(), blocks).named(case.name)
}

fn checks(checks: &[Check]) -> TextTable {
    let told = |check: &Check, answer: Option<&Answer>| {
        answer.map_or_else(|| "-".to_owned(), |answer| check.told(answer))
    };
    let independent = |check: &Check| {
        let answer = check.independent.as_ref().map(|other| &other.answer);
        told(check, answer)
    };
    let rows = checks.iter().map(|check| Row {
        fields: vec![
            check.what.clone(),
            told(check, check.paper.as_ref()),
            check.told(&check.ours),
            independent(check),
            check
                .independent
                .as_ref()
                .map_or_else(|| "-".to_owned(), |other| other.source.clone()),
            check.asked.clone(),
            word(check).to_owned(),
        ],
        holds: Some(!check.fails()),
    });
    let head = [
        "what",
        "paper",
        "ours",
        "independent",
        "from",
        "asked for",
        "",
    ];
    TextTable {
        head: head.map(str::to_owned).into(),
        rows: rows.collect(),
    }
}

/// What a check comes to, in a word.
fn word(check: &Check) -> &'static str {
    match (check.holds, &check.independent) {
        (_, None) if check.asked.is_empty() => "",
        (true, _) => "holds",
        (false, None) => "differs from the paper",
        (false, Some(_)) => "does not hold",
    }
}
