//! The performance case as a text.

use super::super::Report;
use super::super::check::Verdict;
use super::checks::{self, PAPER_SHOWS, TITLE};
use super::{
    Costs, Exponent, Extent, Measured, PerformanceSettings, Quantity, SOLVERS, Solver, Study,
    exponents, tables, why,
};

const HEAD: &str = "\
What a simulated second costs, by the number of elements of the tether and by its length (paper,
sec. 4.3, figures 7 and 8).

The paper finds lumped masses to be O(n^3) and strongly dependent on the length, DeNOC to be O(n)
and independent of the length. It names no integrator, tolerance or stiffness. Here both
formulations run the comparison case (balloon, tether, gondola, three gusts) with the same two
integrators, an explicit and an implicit one. An element is a mass of the tether, as in sec. 4.2:
n of them make n + 1 segments, or n + 1 rigid links (uniform rods).
";

pub(super) fn report(settings: &PerformanceSettings, costs: &Costs) -> Report {
    let exponents = exponents::all(costs);
    let mut text = HEAD.to_owned();
    text.push_str(&how(settings));
    for study in [Study::Elements, Study::Length] {
        text.push_str(&cost_table(study, costs.of(study)));
    }
    text.push_str(&exponent_table(&exponents));
    text.push_str(&why::why(settings, costs, &exponents));
    let runs = costs.by_elements.iter().chain(&costs.by_length);
    let checks = checks::checks(settings, costs, &exponents);
    Report {
        title: TITLE.to_owned(),
        paper_shows: PAPER_SHOWS.to_owned(),
        text,
        verdict: Verdict::of(&checks, checks::sentence()),
        checks,
        tables: tables::tables(costs, &exponents),
        stopped: runs.filter_map(stopped).collect(),
    }
}

fn stopped(run: &Measured) -> Option<String> {
    let reason = run.stopped.as_ref()?;
    Some(format!(
        "performance: {}, {} elements, {} m stopped at {} s: {reason}",
        run.solver.name(),
        run.elements,
        run.length_m,
        run.simulated_s
    ))
}

fn how(settings: &PerformanceSettings) -> String {
    format!(
        "
explicit: Dormand-Prince 5(4), relative tolerance {:e}; implicit: ROS34PW2, accuracy {:e} m.
Runs of {} s; CPU time of one thread, the least of up to {} repeats. A star marks what was flown in
part, from the start of the first gust: {} largest stable steps of RK4 with lumped masses, {} s with
links.
",
        settings.relative_tolerance,
        settings.accuracy_m,
        settings.duration_s,
        settings.repeats,
        settings.stable_steps_of_part,
        settings.duration_of_part_s.min(settings.duration_s)
    )
}

fn cost_table(study: Study, runs: &[Measured]) -> String {
    let (title, unit) = match study {
        Study::Elements => ("By elements", "n"),
        Study::Length => ("By length", "m"),
    };
    let mut text = format!("\n{title}: steps and CPU time per simulated second\n\n{unit:>6}");
    for solver in SOLVERS {
        text.push_str(&format!(" {:>23}", solver.name()));
    }
    text.push('\n');
    text.push_str(&format!("{:>6}", ""));
    for _ in SOLVERS {
        text.push_str(&format!(" {:>11} {:>11}", "steps/s", "us/s"));
    }
    text.push('\n');
    for group in runs.chunks(SOLVERS.len()) {
        let Some(first) = group.first() else { continue };
        match study {
            Study::Elements => text.push_str(&format!("{:>6}", first.elements)),
            Study::Length => text.push_str(&format!("{:>6}", first.length_m)),
        }
        for run in group {
            let part = if run.extent == Extent::Whole { "" } else { "*" };
            let steps = figures(run.steps_per_simulated_s()) + part;
            let cpu_us = figures(1e6 * run.cpu_per_simulated_s()) + part;
            text.push_str(&format!(" {steps:>11} {cpu_us:>11}"));
        }
        text.push('\n');
    }
    text
}

/// Three figures of a number.
fn figures(value: f64) -> String {
    let magnitude = if value > 0.0 {
        libm::floor(libm::log10(value))
    } else {
        0.0
    };
    if !(-3.0..7.0).contains(&magnitude) {
        return format!("{value:.2e}");
    }
    let decimals = (2.0 - magnitude).max(0.0) as usize;
    format!("{value:.decimals$}")
}

/// The exponent of a quantity in a study, of few elements or of many.
pub(super) fn find(
    exponents: &[Exponent],
    study: Study,
    solver: Solver,
    quantity: Quantity,
    many: bool,
) -> Option<Exponent> {
    let found = exponents.iter().find(|exponent| {
        (exponent.solver, exponent.quantity) == (solver, quantity) && exponent.is_of(study, many)
    });
    found.copied()
}

/// Studies and whether of many elements.
const COLUMNS: [(Study, bool); 3] = [
    (Study::Elements, false),
    (Study::Elements, true),
    (Study::Length, false),
];

fn exponent_table(exponents: &[Exponent]) -> String {
    let mut text = "\nPowers in which they grow, by least squares of logarithms\n\n".to_owned();
    text.push_str(&format!("{:<16}", ""));
    for (study, many) in COLUMNS {
        let unit = match study {
            Study::Elements => "n",
            Study::Length => "m",
        };
        let range = exponents
            .iter()
            .find(|exponent| exponent.is_of(study, many))
            .map_or_else(String::new, |Exponent { range, .. }| {
                format!("{} to {} {unit}", range.0, range.1)
            });
        text.push_str(&format!(" {range:>15}"));
    }
    text.push_str(&format!("  the paper\n{:<16}", ""));
    for _ in COLUMNS {
        text.push_str(&format!(" {:>7} {:>7}", "steps", "CPU"));
    }
    text.push_str("  elements length\n");
    for solver in SOLVERS {
        text.push_str(&format!("{:<16}", solver.name()));
        for (study, many) in COLUMNS {
            for quantity in [Quantity::Steps, Quantity::Cpu] {
                let found = find(exponents, study, solver, quantity, many);
                text.push_str(&format!(" {:>7}", power(found)));
            }
        }
        let (elements, length) = solver.claim();
        text.push_str(&format!("  {elements:<8} {length}\n"));
    }
    text
}

/// An exponent with two decimals.
pub(super) fn power(exponent: Option<Exponent>) -> String {
    exponent.map_or_else(
        || "-".to_owned(),
        |found| {
            // Minus zero reads as a difference where there is none.
            format!("{:.2}", libm::round(100.0 * found.exponent) / 100.0 + 0.0)
        },
    )
}
