//! Design searches that tests make.

use std::collections::BTreeMap;
use std::fs;

use super::{Scratch, aerobot, text};

/// A point of 2 kg that flies 10 s without air, g = 8.87 m/s^2.
pub(crate) const THROW: &str = r#"(
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

/// Twelve flights of 10 s through gusts for each design.
pub(crate) const GUSTS: &str = r#"
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

/// Columns of a CSV table without quotes in what is looked at.
pub(crate) struct Table(pub(crate) Vec<BTreeMap<String, String>>);

impl Table {
    pub(crate) fn read(path: &str) -> Self {
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

    pub(crate) fn numbers(&self, column: &str) -> Vec<f64> {
        self.0
            .iter()
            .map(|row| row[column].parse().unwrap())
            .collect()
    }
}

/// The best design of a summary.
pub(crate) struct Best(pub(crate) serde_json::Value);

impl Best {
    pub(crate) fn of(folder: &str) -> Self {
        let text = fs::read_to_string(format!("{folder}/summary.json")).unwrap();
        assert!(!text.contains("NaN"));
        Self(serde_json::from_str::<serde_json::Value>(&text).unwrap()["best"].clone())
    }

    pub(crate) fn objective(&self) -> f64 {
        self.0["objective"]["value"].as_f64().unwrap()
    }

    pub(crate) fn named(&self, list: &str, name: &str) -> f64 {
        let list = self.0[list].as_array().unwrap();
        let entry = list.iter().find(|entry| entry["name"] == name);
        entry.unwrap()["value"].as_f64().unwrap()
    }
}

/// Writes a scene and a search of it; the path of the search.
pub(crate) fn search(scratch: &Scratch, scene: &str, body: &str) -> String {
    scratch.file("scene.ron", scene);
    let search = format!("(name: \"search\", scene: \"scene.ron\", {body})");
    scratch.file("search.ron", &search)
}

pub(crate) fn optimised(scratch: &Scratch, scene: &str, body: &str) -> Best {
    let file = search(scratch, scene, body);
    let out = scratch.path("out");
    let output = aerobot(&["optimise", &file, "--out", &out]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    Best::of(&out)
}
