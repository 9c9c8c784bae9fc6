//! Lines that twist while they whip through all shapes: what they conserve, what damping takes, and both
//! formulations.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod flight;

use aerobot::engine::recording::frame::MemorySink;
use flight::torsional_pendulum::pendulum;
use flight::{assert_below, fly, largest_distance_m};
use glam::DVec3;

/// Two tumbling bodies on a line that whips through all shapes, with nothing around.
fn wild_pair(torsion: &str, run: &str) -> MemorySink {
    fly(
        &format!(
            r#"(
        name: "wild", environment: (gravity: Constant(0), atmosphere: Vacuum),
        entities: {{
            "a": (
                Body: (mass_kg: 3, inertia: Tensor(xx_kg_m2: 0.5, yy_kg_m2: 0.8, zz_kg_m2: 1.1)),
                Pose: (position_m: (-3, 0, 0)),
                Motion: (velocity_m_s: (0.2, -2, 0.3), rate_rad_s: (0.4, -0.7, 0.9)),
            ),
            "b": (
                Body: (mass_kg: 5, inertia: Tensor(xx_kg_m2: 1.5, yy_kg_m2: 0.9, zz_kg_m2: 1.2)),
                Pose: (position_m: (1.9, 0, 0)),
                Motion: (velocity_m_s: (0.1, 1.5, -0.4), rate_rad_s: (-0.6, 0.5, 1.2)),
            ),
            "line": (
                Tether: (
                    from: ("a", (0.3, 0.1, -0.2)), to: ("b", (-0.4, 0.2, 0.15)), length_m: 4, nodes: 3,
                    diameter_m: 0.016, density_kg_m3: 1000, axial_stiffness_n: 2000,
                    slack: false, start: Straight, torsion: (stiffness_n_m2: 4, {torsion}),
                ),
                Motion: (velocity_m_s: (0, 0, 3)),
            ),
        }},
        run: (duration_s: 5, output_every_s: 0.05, record: (channels: All), {run}),
    )"#
        ),
        &[],
    )
}

/// Largest departure of mechanical energy less work from its start, J.
fn imbalance_j(results: &MemorySink) -> f64 {
    let energy = results.channel("system", "mechanical_energy_j");
    let work = results.channel("system", "nonconservative_work_j");
    assert!(!energy.is_empty() && energy.len() == work.len());
    let start = energy[0].1 - work[0].1;
    energy
        .iter()
        .zip(&work)
        .map(|(energy, work)| (energy.1 - work.1 - start).abs())
        .fold(0.0, f64::max)
}

/// Linear momentum (kg m/s) and angular momentum about the origin (kg m^2/s): bodies, nodes, and the half
/// segments of the line that bodies carry.
fn momenta(results: &MemorySink, index: usize) -> (DVec3, DVec3) {
    let frame = &results.frames[index];
    let row = |name: &str| {
        let mut rows = frame.states.iter();
        rows.find(|row| &*row.entity == name).expect("a row")
    };
    let line_kg = 1000.0 * 4.0 * std::f64::consts::PI * 0.008 * 0.008;
    let (mut linear, mut angular) = (DVec3::ZERO, DVec3::ZERO);
    let mut add = |mass: f64, place: DVec3, velocity: DVec3| {
        linear += mass * velocity;
        angular += place.cross(mass * velocity);
    };
    for node in ["line/1", "line/2", "line/3"] {
        let row = row(node);
        add(line_kg / 4.0, row.position_m, row.velocity_m_s);
    }
    let mut spin = DVec3::ZERO;
    for (name, mass, inertia, offset) in [
        (
            "a",
            3.0,
            DVec3::new(0.5, 0.8, 1.1),
            DVec3::new(0.3, 0.1, -0.2),
        ),
        (
            "b",
            5.0,
            DVec3::new(1.5, 0.9, 1.2),
            DVec3::new(-0.4, 0.2, 0.15),
        ),
    ] {
        let row = row(name);
        let (attitude, rate) = row.rotation.expect("a body turns");
        add(mass, row.position_m, row.velocity_m_s);
        let arm = attitude * offset;
        let turning = attitude * rate.cross(offset);
        add(
            line_kg / 8.0,
            row.position_m + arm,
            row.velocity_m_s + turning,
        );
        spin += attitude * (inertia * rate);
    }
    (linear, angular + spin)
}

/// Forces on nodes and torques on bodies are the gradient of one potential that no rigid motion changes: on
/// a line that whips and twists, energy and both momenta stay.
#[test]
fn a_wild_line_keeps_energy_and_momenta() {
    let results = wild_pair(
        "twist_rad: 3",
        "integrator: Adaptive(relative_tolerance: 1e-12)",
    );
    let torques = results.channel("line", "torsion_n_m");
    let largest = torques
        .iter()
        .map(|sample| sample.1.abs())
        .fold(0.0, f64::max);
    let twists = results.channel("line", "twist_rad");
    let (least, most) = twists
        .iter()
        .fold((f64::MAX, f64::MIN), |(least, most), sample| {
            (least.min(sample.1), most.max(sample.1))
        });
    println!("torque up to {largest:.2} N m, twist from {least:.2} to {most:.2} rad");
    assert!(largest > 2.0 && most - least > 2.0);
    assert_below("energy, J", imbalance_j(&results), 1e-8);
    let start = momenta(&results, 0);
    for index in 0..results.frames.len() {
        let now = momenta(&results, index);
        assert!((now.0 - start.0).length() < 1e-10, "linear, row {index}");
        assert!((now.1 - start.1).length() < 1e-9, "angular, row {index}");
    }
}

/// What torsional damping takes is the work that is recorded; of lumped masses and of links.
#[test]
fn damping_takes_what_is_missing_from_the_energy() {
    let tight = "integrator: Adaptive(relative_tolerance: 1e-10)";
    for run in [
        tight.to_owned(),
        format!("{tight}, formulation: Denoc, links: Rod"),
        format!("{tight}, formulation: Denoc, links: PointMass"),
        format!("{tight}, formulation: Denoc, elastic_links: true"),
    ] {
        let results = pendulum(
            "damping_n_m_s: 0.05, twist_rad: 4",
            "Pose: (position_m: (2.5, 0, 95.47)), Motion: (velocity_m_s: (0, 1, 0), rate_rad_s: (0.1, 0, 2)),",
            &run,
            &["run.duration_s=1.5", "entities.line.Tether.damping_n_s_m=0"],
        );
        let work = results.channel("system", "nonconservative_work_j");
        let work = work[work.len() - 1].1;
        println!("{run}: work {work:.3} J");
        assert!(work < -0.1, "{work}");
        assert_below("energy less work, J", imbalance_j(&results), 1e-8);
    }
}

/// A swinging, twisting line of lumped masses tends to that of links as it gets stiff.
#[test]
fn both_formulations_agree_on_a_stiff_line() {
    let fly = |overrides: &[&str]| {
        let mut all = vec![
            "run.duration_s=2",
            "entities.line.Tether.lumping=Interior",
            "run.links=PointMass",
            "entities.line.Tether.start=Straight",
        ];
        all.extend(overrides);
        pendulum(
            "twist_rad: 4",
            "Pose: (position_m: (1.4, 0, 95)), Motion: (velocity_m_s: (0, 1, 0)),",
            "integrator: Implicit(accuracy_m: 1e-5)",
            &all,
        )
    };
    let links = fly(&["run.formulation=Denoc"]);
    let mut differences = Vec::new();
    for stiffness in ["2e5", "2e6"] {
        let ea = format!("entities.line.Tether.axial_stiffness_n={stiffness}");
        let lumped = fly(&[&ea]);
        let twist = links.channel("line", "twist_rad");
        let other = lumped.channel("line", "twist_rad");
        let apart = twist.iter().zip(&other).map(|(a, b)| (a.1 - b.1).abs());
        differences.push([
            largest_distance_m(&links, &lumped),
            apart.fold(0.0, f64::max),
        ]);
    }
    println!("{differences:?}");
    for (soft, stiff) in differences[0].iter().zip(&differences[1]) {
        assert!(*soft < 0.05 && *stiff < 0.2 * *soft);
    }
}
