//! What a simulated second costs by the number of elements and by the length: the powers in which steps
//! grow follow from what limits them; and the command that tells them.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod program;

use std::fs;

use aerobot::engine::plugin::Simulator;
use aerobot::reproduce::ReproduceError;
use aerobot::reproduce::performance::{
    Costs, Extent, Measured, PerformanceSettings, SOLVERS, Solver, measure, power_law,
};
use program::reproduced::{assert_kept, assert_listed, assert_refused, assert_tables};
use program::{Scratch, aerobot, text};

const LUMPED_EXPLICIT: Solver = SOLVERS[0];
const LUMPED_IMPLICIT: Solver = SOLVERS[1];
const LINKS_EXPLICIT: Solver = SOLVERS[2];
const LINKS_IMPLICIT: Solver = SOLVERS[3];

/// Few sizes; long enough for the first two gusts.
fn short() -> PerformanceSettings {
    PerformanceSettings {
        elements: vec![5, 10, 20, 40],
        lengths_m: vec![200.0, 400.0, 1000.0],
        duration_s: 25.0,
        most_of_whole_lumped: 10,
        most_of_whole_links: 20,
        repeats: 1,
        ..PerformanceSettings::default()
    }
}

fn measured(settings: &PerformanceSettings) -> Costs {
    let mut parts = Vec::new();
    let costs = measure(&Simulator::new(), settings, &mut |_, part| parts.push(part));
    assert!(parts.is_sorted() && parts.last() == Some(&1.0), "{parts:?}");
    costs.unwrap_or_else(|error| panic!("{error}"))
}

/// The power of the number of elements, or of the length, in which something grows.
fn power(runs: &[Measured], solver: Solver, of: impl Fn(&Measured) -> f64) -> f64 {
    let is_by_length = runs[0].elements == runs.last().unwrap().elements;
    let points: Vec<(f64, f64)> = runs
        .iter()
        .filter(|run| run.solver == solver)
        .map(|run| {
            let argument = if is_by_length {
                run.length_m
            } else {
                f64::from(run.elements)
            };
            (argument, of(run))
        })
        .collect();
    power_law(&points).unwrap()
}

#[track_caller]
fn assert_between(what: &str, value: f64, least: f64, most: f64) {
    println!("{what}: {value:.3}");
    assert!((least..=most).contains(&value), "{what}: {value}");
}

#[test]
fn val_steps_grow_with_elements_and_length_as_what_limits_them() {
    let costs = measured(&short());
    for run in costs.by_elements.iter().chain(&costs.by_length) {
        assert_eq!(run.stopped, None);
        assert!(run.evaluations >= run.steps && run.cpu_s > 0.0 && run.repeats == 1);
    }
    let runs = &costs.by_elements;
    let steps = Measured::steps_per_simulated_s;
    // Dampers of c (n + 1) on nodes of m/(n + 1); without them springs of k (n + 1).
    let stable = |run: &Measured| run.stable_step_s;
    let undamped = |run: &Measured| run.undamped_stable_step_s.unwrap();
    let waves = |run: &Measured| run.transverse_rad_s.unwrap();
    let explicit = power(runs, LUMPED_EXPLICIT, steps);
    assert_between("lumped explicit, steps", explicit, 1.85, 2.0);
    let by_stability = power(runs, LUMPED_EXPLICIT, stable);
    assert_between("stable step", explicit + by_stability, -0.02, 0.02);
    let by_stiffness = power(runs, LUMPED_EXPLICIT, undamped);
    assert_between("undamped stable step", by_stiffness, -1.05, -0.9);
    let by_waves = power(runs, LINKS_EXPLICIT, waves);
    assert_between("fastest transverse vibration", by_waves, 0.9, 1.05);
    for solver in [LUMPED_IMPLICIT, LINKS_IMPLICIT] {
        let implicit = power(runs, solver, steps);
        assert_between(&solver.name(), implicit, -0.05, 0.05);
    }
    // Neither by the elements nor by the length are rigid links independent, explicitly.
    let few: Vec<Measured> = runs[..12].to_vec();
    assert_between("links", power(&few, LINKS_EXPLICIT, steps), 0.4, 1.0);
    let runs = &costs.by_length;
    let explicit = power(runs, LUMPED_EXPLICIT, steps);
    assert_between("lumped explicit, length", explicit, -1.02, -0.98);
    assert_between(
        "links, length",
        power(runs, LINKS_EXPLICIT, steps),
        -1.0,
        -0.5,
    );
    for solver in [LUMPED_IMPLICIT, LINKS_IMPLICIT] {
        let implicit = power(runs, solver, steps);
        assert_between(&solver.name(), implicit, -0.1, 0.05);
    }
}

/// An explicit run is limited alike wherever it is, so a part of it tells what all of it takes; and
/// explicit and implicit runs end in one place.
#[test]
fn val_a_part_of_an_explicit_run_takes_as_many_steps_per_second() {
    let settings = |most_of_whole_lumped| PerformanceSettings {
        elements: vec![10, 20],
        lengths_m: Vec::new(),
        duration_s: 15.0,
        most_of_whole_lumped,
        ..short()
    };
    let (part, whole) = (measured(&settings(10)), measured(&settings(20)));
    let (part, whole) = (&part.by_elements[4], &whole.by_elements[4]);
    assert_eq!((part.solver, part.elements), (LUMPED_EXPLICIT, 20));
    assert_eq!(
        (part.extent, whole.extent),
        (Extent::StableSteps, Extent::Whole)
    );
    assert!(part.simulated_s < 1.0 && whole.simulated_s == 15.0);
    let ratio = part.steps_per_simulated_s() / whole.steps_per_simulated_s();
    assert_between("steps of a part to those of the whole", ratio, 0.98, 1.02);
}

#[test]
fn explicit_and_implicit_runs_end_in_one_place() {
    let costs = measured(&PerformanceSettings {
        elements: vec![3, 5],
        lengths_m: vec![1000.0],
        ..short()
    });
    for run in &costs.by_elements {
        assert_eq!(
            run.from_explicit_m.is_some(),
            [LUMPED_IMPLICIT, LINKS_IMPLICIT].contains(&run.solver)
        );
        assert!(run.from_explicit_m.unwrap_or(0.0) < 1e-2, "{run:?}");
    }
    // The middle of both studies is one run.
    let (by_elements, by_length) = (&costs.by_elements[4..], &costs.by_length);
    for (a, b) in by_elements.iter().zip(by_length) {
        assert_eq!((a.steps, a.evaluations), (b.steps, b.evaluations));
        assert_eq!(a.bodies, b.bodies);
    }
}

#[test]
fn one_number_of_elements_tells_no_power() {
    let settings = PerformanceSettings {
        elements: vec![5],
        ..short()
    };
    let refused = measure(&Simulator::new(), &settings, &mut |_, _| {}).unwrap_err();
    assert!(matches!(refused, ReproduceError::Setting(_)), "{refused}");
}

fn read(scratch: &Scratch, file: &str) -> String {
    fs::read_to_string(scratch.path(file)).unwrap()
}

const SHORT: [&str; 6] = ["reproduce", "performance", "--nodes", "7", "--until", "1"];

#[test]
fn the_command_writes_its_tables() {
    let scratch = Scratch::new();
    let out = scratch.text();
    let first = aerobot(&[&SHORT[..], &["--out", out]].concat());
    assert_eq!(first.status.code(), Some(0), "{}", text(&first.stderr));
    let printed = text(&first.stdout);
    for wanted in ["figures 7 and 8", "O(n^3)", "independent", "too short runs"] {
        assert!(printed.contains(wanted), "{printed}");
    }
    // Sizes x solvers, with a header; steps, evaluations and what limits them, of two ranges.
    assert_tables(
        &scratch,
        &[
            ("performance_elements.csv", 5 * 4),
            ("performance_length.csv", 8 * 4),
            ("performance_exponents.csv", 2 * 16),
            ("performance_timing.csv", 13 * 4),
            ("performance_timing_exponents.csv", 2 * 8),
        ],
    );
    assert_kept(&SHORT, out);
}

#[test]
fn tables_without_a_clock_have_the_same_bytes_again() {
    let scratches = [Scratch::new(), Scratch::new()];
    for scratch in &scratches {
        let out = scratch.text();
        let output = aerobot(&[&SHORT[..], &["--quiet", "--out", out]].concat());
        assert_eq!(output.status.code(), Some(0));
        assert!(output.stdout.is_empty() && output.stderr.is_empty());
    }
    let [once, twice] = &scratches;
    for file in ["elements", "length", "exponents"] {
        let file = format!("performance_{file}.csv");
        let table = read(once, &file);
        assert_eq!(table, read(twice, &file), "{file}");
        assert!(!table.contains("cpu"), "{file}");
    }
}

#[test]
fn what_makes_no_sense_is_refused_and_nothing_is_written() {
    assert_refused(&[
        (&["performence"], "did you mean `performance`?"),
        (&["performance", "--nodes", "1"], "must be at least 2"),
        (&["performance", "--nodes", "-1"], "invalid value"),
        (
            &["performance", "--until", "0"],
            "`duration_s` must be above",
        ),
        (&["performance", "--until", "NaN"], "duration_s"),
    ]);
    assert_listed("performance");
}
