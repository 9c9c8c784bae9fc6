//! Tethers that are cut during a run of the second formulation: the tree changes, and what moves goes on.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod flight;

use flight::dumbbell::{assert_conserved, dumbbell};
use flight::{assert_below, assert_relative, fly, largest_distance_m, position, velocity};
use glam::DVec3;

const G: f64 = 8.87;

/// A body that swings from an anchor by a line of ten links.
fn swinging(events: &str, run: &str) -> String {
    format!(
        r#"(
    name: "swinging",
    environment: (gravity: Constant({G}), atmosphere: Vacuum),
    entities: {{
        "anchor": (Fixed: (position_m: (0, 0, 60_000))),
        "probe": (
            Body: (mass_kg: 100, inertia: Box(1, 1, 1)), Motion: (velocity_m_s: (8, 3, 0)),
        ),
        "tether": (Tether: (
            from: ("anchor", Centre), to: ("probe", (0.2, 0, 0.5)), length_m: 200, nodes: 9,
            diameter_m: 0.004, density_kg_m3: 1440, axial_stiffness_n: 1e6, damping_n_s_m: 20,
        )),
    }},
    events: [{events}],
    run: (formulation: Denoc, {run}),
)"#
    )
}

/// A body that is let go flies on a parabola with the velocity it had, and so does the line's end that no
/// tension holds any more; the other nodes go on swinging.
#[test]
fn what_is_released_flies_on_a_parabola() {
    for integrator in ["Auto()", "Implicit()", "Adaptive()", "Fixed()"] {
        for links in ["run.links=Rod", "run.links=PointMass"] {
            let run = format!("duration_s: 5, output_every_s: 1, integrator: {integrator}");
            let event = r#"(at_s: 2, do: Release(body: "probe"))"#;
            let results = fly(&swinging(event, &run), &[links]);
            let v = velocity(&results, "probe", 2.0);
            // The half link that stays on it makes it turn about the common centre of mass.
            let line_kg = 1440.0 * std::f64::consts::PI * 4e-6 * 20.0;
            let arm_m = 0.5 * line_kg / 100.0 * 0.6;
            let (at_2, at_5) = (
                position(&results, "probe", 2.0),
                position(&results, "probe", 5.0),
            );
            let expected = at_2 + 3.0 * v - 4.5 * G * DVec3::Z;
            assert_below(integrator, at_5.distance(expected), 3.0 * arm_m * 0.5);
            let end = results.frames.last().unwrap();
            let lengths = end.segments[..9]
                .iter()
                .map(|row| (row.length_m - 20.0).abs());
            assert_below("lengths", lengths.fold(0.0, f64::max), 1e-9);
            assert_eq!(end.segments[9].tension_n, 0.0);
        }
    }
}

/// A node between two cuts falls freely from where it was.
#[test]
fn a_node_between_two_cuts_falls() {
    let events = r#"(at_s: 2, do: Cut(tether: "tether", segment: 5)), (at_s: 2, do: Cut(tether: "tether", segment: 6))"#;
    for integrator in ["Implicit()", "Adaptive()"] {
        let run = format!("duration_s: 4, output_every_s: 1, integrator: {integrator}");
        let results = fly(&swinging(events, &run), &[]);
        let start = position(&results, "tether/5", 2.0);
        let fall = 2.0 * velocity(&results, "tether/5", 2.0) - 2.0 * G * DVec3::Z;
        let end = position(&results, "tether/5", 4.0);
        assert_below(integrator, end.distance(start + fall), 1e-8);
    }
}

/// Momentum and angular momentum of a spinning dumbbell, of point-mass links, are as they were at the cut.
#[test]
fn a_cut_conserves_momentum_and_angular_momentum() {
    let text = dumbbell(
        "length_m: 100, axial_stiffness_n: 5e3",
        "formulation: Denoc, links: PointMass",
    );
    assert_conserved(&fly(&text, &[]), 100.0, [1e-12, 1e-9]);
}

/// One tether of a ring is cut, and the body hangs on by the other two: stiff lumped masses do the same.
#[test]
fn a_ring_that_loses_a_tether_moves_as_lumped_masses_do() {
    let text = |more: &str| {
        format!(
            r#"(
    name: "ring", environment: (gravity: Constant({G}), atmosphere: Vacuum),
    entities: {{
        "anchor": (Fixed: (position_m: (0, 0, 100))),
        "body": (Body: (mass_kg: 20, inertia: Box(2, 2, 1))),
        "ring": (Tethers: (
            count: 3, from_radius_m: 1, to_radius_m: 1, from: ("anchor", Centre), to: ("body", (0, 0, 0.5)),
            length_m: 10, nodes: 1, diameter_m: 0.004, density_kg_m3: 1440, axial_stiffness_n: 1e6,
            damping_n_s_m: 50, slack: false,
        )),
    }},
    events: [(at_s: 0.5, do: Cut(tether: "ring/2", segment: 1))],
    run: ({more}, duration_s: 2.5, output_every_s: 0.5, integrator: Adaptive(relative_tolerance: 1e-9)),
)"#
        )
    };
    let rigid = fly(&text("formulation: Denoc, links: PointMass"), &[]);
    let fallen = position(&rigid, "body", 0.0).distance(position(&rigid, "body", 2.5));
    assert!(fallen > 0.1, "the cut moves the body: {fallen} m");
    let differences = [1e6, 1e7].map(|stiffness_n: f64| {
        let stiffness = format!("entities.ring.Tethers.axial_stiffness_n={stiffness_n:e}");
        largest_distance_m(
            &fly(&text("formulation: LumpedMass"), &[&stiffness]),
            &rigid,
        )
    });
    println!("{differences:?} m");
    assert!(differences[1] < 0.3 * differences[0], "{differences:?}");
    assert_relative("stays", position(&rigid, "body", 0.0).z, 89.5, 1e-6);
}
