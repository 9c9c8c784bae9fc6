//! `aerobot compare` as a user meets it: what it prints and writes, and what it refuses.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod program;

use std::fs;

use program::{Scratch, aerobot, text};

const SCENE: &str = "scenes/paper/comparison_900m.ron";
/// A body that falls through the air below the end of the atmosphere at 0 m.
const FALLING: &str = "tests/bad_scenes/while_running/falls_out_of_the_air.ron";

#[test]
fn wrong_arguments_are_refused_and_nothing_is_written() {
    let out = Scratch::new();
    for (arguments, message) in [
        (&["compare"][..], "SCENE"),
        (&["compare", "tests/no_such_scene.ron"], "cannot read"),
        (
            &["compare", SCENE, "--formulation", "denoc"],
            "--formulation",
        ),
        (&["compare", SCENE, "--until", "soon"], "soon"),
        (
            &["compare", SCENE, "--set", "run.formulation=Denoc"],
            "error: `--set run.formulation`: the two runs that are compared differ in",
        ),
    ] {
        let output = aerobot(&[arguments, &["--out", out.text()]].concat());
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(message), "{arguments:?}: {said}");
        assert!(!out.0.exists() && output.stdout.is_empty(), "{arguments:?}");
    }
}

#[test]
fn the_command_prints_differences_and_costs() {
    let out = Scratch::new();
    let short = ["compare", SCENE, "--until", "12", "--out", out.text()];
    let first = aerobot(&short);
    assert_eq!(first.status.code(), Some(0), "{}", text(&first.stderr));
    let said = text(&first.stdout);
    for part in [
        "denoc less lumped-mass, up to 12 s",
        "balloon",
        "gondola",
        "distance",
        "largest difference",
        "simulated s per CPU s",
        "integrator of denoc",
        out.text(),
    ] {
        assert!(said.contains(part), "{part} is not in\n{said}");
    }
    assert!(!said.contains("NaN") && !said.contains("inf"), "{said}");
    for folder in ["lumped-mass", "denoc"] {
        for file in ["scene.ron", "states.csv", "tethers.csv", "timing.json"] {
            assert!(out.0.join(folder).join(file).exists(), "{folder}/{file}");
        }
        let summary = fs::read_to_string(out.0.join(folder).join("summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
        assert_eq!(summary["formulation"], folder);
    }
    for table in [
        "differences.csv",
        "body_differences.csv",
        "tether_differences.csv",
        "costs.csv",
    ] {
        assert!(out.0.join(table).exists(), "{table}");
    }
    let again = aerobot(&short);
    assert_eq!(again.status.code(), Some(2));
    assert!(text(&again.stderr).contains("`--force`"));
    let quiet = aerobot(&[&short[..], &["--force", "--quiet"]].concat());
    assert_eq!(quiet.status.code(), Some(0));
    assert!(quiet.stdout.is_empty() && quiet.stderr.is_empty());
}

#[test]
fn a_command_that_stops_says_up_to_when_it_has_compared() {
    let out = Scratch::new();
    let stopped = aerobot(&["compare", FALLING, "--out", out.text()]);
    let said = text(&stopped.stderr);
    assert_eq!(stopped.status.code(), Some(3), "{said}");
    for part in [
        "error: `lumped-mass` stopped at ",
        "error: `denoc` stopped at ",
        "`stone`",
        "compared up to ",
        out.text(),
    ] {
        assert!(said.contains(part), "{part} is not in\n{said}");
    }
    assert!(out.0.join("differences.csv").exists());
}

#[test]
fn a_bad_scene_gets_the_message_of_every_command() {
    let out = Scratch::new();
    let scene = "tests/bad_scenes/negative_mass.ron";
    let compare = aerobot(&["compare", scene, "--out", out.text()]);
    assert_eq!(compare.status.code(), Some(2));
    assert_eq!(
        text(&compare.stderr),
        text(&aerobot(&["check", scene]).stderr)
    );
    assert!(!out.0.exists() && compare.stdout.is_empty());
}
