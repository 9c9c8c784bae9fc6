//! The towed line at rest against a continuous cable, which is computed without nodes, segments and
//! Newton's method on forces; and the command that sets the two side by side.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod flight;
mod program;

use std::f64::consts::PI;
use std::fs;
use std::path::PathBuf;

use aerobot::components::state::Position;
use aerobot::engine::plugin::Simulator;
use aerobot::engine::world::SceneEntities;
use aerobot::reproduce::ReproduceError;
use aerobot::reproduce::towing::{TowingSettings, WindResult, compare};
use aerobot::systems::towed_cable::{Conditions, Line, StaticShape, TowedBody, TowedCable};
use flight::{assert_below, owned, scene_file};
use glam::DVec3;
use program::reproduced::{assert_kept, assert_listed, assert_refused, assert_tables};
use program::{Scratch, aerobot, text};

/// Where the probe of the scene rests, m, with overrides.
fn discrete(overrides: &[String]) -> DVec3 {
    let simulator = Simulator::new();
    let scene = simulator
        .load(&scene_file("paper/towing_9700m.ron"), overrides)
        .unwrap_or_else(|error| panic!("{error}"));
    let mut simulation = simulator
        .build(&scene)
        .unwrap_or_else(|error| panic!("{error}"));
    simulation
        .settle_in_wind(&scene)
        .unwrap_or_else(|error| panic!("{error}"));
    let world = simulation.world();
    let probe = world.resource::<SceneEntities>().get("probe").unwrap();
    world.get::<Position>(probe).unwrap().0
}

/// The numbers of the scene, written down a second time.
fn continuous(
    axial_stiffness_n: f64,
    density_kg_m3: impl Fn(f64) -> f64,
    wind_m_s: impl Fn(f64) -> f64,
) -> StaticShape {
    let diameter_m: f64 = 0.43991707e-3;
    let cable = TowedCable {
        line: Line {
            length_m: 9700.0,
            mass_per_length_kg_m: 1560.0 * PI * 0.25 * diameter_m * diameter_m,
            diameter_m,
            axial_stiffness_n,
            normal_drag: 1.0,
            tangential_drag: 0.03,
        },
        body: TowedBody {
            mass_kg: 4.0,
            drag_area_m2: 0.47 * PI * 0.05 * 0.05,
            displaced_volume_m3: 0.0,
        },
        top_altitude_m: 52_000.0,
    };
    let surroundings = |z: f64| {
        Some(Conditions {
            density_kg_m3: density_kg_m3(z),
            wind_m_s: wind_m_s(z),
            gravity_m_s2: 8.87,
        })
    };
    cable.solve(&surroundings, &[]).unwrap()
}

fn exponential(z: f64) -> f64 {
    1.594 * (-(z - 50_000.0) / 7000.0).exp()
}

fn shear(speed_m_s: f64) -> impl Fn(f64) -> f64 {
    move |z| speed_m_s * (52_000.0 - z) / 9700.0
}

const ZYLON_N: f64 = 27_359.24;

const NODES: [u32; 4] = [50, 100, 200, 400];

/// Distances of the discrete probe from the continuous one, m, at `nodes` nodes.
fn errors_m(overrides: &[&str], nodes: &[u32], exact: &StaticShape) -> Vec<DVec3> {
    let error = |nodes: &u32| {
        let mut overrides = owned(overrides);
        overrides.push(format!("entities.towline.Tether.nodes={nodes}"));
        discrete(&overrides) - DVec3::new(exact.body.x_m, 0.0, exact.body.z_m)
    };
    nodes.iter().map(error).collect()
}

/// Errors fall as the square of the length of a segment.
#[track_caller]
fn assert_second_order(what: &str, errors: &[DVec3], tolerance: f64) {
    println!("{what}: {errors:?}");
    for (pair, nodes) in errors.windows(2).zip(NODES) {
        let segments = f64::from(2 * nodes + 1) / f64::from(nodes + 1);
        let order = (pair[0].length() / pair[1].length()).ln() / segments.ln();
        assert!((order - 2.0).abs() < tolerance, "{what}: order {order}");
    }
}

#[test]
fn the_discrete_line_rests_where_the_continuous_cable_does() {
    for speed_m_s in [5.0, 10.0] {
        let exact = continuous(ZYLON_N, exponential, shear(speed_m_s));
        let gradient = format!(
            "environment.wind.0.gradient_per_s={:?}",
            -speed_m_s / 9700.0
        );
        let errors = errors_m(&[&gradient], &NODES, &exact);
        assert_second_order(&format!("{speed_m_s} m/s"), &errors, 0.03);
        if speed_m_s == 5.0 {
            assert_below("depth at 200 nodes, m", errors[2].z.abs(), 0.02);
        }
    }
}

#[test]
fn it_does_so_in_air_of_uniform_density() {
    let exact = continuous(ZYLON_N, |_| 2.0, shear(5.0));
    let air = "environment.atmosphere=Uniform(density_kg_m3: 2)";
    assert_second_order("uniform", &errors_m(&[air], &NODES, &exact), 0.03);
}

/// The wind turns round at 44.5 km: the line leans into it above and away from it below.
#[test]
fn it_does_so_in_a_wind_that_turns_round() {
    let exact = continuous(ZYLON_N, exponential, |z| 8.0 * (44_500.0 - z) / 9700.0);
    assert!(exact.top.angle_rad < 0.0, "{:?}", exact.top);
    let turned = [
        "environment.wind.0.altitude_m=44500",
        "environment.wind.0.gradient_per_s=-0.0008247422680412371",
    ];
    assert_second_order("turned", &errors_m(&turned, &NODES, &exact), 0.1);
}

/// 1000 times the stiffness of Zylon stretches by 16 mm; the limit itself by nothing. Beyond 200 nodes
/// the round-off of an altitude, seen through segments so stiff, is what is left of the error.
#[test]
fn a_stiff_line_rests_where_an_inextensible_cable_does() {
    let limit = continuous(f64::INFINITY, exponential, shear(5.0));
    let stiff = continuous(1e3 * ZYLON_N, exponential, shear(5.0));
    let apart = (stiff.body.z_m - limit.body.z_m).hypot(stiff.body.x_m - limit.body.x_m);
    assert!((1e-3..0.03).contains(&apart), "{apart}");
    let stiffness = "entities.towline.Tether.axial_stiffness_n=27359240";
    let errors = errors_m(&[stiffness], &NODES[..3], &stiff);
    assert_second_order("stiff", &errors, 0.05);
    let from_limit = errors[2] + DVec3::new(0.0, 0.0, stiff.body.z_m - limit.body.z_m);
    assert_below("200 nodes from the limit, m", from_limit.z.abs(), 0.025);
}

/// Links do not stretch at all: their rest is that of the inextensible cable itself, of second order too.
#[test]
fn rigid_links_rest_where_an_inextensible_cable_does() {
    // x and z of the body that a separate program printed, m.
    for (speed_m_s, printed) in [
        (5.0, (4886.936, 43_720.870)),
        (10.0, (6920.934, 45_416.559)),
    ] {
        let limit = continuous(f64::INFINITY, exponential, shear(speed_m_s));
        let apart = (limit.body.x_m - printed.0).hypot(limit.body.z_m - printed.1);
        assert_below("the cable from the printed one, m", apart, 1e-3);
        let gradient = format!(
            "environment.wind.0.gradient_per_s={:?}",
            -speed_m_s / 9700.0
        );
        let links = [gradient.as_str(), "run.formulation=Denoc"];
        let errors = errors_m(&links, &NODES, &limit);
        assert_second_order(&format!("links, {speed_m_s} m/s"), &errors, 0.05);
        assert_below("depth at 200 nodes, m", errors[2].z.abs(), 0.03);
    }
}

/// Few nodes, a short flight: everything but the figures.
fn short() -> TowingSettings {
    TowingSettings {
        winds_m_s: vec![5.0, 40.0],
        nodes: 8,
        duration_s: 30.0,
    }
}

fn compared(settings: &TowingSettings) -> Vec<WindResult> {
    let mut parts = Vec::new();
    let results = compare(&Simulator::new(), settings, &mut |_, part| parts.push(part));
    assert!(parts.is_sorted() && parts.last() == Some(&1.0), "{parts:?}");
    results.unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn the_three_lines_of_the_towing_case_are_of_one_kind() {
    let results = compared(&short());
    assert_eq!(results.len(), 2);
    for result in &results {
        for line in [&result.continuous, &result.discrete, &result.dynamic] {
            assert_eq!((line.points.len(), line.segment_tensions_n.len()), (10, 9));
            assert!((line.points[0].z_m - 52_000.0).abs() < 1e-6);
            assert_eq!(line.probe().from_top_m, 9700.0);
        }
        assert_eq!((result.flown_s, &result.stopped), (30.0, &None));
        // Still on its way from straight down.
        assert!(result.unsettled_m() > 1000.0);
        println!("{} m/s: order {}", result.wind_m_s, result.order());
    }
    let calm = &results[0];
    assert!((calm.order() - 2.0).abs() < 0.5, "{}", calm.order());
    assert!((calm.continuous.top_tension_n - 53.4911).abs() < 1e-4);
    assert!((calm.discrete.top_tension_n - 53.4911).abs() < 0.1);
    assert!((calm.discrete.top_angle_rad - calm.continuous.top_angle_rad).abs() < 2e-3);
    let segments = calm.discrete.segment_tensions_n.iter();
    for (discrete, continuous) in segments.zip(&calm.continuous.segment_tensions_n) {
        let apart = (discrete - continuous).abs();
        assert!(apart < 1.0, "{discrete} {continuous}");
    }
}

/// The force on the held top converges as the shape does.
#[test]
fn the_pull_on_the_balloon_is_of_second_order() {
    let at = |nodes| {
        let settings = TowingSettings {
            winds_m_s: vec![10.0],
            nodes,
            duration_s: 1e-3,
        };
        let result = compared(&settings).remove(0);
        result.discrete.top_tension_n - result.continuous.top_tension_n
    };
    let (coarse, fine) = (at(60), at(121));
    let order = (coarse / fine).log2();
    println!("{coarse} N, {fine} N: order {order}");
    assert!((order - 2.0).abs() < 0.1, "{order}");
}

#[test]
fn one_node_is_too_few_to_tell_an_order() {
    let settings = TowingSettings {
        nodes: 1,
        ..short()
    };
    let refused = compare(&Simulator::new(), &settings, &mut |_, _| {}).unwrap_err();
    assert!(matches!(refused, ReproduceError::Setting(_)), "{refused}");
}

#[test]
fn the_command_writes_its_tables_once() {
    let scratch = Scratch::new();
    let out = scratch.text();
    let short = ["reproduce", "towing", "--nodes", "4", "--until", "10"];
    let first = aerobot(&[&short[..], &["--out", out]].concat());
    assert_eq!(first.status.code(), Some(0), "{}", text(&first.stderr));
    let printed = text(&first.stdout);
    for wanted in ["Figure 15", "4906.649", "8285.367", "53.4911", "leaves out"] {
        assert!(printed.replace('\n', " ").contains(wanted), "{printed}");
    }
    // Winds x models x (points | top and segments), with a header.
    assert_tables(
        &scratch,
        &[
            ("towing.csv", 6),
            ("towing_shapes.csv", 6 * 3 * 6),
            ("towing_tension.csv", 6 * 3 * 6),
        ],
    );
    assert_kept(&short, out);
}

#[test]
fn what_cannot_be_reproduced_is_refused_and_nothing_is_written() {
    assert_refused(&[
        (&["towin"], "did you mean `towing`?"),
        (&["towing", "--nodes", "1"], "2 nodes or more"),
        (&["towing", "--nodes", "-1"], "invalid value"),
        (&["towing", "--until", "0"], "`duration_s` must be above"),
        (&["towing", "--until", "NaN"], "duration_s"),
    ]);
    assert_listed("towing");
}

#[test]
fn every_scene_of_the_paper_is_accepted_and_tethers_of_every_length() {
    let folder = scene_file("paper");
    let mut scenes: Vec<PathBuf> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "ron"))
        .collect();
    scenes.sort();
    assert!(scenes.len() >= 4);
    let simulator = Simulator::new();
    let check = |path: &PathBuf, overrides: &[String]| {
        let built = simulator
            .load(path, overrides)
            .and_then(|scene| simulator.build(&scene).map(|_| ()));
        built.unwrap_or_else(|error| panic!("{error}"));
    };
    for scene in &scenes {
        check(scene, &[]);
    }
    for length_m in [900, 2000, 5000, 10_000] {
        let overrides = [format!("entities.tether.Tether.length_m={length_m}")];
        check(&scene_file("paper/long_tethers.ron"), &overrides);
    }
}
