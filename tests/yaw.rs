//! The yaw of a body on a ring of tethers: elastic masses against separate programs, inextensible links against
//! the multifilar pendulum integrated here, and the command that lays both beside the paper.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod flight;
mod program;

use std::f64::consts::PI;
use std::fs;

use aerobot::engine::plugin::Simulator;
use aerobot::reproduce::yaw::{LengthResult, YawSettings, study};
use flight::{assert_below, assert_relative, fly_scene};
use program::reproduced::{assert_kept, assert_listed, assert_refused, assert_tables};
use program::{Scratch, aerobot, text};

const SCENE: &str = "paper/multi_tether_yaw.ron";

/// Overrides of the ring of the scene.
fn ring(fields: &[(&str, String)]) -> Vec<String> {
    let set =
        |(field, value): &(&str, String)| format!("entities.suspension.Tethers.{field}={value}");
    fields.iter().map(set).collect()
}

/// Time and heading of the body, s and rad.
fn headings(overrides: &[String]) -> Vec<(f64, f64)> {
    let overrides: Vec<&str> = overrides.iter().map(String::as_str).collect();
    let headings = fly_scene(SCENE, &overrides).channel("body", "heading_rad");
    assert_eq!(headings.len(), 601);
    headings
}

/// Mean frequency between upward zero crossings, each on the line between its neighbours, Hz; the first is
/// the start.
fn frequency_hz(headings: &[(f64, f64)]) -> f64 {
    assert_below("heading at the start", headings[0].1.abs(), 1e-12);
    let mut crossings_s = vec![0.0];
    for pair in headings[1..].windows(2) {
        let [(before_s, before), (after_s, after)] = [pair[0], pair[1]];
        if before <= 0.0 && after > 0.0 {
            crossings_s.push(before_s + (after_s - before_s) * before / (before - after));
        }
    }
    (crossings_s.len() - 1) as f64 / crossings_s.last().unwrap()
}

/// By a separate program (absolute coordinates, adaptive of order 8, tolerance 1e-10), with the seven decimals
/// that it printed; the paper's lengths, with the scene's own integrator.
#[test]
fn val_elastic_tethers_turn_a_body_as_a_separate_program_says() {
    for (length_m, expected_hz) in [(10, 0.0857245), (20, 0.0605749), (50, 0.0382318)] {
        let found_hz = frequency_hz(&headings(&ring(&[("length_m", length_m.to_string())])));
        assert_relative(&format!("{length_m} m, Hz"), found_hz, expected_hz, 1e-4);
    }
}

/// By another program: absolute coordinates, a quaternion, RK4 at steps of 0.1 ms and, for 5e5 N, 0.05 ms;
/// half of that changed none of the ten decimals, and Dormand-Prince of order 8 at 1e-10 none of nine.
#[test]
fn other_numbers_of_tethers_and_stiffnesses_agree_with_another_program() {
    for (count, stiffness, expected_hz) in [
        (2, "5e3", 0.0849770440),
        (4, "5e4", 0.0857800286),
        (2, "5e5", 0.0857250985),
    ] {
        let overrides = ring(&[
            ("count", count.to_string()),
            ("axial_stiffness_n", stiffness.to_owned()),
        ]);
        let what = format!("{count} tethers of {stiffness} N, Hz");
        assert_relative(
            &what,
            frequency_hz(&headings(&overrides)),
            expected_hz,
            1e-5,
        );
    }
}

/// Heading of the multifilar pendulum every 0.1 s, rad:
/// (I + m h'^2) psi'' + m h' h'' psi'^2 = m g h' with h^2 = L^2 - a^2 - b^2 + 2 a b cos psi, by RK4.
fn pendulum(length_m: f64) -> Vec<f64> {
    const STEPS: u32 = 50;
    let (mass_kg, moment_kg_m2, gravity) = (20.0, 61.0, 8.87);
    let rates = |[psi, rate]: [f64; 2]| {
        let h = (length_m * length_m - 2.0 + 2.0 * psi.cos()).sqrt();
        let first = -psi.sin() / h;
        let second = (-psi.cos() - first * first) / h;
        let push = mass_kg * first * (gravity - second * rate * rate);
        [rate, push / (moment_kg_m2 + mass_kg * first * first)]
    };
    let step_s = 0.1 / f64::from(STEPS);
    let at = |from: [f64; 2], rate: [f64; 2], part: f64| {
        [0, 1].map(|i: usize| from[i] + part * step_s * rate[i])
    };
    let mut state = [0.0, 0.1];
    let mut record = vec![0.0];
    for _ in 0..600 {
        for _ in 0..STEPS {
            let a = rates(state);
            let b = rates(at(state, a, 0.5));
            let c = rates(at(state, b, 0.5));
            let d = rates(at(state, c, 1.0));
            let mean = [0, 1].map(|i: usize| (a[i] + 2.0 * (b[i] + c[i]) + d[i]) / 6.0);
            state = at(state, mean, 1.0);
        }
        record.push(state[0]);
    }
    record
}

/// A rigid link for each tether, 1e-4 kg in all of them together.
fn light_links(length_m: f64, count: u32, integrator: &str) -> Vec<String> {
    let density = 1e-4 / (f64::from(count) * length_m * PI * 1e-6);
    let mut overrides = ring(&[
        ("length_m", format!("{length_m:?}")),
        ("count", count.to_string()),
        ("nodes", "0".to_owned()),
        ("lumping", "HalfSegment".to_owned()),
        ("density_kg_m3", format!("{density:?}")),
    ]);
    overrides.push("run.formulation=Denoc".to_owned());
    overrides.push(format!("run.integrator={integrator}"));
    overrides
}

/// Largest difference from the pendulum over 60 s, rad; the links have 5e-6 of the body's mass.
#[track_caller]
fn assert_pendulum(length_m: f64, count: u32, integrator: &str) {
    let found = headings(&light_links(length_m, count, integrator));
    let pairs = pendulum(length_m).into_iter().zip(&found);
    let largest = pairs.fold(0.0, |most: f64, (expected, (_, heading))| {
        most.max((heading - expected).abs())
    });
    let what = format!("{count} links of {length_m} m, {integrator}, rad");
    assert_below(&what, largest, 1e-4);
}

#[test]
fn val_inextensible_tethers_are_the_multifilar_pendulum() {
    for (length_m, amplitude_deg) in [(10.0, 10.6394), (20.0, 15.0685), (50.0, 23.9306)] {
        assert_pendulum(length_m, 3, "Auto(accuracy_m: 1e-3)");
        let record = pendulum(length_m);
        let amplitude = record.into_iter().fold(0.0, f64::max).to_degrees();
        // The pendulum of this file is that of the separate program; a peak lies between samples.
        assert_relative("amplitude, deg", amplitude, amplitude_deg, 5e-4);
    }
}

/// Of four rigid tethers one is more than the lengths can tell, of six three.
#[test]
fn the_number_of_tethers_does_not_matter() {
    for count in [2, 4, 6] {
        assert_pendulum(10.0, count, "Auto(accuracy_m: 1e-3)");
    }
}

#[test]
fn every_integrator_closes_the_loops() {
    for integrator in [
        "Auto(accuracy_m: 1e-5)",
        "Implicit(accuracy_m: 1e-4)",
        "Adaptive(relative_tolerance: 1e-8)",
        "Fixed(step_s: 0.05, method: RungeKutta4)",
        "Fixed(step_s: 0.05, method: Rosenbrock)",
    ] {
        assert_pendulum(20.0, 3, integrator);
    }
    assert_pendulum(10.0, 4, "Adaptive(relative_tolerance: 1e-8)");
}

/// With the scene's accuracy, and steps that outputs do not shorten: 1e-4 of the frequency.
#[test]
fn a_millimetre_of_accuracy_is_enough_for_the_frequency() {
    let heading_at_crossing = |integrator: &str| {
        let mut overrides = ring(&[("nodes", "10".to_owned())]);
        overrides.push(format!("run.integrator={integrator}"));
        // Five periods of 11.6654 s: the heading there is the phase that is left over.
        overrides.push("run.duration_s=58.327".to_owned());
        overrides.push("run.output_every_s=58.327".to_owned());
        let overrides: Vec<&str> = overrides.iter().map(String::as_str).collect();
        let sink = fly_scene(SCENE, &overrides);
        sink.channel("body", "heading_rad").last().unwrap().1
    };
    let tight = heading_at_crossing("Auto(accuracy_m: 1e-6)");
    let shift_s = (heading_at_crossing("Auto(accuracy_m: 1e-3)") - tight) / 0.1;
    assert_below("frequency, relative", (shift_s / 58.327).abs(), 1e-4);
}

fn results(settings: &YawSettings) -> Vec<LengthResult> {
    let mut parts = Vec::new();
    let results = study(&Simulator::new(), settings, &mut |_, part| parts.push(part));
    assert!(parts.is_sorted() && parts.last() == Some(&1.0));
    results.unwrap_or_else(|error| panic!("{error}"))
}

/// What the paper's table would be of these very runs: no frequency but a bin.
#[test]
fn val_fifteen_seconds_show_every_length_in_the_first_bin() {
    let results = results(&YawSettings {
        duration_s: Some(30.0),
        ..YawSettings::default()
    });
    for result in results {
        for flight in [&result.lumped, &result.links] {
            assert_eq!(flight.stopped, None);
            assert_eq!(flight.paper_bin(), Some(1));
            // A stretch of 0.1 % and a line of 4 % of the body's mass.
            let found = flight.frequency().unwrap();
            let pendulum_hz = result.pendulum.frequency_hz().unwrap();
            assert_relative("Hz, and the pendulum's", found.hz, pendulum_hz, 1e-2);
        }
        let c_m_s = (20.0 * 8.87 / 3.0 / 0.005_f64).sqrt();
        let wave_s = result.pendulum.length_m / c_m_s;
        assert_relative("transverse wave, s", result.wave_s, wave_s, 1e-12);
    }
}

#[test]
fn the_command_writes_its_tables() {
    let scratch = Scratch::new();
    let out = scratch.text();
    let short = ["reproduce", "yaw", "--nodes", "1", "--until", "28"];
    let first = aerobot(&[&short[..], &["--out", out]].concat());
    assert_eq!(first.status.code(), Some(0), "{}", text(&first.stderr));
    let printed = text(&first.stdout);
    for wanted in [
        "table 1",
        "0.133",
        "0.085647",
        "0.060429",
        "0.037966",
        "61.0 kg m2",
        "27.2 kg m2",
        "2/15",
        "0.092",
        "0.460",
    ] {
        assert!(printed.contains(wanted), "{wanted}: {printed}");
    }
    // Lengths x formulations (x outputs), with a header.
    assert_tables(&scratch, &[("yaw.csv", 6), ("yaw_headings.csv", 6 * 281)]);
    assert_kept(&short, out);
}

/// What is too short for a period, or for 15 s, has no figure.
#[test]
fn a_short_run_tells_no_frequency() {
    let scratch = Scratch::new();
    let arguments = [
        "reproduce",
        "yaw",
        "--nodes",
        "1",
        "--until",
        "5",
        "--force",
    ];
    let output = aerobot(&[&arguments[..], &["--out", scratch.text()]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let printed = text(&output.stdout);
    let line = printed
        .lines()
        .find(|line| line.starts_with("lumped masses, elastic"));
    assert_eq!(line.unwrap().matches(" -").count(), 3, "{printed}");
    let table = fs::read_to_string(scratch.path("yaw.csv")).unwrap();
    assert!(table.contains("10,3,1,lumped-mass,,,0,"), "{table}");
}

#[test]
fn what_makes_no_sense_is_refused_and_nothing_is_written() {
    assert_refused(&[
        (&["yav"], "did you mean `yaw`?"),
        (&["yaw", "--nodes", "0"], "has no node to put the mass"),
        (&["yaw", "--nodes", "-1"], "invalid value"),
        (&["yaw", "--until", "0"], "`duration_s` must be above"),
        (&["yaw", "--until", "NaN"], "duration_s"),
    ]);
    assert_listed("yaw");
}
