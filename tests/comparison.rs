//! The comparison case (paper, sec. 4.2) against trajectories computed by a separate program (adaptive
//! order 8, tolerance 1e-10): uniform density, interior lumping, attachments at the centres of mass.
//!
//! A few values stand here; where `../shared/reference` exists, every second of it is compared too.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod flight;

use flight::{fly, fly_scene, scene_file};
use glam::DVec3;

const CENTRED: [&str; 4] = [
    "environment.atmosphere=Uniform(density_kg_m3: 0.8183)",
    "entities.tether.Tether.lumping=Interior",
    "entities.tether.Tether.from=(\"balloon\", (0, 0, 0))",
    "entities.tether.Tether.to=(\"gondola\", (0, 0, 0))",
];

/// Displacements from the start at 100 s, balloon then gondola, m.
const AT_100_S: [DVec3; 2] = [
    DVec3::new(52.034195, 42.198379, 65.066100),
    DVec3::new(52.294133, 44.439419, 65.071886),
];

fn largest_difference(integrator: &str) -> f64 {
    let mut overrides = CENTRED.to_vec();
    overrides.push(integrator);
    let results = fly_scene("paper/comparison_900m.ron", &overrides);
    let balloon = results.positions("balloon");
    let gondola = results.positions("gondola");
    assert!((balloon[0].1.z - 56_000.0).abs() < 1e-9);
    assert!((gondola[0].1.z - 55_095.927_242_957).abs() < 1e-8);
    let displaced = |track: &[(f64, DVec3)], row: usize| track[row].1 - track[0].1;
    let mut largest = 0.0_f64;
    for (track, expected) in [&balloon, &gondola].into_iter().zip(AT_100_S) {
        let difference = displaced(track, 100) - expected;
        largest = largest.max(difference.abs().max_element());
    }
    for (second, [balloon_m, gondola_m]) in reference().into_iter().enumerate() {
        assert_eq!(balloon[second].0, second as f64);
        for (track, expected) in [(&balloon, balloon_m), (&gondola, gondola_m)] {
            let difference = displaced(track, second) - expected;
            largest = largest.max(difference.abs().max_element());
        }
    }
    largest
}

/// Displacements of balloon and gondola at every second, m; empty without the reference data.
fn reference() -> Vec<[DVec3; 2]> {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../shared/reference/comparison_lumped.csv"
    );
    let text = std::fs::read_to_string(file).unwrap_or_default();
    text.lines()
        .filter(|line| line.starts_with(|c: char| c.is_ascii_digit()))
        .map(|line| {
            let values: Vec<f64> = line
                .split(',')
                .map(|field| field.parse().unwrap())
                .collect();
            [
                DVec3::from_slice(&values[1..]),
                DVec3::from_slice(&values[4..]),
            ]
        })
        .collect()
}

/// The printed digits end at 1e-6; the trajectory is asked for to 1e-5.
#[test]
fn val_adaptive_follows_the_reference() {
    let difference = largest_difference("run.integrator=Adaptive(relative_tolerance: 1e-9)");
    println!("adaptive at 1e-9: {difference:.3e} m");
    assert!(difference < 1e-5, "{difference}");
}

#[test]
fn val_fixed_step_follows_the_reference() {
    let difference = largest_difference("run.integrator=Fixed()");
    println!("RK4 at its default step: {difference:.3e} m");
    assert!(difference < 1e-3, "{difference}");
}

/// As shipped: attachments off the centres, half-segment lumping, VIRA. The balloon starts where it
/// floats, everything else below it, and nothing moves before the first gust.
#[test]
fn the_shipped_scene_rests_until_the_first_gust() {
    let results = fly_scene("paper/comparison_900m.ron", &["run.duration_s=10"]);
    for entity in ["balloon", "gondola", "tether/5"] {
        let track = results.positions(entity);
        for (time, position) in &track {
            let moved = position.distance(track[0].1);
            assert!(moved < 1e-8, "{entity} moved {moved} m by {time} s");
        }
    }
}

/// The force on the balloon is the weight of all below it (g = 8.87: 100 kg and the whole line), and
/// the one on the gondola its own weight; segment tensions are half a segment's weight away.
#[test]
fn attachment_tensions_balance_the_weight() {
    let results = fly_scene("paper/comparison_900m.ron", &["run.duration_s=1"]);
    let line = 1440.0 * 900.0 * std::f64::consts::PI * 1e-6;
    let from = results.channel("tether", "tension_from_n")[0].1;
    let to = results.channel("tether", "tension_to_n")[0].1;
    assert!(
        (from / (8.87 * (100.0 + line)) - 1.0).abs() < 1e-9,
        "{from}"
    );
    assert!((to / (8.87 * 100.0) - 1.0).abs() < 1e-9, "{to}");
    let top = results.frames[0].segments[0].tension_n;
    assert!(
        (top - 8.87 * (100.0 + line * (1.0 - 0.5 / 11.0))).abs() < 1e-6,
        "{top}"
    );
}

/// A scene file must be loadable from anywhere; `fly` and `fly_scene` agree.
#[test]
fn text_and_file_are_one_scene() {
    let text = std::fs::read_to_string(scene_file("paper/comparison_900m.ron")).unwrap();
    let from_text = fly(&text, &["run.duration_s=2"]);
    let from_file = fly_scene("paper/comparison_900m.ron", &["run.duration_s=2"]);
    assert_eq!(from_text.frames, from_file.frames);
}
