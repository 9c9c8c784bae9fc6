//! `aerobot modes` as a user meets it: what it prints, the table that it writes, and what it refuses.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod program;

use std::fs;

use program::{Scratch, aerobot, text};

const PENDULUM: &str = "scenes/examples/elastic_pendulum.ron";

#[test]
fn it_prints_modes_and_writes_the_same_table_every_time() {
    let scratch = Scratch::folder();
    let (first, second) = (scratch.path("first.csv"), scratch.path("second.csv"));
    let printed = aerobot(&["modes", PENDULUM, "--out", &first]);
    assert_eq!(printed.status.code(), Some(0), "{printed:?}");
    let out = text(&printed.stdout);
    for expected in [
        "0.149827 Hz",
        "swing in x of `bob`",
        "swing in y of `bob`",
        "bounce of `bob`",
        "5.03292 Hz",
        "`bob` z 100.0 %",
    ] {
        assert!(out.contains(expected), "{expected}: {out}");
    }
    let quiet = aerobot(&["modes", PENDULUM, "--out", &second, "--quiet"]);
    assert_eq!(quiet.status.code(), Some(0));
    assert!(quiet.stdout.is_empty());
    let table = fs::read_to_string(&first).unwrap();
    assert_eq!(table, fs::read_to_string(&second).unwrap());
    assert!(
        table.starts_with("mode,name,frequency_hz,period_s,damping_ratio,"),
        "{table}"
    );
    let columns = table.lines().next().unwrap().split(',').count();
    assert!(table.lines().all(|line| line.split(',').count() == columns));
    assert!(!table.contains("NaN") && !table.contains("inf"), "{table}");
}

#[test]
fn it_prints_as_many_as_are_asked_for() {
    let printed = aerobot(&["modes", PENDULUM, "--count", "1"]);
    let out = text(&printed.stdout);
    assert!(out.starts_with("1 mode "), "{out}");
    let refused = aerobot(&["modes", PENDULUM, "--count", "0"]);
    assert_eq!(refused.status.code(), Some(2));
}

/// A file that is there stays; a scene that finds no steady state has the message of `trim`.
#[test]
fn it_refuses_as_trim_does() {
    let scratch = Scratch::folder();
    let file = scratch.file("there.csv", "mine");
    let printed = aerobot(&["modes", PENDULUM, "--out", &file]);
    assert_eq!(printed.status.code(), Some(2));
    assert!(text(&printed.stderr).contains("exists"), "{printed:?}");
    assert_eq!(fs::read_to_string(&file).unwrap(), "mine");
    let folder = fs::read_dir("tests/bad_scenes/trimming").unwrap();
    let mut scenes = 0;
    for scene in folder.map(|entry| entry.unwrap().path()) {
        if scene.extension().is_none_or(|extension| extension != "ron") {
            continue;
        }
        scenes += 1;
        let scene = scene.to_str().unwrap();
        let [modes, trim] = ["modes", "trim"].map(|command| aerobot(&[command, scene]));
        assert_eq!(modes.status.code(), Some(2), "{scene}");
        assert_eq!(text(&modes.stderr), text(&trim.stderr), "{scene}");
    }
    assert!(scenes > 0);
}
