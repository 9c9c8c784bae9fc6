//! How rigid links start from a scene that was written for tethers, and how long a step they take: poses
//! and motions that links do not allow, starts out of reach, stable steps, steps too long.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod flight;

use aerobot::engine::plugin::Simulator;
use aerobot::engine::recording::frame::MemorySink;
use flight::{assert_below, fly, load, owned, scene_file};
use glam::DVec3;

/// Two points of 50 and 100 kg on a line of rods, afloat in nothing.
const PAIR: &str = r#"(
    name: "pair", environment: (atmosphere: Vacuum, gravity: Constant(0)),
    entities: {
        "light": (
            Body: (mass_kg: 50), Pose: (position_m: (0, 0, 1000)), Motion: (velocity_m_s: (0, 1, 3)),
        ),
        "heavy": (Body: (mass_kg: 100), Pose: (position_m: (0, 0, 900))),
        "line": (Tether: (
            from: ("light", Centre), to: ("heavy", Centre), length_m: 100, nodes: 3, diameter_m: 0.01,
            density_kg_m3: 1000, axial_stiffness_n: 1e8, start: Straight,
        )),
    },
    run: (formulation: Denoc, duration_s: 1, output_every_s: 1),
)"#;

/// Motion along the line is shared by an impulse, as momentum demands; across the line nothing changes.
#[test]
fn a_motion_along_a_rigid_line_is_shared_by_impulse() {
    let rod_kg = 1000.0 * 100.0 * std::f64::consts::PI * 0.005 * 0.005;
    // Half of the first link's mass goes with the light body.
    let common = 3.0 * (50.0 + rod_kg / 8.0) / (150.0 + rod_kg);
    for base in ["light", "heavy"] {
        let results = fly(PAIR, &[&format!("run.base=\"{base}\"")]);
        for (name, across) in [("light", 1.0), ("heavy", 0.0)] {
            let (_, row) = results.states(name).next().unwrap();
            let expected = DVec3::new(0.0, across, common);
            let error = row.velocity_m_s.distance(expected);
            assert_below(&format!("{name} from {base}, m/s"), error, 1e-13);
        }
    }
}

/// A line stretched by one part in a hundred draws its ends together about their common centre of mass, that
/// of the line included, whatever body the tree grows from.
#[test]
fn a_stretched_pose_keeps_its_centre_of_mass() {
    let stretched = "entities.light.Pose.position_m=(0, 0, 1001)";
    let rod_kg = 1000.0 * 100.0 * std::f64::consts::PI * 0.005 * 0.005;
    let all_kg = 150.0 + rod_kg;
    let centre = (50.0 * 1001.0 + 100.0 * 900.0 + rod_kg * 950.5) / all_kg;
    let top = centre + (100.0 * 100.0 + 50.0 * rod_kg) / all_kg;
    for base in ["light", "heavy"] {
        let results = fly(PAIR, &[stretched, &format!("run.base=\"{base}\"")]);
        for (name, z) in [("light", top), ("heavy", top - 100.0)] {
            let (_, row) = results.states(name).next().unwrap();
            assert_below(
                &format!("{name} from {base}, m"),
                (row.position_m.z - z).abs(),
                1e-10,
            );
        }
    }
}

fn refusal(text: &str, overrides: &[&str]) -> Option<String> {
    let simulator = Simulator::new();
    let scene = load(&simulator, text, overrides);
    simulator.build(&scene).err().map(|error| error.to_string())
}

/// What a tether may be stretched by is a part of its own length: four in a row by one part in a hundred
/// each are taken, a short one beside a long one is not.
#[test]
fn every_tether_is_judged_by_its_own_length() {
    let line = |from: &str, to: &str, length_m: f64| {
        format!(
            "Tether: (from: (\"{from}\", Centre), to: (\"{to}\", Centre), length_m: {length_m}, nodes: 0, \
             axial_stiffness_n: 1e6)"
        )
    };
    let body = |z: f64| format!("Body: (mass_kg: 5), Pose: (position_m: (0, 0, {z}))");
    let scene = |rest: &str| {
        format!(
            "(name: \"row\", entities: {{ \"top\": (Fixed: (position_m: (0, 0, 5000))), {rest} }}, \
             run: (formulation: Denoc, duration_s: 1, output_every_s: 1))"
        )
    };
    let mut row = String::new();
    let mut above = "top".to_owned();
    for k in 1..=4 {
        let z = 5000.0 - 101.0 * f64::from(k);
        let own = format!("b{k}");
        row += &format!("\"{own}\": ({}), ", body(z));
        row += &format!("\"line{k}\": ({}), ", line(&above, &own, 100.0));
        above = own;
    }
    assert_eq!(refusal(&scene(&row), &[]), None);
    let short = format!(
        "\"deep\": ({}), \"long\": ({}), \"near\": ({}), \"short\": ({}),",
        body(4000.0),
        line("top", "deep", 1000.0),
        body(4990.0),
        line("top", "near", 2.0),
    );
    let message = refusal(&scene(&short), &[]).expect("out of reach");
    assert!(
        message.contains("`short` miss the places of its ends by 8.000000 m"),
        "{message}"
    );
}

/// Elastic links between point masses are lumped masses in other coordinates: their stable step is the
/// same, to what a power iteration leaves, however stiff the dampers are.
#[test]
fn elastic_links_have_the_stable_step_of_lumped_masses() {
    let simulator = Simulator::new();
    let step_s = |overrides: &[&str], nodes: u32| {
        let mut overrides = owned(overrides);
        overrides.push(format!("entities.tether.Tether.nodes={nodes}"));
        let scene = simulator
            .load(&scene_file("paper/comparison_900m.ron"), &overrides)
            .unwrap();
        simulator.build(&scene).unwrap().stable_step().step_s
    };
    let links = [
        "run.formulation=Denoc",
        "run.elastic_links=true",
        "run.links=PointMass",
    ];
    for nodes in [10, 100, 400] {
        let ratio = step_s(&links, nodes) / step_s(&[], nodes);
        println!("{nodes} nodes: {ratio:.4}");
        assert!((0.95..1.01).contains(&ratio), "{nodes}: {ratio}");
    }
}

/// A uniform chain of rods of mass m and length L under the tension T has the fastest transverse wave
/// w^2 = 12 T / (m L), neighbours out of phase; RK4 takes 2 sqrt 2 / w at the most.
#[test]
fn rigid_links_have_the_stable_step_of_their_transverse_waves() {
    let simulator = Simulator::new();
    let overrides = owned(&[
        "run.formulation=Denoc",
        "entities.tether.Tether.nodes=100",
        "entities.tether.Tether.density_kg_m3=14.4",
    ]);
    let scene = simulator
        .load(&scene_file("paper/comparison_900m.ron"), &overrides)
        .unwrap();
    let found = simulator.build(&scene).unwrap().stable_step().step_s;
    let link_kg = 0.040_715_040_79 / 101.0;
    let wave = (12.0 * 100.0 * 8.87 / (link_kg * 900.0 / 101.0_f64)).sqrt();
    let ratio = found * wave / 8.0_f64.sqrt();
    println!("{found} s, ratio {ratio:.4}");
    assert!((0.97..1.01).contains(&ratio), "{ratio}");
}

/// Nothing that oscillates limits the step of a chain at rest in nothing.
#[test]
fn a_chain_without_load_has_no_stable_step() {
    let simulator = Simulator::new();
    let at_rest = "entities.light.Motion.velocity_m_s=(0, 0, 0)";
    let scene = load(&simulator, PAIR, &[at_rest]);
    let simulation = simulator.build(&scene).unwrap();
    assert_eq!(simulation.stable_step().step_s, f64::INFINITY);
}

/// A fixed step in which a link would turn by a right angle stops the run, and what it says of the end is
/// the last state that was reached.
#[test]
fn a_step_that_is_too_long_for_a_link_stops_at_the_last_state() {
    let text = r#"(
        name: "edge", environment: (atmosphere: Vacuum),
        entities: {
            "top": (Fixed: (position_m: (0, 0, 0))),
            "bob": (
                Body: (mass_kg: 1), Pose: (position_m: (0, 0, 1)), Motion: (velocity_m_s: (5, 0, 0)),
            ),
            "line": (Tether: (
                from: ("top", Centre), to: ("bob", Centre), length_m: 1, nodes: 0, axial_stiffness_n: 1e4,
            )),
        },
        run: (
            formulation: Denoc, duration_s: 2, output_every_s: 0.2, integrator: Fixed(step_s: 0.2),
        ),
    )"#;
    let simulator = Simulator::new();
    let mut results = MemorySink::default();
    let mut simulation = simulator.build(&load(&simulator, text, &[])).unwrap();
    let summary = simulation.run(&mut results, &mut |_| {});
    let stop = summary.stopped.expect("a step too long");
    assert!(stop.reason.contains("right angle"), "{}", stop.reason);
    let last = results.frames.last().unwrap();
    assert_eq!(summary.simulated_s, last.time_s);
    let row = last
        .states
        .iter()
        .find(|row| &*row.entity == "bob")
        .unwrap();
    assert_eq!(
        summary.final_states[0].position_m,
        row.position_m.to_array()
    );
    let largest = summary.largest_tension.expect("a tension");
    assert!(largest.time_s <= last.time_s);
}
