//! Closed chains in flight: several tethers between balloon and gondola, and instruments below. Both
//! formulations meet where tethers are stiff, and a gondola off its axis turns as it swings.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod flight;

use aerobot::engine::plugin::Simulator;
use aerobot::engine::recording::frame::MemorySink;
use flight::{assert_below, assert_relative, fly_scene, owned, run_for_summary, scene_file};

const MULTI_TETHER: &str = "paper/multi_tether.ron";
const FLIGHT_CHAIN: &str = "paper/flight_chain.ron";
const MOJAVE: &str = "paper/mojave_test.ron";
const LUMPED: &str = "run.formulation=LumpedMass";
const DENOC: &str = "run.formulation=Denoc";

#[test]
fn every_scene_flies_in_both_formulations() {
    for scene in [MULTI_TETHER, FLIGHT_CHAIN, MOJAVE] {
        for formulation in [LUMPED, DENOC] {
            let simulator = Simulator::new();
            let overrides = owned(&[formulation, "run.duration_s=30"]);
            let scene = simulator.load(&scene_file(scene), &overrides);
            let scene = scene.unwrap_or_else(|error| panic!("{error}"));
            let (_, summary) = run_for_summary(&simulator, &scene);
            let Some(largest) = summary.largest_tension else {
                panic!("no tension");
            };
            println!("{formulation}: {} N", largest.tension_n);
            assert!(summary.warnings.is_empty(), "{:?}", summary.warnings);
            assert!(summary.events.is_empty(), "{:?}", summary.events);
        }
    }
}

/// Tethers of a scene: the path of the component, EA in N and c in N s/m.
type Lines = &'static [(&'static str, f64, f64)];

/// Overrides that put the mass of tethers on their nodes and make them stiffer by `factor`, with the damping
/// that leaves the damping ratio of their vibrations nearly what it was.
fn stiffer(lines: Lines, factor: f64) -> Vec<String> {
    let set = |(line, stiffness_n, damping): &(&str, f64, f64)| {
        [
            format!("entities.{line}.lumping=Interior"),
            format!(
                "entities.{line}.axial_stiffness_n={:e}",
                stiffness_n * factor
            ),
            format!(
                "entities.{line}.damping_n_s_m={:e}",
                damping * factor.sqrt()
            ),
        ]
    };
    lines.iter().flat_map(set).collect()
}

/// Largest difference of a component of a body's displacement from its start, m.
fn largest_difference_m(a: &MemorySink, b: &MemorySink, bodies: &[&str]) -> f64 {
    let mut largest = 0.0_f64;
    for body in bodies {
        let (a, b) = (a.positions(body), b.positions(body));
        assert!(a.len() == b.len() && a.len() > 10);
        for ((time_a, at_a), (time_b, at_b)) in a.iter().zip(&b) {
            assert_eq!(time_a, time_b);
            let difference = (at_a - a[0].1) - (at_b - b[0].1);
            largest = largest.max(difference.abs().max_element());
        }
    }
    largest
}

/// Flies lumped masses of EA times 1, 10 and 100 and the rigid links that they become: the difference must
/// fall as 1/EA.
fn assert_limit(scene: &str, lines: Lines, bodies: &[&str]) {
    let fly = |more: &[&str], lines: &[String]| {
        let lines = lines.iter().map(String::as_str);
        let all: Vec<&str> = more.iter().copied().chain(lines).collect();
        fly_scene(scene, &[&["run.duration_s=55"], &all[..]].concat())
    };
    let tight = "run.integrator=Adaptive(relative_tolerance: 1e-8)";
    let links = fly(&[DENOC, "run.links=PointMass", tight], &stiffer(lines, 1.0));
    let differences = [1.0, 10.0, 100.0].map(|factor| {
        let accuracy_m = if factor > 10.0 { 1e-7 } else { 1e-6 };
        let integrator = format!("run.integrator=Implicit(accuracy_m: {accuracy_m:e})");
        let lumped = fly(&[LUMPED, &integrator], &stiffer(lines, factor));
        largest_difference_m(&lumped, &links, bodies)
    });
    println!("{scene}, EA times 1, 10, 100: {differences:?} m");
    for pair in differences.windows(2) {
        let decade = (pair[0] / pair[1]).log10();
        assert!((0.9..1.1).contains(&decade), "{differences:?}");
    }
}

#[test]
fn val_lumped_masses_become_rigid_links_on_a_multi_tether() {
    assert_limit(
        MULTI_TETHER,
        &[("suspension.Tethers", 2e5, 10.0)],
        &["balloon", "gondola"],
    );
}

#[test]
fn val_lumped_masses_become_rigid_links_on_a_flight_chain() {
    assert_limit(
        FLIGHT_CHAIN,
        &[
            ("suspension.Tethers", 2e5, 10.0),
            ("single-line.Tether", 1e5, 10.0),
            ("double-line.Tethers", 1e5, 10.0),
        ],
        &["balloon", "gondola", "magnetometer", "camera"],
    );
}

/// Heading of the gondola of the Mojave test, rad, with the centre of its ring here from its centre of mass, m.
fn headings(x_m: f64, y_m: f64, formulation: &str) -> Vec<f64> {
    let to = format!("entities.suspension.Tethers.to=(\"gondola\", ({x_m:?}, {y_m:?}, 0.2))");
    let sink = fly_scene(MOJAVE, &[&to, formulation, "run.duration_s=30"]);
    let headings = sink.channel("gondola", "heading_rad");
    headings.into_iter().map(|(_, heading)| heading).collect()
}

fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values
        .into_iter()
        .fold(0.0, |most, value| most.max(value.abs()))
}

/// A gust along x swings the gondola along x. With its centre of mass beside that plane it turns; in the plane,
/// on the axis or not, the mirror image of the motion is the motion and it does not.
#[test]
fn val_a_gondola_off_its_axis_turns_as_it_swings() {
    for formulation in [LUMPED, DENOC] {
        let off = headings(0.0, 0.1, formulation);
        let mirrored = headings(0.0, -0.1, formulation);
        let half = headings(0.0, 0.05, formulation);
        let on = headings(0.0, 0.0, formulation);
        let ahead = headings(0.1, 0.0, formulation);
        println!("{formulation}: {} rad", largest(off.clone()));
        assert!(largest(off.clone()) > 0.04);
        assert_below("on the axis, rad", largest(on), 1e-8);
        assert_below("in the plane, rad", largest(ahead), 1e-8);
        let sums = off.iter().zip(mirrored).map(|(a, b)| a + b);
        assert_below("mirror image, rad", largest(sums), 1e-8);
        let ratio = largest(half) / largest(off);
        assert_relative("of half the offset", ratio, 0.5, 0.1);
    }
}
