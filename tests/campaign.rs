//! Campaigns as a user meets them: the same bytes for any number of workers, of processes, and of kills; replays
//! to the bit; and what is refused.
//!
//! Each `tests/bad_campaigns/NAME.ron` is refused with the text of `NAME.txt`; `AEROBOT_BLESS=1` writes these anew,
//! as in `bad_input.rs`.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod program;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

use program::full_disk::ends_on_a_full_disk;
use program::refused::all_are_refused;
use program::{Scratch, aerobot, text};

/// A free fall of 1 s with all that a campaign can do; every fifth run is refused for its radius.
fn campaign(scratch: &Scratch, head: &str) -> String {
    let scene = fs::read_to_string("scenes/examples/free_fall.ron").unwrap();
    scratch.file("free_fall.ron", &scene);
    scratch.file("masses.csv", "mass_kg\n3\n4\n4.5\n");
    let campaign = format!(
        r#"(
    name: "falls",
    scene: "free_fall.ron",
    {head}
    seed: 7,
    set: {{"run.duration_s": 1, "run.integrator": Auto()}},
    vary: {{
        "entities.sphere.Body.mass_kg": Measured(file: "masses.csv", column: "mass_kg"),
        "entities.sphere.Sphere.radius_m": Uniform(-0.0125, 0.05),
        "environment.gravity": Choice([Constant(8.87), Constant(9.81)]),
    }},
    metrics: {{
        "height_z_m": Final(entity: "sphere", channel: "z_m"),
        "fast_s": FirstTime(entity: "sphere", channel: "vz_m_s", below: -9),
    }},
    envelopes: {{"fall_vz_m_s": (entity: "sphere", channel: "vz_m_s", every_s: 0.25)}},
    keep: (every: 50, extremes_of: ["height_z_m"]),
)
"#
    );
    scratch.file("falls.ron", &campaign)
}

fn done(output: &Output) {
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
}

/// Every file below a folder that is a result: not journals, not how long anything took, not into how many shards
/// it was divided.
fn results(folder: &str) -> BTreeMap<String, Vec<u8>> {
    fn collect(folder: &Path, below: &str, found: &mut BTreeMap<String, Vec<u8>>) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = format!("{below}/{}", path.file_name().unwrap().to_str().unwrap());
            if path.is_dir() {
                collect(&path, &name, found);
            } else if !name.starts_with("/shards/")
                && name != "/manifest.json"
                && !name.ends_with("timing.json")
            {
                found.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    let mut found = BTreeMap::new();
    collect(Path::new(folder), "", &mut found);
    for (name, bytes) in &found {
        let text = String::from_utf8_lossy(bytes);
        assert!(!text.contains("NaN") && !name.ends_with(".part"), "{name}");
    }
    let has = |start: &str| found.keys().any(|name| name.starts_with(start));
    assert!(
        has("/runs.csv") && has("/runs.parquet") && has("/envelopes.parquet") && has("/kept/run-")
    );
    found
}

fn assert_same(left: &BTreeMap<String, Vec<u8>>, right: &BTreeMap<String, Vec<u8>>) {
    assert_eq!(
        left.keys().collect::<Vec<_>>(),
        right.keys().collect::<Vec<_>>()
    );
    for (name, bytes) in left {
        assert!(*bytes == right[name], "{name} differs");
    }
}

/// Starts the program and does not wait for it.
fn start(arguments: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_aerobot"))
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

const PLANS: &str = "runs: 150, plan: LatinHypercube,";

/// One worker, two, two shards at once in processes of their own, in any order.
#[test]
fn workers_and_shards_change_no_byte() {
    let scratch = Scratch::folder();
    let file = campaign(&scratch, PLANS);
    let folders = ["one", "two", "shards"].map(|name| scratch.path(name));
    let run = |workers, folder: &str| {
        done(&aerobot(&[
            "campaign",
            "run",
            &file,
            "--out",
            folder,
            "--workers",
            workers,
        ]));
    };
    run("1", &folders[0]);
    run("2", &folders[1]);
    done(&aerobot(&[
        "campaign",
        "plan",
        &file,
        "--out",
        &folders[2],
        "--shards",
        "2",
    ]));
    let early = aerobot(&["campaign", "merge", &folders[2]]);
    assert_eq!(early.status.code(), Some(2));
    assert!(text(&early.stderr).contains("2 of 2 shards are not finished: 1, 2"));
    let shard = |text: &str| {
        start(&[
            "campaign",
            "run",
            &folders[2],
            "--shard",
            text,
            "--workers",
            "1",
        ])
    };
    for mut child in ["2/2", "1/2"].map(shard) {
        assert!(child.wait().unwrap().success());
    }
    // A finished shard is left alone.
    let again = aerobot(&["campaign", "run", &folders[2], "--shard", "1/2"]);
    assert!(
        !text(&again.stdout).contains("now"),
        "{}",
        text(&again.stdout)
    );
    let status = text(&aerobot(&["campaign", "status", &folders[2]]).stdout);
    assert!(
        status.contains("150 of 150 runs") && status.contains("0 shards missing"),
        "{status}"
    );
    done(&aerobot(&["campaign", "merge", &folders[2]]));
    let all = folders.map(|folder| results(&folder));
    assert_same(&all[0], &all[1]);
    assert_same(&all[0], &all[2]);

    // A fifth of the radii is below zero, and of a Latin hypercube exactly so many.
    let table = String::from_utf8(all[0]["/runs.csv"].clone()).unwrap();
    assert_eq!(table.lines().count(), 151);
    assert_eq!(table.matches(",refused,").count(), 30, "{table}");
    let summary = String::from_utf8(all[0]["/summary.json"].clone()).unwrap();
    assert!(
        summary.contains("\"runs\": 30") && summary.contains("refused: "),
        "{summary}"
    );
}

/// Ended with SIGKILL at moments of chance and started again: no finished run is lost or repeated, and no byte
/// of the results differs.
#[test]
fn kills_change_no_byte() {
    let scratch = Scratch::folder();
    let file = campaign(&scratch, PLANS);
    let (whole, killed) = (scratch.path("whole"), scratch.path("killed"));
    done(&aerobot(&[
        "campaign",
        "run",
        &file,
        "--out",
        &whole,
        "--workers",
        "2",
    ]));
    let journal = |name: &str| {
        let path = format!("{killed}/shards/shard-00001.{name}");
        fs::read_to_string(path).unwrap_or_default()
    };
    let mut before = String::new();
    // A generator of its own, from the process: other moments in every run of this test.
    let mut chance = u64::from(std::process::id());
    for _ in 0..8 {
        chance = chance
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        let mut child = start(&["campaign", "run", &file, "--out", &killed, "--workers", "2"]);
        std::thread::sleep(Duration::from_millis(20 + (chance >> 33) % 120));
        let _ = child.kill();
        child.wait().unwrap();
        let now = journal("part") + &journal("journal");
        let kept = before.rfind('\n').map_or(0, |end| end + 1);
        assert!(now.starts_with(&before[..kept]), "finished runs are lost");
        before = now;
    }
    // A line that was torn.
    let part = format!("{killed}/shards/shard-00001.part");
    if let Ok(text) = fs::read_to_string(&part) {
        fs::write(&part, format!("{text}149\tdone\t1\t\t3")).unwrap();
    }
    done(&aerobot(&["campaign", "run", &file, "--out", &killed]));
    let lines = journal("journal");
    let mut indices: Vec<&str> = lines
        .lines()
        .skip(1)
        .filter_map(|line| line.split('\t').next())
        .collect();
    indices.sort_unstable();
    indices.dedup();
    assert_eq!(
        (indices.len(), lines.lines().count()),
        (150, 151),
        "runs are missing or repeated"
    );
    assert_same(&results(&whole), &results(&killed));
}

/// A replay, and the scene that it writes run by `aerobot run`, end in the digits of the table.
#[test]
fn replays_have_the_bits_of_the_table() {
    let scratch = Scratch::folder();
    let file = campaign(&scratch, "runs: 60, plan: Sobol,");
    let (out, replay, run) = (
        scratch.path("out"),
        scratch.path("replay"),
        scratch.path("run"),
    );
    done(&aerobot(&["campaign", "run", &file, "--out", &out]));
    let table = fs::read_to_string(format!("{out}/runs.csv")).unwrap();
    let row = table
        .lines()
        .skip(8)
        .find(|line| line.contains(",done,"))
        .unwrap();
    let index = row.split(',').next().unwrap();
    let repeated = aerobot(&["campaign", "replay", &out, "--run", index, "--out", &replay]);
    done(&repeated);
    done(&aerobot(&[
        "run",
        &format!("{replay}/scene.ron"),
        "--out",
        &run,
    ]));
    let states = |folder: &str| fs::read_to_string(format!("{folder}/states.csv")).unwrap();
    assert_eq!(states(&replay), states(&run));
    let columns: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let height = columns
        .iter()
        .position(|name| *name == "height_z_m")
        .unwrap();
    let z = states(&replay)
        .lines()
        .last()
        .unwrap()
        .split(',')
        .nth(4)
        .unwrap()
        .to_owned();
    assert_eq!(row.split(',').nth(height), Some(z.as_str()));
    assert!(text(&repeated.stdout).contains(&format!("height_z_m = {z}")));
    let beyond = aerobot(&[
        "campaign",
        "replay",
        &out,
        "--run",
        "60",
        "--out",
        &scratch.path("no"),
    ]);
    assert_eq!(beyond.status.code(), Some(2));
}

/// Stops at the same run for any number of workers, and goes on to the end without the option.
#[test]
fn a_precision_is_reached_at_the_same_run() {
    let scratch = Scratch::folder();
    let file = campaign(&scratch, "runs: 400,");
    let stopped = ["1", "3"].map(|workers| {
        let out = scratch.path(workers);
        let precise = ["--until-ci", "0.1", "--of", "height_z_m"];
        let run = [
            "campaign",
            "run",
            &file,
            "--out",
            &out,
            "--workers",
            workers,
        ];
        done(&aerobot(&[&run[..], &precise].concat()));
        (results(&out), out)
    });
    assert_same(&stopped[0].0, &stopped[1].0);
    let rows = |out: &str| {
        fs::read_to_string(format!("{out}/runs.csv"))
            .unwrap()
            .lines()
            .count()
            - 1
    };
    let counted = rows(&stopped[0].1);
    assert!(
        counted % 50 == 0 && (100..400).contains(&counted),
        "{counted}"
    );
    done(&aerobot(&[
        "campaign",
        "run",
        &file,
        "--out",
        &stopped[0].1,
    ]));
    assert_eq!(rows(&stopped[0].1), 400);
}

#[test]
fn every_bad_campaign_is_refused_with_its_message_and_nothing_is_written() {
    all_are_refused("tests/bad_campaigns", &["campaign", "run"], 15);
}

#[test]
fn folders_of_others_are_left_alone() {
    let scratch = Scratch::folder();
    let file = campaign(&scratch, "runs: 60,");
    let out = scratch.path("out");
    done(&aerobot(&["campaign", "run", &file, "--out", &out]));
    let before = results(&out);
    let refused = |arguments: &[&str], words: &str| {
        let output = aerobot(&[&["campaign"], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(
            text(&output.stderr).contains(words),
            "{}",
            text(&output.stderr)
        );
        assert_same(&before, &results(&out));
    };
    refused(&["run", &out, "--shard", "1/3"], "has 1 shards");
    refused(
        &["run", &file, "--out", &scratch.0.display().to_string()],
        "has no `manifest.json`",
    );
    refused(
        &["run", &out, "--until-ci", "1", "--of", "height"],
        "there is `height_z_m`",
    );
    refused(
        &["plan", &file, "--out", &out, "--shards", "2"],
        "has 1 shards",
    );
    refused(
        &["status", &scratch.path("nowhere")],
        "is not the folder of a campaign",
    );
    scratch.file(
        "free_fall.ron",
        &fs::read_to_string("scenes/examples/free_fall.ron")
            .unwrap()
            .replace("8.87", "8.9"),
    );
    refused(
        &["run", &file, "--out", &out],
        "belongs to another campaign",
    );
    scratch.file("out/input/scene.ron", "()");
    let changed = aerobot(&["campaign", "run", &out]);
    assert!(text(&changed.stderr).contains("have been changed"));
}

/// A limit on the size of files stands in for a full disk: the runs that were finished are kept.
#[test]
fn a_full_disk_ends_it_and_keeps_what_is_finished() {
    let scratch = Scratch::folder();
    let file = campaign(&scratch, PLANS);
    let (whole, full) = (scratch.path("whole"), scratch.path("full"));
    ends_on_a_full_disk(8, &["campaign", "run", &file, "--out", &full]);
    let kept = fs::read_to_string(format!("{full}/shards/shard-00001.part")).unwrap();
    assert!(kept.lines().count() > 10);
    done(&aerobot(&["campaign", "run", &file, "--out", &full]));
    done(&aerobot(&["campaign", "run", &file, "--out", &whole]));
    assert_same(&results(&whole), &results(&full));
}
