//! The same scene, seed and version give the same bytes, in any order of systems and on any thread.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod flight;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use aerobot::engine::plugin::Simulator;
use aerobot::engine::run_folder::{Destination, run_into};
use flight::{owned, run, scene_file};

/// Everything in a run's folder but `timing.json`.
const FILES: [&str; 5] = [
    "scene.ron",
    "states.csv",
    "tethers.csv",
    "channels.csv",
    "summary.json",
];

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("aerobot-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        Self(folder)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn run_command(scene: &Path, out: &Path, arguments: &[&str]) {
    let output = Command::new(env!("CARGO_BIN_EXE_aerobot"))
        .arg("run")
        .arg(scene)
        .arg("--out")
        .arg(out)
        .args(arguments)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
}

fn assert_same_bytes(a: &Path, b: &Path) {
    for file in FILES {
        assert!(
            fs::read(a.join(file)).unwrap() == fs::read(b.join(file)).unwrap(),
            "`{file}` differs"
        );
    }
}

/// Twice the same run, and once more from the scene that the first wrote.
#[test]
fn a_run_and_its_own_scene_give_the_same_bytes() {
    let scene = scene_file("paper/comparison_900m.ron");
    let arguments = [
        "--until",
        "25",
        "--seed",
        "7",
        "--set",
        "run.record=(channels: All)",
    ];
    let (first, second, third) = (
        Folder::new("first"),
        Folder::new("second"),
        Folder::new("third"),
    );
    run_command(&scene, &first.0, &arguments);
    run_command(&scene, &second.0, &arguments);
    run_command(&first.0.join("scene.ron"), &third.0, &[]);
    assert_same_bytes(&first.0, &second.0);
    assert_same_bytes(&first.0, &third.0);
    let summary = fs::read_to_string(first.0.join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["seed"], 7);
    assert_eq!(summary["simulated_s"], 25.0);
}

/// A scene with a table beside it takes the table along.
#[test]
fn a_scene_with_a_table_can_be_run_from_its_results() {
    let source = Folder::new("tables");
    fs::create_dir_all(source.0.join("air")).unwrap();
    fs::write(
        source.0.join("air/thin.csv"),
        "# made up\naltitude_m,density_kg_m3\n0,1.2\n1000,1.1\n5000,0.7\n",
    )
    .unwrap();
    let scene = r#"(
        name: "table",
        environment: (atmosphere: Table(file: "air/thin.csv")),
        entities: {"ball": (
            Body: (mass_kg: 1), Pose: (position_m: (0, 0, 3000)),
            Drag: Constant(coefficient: 0.5, area_m2: 0.1),
        )},
        run: (duration_s: 3, output_every_s: 1),
    )"#;
    fs::write(source.0.join("table.ron"), scene).unwrap();
    let (first, second) = (Folder::new("table-first"), Folder::new("table-second"));
    run_command(&source.0.join("table.ron"), &first.0, &[]);
    run_command(&first.0.join("scene.ron"), &second.0, &[]);
    assert_same_bytes(&first.0, &second.0);
}

/// Systems that the schedules leave unordered may run in any order.
#[test]
fn the_order_of_systems_is_not_in_the_files() {
    let fly = |formulation: &str, seed: Option<u64>| {
        let formulation_field = format!("run.formulation={formulation}");
        let overrides = [
            "run.duration_s=15",
            "run.record=(channels: All)",
            &formulation_field,
        ];
        let mut simulator = Simulator::new();
        if let Some(seed) = seed {
            simulator.set_shuffle_seed(seed);
        }
        let file = scene_file("paper/comparison_900m.ron");
        let scene = simulator.load(&file, &owned(&overrides)).unwrap();
        let folder = Folder::new(&format!("shuffle-{formulation}-{seed:?}"));
        let destination = Destination {
            folder: folder.0.clone(),
            overwrite: false,
        };
        let finished = run_into(&simulator, &scene, &destination, &mut |_| {}).unwrap();
        assert_eq!(finished.summary.outcome, "done");
        folder
    };
    for formulation in ["LumpedMass", "Denoc"] {
        let plain = fly(formulation, None);
        for seed in [1, 20, 300] {
            assert_same_bytes(&plain.0, &fly(formulation, Some(seed)).0);
        }
    }
}

/// One simulator, many worlds on many threads: each gives the same.
#[test]
fn threads_do_not_disturb_each_other() {
    let simulator = Simulator::new();
    let file = scene_file("paper/comparison_900m.ron");
    let scene = simulator
        .load(&file, &owned(&["run.duration_s=12"]))
        .unwrap();
    let alone = run(&simulator, &scene).frames;
    std::thread::scope(|scope| {
        let flights: Vec<_> = (0..4)
            .map(|_| scope.spawn(|| run(&simulator, &scene).frames))
            .collect();
        for flight in flights {
            assert!(flight.join().unwrap() == alone);
        }
    });
}
