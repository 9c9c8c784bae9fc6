//! One scene run in two ways, side by side: the numbers against what the two folders hold.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod flight;
mod program;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use aerobot::comparison::difference::TensionAt;
use aerobot::comparison::{CompareError, Comparison, Pair, Variant};
use aerobot::engine::plugin::Simulator;
use aerobot::engine::run_folder::{Destination, RunError};
use flight::owned;
use program::{Scratch, aerobot, text};

/// A second way that differs by its errors: what is tested here does not ask what moves a tether.
const WAYS: [Variant; 2] = [
    Variant {
        name: "fine",
        change: "run.integrator=Adaptive()",
    },
    Variant {
        name: "rough",
        change: "run.integrator=Implicit(accuracy_m: 0.3)",
    },
];
const TABLES: [&str; 4] = [
    "differences.csv",
    "body_differences.csv",
    "tether_differences.csv",
    "costs.csv",
];
const RUN_FILES: [&str; 5] = [
    "scene.ron",
    "states.csv",
    "tethers.csv",
    "channels.csv",
    "summary.json",
];
const SCENE: &str = "scenes/paper/comparison_900m.ron";
/// A body that falls through the air below the end of the atmosphere at 0 m.
const FALLING: &str = "tests/bad_scenes/while_running/falls_out_of_the_air.ron";

fn load(file: &str, overrides: &[&str], ways: [Variant; 2]) -> Result<Pair, CompareError> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    Pair::load(&Simulator::new(), &file, &owned(overrides), ways)
}

fn compared(file: &str, overrides: &[&str], ways: [Variant; 2], out: &Scratch) -> Comparison {
    let pair = load(file, overrides, ways).unwrap_or_else(|error| panic!("{error}"));
    let mut parts = Vec::new();
    let destination = Destination {
        folder: out.0.clone(),
        overwrite: false,
    };
    let comparison = pair.run_into(&destination, &mut |_, part| parts.push(part));
    let comparison = comparison.unwrap_or_else(|error| panic!("{error}"));
    assert!(parts.is_sorted(), "{parts:?}");
    comparison
}

/// The rows of a CSV file, without its header.
fn rows(folder: &Path, file: &str) -> Vec<Vec<String>> {
    let text = fs::read_to_string(folder.join(file)).unwrap();
    let mut lines = text.lines();
    let columns = lines.next().unwrap().split(',').count();
    let rows = lines.map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
    let rows: Vec<_> = rows.collect();
    assert!(rows.iter().all(|row| row.len() == columns), "{file}");
    rows
}

/// Positions by time and body, as text and as numbers.
fn positions(folder: &Path) -> Vec<(String, String, [f64; 3])> {
    let bodies = rows(folder, "states.csv").into_iter();
    let bodies = bodies.filter(|row| !row[1].contains('/'));
    bodies
        .map(|row| {
            let position = [2, 3, 4].map(|column: usize| row[column].parse().unwrap());
            (row[0].clone(), row[1].clone(), position)
        })
        .collect()
}

/// Differences by body: time, x, y, z, distance.
fn differences(out: &Scratch) -> BTreeMap<String, Vec<[f64; 5]>> {
    let (first, second) = (
        positions(&out.0.join("fine")),
        positions(&out.0.join("rough")),
    );
    assert_eq!(first.len(), second.len());
    let mut found: BTreeMap<String, Vec<[f64; 5]>> = BTreeMap::new();
    for (a, b) in first.iter().zip(&second) {
        assert_eq!((&a.0, &a.1), (&b.0, &b.1));
        let [x, y, z] = [0, 1, 2].map(|axis| b.2[axis] - a.2[axis]);
        let row = [
            a.0.parse().unwrap(),
            x,
            y,
            z,
            (x * x + y * y + z * z).sqrt(),
        ];
        found.entry(a.1.clone()).or_default().push(row);
    }
    found
}

/// The first row in which a column is farthest from zero.
fn farthest(rows: &[[f64; 5]], column: usize) -> (f64, f64) {
    let largest = rows.iter().map(|row| row[column].abs()).fold(0.0, f64::max);
    let row = rows
        .iter()
        .find(|row| row[column].abs() == largest)
        .unwrap();
    (row[column], row[0])
}

#[test]
fn differences_of_bodies_are_those_of_the_two_folders() {
    let out = Scratch::new();
    let overrides = [
        "run.duration_s=30",
        "run.record.bodies=Every(period_s: 0.3)",
    ];
    let comparison = compared(SCENE, &overrides, WAYS, &out);
    let expected = differences(&out);
    assert_eq!(comparison.bodies.len(), 2);
    assert!(comparison.is_complete() && comparison.missing.is_empty());
    assert_eq!(comparison.compared_until_s(), Some(30.0));
    for body in &comparison.bodies {
        let rows = &expected[&*body.name];
        for axis in 0..3 {
            let found = body.largest_m[axis];
            assert_eq!((found.value, found.time_s), farthest(rows, axis + 1));
            assert!(found.value.abs() > 1e-6, "{} axis {axis}", body.name);
        }
        let far = body.largest_distance_m;
        assert_eq!((far.value, far.time_s), farthest(rows, 4));
        let last = rows.last().unwrap();
        assert_eq!(
            (body.last.0, body.last.1.to_array()),
            (30.0, [last[1], last[2], last[3]])
        );
    }
    let table = self::rows(&out.0, "differences.csv");
    assert_eq!(table.len(), expected.values().map(Vec::len).sum::<usize>());
    let mut seen: BTreeMap<&str, usize> = BTreeMap::new();
    for row in &table {
        let number = seen.entry(&row[1]).or_default();
        let wanted = expected[&row[1]][*number];
        let found = [0, 2, 3, 4, 5].map(|column| row[column].parse::<f64>().unwrap());
        assert_eq!(found, wanted);
        *number += 1;
    }
    let largest = self::rows(&out.0, "body_differences.csv");
    let x = &largest[0];
    assert_eq!((x[0].as_str(), x[1].as_str()), ("balloon", "x"));
    let at = comparison.bodies[0].largest_m[0];
    assert_eq!(x[2].parse::<f64>().unwrap(), at.value);
    assert_eq!(largest.len(), 8);
}

#[test]
fn tensions_are_those_of_the_two_folders() {
    let out = Scratch::new();
    let comparison = compared(SCENE, &["run.duration_s=20"], WAYS, &out);
    let read = |way: &str| -> Vec<TensionAt> {
        let rows = rows(&out.0.join(way), "tethers.csv").into_iter();
        rows.map(|row| TensionAt {
            value_n: row[3].parse().unwrap(),
            time_s: row[0].parse().unwrap(),
            segment: row[2].parse().unwrap(),
        })
        .collect()
    };
    let (fine, rough) = (read("fine"), read("rough"));
    let apart: Vec<TensionAt> = (fine.iter().zip(&rough))
        .map(|(a, b)| TensionAt {
            value_n: b.value_n - a.value_n,
            ..*a
        })
        .collect();
    let first_largest = |tensions: &[TensionAt], size: fn(f64) -> f64| {
        let sizes = tensions.iter().map(|tension| size(tension.value_n));
        let largest = sizes.fold(f64::NEG_INFINITY, f64::max);
        *tensions
            .iter()
            .find(|tension| size(tension.value_n) == largest)
            .unwrap()
    };
    let [tether] = comparison.tethers.as_slice() else {
        panic!("{:?}", comparison.tethers)
    };
    let largest = [first_largest(&fine, |n| n), first_largest(&rough, |n| n)];
    assert_eq!(tether.largest_tension_n, largest);
    assert_eq!(tether.largest_difference_n, first_largest(&apart, f64::abs));
    let end: Vec<TensionAt> = apart.into_iter().filter(|at| at.time_s == 20.0).collect();
    assert_eq!(end.len(), 11);
    assert_eq!(tether.final_difference_n, first_largest(&end, f64::abs));
    let table = rows(&out.0, "tether_differences.csv");
    assert_eq!(table[0][1].parse::<f64>().unwrap(), largest[0].value_n);
    let header = fs::read_to_string(out.0.join("tether_differences.csv")).unwrap();
    assert!(
        header.starts_with("tether,fine_largest_tension_n,"),
        "{header}"
    );
}

/// There is one way to run a scene.
#[test]
fn each_folder_is_that_of_a_run() {
    let out = Scratch::new();
    compared(SCENE, &["run.duration_s=5"], WAYS, &out);
    let again = Scratch::new();
    compared(SCENE, &["run.duration_s=5"], WAYS, &again);
    for table in TABLES {
        let read = |scratch: &Scratch| fs::read(scratch.0.join(table)).unwrap();
        assert!(read(&out) == read(&again), "{table}");
    }
    for way in WAYS {
        let alone = Scratch::new();
        let set = ["--set", "run.duration_s=5", "--set", way.change];
        let run = aerobot(&[&["run", SCENE, "--out", alone.text()], &set[..]].concat());
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        for file in RUN_FILES {
            let here = fs::read(out.0.join(way.name).join(file)).unwrap();
            assert!(here == fs::read(alone.0.join(file)).unwrap(), "{file}");
        }
        assert!(out.0.join(way.name).join("timing.json").exists());
    }
}

#[test]
fn a_run_that_stops_is_compared_up_to_there() {
    let ways = [
        WAYS[0],
        Variant {
            name: "weightless",
            change: "environment.gravity=Constant(1e-3)",
        },
    ];
    let out = Scratch::new();
    let comparison = compared(FALLING, &["run.duration_s=20"], ways, &out);
    let [stopped, done] = &comparison.runs;
    assert_eq!(stopped.summary.outcome, "stopped");
    assert_eq!(done.summary.outcome, "done");
    assert!(!comparison.is_complete());
    let until_s = comparison.compared_until_s().unwrap();
    let stop_s = stopped.summary.stopped.as_ref().unwrap().time_s;
    assert!(until_s <= stop_s && until_s > stop_s - 0.5 - 1e-9);
    let times = rows(&out.0, "differences.csv").into_iter();
    let last = times.map(|row| row[0].parse::<f64>().unwrap()).next_back();
    assert_eq!(last, Some(until_s));
}

#[test]
fn what_is_not_recorded_is_said_to_be_missing() {
    let out = Scratch::new();
    let never = [
        "run.duration_s=2",
        "run.record=(bodies: Never, tethers: Never)",
    ];
    let comparison = compared(SCENE, &never, WAYS, &out);
    assert!(comparison.bodies.is_empty() && comparison.tethers.is_empty());
    assert_eq!(comparison.compared_until_s(), None);
    let [positions, tensions] = comparison.missing.as_slice() else {
        panic!("{:?}", comparison.missing)
    };
    assert!(positions.contains("`run.record.bodies` is `Never`"));
    assert!(tensions.contains("`run.record.tethers` is `Never`"));
    for table in TABLES {
        let lines = fs::read_to_string(out.0.join(table)).unwrap();
        let expected = if table == "costs.csv" { 3 } else { 1 };
        assert_eq!(lines.lines().count(), expected, "{table}");
    }
}

#[test]
fn anchors_are_not_compared() {
    let out = Scratch::new();
    let scene = "scenes/examples/hanging_cable.ron";
    let comparison = compared(scene, &["run.duration_s=1"], WAYS, &out);
    assert!(comparison.missing.is_empty(), "{:?}", comparison.missing);
    assert_eq!(comparison.tethers.len(), 1);
    for body in &comparison.bodies {
        assert_ne!(&*body.name, "anchor");
    }
}

#[test]
fn a_scene_that_is_refused_in_one_way_names_it_and_nothing_is_written() {
    let unstable = Variant {
        name: "long-steps",
        change: "run.integrator=Fixed(step_s: 10)",
    };
    for ways in [[WAYS[0], unstable], [unstable, WAYS[0]]] {
        let refused = load(SCENE, &[], ways).err().unwrap();
        let message = refused.to_string();
        assert!(message.contains("not stable"), "{message}");
        assert!(
            message.ends_with(
                "  = note: in the run `long-steps`, with `run.integrator=Fixed(step_s: 10)`"
            ),
            "{message}"
        );
    }
    let refused = load("tests/bad_scenes/negative_mass.ron", &[], WAYS).err();
    assert!(
        matches!(refused, Some(CompareError::Scene(_))),
        "{refused:?}"
    );
}

#[test]
fn a_folder_that_exists_is_left_as_it_is() {
    let out = Scratch::new();
    out.file("kept.txt", "the work of a week\n");
    let destination = |overwrite| Destination {
        folder: out.0.clone(),
        overwrite,
    };
    let short = ["run.duration_s=1"];
    let pair = load(SCENE, &short, WAYS).unwrap();
    let refused = pair.run_into(&destination(false), &mut |_, _| {});
    assert!(matches!(
        refused,
        Err(CompareError::Folder(RunError::Exists(_)))
    ));
    assert_eq!(fs::read_dir(&out.0).unwrap().count(), 1);
    // A folder that is in the way of a table.
    fs::create_dir(out.0.join("costs.csv")).unwrap();
    let pair = load(SCENE, &short, WAYS).unwrap();
    let refused = pair.run_into(&destination(true), &mut |_, _| {});
    assert!(matches!(
        refused,
        Err(CompareError::Folder(RunError::Io(..)))
    ));
    assert!(!out.0.join("fine").exists());
    fs::remove_dir(out.0.join("costs.csv")).unwrap();
    let pair = load(SCENE, &short, WAYS).unwrap();
    assert!(pair.run_into(&destination(true), &mut |_, _| {}).is_ok());
    assert!(out.0.join("kept.txt").exists() && out.0.join("rough/states.csv").exists());
}
