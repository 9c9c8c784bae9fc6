//! The cases of the paper that compare formulations, chains, coupled motions and docking, and the command that runs all
//! cases beside each other. What each case is held against stands in its checks: here they must hold, and there must
//! be as many as the case has.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod program;

use std::fs;

use aerobot::engine::plugin::Simulator;
use aerobot::reproduce::docking::{DockingSettings, study as dock};
use aerobot::reproduce::{Report, Settings, cases};
use program::reproduced::{assert_kept, assert_refused, assert_tables};
use program::{Scratch, aerobot, text};

/// Runs a case by its name; every check must hold, against the paper too.
fn report(name: &str, nodes: u32, duration_s: f64) -> Report {
    let settings = Settings {
        nodes: Some(nodes),
        duration_s: Some(duration_s),
    };
    let case = cases()
        .into_iter()
        .find(|case| case.name() == name)
        .unwrap();
    let report = case
        .run(&Simulator::new(), &settings, &mut |_, _| {})
        .unwrap_or_else(|error| panic!("{error}"));
    for check in &report.checks {
        println!("{check}");
        assert!(check.holds, "{check}");
    }
    assert!(report.stopped.is_empty() && report.verdict.holds);
    assert!(!report.title.is_empty() && !report.paper_shows.is_empty());
    report
}

/// How many checks have such a beginning.
fn count(report: &Report, beginning: &str) -> usize {
    let own = report.checks.iter();
    own.filter(|check| check.what.starts_with(beginning))
        .count()
}

#[test]
fn val_both_formulations_fly_one_trajectory() {
    let report = report("comparison", 3, 25.0);
    assert_eq!(count(&report, "stretch"), 1);
    assert_eq!(count(&report, "force on"), 4);
    assert_eq!(count(&report, "motion before"), 2);
    assert_eq!(count(&report, "power of 1/EA"), 2);
    assert_eq!(count(&report, "largest difference"), 1);
}

#[test]
fn val_chains_carry_their_weights_and_swing_as_pendulums() {
    let report = report("chains", 2, 22.0);
    for (beginning, wanted) in [
        ("multi-tether: pull", 4),
        ("flight-chain: pull", 12),
        ("multi-tether: heading", 2),
        ("multi-tether: swing", 1),
        ("multi-tether: yaw", 1),
        ("flight-chain: swing of the magnetometer", 1),
        ("multi-tether: power of 1/EA", 2),
        ("flight-chain: power of 1/EA", 2),
    ] {
        assert_eq!(count(&report, beginning), wanted, "{beginning}");
    }
}

#[test]
fn val_pendulum_and_torsion_couple_off_the_axis() {
    let report = report("mojave", 2, 60.0);
    assert_eq!(count(&report, "mode of the swing"), 4);
    assert_eq!(count(&report, "mode of the turn"), 4);
    assert_eq!(count(&report, "turn of a gondola on the axis"), 1);
    assert_eq!(count(&report, "turns of offsets"), 1);
    assert_eq!(count(&report, "power of 1/EA"), 1);
}

/// Two frequencies 0.0075 Hz apart in the spectrum of 288 s.
#[test]
fn val_the_spectrum_of_a_flight_shows_its_modes() {
    use aerobot::engine::modes::Motion;
    use aerobot::reproduce::mojave::{MojaveSettings, study};
    use aerobot_report::spectrum::{peak_near, peaks};
    let settings = MojaveSettings {
        offsets_m: vec![0.05],
        offset_of_links_m: 0.05,
        nodes: Some(1),
        duration_s: 300.0,
    };
    let found = study(&Simulator::new(), &settings, &mut |_, _| {}).unwrap();
    let result = &found.offsets[0];
    for (spectrum, motion) in [
        (&result.swing, Motion::X),
        (&result.turn, Motion::X),
        (&result.turn, Motion::Yaw),
    ] {
        let mode_hz = result.mode_hz(motion).unwrap();
        let peak_hz = peak_near(spectrum, mode_hz, 0.05).unwrap().frequency_hz;
        println!("{motion:?}: mode {mode_hz} Hz, peak {peak_hz} Hz");
        assert!((peak_hz / mode_hz - 1.0).abs() < 0.005);
    }
    // Two frequencies, and not one peak near both.
    assert!(peaks(&result.turn, 0.05).len() >= 2);
}

/// Momentum and power, from the library; a seed other than those of the case.
#[test]
fn val_docking_conserves_momentum() {
    let settings = DockingSettings {
        seeds: vec![11],
        ..DockingSettings::default()
    };
    let found = dock(&Simulator::new(), &settings, &mut |_, _| {}).unwrap();
    let [approach] = found.approaches.as_slice() else {
        panic!("one seed, one approach")
    };
    let impact = approach.impact.unwrap();
    let part = impact.change_kg_m_s() / impact.exchanged_kg_m_s(&found.craft);
    println!(
        "docked at {:?}, {part:.4} of the momentum lost",
        approach.docked_s()
    );
    assert!(part < 0.01, "{part}");
    assert!((impact.recorded_m_s - impact.ports_m_s).abs() < 0.01);
    let [thrust_n, airspeed_m_s, power_w] = approach.closing_means().unwrap();
    let theory_w = found.craft.level_power_w(thrust_n, airspeed_m_s);
    assert!(
        (power_w / theory_w - 1.0).abs() < 0.02,
        "{power_w} {theory_w}"
    );
    // By hand: 53.22 N on four discs of 0.5 m at 1.04 kg/m3, 305 W over 0.65.
    let hover_w = found.craft.hover_power_w();
    assert!((460.0..480.0).contains(&hover_w), "{hover_w}");
    let last = approach.rows.last().unwrap();
    assert!(last.path_m.length() < 0.3 && last.phase == 4.0);
}

/// All cases beside each other: in the order of the list, with the bytes of one alone.
#[test]
fn cases_run_beside_each_other_in_the_order_of_the_paper() {
    let short = ["--nodes", "2", "--until", "2"];
    let (all, alone) = (Scratch::new(), Scratch::new());
    let output = aerobot(&[&["reproduce", "--out", all.text()], &short[..]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let printed = text(&output.stdout);
    let wrote: Vec<&str> = printed
        .lines()
        .filter_map(|line| line.split_once(": wrote ").map(|(case, _)| case))
        .collect();
    let listed = text(&aerobot(&["reproduce", "--list"]).stdout);
    let names: Vec<&str> = listed
        .lines()
        .filter_map(|line| line.split(' ').next())
        .collect();
    assert_eq!(wrote, names);
    assert_eq!(names.len(), 9);
    assert_eq!(
        printed
            .lines()
            .filter(|line| line.starts_with("verdict: "))
            .count(),
        9
    );
    for figure in [
        "5, 6", "7, 8", "9, 10", "11", "13, 14", "15", "17 to 19", "21",
    ] {
        assert!(listed.contains(&format!(" {figure}")), "{figure}: {listed}");
    }
    for case in ["comparison", "chains", "mojave", "docking"] {
        let arguments = [
            &["reproduce", case, "--force", "--out", alone.text()],
            &short[..],
        ]
        .concat();
        let output = aerobot(&arguments);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        let said = text(&output.stdout).replace(alone.text(), all.text());
        // Both end with where the page is.
        let (said, _) = said.split_once("\nreport in `").unwrap();
        assert!(printed.contains(said), "{case}: {said}");
    }
    for entry in fs::read_dir(&alone.0).unwrap() {
        let file = entry.unwrap().file_name();
        // The page says what each case took.
        if file == "report.html" {
            continue;
        }
        let [one, other] = [&alone, &all].map(|scratch| fs::read(scratch.0.join(&file)).unwrap());
        assert!(one == other, "{}", file.display());
    }
    let page = fs::read_to_string(all.0.join("report.html")).unwrap();
    for part in [
        "Two formulations of one flight",
        "comparison-displacement",
        "docking-approach",
        "Time taken",
    ] {
        assert!(page.contains(part), "{part}");
    }
    // Bodies x formulations x outputs; offsets and one in links; seeds, a row each 0.1 s.
    assert_tables(
        &all,
        &[
            ("comparison_displacement.csv", 2 * 2 * 3),
            ("comparison_difference.csv", 2 * 3),
            ("comparison_tension.csv", 2 * 3),
            ("comparison_stiffness.csv", 4),
            ("chains_displacement.csv", 2 * 2 * 5 + 4 * 2 * 5),
            ("chains_stiffness.csv", 2 * 3),
            ("mojave_motion.csv", 5 * 21),
            ("docking.csv", 4),
            ("docking_approach.csv", 4 * 21),
        ],
    );
}

#[test]
fn what_makes_no_sense_is_refused_and_nothing_is_written() {
    assert_refused(&[
        (&["dock"], "did you mean `docking`?"),
        (&["chain"], "did you mean `chains`?"),
        (&["mojave", "--nodes", "0"], "has no node to put the mass"),
        (
            &["comparison", "--until", "0"],
            "`duration_s` must be above",
        ),
        (&["--until", "0"], "`duration_s` must be above"),
    ]);
    let scratch = Scratch::new();
    let short = ["reproduce", "mojave", "--nodes", "1", "--until", "1"];
    let first = aerobot(&[&short[..], &["--out", scratch.text()]].concat());
    assert_eq!(first.status.code(), Some(0), "{}", text(&first.stderr));
    assert_kept(&short, scratch.text());
}
