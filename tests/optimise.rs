//! Design searches as a user meets them: optima that are known in closed form or found by other means; the same bytes
//! for any number of workers and of kills; and what is refused.
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
use program::{Scratch, aerobot, text};

/// A point of 2 kg that flies 10 s without air, g = 8.87 m/s^2.
const THROW: &str = r#"(
    name: "throw",
    environment: (gravity: Constant(8.87), atmosphere: Vacuum),
    entities: {
        "ball": (
            Body: (mass_kg: 2),
            Pose: (position_m: (0, 0, 0)),
            Motion: (velocity_m_s: (10, 0, 10)),
        ),
    },
    run: (
        duration_s: 10, output_every_s: 1, integrator: Adaptive(relative_tolerance: 1e-11),
        record: (channels: All),
    ),
)
"#;

/// A point of 1 kg that falls into a line without damping or mass, of 10 m.
const BOUNCE: &str = r#"(
    name: "bounce",
    environment: (gravity: Constant(8.87), atmosphere: Vacuum),
    entities: {
        "pivot": (Fixed: (position_m: (0, 0, 0))),
        "bob": (Body: (mass_kg: 1), Pose: (position_m: (0, 0, -10))),
        "line": (Tether: (
            from: ("pivot", Centre), to: ("bob", Centre), length_m: 10, nodes: 0, axial_stiffness_n: 1e4,
        )),
    },
    run: (duration_s: 0.3, output_every_s: 0.0005, integrator: Adaptive(relative_tolerance: 1e-10)),
)
"#;

/// Columns of a CSV table without quotes in what is looked at.
struct Table(Vec<BTreeMap<String, String>>);

impl Table {
    fn read(path: &str) -> Self {
        let text = fs::read_to_string(path).unwrap();
        let mut lines = text.lines();
        let head: Vec<&str> = lines.next().unwrap().split(',').collect();
        let row = |line: &str| {
            let fields = line.splitn(head.len(), ',').map(str::to_owned);
            head.iter()
                .map(|name| (*name).to_owned())
                .zip(fields)
                .collect()
        };
        Self(lines.map(row).collect())
    }

    fn numbers(&self, column: &str) -> Vec<f64> {
        self.0
            .iter()
            .map(|row| row[column].parse().unwrap())
            .collect()
    }
}

struct Best(serde_json::Value);

impl Best {
    fn of(folder: &str) -> Self {
        let text = fs::read_to_string(format!("{folder}/summary.json")).unwrap();
        assert!(!text.contains("NaN"));
        Self(serde_json::from_str::<serde_json::Value>(&text).unwrap()["best"].clone())
    }

    fn objective(&self) -> f64 {
        self.0["objective"]["value"].as_f64().unwrap()
    }

    fn named(&self, list: &str, name: &str) -> f64 {
        let list = self.0[list].as_array().unwrap();
        let entry = list.iter().find(|entry| entry["name"] == name);
        entry.unwrap()["value"].as_f64().unwrap()
    }
}

fn search(scratch: &Scratch, scene: &str, body: &str) -> String {
    scratch.file("scene.ron", scene);
    let search = format!("(name: \"search\", scene: \"scene.ron\", {body})");
    scratch.file("search.ron", &search)
}

fn optimised(scratch: &Scratch, scene: &str, body: &str) -> Best {
    let file = search(scratch, scene, body);
    let out = scratch.path("out");
    let output = aerobot(&["optimise", &file, "--out", &out]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    Best::of(&out)
}

/// Farthest throw with a given energy that is back at its height after 10 s: v_z = g t / 2, and v_x has what is left.
#[test]
fn the_farthest_throw_in_closed_form() {
    let scratch = Scratch::folder();
    let best = optimised(
        &scratch,
        THROW,
        r#"
        variables: {
            "entities.ball.Motion.velocity_m_s.0": (from: 0, to: 200),
            "entities.ball.Motion.velocity_m_s.2": (from: 0, to: 200),
        },
        objective: Maximise(Value("range_x_m")),
        constraints: {
            "height_z_m": (of: Value("height_z_m"), at_least: 0),
            "energy_j": (of: Value("energy_j"), at_most: 6400),
        },
        metrics: {
            "range_x_m": Final(entity: "ball", channel: "x_m"),
            "height_z_m": Final(entity: "ball", channel: "z_m"),
            "energy_j": Largest(entity: "system", channel: "kinetic_energy_j"),
        },
        search: (tolerance: 1e-6),"#,
    );
    let up = 0.5 * 8.87 * 10.0;
    let along = libm::sqrt(6400.0 - up * up);
    let found = best.objective();
    assert!(
        (found / (10.0 * along) - 1.0).abs() < 1e-4,
        "{found} {}",
        10.0 * along
    );
    let found = best.named("variables", "entities.ball.Motion.velocity_m_s.2");
    assert!((found / up - 1.0).abs() < 1e-4, "{found} {up}");
    // The scene of the best design is that flight.
    let run = scratch.path("run");
    let output = aerobot(&["run", &scratch.path("out/best.ron"), "--out", &run]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let states = Table::read(&format!("{run}/states.csv"));
    assert_eq!(states.numbers("x_m").last(), Some(&best.objective()));
}

/// What falls into a spring without loss stretches it by 2 m g L / EA: the softest line that lets it fall 20 mm.
#[test]
fn the_softest_line_in_closed_form() {
    let scratch = Scratch::folder();
    let best = optimised(
        &scratch,
        BOUNCE,
        r#"
        variables: {"entities.line.Tether.axial_stiffness_n": (from: 100, to: 1e6, scale: Log)},
        objective: Minimise(Variable("entities.line.Tether.axial_stiffness_n")),
        constraints: {"lowest_z_m": (of: Value("lowest_z_m"), at_least: -10.02)},
        metrics: {"lowest_z_m": Smallest(entity: "bob", channel: "z_m")},
        search: (tolerance: 1e-7),"#,
    );
    let stiffness_n = 2.0 * 8.87 * 10.0 / 0.02;
    // Rows every 0.0005 s miss the lowest place by 1e-5 of the stretch at most; the tolerance is 1e-6 of the value.
    let error = best.objective() / stiffness_n - 1.0;
    assert!(error.abs() < 5e-5, "{error}");
    let lowest_m = best.named("constraints", "lowest_z_m");
    assert!((-10.02..-10.0199).contains(&lowest_m), "{lowest_m}");
}

/// (v^2 + c^2 / v^2) is least where v = sqrt(c): inside of the bounds, with a law of power -1; and of whole v at the
/// best of its neighbours.
#[test]
fn an_optimum_inside_and_one_of_whole_numbers() {
    for (integer, at) in [("false", libm::sqrt(1400.0)), ("true", 37.0)] {
        let scratch = Scratch::folder();
        let best = optimised(
            &scratch,
            THROW,
            &format!(
                r#"
                variables: {{
                    "speed_m_s": (from: 1, to: 100, integer: {integer}, start: 90, sets: {{
                        "entities.ball.Motion.velocity_m_s.0": (),
                        "entities.ball.Motion.velocity_m_s.1": (factor: 1400, power: -1),
                    }}),
                }},
                set: {{"run.duration_s": 0.1, "entities.ball.Motion.velocity_m_s.2": 0}},
                objective: Minimise(Value("energy_j")),
                metrics: {{"energy_j": Smallest(entity: "system", channel: "kinetic_energy_j")}},
                "#
            ),
        );
        let found = best.named("variables", "speed_m_s");
        // A valley is flat at its floor: 1e-3 of the value is 4e-6 of what is to be least.
        assert!((found / at - 1.0).abs() < 2e-3, "{found} {at}");
        let energy = at * at + 1400.0 * 1400.0 / at / at;
        assert!((best.objective() / energy - 1.0).abs() < 1e-5);
    }
}

/// Twelve flights of 10 s through gusts for each design.
const GUSTS: &str = r#"
    variables: {"entities.tether.Tether.length_m": (from: 100, to: 1000)},
    objective: Minimise(Mass(["tether"])),
    constraints: {
        "swing_90_rad": (of: Percentile(metric: "swing_rad", percent: 90), at_most: 0.008),
    },
    runs: 12,
    seed: 3,
    set: {"run.duration_s": 8, "entities.tether.Tether.nodes": 1},
    metrics: {"swing_rad": Largest(entity: "gondola", channel: "swing_rad")},
    search: (sample: 5, starts: 1, tolerance: 1e-4),
"#;

/// The percentile of the same flights, by a campaign and by hand.
fn swing_90_rad(scratch: &Scratch, length_m: f64) -> f64 {
    let campaign = format!(
        r#"(name: "flights", scene: "scene.ron", runs: 12, seed: 3,
            set: {{"run.duration_s": 8, "entities.tether.Tether.nodes": 1, "entities.tether.Tether.length_m": {length_m:?}}},
            metrics: {{"swing_rad": Largest(entity: "gondola", channel: "swing_rad")}})"#
    );
    let file = scratch.file("flights.ron", &campaign);
    let out = scratch.path(&format!("flights-{length_m}"));
    let output = aerobot(&["campaign", "run", &file, "--out", &out]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let mut swings = Table::read(&format!("{out}/runs.csv")).numbers("swing_rad");
    swings.sort_by(f64::total_cmp);
    // 0.9 x 11 = 9.9.
    swings[9] + 0.9 * (swings[10] - swings[9])
}

/// At the optimum the percentile is the limit; a grid over all lengths has its shortest just beyond; and the mass
/// is that of a cylinder.
#[test]
fn gusts_by_a_campaign_and_by_a_grid() {
    let scratch = Scratch::folder();
    let scene = fs::read_to_string("scenes/gust_response.ron").unwrap();
    let best = optimised(&scratch, &scene, GUSTS);
    let length_m = best.named("variables", "entities.tether.Tether.length_m");
    let swing_rad = best.named("constraints", "swing_90_rad");
    let again_rad = swing_90_rad(&scratch, length_m);
    assert!(
        (swing_rad / again_rad - 1.0).abs() < 1e-12,
        "{swing_rad} {again_rad}"
    );
    assert!(
        swing_rad <= 0.008 && swing_rad > 0.008 * 0.999,
        "{swing_rad}"
    );
    let mass_kg = 1440.0 * std::f64::consts::PI * 0.25 * 0.002 * 0.002 * length_m;
    assert!((best.objective() / mass_kg - 1.0).abs() < 1e-12);
    let grid = (0..=18).map(|k| 100.0 + 50.0 * f64::from(k));
    let kept = grid
        .into_iter()
        .find(|length_m| swing_90_rad(&scratch, *length_m) <= 0.008);
    let shortest_m = kept.unwrap();
    assert!(
        shortest_m >= length_m && shortest_m - length_m <= 50.0,
        "{shortest_m} {length_m}"
    );
}

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
