//! The second formulation against trajectories of separate programs: uniform rods, massless links with
//! point masses at the joints, elastic rods; the comparison case (paper, sec. 4.2), a chain that branches, a
//! pendulum.
//!
//! A few values stand here; where `../shared/reference` exists, every second of the comparison case with
//! attachments at the centres is compared too.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::unreadable_literal,
    reason = "a test fails by panicking, and its digits come from a table"
)]

#[path = "../flight/mod.rs"]
mod flight;

mod branched_cases;
mod offset_cases;
mod pendulum_cases;

use aerobot::engine::recording::frame::{Frame, MemorySink, StateRow};
use branched_cases::{BRANCH_POINTS, BRANCH_RODS};
use flight::{CENTRED_COMPARISON, assert_below, fly, fly_scene, reference_displacements};
use glam::{DQuat, DVec3};
use offset_cases::{OFFSET_INTERIOR_POINTS, OFFSET_POINTS, OFFSET_RODS, OFFSET_RODS_ADDED_MASS};
use pendulum_cases::{PENDULUM_ELASTIC_RODS, PENDULUM_RODS};

/// Largest differences of a component of a displacement, m: from six printed digits at 100 s, and from a
/// reference file of `shared/` at every second (zero without it).
fn largest_differences(links: &str, file: &str, at_100_s: [DVec3; 2]) -> [f64; 2] {
    let links = format!("run.links={links}");
    let integrator = "run.integrator=Adaptive(relative_tolerance: 1e-9)";
    let mut overrides = CENTRED_COMPARISON.to_vec();
    overrides.extend(["run.formulation=Denoc", links.as_str(), integrator]);
    let results = fly_scene("paper/comparison_900m.ron", &overrides);
    let tracks = ["balloon", "gondola"].map(|name| results.positions(name));
    let displaced = |which: usize, row: usize| tracks[which][row].1 - tracks[which][0].1;
    let [mut printed, mut every_second] = [0.0_f64; 2];
    for (which, expected) in at_100_s.into_iter().enumerate() {
        let difference = displaced(which, 100) - expected;
        printed = printed.max(difference.abs().max_element());
    }
    for (second, expected) in reference_displacements(file).into_iter().enumerate() {
        for (which, expected) in expected.into_iter().enumerate() {
            assert_eq!(tracks[which][second].0, second as f64);
            let difference = displaced(which, second) - expected;
            every_second = every_second.max(difference.abs().max_element());
        }
    }
    println!("{links}: printed digits {printed:.1e} m, every second {every_second:.1e} m");
    [printed, every_second]
}

const POINTS: [DVec3; 2] = [
    DVec3::new(52.084772, 42.215221, 65.085099),
    DVec3::new(52.307193, 44.467665, 65.087947),
];
const RODS: [DVec3; 2] = [
    DVec3::new(52.070530, 42.217018, 65.080316),
    DVec3::new(52.302461, 44.473286, 65.083175),
];

/// The printed digits end at 5e-7; a step may err by 1e-9, and what adds up stays below five of them.
#[track_caller]
fn assert_follows_the_reference(links: &str, file: &str, at_100_s: [DVec3; 2]) {
    let [printed, every_second] = largest_differences(links, file, at_100_s);
    assert!(printed < 1e-6, "{printed:e}");
    assert!(every_second < 5e-9, "{every_second:e}");
}

#[test]
fn val_point_mass_links_follow_the_reference() {
    assert_follows_the_reference("PointMass", "comparison_rigid_point_mass.csv", POINTS);
}

#[test]
fn val_rods_follow_the_reference() {
    assert_follows_the_reference("Rod", "comparison_rigid_rod.csv", RODS);
}

/// Which scene a case flies, from where its separate program starts.
#[derive(Clone, Copy)]
enum Flight {
    /// `paper/comparison_900m.ron`, from its equilibrium.
    Comparison,
    /// `examples/branched_chain.ron`, upright and with straight lines: not in equilibrium.
    BranchedChain,
    /// [`PENDULUM`].
    Pendulum,
}

/// A case that a separate program has computed (Python; every end of a link a free point, joints and
/// lengths held by Lagrange multipliers, positions and velocities projected every second, scipy's DOP853
/// at 1e-12 or 1e-13). It estimates its own error by tolerances a tenth as tight, and by a second program
/// in tree coordinates, at 2e-9 m, 1e-9 (quaternion) and 2e-8 N or better.
struct Case {
    flight: Flight,
    overrides: &'static [&'static str],
    /// Body, time in s, position in m with z above that of the start.
    positions_m: &'static [(&'static str, u32, [f64; 3])],
    /// Body, time in s, quaternion (body to inertial, scalar last), of either sign.
    attitudes: &'static [(&'static str, u32, [f64; 4])],
    /// Body, time in s, rates in the body frame.
    rates_rad_s: &'static [(&'static str, u32, [f64; 3])],
    /// Tether, link, time in s, tension; where a gust begins or ends, with the new wind.
    tensions_n: &'static [(&'static str, u32, u32, f64)],
    /// Time in s, kinetic energy, change of the mechanical energy since the start.
    energies_j: &'static [(u32, f64, f64)],
}

const POINT_MASSES: &str = "run.links=PointMass";
const INTERIOR: &str = "entities.tether.Tether.lumping=Interior";
const ADDED_MASS: &str = "entities.balloon.AddedMass=()";
const EXPONENTIAL: &str = "environment.atmosphere=Exponential(density_kg_m3: 0.8183, \
                           altitude_m: 56000, scale_height_m: 8200)";

/// Under the balloon of radius 3.687116138900974 m, which carries all that is in the scene.
const BRANCH_START: [&str; 7] = [
    "entities.balloon.Pose=(position_m: (0, 0, 56000))",
    "entities.gondola.Pose=(position_m: (-0.1, 0, 55695.812883861099))",
    "entities.a.Pose=(position_m: (0.3, 0, 55575.312883861099))",
    "entities.b.Pose=(position_m: (-0.55, 0.1, 55635.012883861099))",
    "entities.tether.Tether.start=Straight",
    "entities.line-a.Tether.start=Straight",
    "entities.line-b.Tether.start=Straight",
];

/// A body that turns about the end of a straight tether, which it leaves where it is.
const PENDULUM: &str = r#"(
    name: "pendulum",
    environment: (gravity: Constant(8.87), atmosphere: Vacuum),
    entities: {
        "anchor": (Fixed: (position_m: (0, 0, 1000))),
        "body": (
            Body: (mass_kg: 5, inertia: Box(0.5, 0.3, 0.8)),
            Pose: (position_m: (11.9, 3.95, 984.1080666151703)),
            Motion: (velocity_m_s: (0.105, 0.07, -0.035), rate_rad_s: (0.3, -0.2, 0.5)),
        ),
        "tether": (Tether: (
            from: ("anchor", Centre), to: ("body", (0.1, 0.05, 0.4)),
            length_m: 20, nodes: 5, diameter_m: 0.01, density_kg_m3: 1440,
            axial_stiffness_n: 2000, damping_n_s_m: 20, start: Straight,
        )),
    },
    run: (duration_s: 20, output_every_s: 1, record: (channels: All)),
)"#;

/// Flies a case and compares everything that its program has printed. Bounds are some times what the
/// program says of its own error; the integrator's is below that.
fn assert_follows(case: &Case) {
    let mut overrides = vec![
        "run.formulation=Denoc",
        "run.integrator=Adaptive(relative_tolerance: 1e-10)",
    ];
    if matches!(case.flight, Flight::BranchedChain) {
        overrides.extend(BRANCH_START);
    }
    overrides.extend(case.overrides);
    let (results, base_m) = match case.flight {
        Flight::Comparison => (fly_scene("paper/comparison_900m.ron", &overrides), 56_000.0),
        Flight::BranchedChain => (
            fly_scene("examples/branched_chain.ron", &overrides),
            56_000.0,
        ),
        Flight::Pendulum => (fly(PENDULUM, &overrides), 1000.0),
    };
    assert_same_states(case, &results, base_m);
    assert_same_tensions(case, &results);
    if !case.energies_j.is_empty() {
        assert_same_energies(case, &results);
    }
}

fn frame(results: &MemorySink, time_s: u32) -> &Frame {
    let frame = &results.frames[time_s as usize];
    assert_eq!(frame.time_s, f64::from(time_s));
    frame
}

fn state<'a>(results: &'a MemorySink, body: &str, time_s: u32) -> &'a StateRow {
    let mut states = frame(results, time_s).states.iter();
    states.find(|row| &*row.entity == body).unwrap()
}

fn assert_same_states(case: &Case, results: &MemorySink, base_m: f64) {
    let mut largest = [0.0_f64; 3];
    for (body, time_s, expected) in case.positions_m {
        let found = state(results, body, *time_s).position_m - base_m * DVec3::Z;
        largest[0] = largest[0].max(found.distance(DVec3::from_array(*expected)));
    }
    for (body, time_s, expected) in case.attitudes {
        let (found, expected) = (
            state(results, body, *time_s).rotation.unwrap().0,
            DQuat::from_array(*expected),
        );
        let same = (found - expected).length();
        let opposite = (found + expected).length();
        largest[1] = largest[1].max(same.min(opposite));
    }
    for (body, time_s, expected) in case.rates_rad_s {
        let found = state(results, body, *time_s).rotation.unwrap().1;
        largest[2] = largest[2].max(found.distance(DVec3::from_array(*expected)));
    }
    assert_below("position, m", largest[0], 5e-9);
    assert_below("quaternion", largest[1], 5e-9);
    assert_below("body rate, rad/s", largest[2], 5e-9);
}

fn assert_same_tensions(case: &Case, results: &MemorySink) {
    let mut largest = 0.0_f64;
    for (tether, link, time_s, expected) in case.tensions_n {
        let mut rows = frame(results, *time_s).segments.iter();
        let row = rows
            .find(|row| &*row.tether == *tether && row.segment == *link)
            .unwrap();
        largest = largest.max((row.tension_n - expected).abs());
    }
    assert_below("tension, N", largest, 1e-7);
}

fn assert_same_energies(case: &Case, results: &MemorySink) {
    let kinetic = results.channel("system", "kinetic_energy_j");
    let mechanical = results.channel("system", "mechanical_energy_j");
    let mut largest = 0.0_f64;
    for (time_s, expected_kinetic, expected_change) in case.energies_j {
        let row = *time_s as usize;
        let change = mechanical[row].1 - mechanical[0].1;
        largest = largest.max((kinetic[row].1 - expected_kinetic).abs());
        largest = largest.max((change - expected_change).abs());
    }
    // The mechanical energy counts from z = 0: 63 kJ, of which round-off is 7e-12 J.
    assert_below("energy, J", largest, 1e-8);
}

/// Uniform rods: places of balloon and gondola, attitudes, rates of the gondola, tensions.
#[test]
fn val_rods_with_offsets_follow_the_reference() {
    assert_follows(&OFFSET_RODS);
}

#[test]
fn val_point_masses_with_offsets_follow_the_reference() {
    assert_follows(&OFFSET_POINTS);
    assert_follows(&OFFSET_INTERIOR_POINTS);
}

#[test]
fn val_rods_below_a_balloon_with_added_mass_follow_the_reference() {
    assert_follows(&OFFSET_RODS_ADDED_MASS);
}

#[test]
fn val_a_branched_chain_of_rods_follows_the_reference() {
    assert_follows(&BRANCH_RODS);
}

#[test]
fn val_a_branched_chain_of_point_masses_follows_the_reference() {
    assert_follows(&BRANCH_POINTS);
}

/// Three turns in space at once, the energy, and the tension of links that a body jerks.
#[test]
fn val_a_pendulum_of_rods_follows_the_reference() {
    assert_follows(&PENDULUM_RODS);
}

/// Slack, snaps and dampers in the first milliseconds, then the swing: the separate program locates every
/// change.
#[test]
fn val_a_pendulum_of_elastic_rods_follows_the_reference() {
    assert_follows(&PENDULUM_ELASTIC_RODS);
}
