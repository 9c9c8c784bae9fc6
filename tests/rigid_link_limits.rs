//! The formulations against each other where they must meet: lumped masses become rigid links as tethers
//! become stiff, elastic links are lumped masses in other coordinates, rods become lumped masses as links
//! become short, and the body from which a tree grows changes nothing.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod flight;

use aerobot::engine::recording::frame::MemorySink;
use flight::{CENTRED_COMPARISON, assert_below, fly_scene, largest_distance_m, summary_of};

const COMPARISON: &str = "paper/comparison_900m.ron";
const BRANCHED: &str = "examples/branched_chain.ron";
const LUMPED: &str = "run.formulation=LumpedMass";
const DENOC: &str = "run.formulation=Denoc";
const POINT_MASSES: &str = "run.links=PointMass";
const ELASTIC: &str = "run.elastic_links=true";
const TIGHT: &str = "run.integrator=Adaptive(relative_tolerance: 1e-10)";

fn fly_with(scene: &str, overrides: &[&str], more: &[String]) -> MemorySink {
    let more = more.iter().map(String::as_str);
    let all: Vec<&str> = overrides.iter().copied().chain(more).collect();
    fly_scene(scene, &all)
}

fn implicit(accuracy_m: f64) -> String {
    format!("run.integrator=Implicit(accuracy_m: {accuracy_m:e})")
}

/// A tether that is stiffer by `factor`, with the damping that leaves the damping ratio of its vibrations
/// nearly what it was.
fn stiffer(tether: &str, stiffness_n: f64, factor: f64) -> [String; 2] {
    let field = |name: &str, value: f64| format!("entities.{tether}.Tether.{name}={value:e}");
    [
        field("axial_stiffness_n", stiffness_n * factor),
        field("damping_n_s_m", 10.0 * factor.sqrt()),
    ]
}

/// Largest difference of a component of a body's displacement from its start, m.
fn largest_difference_m(a: &MemorySink, b: &MemorySink, bodies: &[&str]) -> f64 {
    let mut largest = 0.0_f64;
    for body in bodies {
        let (a, b) = (a.positions(body), b.positions(body));
        assert_eq!(a.len(), b.len());
        for ((time_a, at_a), (time_b, at_b)) in a.iter().zip(&b) {
            assert_eq!(time_a, time_b);
            let difference = (at_a - a[0].1) - (at_b - b[0].1);
            largest = largest.max(difference.abs().max_element());
        }
    }
    largest
}

/// The power of x with which y falls: the slope of a straight line through the logarithms.
fn fitted_order(x: &[f64], y: &[f64]) -> f64 {
    let mean = |values: &[f64]| values.iter().map(|v| v.ln()).sum::<f64>() / values.len() as f64;
    let (mean_x, mean_y) = (mean(x), mean(y));
    let pairs = || {
        x.iter()
            .zip(y)
            .map(|(x, y)| (x.ln() - mean_x, y.ln() - mean_y))
    };
    -pairs().map(|(x, y)| x * y).sum::<f64>() / pairs().map(|(x, _)| x * x).sum::<f64>()
}

const STIFFNESSES_N: [f64; 5] = [2e5, 2e6, 2e7, 2e8, 2e9];

/// What is left of the stretch at 2e9 N is 2e-5 m, so the implicit method is asked for less than that.
fn accuracy_for(stiffness_n: f64) -> f64 {
    if stiffness_n < 1e7 { 1e-6 } else { 1e-7 }
}

/// Point masses on rigid links are the limit of lumped masses as EA grows: the difference, which is that of
/// the stretch, falls as 1/EA over four decades. Two programs that share neither coordinates nor
/// integrator.
#[test]
fn val_lumped_masses_become_point_mass_links_as_the_tether_stiffens() {
    let links = [CENTRED_COMPARISON.as_slice(), &[DENOC, POINT_MASSES, TIGHT]].concat();
    let links = fly_scene(COMPARISON, &links);
    let difference = |stiffness_n: f64| {
        let mut more = stiffer("tether", 2e5, stiffness_n / 2e5).to_vec();
        more.push(implicit(accuracy_for(stiffness_n)));
        let lumped = fly_with(COMPARISON, &CENTRED_COMPARISON, &more);
        largest_difference_m(&lumped, &links, &["balloon", "gondola"])
    };
    let differences = STIFFNESSES_N.map(difference);
    let order = fitted_order(&STIFFNESSES_N, &differences);
    println!("EA {STIFFNESSES_N:?} N: {differences:?} m, order {order:.3}");
    assert!((0.9..1.1).contains(&order), "{order}");
    for pair in differences[1..].windows(2) {
        let decade = (pair[0] / pair[1]).log10();
        assert!((0.9..1.1).contains(&decade), "{differences:?}");
    }
    // Two separate programs, one of either formulation, gave these differences; half of the last digit.
    for (stiffness_n, printed_m, digit_m) in [
        (2e5, 0.358, 1e-3),
        (8e5, 0.0648, 1e-4),
        (3.2e6, 0.0175, 1e-4),
        (1.28e7, 0.0036, 1e-4),
    ] {
        let found_m = difference(stiffness_n);
        println!("{stiffness_n:e} N: {found_m:.5} m, printed {printed_m}");
        assert!((found_m - printed_m).abs() < 0.5 * digit_m, "{found_m}");
    }
}

/// Elastic rods become rigid rods as EA grows, in the same way.
#[test]
fn elastic_rods_become_rigid_rods_as_the_tether_stiffens() {
    let rigid = fly_scene(COMPARISON, &[DENOC, TIGHT]);
    let differences = STIFFNESSES_N.map(|stiffness_n| {
        let mut more = stiffer("tether", 2e5, stiffness_n / 2e5).to_vec();
        more.push(implicit(accuracy_for(stiffness_n)));
        let elastic = fly_with(COMPARISON, &[DENOC, ELASTIC], &more);
        largest_difference_m(&elastic, &rigid, &["balloon", "gondola"])
    });
    let order = fitted_order(&STIFFNESSES_N, &differences);
    println!("EA {STIFFNESSES_N:?} N: {differences:?} m, order {order:.3}");
    assert!((0.9..1.1).contains(&order), "{order}");
}

/// Elastic links with point masses are the lumped formulation in joint coordinates: the same equations,
/// integrated to 1e-11, so the same trajectory of bodies and nodes, to some times that of the way of 60 m
/// and the round-off of 56 km (7e-12 m).
#[test]
fn elastic_point_mass_links_are_lumped_masses() {
    let overrides = [
        "run.duration_s=20",
        "run.integrator=Adaptive(relative_tolerance: 1e-11)",
    ];
    let links = [overrides.as_slice(), &[DENOC, POINT_MASSES, ELASTIC]].concat();
    let links = fly_scene(COMPARISON, &links);
    let lumped = fly_scene(COMPARISON, &overrides);
    assert_below("distance, m", largest_distance_m(&links, &lumped), 1e-9);
}

/// A probe on a line, thrown upwards: the line goes slack, folds, and snaps taut.
const THROWN: &str = r#"(
    name: "thrown",
    environment: (gravity: Constant(8.87), atmosphere: Uniform(density_kg_m3: 1.2)),
    entities: {
        "anchor": (Fixed: (position_m: (0, 0, 1000))),
        "probe": (
            Body: (mass_kg: 2, inertia: Box(0.2, 0.3, 0.4)),
            Motion: (velocity_m_s: (1, 0.5, 4), rate_rad_s: (0.3, 0.2, -0.1)),
            Drag: Constant(coefficient: 1, area_m2: 0.05),
        ),
        "line": (Tether: (
            from: ("anchor", Centre), to: ("probe", Top),
            length_m: 10, nodes: 4, diameter_m: 0.01, density_kg_m3: 1440,
            axial_stiffness_n: 5000, damping_n_s_m: 20, drag: (normal: 1, tangential: 0.03),
        )),
    },
    run: (
        formulation: LumpedMass, duration_s: 2, output_every_s: 0.05,
        integrator: Adaptive(relative_tolerance: 1e-11),
    ),
)"#;

/// The same where the line goes slack and taut: elastic links do not push.
#[test]
fn elastic_point_mass_links_are_lumped_masses_through_slack_and_snaps() {
    let (links, links_summary) = summary_of(THROWN, &[DENOC, POINT_MASSES, ELASTIC]);
    let (lumped, lumped_summary) = summary_of(THROWN, &[]);
    for summary in [&links_summary, &lumped_summary] {
        let count = |kind| summary.events.iter().filter(|e| e.kind == kind).count();
        assert!(
            count("slack") > 0 && count("taut") > 0,
            "{:?}",
            summary.events
        );
        assert_eq!(count("compression"), 0);
    }
    assert_below("distance, m", largest_distance_m(&links, &lumped), 1e-9);
}

/// Elastic rods and lumped masses share everything but where the mass sits within a segment: they meet with
/// the square of the segment's length.
#[test]
fn elastic_rods_and_lumped_masses_meet_with_the_square_of_the_segments_length() {
    let nodes = [5, 10, 20, 40];
    let differences = nodes.map(|nodes| {
        let more = [
            format!("entities.tether.Tether.nodes={nodes}"),
            implicit(1e-6),
        ];
        let rods = fly_with(COMPARISON, &[DENOC, ELASTIC], &more);
        let lumped = fly_with(COMPARISON, &[LUMPED], &more);
        largest_difference_m(&rods, &lumped, &["balloon", "gondola"])
    });
    let order = fitted_order(&nodes.map(|nodes| f64::from(nodes + 1)), &differences);
    println!("{nodes:?} nodes: {differences:?} m, order {order:.3}");
    assert!((1.9..2.1).contains(&order), "{order}");
}

const BRANCHED_BODIES: [&str; 4] = ["balloon", "gondola", "a", "b"];

/// On a tree, too, lumped masses become point masses on rigid links as 1/EA.
#[test]
fn lumped_masses_become_point_mass_links_on_a_branched_chain() {
    let tight = "run.integrator=Adaptive(relative_tolerance: 1e-8)";
    let links = fly_scene(BRANCHED, &[DENOC, POINT_MASSES, tight]);
    let factors = [1.0, 10.0, 100.0];
    let differences = factors.map(|factor| {
        let mut more = stiffer("tether", 2e5, factor).to_vec();
        more.extend(stiffer("line-a", 1e5, factor));
        more.extend(stiffer("line-b", 1e5, factor));
        more.push(implicit(if factor > 10.0 { 3e-8 } else { 1e-6 }));
        let lumped = fly_with(BRANCHED, &[LUMPED], &more);
        largest_difference_m(&lumped, &links, &BRANCHED_BODIES)
    });
    let order = fitted_order(&factors, &differences);
    println!("EA times {factors:?}: {differences:?} m, order {order:.3}");
    assert!((0.9..1.1).contains(&order), "{order}");
}

/// And rods, rigid or elastic, meet point masses with the square of the links' length.
#[test]
fn rods_meet_point_masses_on_a_branched_chain() {
    let cuts = [[5, 3, 1], [11, 7, 3], [23, 15, 7]];
    let between = |rods: &[&str], points: &[&str]| {
        cuts.map(|cut| {
            let mut more = vec![implicit(3e-6)];
            for (tether, nodes) in ["tether", "line-a", "line-b"].iter().zip(cut) {
                more.push(format!("entities.{tether}.Tether.nodes={nodes}"));
            }
            let rods = fly_with(BRANCHED, rods, &more);
            let points = fly_with(BRANCHED, points, &more);
            largest_difference_m(&rods, &points, &BRANCHED_BODIES)
        })
    };
    let links = [6.0, 12.0, 24.0];
    for (what, differences) in [
        (
            "rigid rods, rigid points",
            between(&[DENOC], &[DENOC, POINT_MASSES]),
        ),
        (
            "elastic rods, lumped masses",
            between(&[DENOC, ELASTIC], &[LUMPED]),
        ),
    ] {
        let order = fitted_order(&links, &differences);
        println!("{what}: {links:?} links: {differences:?} m, order {order:.3}");
        assert!((1.8..2.2).contains(&order), "{what}: {order}");
    }
}

/// Largest distance between the branched chain's flights with trees from the gondola and from `base`, m.
fn distance_from_base_m(base: &str, overrides: &[&str]) -> f64 {
    let from = |base: &str| {
        let base = format!("run.base=\"{base}\"");
        let all = [&[DENOC, "run.duration_s=20", &base], overrides].concat();
        fly_scene(BRANCHED, &all)
    };
    largest_distance_m(&from("gondola"), &from(base))
}

/// The tree may grow from any body: with the integrator's error out of the way, only round-off differs,
/// 7e-12 m of an altitude, and what a swinging chain makes of it.
#[test]
fn a_branched_chain_is_the_same_from_every_base() {
    for base in ["balloon", "a", "b"] {
        let largest_m = distance_from_base_m(base, &[TIGHT]);
        assert_below(&format!("from `{base}`, m"), largest_m, 1e-8);
    }
}

/// An implicit step of another tree steps other coordinates and solves other linear systems; what differs is
/// its error, and falls with its third order.
#[test]
fn implicit_steps_from_another_base_differ_by_their_error() {
    let steps_s = [0.02, 0.01, 0.005];
    for base in ["balloon", "b"] {
        let largest_m = steps_s.map(|step_s| {
            let integrator = format!("run.integrator=Fixed(step_s: {step_s}, method: Rosenbrock)");
            distance_from_base_m(base, &[&integrator])
        });
        let order = fitted_order(&steps_s.map(f64::recip), &largest_m);
        println!("from `{base}`: steps {steps_s:?} s, {largest_m:?} m, order {order:.2}");
        assert!((2.7..3.5).contains(&order), "from `{base}`: {order}");
    }
}
