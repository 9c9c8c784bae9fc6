//! The second formulation on the comparison case (paper, sec. 4.2) against trajectories of separate programs:
//! uniform rods, and massless links with point masses at the joints.
//!
//! A few values stand here; where `../shared/reference` exists, every second of it is compared too.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::unreadable_literal,
    reason = "a test fails by panicking, and its digits come from a table"
)]

mod flight;

use flight::fly_scene;
use glam::DVec3;

const CENTRED: [&str; 5] = [
    "environment.atmosphere=Uniform(density_kg_m3: 0.8183)",
    "entities.tether.Tether.lumping=Interior",
    "entities.tether.Tether.from=(\"balloon\", (0, 0, 0))",
    "entities.tether.Tether.to=(\"gondola\", (0, 0, 0))",
    "run.formulation=Denoc",
];

/// Largest difference of a component of a displacement from a reference file of `shared/`, or else from the
/// printed values at 100 s, m.
fn largest_difference(links: &str, integrator: &str, file: &str, at_100_s: [DVec3; 2]) -> f64 {
    let links = format!("run.links={links}");
    let integrator = format!("run.integrator={integrator}");
    let mut overrides = CENTRED.to_vec();
    overrides.extend([links.as_str(), integrator.as_str()]);
    let results = fly_scene("paper/comparison_900m.ron", &overrides);
    let tracks = ["balloon", "gondola"].map(|name| results.positions(name));
    let displaced = |which: usize, row: usize| tracks[which][row].1 - tracks[which][0].1;
    let mut largest = 0.0_f64;
    for (which, expected) in at_100_s.into_iter().enumerate() {
        let difference = displaced(which, 100) - expected;
        largest = largest.max(difference.abs().max_element());
    }
    for (second, expected) in reference(file).into_iter().enumerate() {
        for (which, expected) in expected.into_iter().enumerate() {
            assert_eq!(tracks[which][second].0, second as f64);
            let difference = displaced(which, second) - expected;
            largest = largest.max(difference.abs().max_element());
        }
    }
    println!("{links}, {integrator}: {largest:.1e} m");
    largest
}

/// Displacements of balloon and gondola at every second, m; empty without the reference data.
fn reference(file: &str) -> Vec<[DVec3; 2]> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/reference/");
    let text = std::fs::read_to_string(format!("{folder}{file}")).unwrap_or_default();
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

const POINTS: [DVec3; 2] = [
    DVec3::new(52.084772, 42.215221, 65.085099),
    DVec3::new(52.307193, 44.467665, 65.087947),
];
const RODS: [DVec3; 2] = [
    DVec3::new(52.070530, 42.217018, 65.080316),
    DVec3::new(52.302461, 44.473286, 65.083175),
];

/// The printed digits end at 5e-7.
#[test]
fn val_point_mass_links_follow_the_reference() {
    let file = "comparison_rigid_point_mass.csv";
    let adaptive = "Adaptive(relative_tolerance: 1e-9)";
    let difference = largest_difference("PointMass", adaptive, file, POINTS);
    assert!(difference < 1e-6, "{difference:e}");
}

#[test]
fn val_rods_follow_the_reference() {
    let file = "comparison_rigid_rod.csv";
    let adaptive = "Adaptive(relative_tolerance: 1e-9)";
    let difference = largest_difference("Rod", adaptive, file, RODS);
    assert!(difference < 1e-6, "{difference:e}");
}
