//! Runs scenes through the library for the tests of this folder.

#![allow(dead_code, reason = "every test file uses its own part")]

pub(crate) mod dumbbell;
pub(crate) mod small_rotorcraft;
pub(crate) mod torsional_pendulum;

use std::path::{Path, PathBuf};

use aerobot::engine::plugin::Simulator;
use aerobot::engine::recording::frame::{Frame, MemorySink, StateRow};
use aerobot::engine::recording::summary::Summary;
use aerobot::engine::scene::Scene;
use glam::DVec3;

/// What makes `paper/comparison_900m.ron` the case that separate programs have computed: uniform density, the
/// tether's mass on its nodes, attachments at the centres of mass.
pub(crate) const CENTRED_COMPARISON: [&str; 4] = [
    "environment.atmosphere=Uniform(density_kg_m3: 0.8183)",
    "entities.tether.Tether.lumping=Interior",
    "entities.tether.Tether.from=(\"balloon\", (0, 0, 0))",
    "entities.tether.Tether.to=(\"gondola\", (0, 0, 0))",
];

/// A scene of the repository.
pub(crate) fn scene_file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("scenes")
        .join(name)
}

/// Overrides as the library takes them.
pub(crate) fn owned(overrides: &[&str]) -> Vec<String> {
    overrides.iter().map(|text| (*text).to_owned()).collect()
}

/// Loads a scene from text.
pub(crate) fn load(simulator: &Simulator, text: &str, overrides: &[&str]) -> Scene {
    simulator
        .load_text(
            "test.ron",
            text.to_owned(),
            Path::new("."),
            &owned(overrides),
        )
        .unwrap_or_else(|error| panic!("{error}"))
}

/// Flies a scene given as text.
pub(crate) fn fly(text: &str, overrides: &[&str]) -> MemorySink {
    let simulator = Simulator::new();
    run(&simulator, &load(&simulator, text, overrides))
}

/// Flies a scene of the repository.
pub(crate) fn fly_scene(name: &str, overrides: &[&str]) -> MemorySink {
    let simulator = Simulator::new();
    let scene = simulator
        .load(&scene_file(name), &owned(overrides))
        .unwrap_or_else(|error| panic!("{error}"));
    run(&simulator, &scene)
}

/// Flies a scene to its end.
pub(crate) fn run(simulator: &Simulator, scene: &Scene) -> MemorySink {
    run_for_summary(simulator, scene).0
}

/// Flies a scene to its end, for its summary too.
pub(crate) fn run_for_summary(simulator: &Simulator, scene: &Scene) -> (MemorySink, Summary) {
    let mut simulation = simulator
        .build(scene)
        .unwrap_or_else(|error| panic!("{error}"));
    let mut results = MemorySink::default();
    let summary = simulation.run(&mut results, &mut |_| {});
    assert_eq!(summary.outcome, "done", "{:?}", summary.stopped);
    (results, summary)
}

/// `actual` must be `expected` to `tolerance`, relative; prints how well it is.
pub(crate) fn assert_relative(what: &str, actual: f64, expected: f64, tolerance: f64) {
    let error = (actual / expected - 1.0).abs();
    println!("{what}: {actual:.12}, expected {expected:.12}, relative error {error:.1e}");
    assert!(error < tolerance, "{what}: {actual}, expected {expected}");
}

/// `error` must be below `bound`; prints it.
pub(crate) fn assert_below(what: &str, error: f64, bound: f64) {
    println!("{what}: {error:.1e}, allowed {bound:.1e}");
    assert!(error < bound, "{what}: {error:.3e}, allowed {bound:.1e}");
}

/// What was recorded at a time.
pub(crate) fn frame_at(results: &MemorySink, time_s: f64) -> &Frame {
    let mut frames = results.frames.iter();
    frames
        .find(|frame| (frame.time_s - time_s).abs() < 1e-9)
        .unwrap_or_else(|| panic!("nothing was recorded at {time_s} s"))
}

fn state_at<'a>(results: &'a MemorySink, entity: &str, time_s: f64) -> &'a StateRow {
    let mut rows = frame_at(results, time_s).states.iter();
    rows.find(|row| &*row.entity == entity)
        .unwrap_or_else(|| panic!("`{entity}` was not recorded"))
}

/// Where an entity is at a time, m.
pub(crate) fn position(results: &MemorySink, entity: &str, time_s: f64) -> DVec3 {
    state_at(results, entity, time_s).position_m
}

/// How it moves, m/s.
pub(crate) fn velocity(results: &MemorySink, entity: &str, time_s: f64) -> DVec3 {
    state_at(results, entity, time_s).velocity_m_s
}

/// The value of a channel of an entity.
pub(crate) fn channel(frame: &Frame, entity: &str, name: &str) -> f64 {
    let mut rows = frame.channels.iter();
    rows.find(|row| &*row.entity == entity && row.channel == name)
        .unwrap_or_else(|| panic!("`{name}` of `{entity}` was not recorded"))
        .value
}

/// Largest distance of anything from where it is in `other`, m.
pub(crate) fn largest_distance_m(results: &MemorySink, other: &MemorySink) -> f64 {
    assert_eq!(results.frames.len(), other.frames.len());
    let pairs = results.frames.iter().zip(&other.frames);
    pairs
        .flat_map(|(a, b)| {
            assert_eq!(a.states.len(), b.states.len());
            a.states.iter().zip(&b.states)
        })
        .map(|(a, b)| (a.position_m - b.position_m).length())
        .fold(0.0, f64::max)
}

/// Flies a scene and gives its summary too.
pub(crate) fn summary_of(text: &str, overrides: &[&str]) -> (MemorySink, Summary) {
    let simulator = Simulator::new();
    run_for_summary(&simulator, &load(&simulator, text, overrides))
}

/// Displacements of balloon and gondola of the comparison case at every second, m, from a file of
/// `../shared/reference`; empty where that is not there.
pub(crate) fn reference_displacements(file: &str) -> Vec<[DVec3; 2]> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/reference/");
    let text = std::fs::read_to_string(format!("{folder}{file}")).unwrap_or_default();
    text.lines()
        .filter(|line| line.starts_with(|c: char| c.is_ascii_digit()))
        .map(|line| {
            let values: Vec<f64> = line
                .split(',')
                .map(|field| field.parse().unwrap_or_else(|_| panic!("{file}: `{line}`")))
                .collect();
            [
                DVec3::from_slice(&values[1..]),
                DVec3::from_slice(&values[4..]),
            ]
        })
        .collect()
}
