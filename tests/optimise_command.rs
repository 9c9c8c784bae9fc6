//! Design searches as a user meets them: the same bytes for any number of workers and of kills; designs that fail; and
//! what is refused.
//!
//! Each `tests/bad_searches/NAME.ron` is refused with the text of `NAME.txt`; `AEROBOT_BLESS=1` writes these anew,
//! as in `bad_input.rs`.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod program;

use std::collections::BTreeMap;
use std::fs;
use std::process::{Command, Stdio};
use std::time::Duration;

use program::full_disk::ends_on_a_full_disk;
use program::refused::all_are_refused;
use program::searches::{GUSTS, THROW, Table, optimised, search};
use program::{Scratch, aerobot, text};

/// Every result; not the journal, whose lines come as runs finish.
fn results(folder: &str) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let files = entries.filter(|path| path.is_file());
    let mut found: BTreeMap<String, Vec<u8>> = files
        .map(|path| {
            let name = path.file_name().unwrap().to_str().unwrap().to_owned();
            (name, fs::read(&path).unwrap())
        })
        .collect();
    assert!(found.remove("runs.journal").is_some());
    for name in [
        "evaluations.csv",
        "summary.json",
        "best.ron",
        "manifest.json",
    ] {
        assert!(found.contains_key(name), "{name}");
    }
    assert_eq!(found.len(), 4, "{:?}", found.keys());
    found
}

#[test]
fn workers_kills_and_pauses_change_no_byte() {
    let scratch = Scratch::folder();
    let scene = fs::read_to_string("scenes/gust_response.ron").unwrap();
    let file = search(&scratch, &scene, GUSTS);
    let folders = ["one", "two", "killed", "paused"].map(|name| scratch.path(name));
    for (folder, workers) in folders.iter().zip(["1", "2"]) {
        let output = aerobot(&["optimise", &file, "--out", folder, "--workers", workers]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    }
    // A generator of its own, from the process: other moments in every run of this test.
    let mut chance = u64::from(std::process::id());
    let journal = || fs::read_to_string(format!("{}/runs.journal", folders[2])).unwrap_or_default();
    let mut before = String::new();
    for _ in 0..6 {
        chance = chance
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        let mut child = Command::new(env!("CARGO_BIN_EXE_aerobot"))
            .args(["optimise", &file, "--out", &folders[2], "--workers", "2"])
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_millis(30 + (chance >> 33) % 100));
        let _ = child.kill();
        child.wait().unwrap();
        let now = journal();
        let kept = before.rfind('\n').map_or(0, |end| end + 1);
        assert!(now.starts_with(&before[..kept]), "finished runs are lost");
        before = now;
    }
    // A line that was torn.
    if !before.is_empty() {
        let torn = format!("{before}100.0\t3\tdone\t8\t\t0.0");
        fs::write(format!("{}/runs.journal", folders[2]), torn).unwrap();
    }
    let output = aerobot(&["optimise", &file, "--out", &folders[2]]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let evaluations = Table::read(&format!("{}/evaluations.csv", folders[2]))
        .0
        .len();
    let lines = journal().lines().count();
    assert_eq!(lines, 12 * evaluations + 1, "runs are missing or repeated");

    // Ended at the most evaluations, where none is feasible yet or not the best, and gone on with.
    let paused = [
        "optimise",
        &file,
        "--out",
        &folders[3],
        "--evaluations",
        "8",
    ];
    let output = aerobot(&paused);
    assert!(
        text(&output.stdout).contains("so far"),
        "{}",
        text(&output.stdout)
    );
    assert_eq!(
        Table::read(&format!("{}/evaluations.csv", folders[3]))
            .0
            .len(),
        8
    );
    let output = aerobot(&["optimise", &folders[3]]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let all = folders.map(|folder| results(&folder));
    for other in &all[1..] {
        assert_eq!(all[0], *other);
    }
}

/// Designs that the scene refuses, or whose run stops, do not end the search.
#[test]
fn designs_that_fail_are_infeasible() {
    let scratch = Scratch::folder();
    let best = optimised(
        &scratch,
        THROW,
        r#"
        variables: {"entities.ball.Body.mass_kg": (from: -3, to: 5)},
        objective: Minimise(Mass(["ball"])),
        constraints: {"range_x_m": (of: Value("range_x_m"), at_least: 99)},
        metrics: {"range_x_m": Final(entity: "ball", channel: "x_m")},"#,
    );
    let mass_kg = best.objective();
    assert!(mass_kg > 0.0 && mass_kg < 2.0, "{mass_kg}");
    let table = fs::read_to_string(scratch.path("out/evaluations.csv")).unwrap();
    assert!(
        table.contains(",failed,") && table.contains("must be above zero"),
        "{table}"
    );
}

#[test]
fn a_search_that_finds_nothing_says_so() {
    let scratch = Scratch::folder();
    let file = search(
        &scratch,
        THROW,
        r#"
        variables: {"entities.ball.Motion.velocity_m_s.0": (from: 0, to: 10)},
        objective: Minimise(Value("range_x_m")),
        constraints: {"range_x_m": (of: Value("range_x_m"), at_least: 101)},
        metrics: {"range_x_m": Final(entity: "ball", channel: "x_m")},"#,
    );
    let out = scratch.path("out");
    let output = aerobot(&["optimise", &file, "--out", &out]);
    assert_eq!(output.status.code(), Some(3));
    let said = text(&output.stdout);
    assert!(
        said.contains("the least infeasible")
            && said.contains("at its upper bound")
            && said.contains("BROKEN"),
        "{said}"
    );
    assert!(text(&output.stderr).contains("no design keeps to every constraint"));
    assert!(!fs::exists(format!("{out}/best.ron")).unwrap());
    let summary = fs::read_to_string(format!("{out}/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["least_infeasible"]["variables"][0]["value"], 10.0);
}

#[test]
fn every_bad_search_is_refused_with_its_message_and_nothing_is_written() {
    all_are_refused("tests/bad_searches", &["optimise"], 14);
}

#[test]
fn folders_of_others_are_left_alone() {
    let scratch = Scratch::folder();
    let body = r#"
        variables: {"entities.ball.Motion.velocity_m_s.0": (from: 0, to: 10)},
        objective: Maximise(Value("range_x_m")),
        metrics: {"range_x_m": Final(entity: "ball", channel: "x_m")},
        search: (evaluations: 9),"#;
    let file = search(&scratch, THROW, body);
    let out = scratch.path("out");
    aerobot(&["optimise", &file, "--out", &out]);
    let before = results(&out);
    let refused = |arguments: &[&str], words: &str| {
        let output = aerobot(arguments);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(said.contains(words), "{said}");
        assert_eq!(before, results(&out));
    };
    refused(
        &["campaign", "run", &out],
        "is not the manifest of a campaign",
    );
    refused(
        &["optimise", &out, "--out", &out],
        "has its results in itself",
    );
    refused(
        &["optimise", &file, "--out", scratch.text()],
        "has no `manifest.json`",
    );
    refused(&["optimise", &scratch.path("nowhere")], "cannot read");
    let other = body.replace("to: 10", "to: 11");
    let file = search(&scratch, THROW, &other);
    refused(
        &["optimise", &file, "--out", &out],
        "belongs to another design search",
    );
}

/// A limit on the size of files stands in for a full disk: the runs that were finished are kept.
#[test]
fn a_full_disk_ends_it_and_keeps_what_is_finished() {
    let scratch = Scratch::folder();
    let scene = fs::read_to_string("scenes/gust_response.ron").unwrap();
    let file = search(&scratch, &scene, GUSTS);
    let (whole, full) = (scratch.path("whole"), scratch.path("full"));
    ends_on_a_full_disk(7, &["optimise", &file, "--out", &full]);
    let kept = fs::read_to_string(format!("{full}/runs.journal")).unwrap();
    assert!(kept.lines().count() > 10);
    for folder in [&full, &whole] {
        let output = aerobot(&["optimise", &file, "--out", folder]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    }
    assert_eq!(results(&whole), results(&full));
}
