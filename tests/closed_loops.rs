//! Closed loops of links: lengths that are kept, quantities that are conserved, orders of convergence, and
//! lumped masses in other coordinates.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod flight;

use aerobot::engine::recording::frame::{Frame, MemorySink};
use flight::{assert_below, fly, largest_distance_m};
use glam::DVec3;

/// Two bodies that float without weight and without air, joined by a ring of three tethers of three links:
/// they drift, spin, and pull on each other.
fn dumbbell(run: &str, tether: &str) -> String {
    let inertia = "Tensor(xx_kg_m2: 3, yy_kg_m2: 4, zz_kg_m2: 5)";
    format!(
        r#"(
    name: "ring", environment: (gravity: Constant(0), atmosphere: Vacuum),
    entities: {{
        "a": (
            Body: (mass_kg: 8, inertia: {inertia}), Pose: (position_m: (0, 0, {TOP})),
            Motion: (velocity_m_s: (1, 0.2, 0.1), rate_rad_s: (0.02, 0.03, 0.3)),
        ),
        "b": (
            Body: (mass_kg: 5, inertia: {inertia}), Pose: (position_m: (0, 0, 0)),
            Motion: (velocity_m_s: (-0.6, 0.3, 0.1), rate_rad_s: (-0.01, 0.02, -0.1)),
        ),
        "ring": (Tethers: (
            count: 3, from_radius_m: 1, to_radius_m: 0.8, from: ("a", (0, 0, -0.2)), to: ("b", (0, 0, 0.2)),
            length_m: 12, nodes: 2, diameter_m: 0.006, density_kg_m3: 1440, axial_stiffness_n: 1e5,
            start: Straight, {tether}
        )),
    }},
    run: (formulation: Denoc, {run}),
)"#
    )
}

/// Height at which the ring is just straight, m: 0.4 + sqrt(12^2 - 0.2^2).
const TOP: f64 = 12.398_333_217_6;

const LINK_KG: f64 = 1440.0 * std::f64::consts::PI * 9e-6 * 4.0;

struct Sums {
    momentum: DVec3,
    angular: DVec3,
    energy_j: f64,
}

/// Of the bodies with half a point-mass link at each of three places, and of the nodes.
fn sums(frame: &Frame) -> Sums {
    let mut sums = Sums {
        momentum: DVec3::ZERO,
        angular: DVec3::ZERO,
        energy_j: 0.0,
    };
    let mut add = |mass_kg: f64, x: DVec3, v: DVec3| {
        sums.momentum += mass_kg * v;
        sums.angular += x.cross(mass_kg * v);
        sums.energy_j += 0.5 * mass_kg * v.length_squared();
    };
    let mut spin = (DVec3::ZERO, 0.0);
    for row in &frame.states {
        let (mass_kg, radius, z) = match &*row.entity {
            "a" => (8.0, 1.0, -0.2),
            "b" => (5.0, 0.8, 0.2),
            _ => {
                add(LINK_KG, row.position_m, row.velocity_m_s);
                continue;
            }
        };
        let motion = row.rotation.unwrap();
        let (q, w) = (motion.0, motion.1);
        add(mass_kg, row.position_m, row.velocity_m_s);
        let own = DVec3::new(3.0, 4.0, 5.0) * w;
        spin.0 += q * own;
        spin.1 += 0.5 * own.dot(w);
        for k in 0..3 {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / 3.0).sin_cos();
            let r = DVec3::new(radius * cos, radius * sin, z);
            let v = row.velocity_m_s + q * w.cross(r);
            add(0.5 * LINK_KG, row.position_m + q * r, v);
        }
    }
    sums.angular += spin.0;
    sums.energy_j += spin.1;
    sums
}

fn energy_error(results: &MemorySink) -> f64 {
    let start = sums(&results.frames[0]).energy_j;
    let end = sums(results.frames.last().unwrap()).energy_j;
    (end / start - 1.0).abs()
}

const POINT_MASSES: &str = "run.links=PointMass";

/// Momentum is conserved to round-off whatever the step, angular momentum to the integrator's error, energy
/// with its order.
#[test]
fn a_spinning_ring_conserves_what_it_must() {
    let run = |integrator: &str| {
        let run = format!("duration_s: 8, output_every_s: 1, integrator: {integrator}");
        fly(&dumbbell(&run, ""), &[POINT_MASSES])
    };
    let tight = run("Adaptive(relative_tolerance: 1e-11)");
    let start = sums(&tight.frames[0]);
    for frame in &tight.frames {
        let now = sums(frame);
        assert_below("momentum", now.momentum.distance(start.momentum), 1e-11);
        assert_below(
            "angular momentum",
            now.angular.distance(start.angular),
            1e-7,
        );
        assert_below("energy", (now.energy_j / start.energy_j - 1.0).abs(), 1e-9);
    }
    let errors =
        [0.05, 0.025].map(|step_s| energy_error(&run(&format!("Fixed(step_s: {step_s})"))));
    let order = (errors[0] / errors[1]).log2();
    println!("energy {errors:?}, order {order:.2}");
    assert!(order > 3.5, "{order}");
}

/// Every link keeps its length to round-off of what it stands at, those that close loops too, in every
/// integrator.
#[test]
fn loops_stay_closed() {
    for integrator in [
        "Auto(accuracy_m: 1e-2)",
        "Implicit(accuracy_m: 1e-2)",
        "Adaptive(relative_tolerance: 1e-6)",
        "Fixed(step_s: 0.05)",
    ] {
        let run = format!("duration_s: 60, output_every_s: 2, integrator: {integrator}");
        let results = fly(&dumbbell(&run, ""), &[]);
        let segments = results.frames.iter().flat_map(|frame| &frame.segments);
        let worst = segments
            .map(|segment| (segment.length_m - 4.0).abs())
            .fold(0.0, f64::max);
        assert_below(integrator, worst, 2e-10);
    }
}

/// The method of the implicit steps is of third order with loops, too, rods and point masses.
#[test]
fn rosenbrock_is_of_third_order_on_loops() {
    for links in ["Rod", "PointMass"] {
        let links = format!("run.links={links}");
        let run = |integrator: &str| {
            let run = format!("duration_s: 6, output_every_s: 1, integrator: {integrator}");
            fly(&dumbbell(&run, ""), &[&links])
        };
        let exact = run("Adaptive(relative_tolerance: 1e-11)");
        let errors = [0.08, 0.04, 0.02].map(|step_s| {
            let integrator = format!("Fixed(step_s: {step_s}, method: Rosenbrock)");
            largest_distance_m(&run(&integrator), &exact)
        });
        let order = 0.5 * (errors[0] / errors[2]).log2();
        println!("{links}: {errors:?} m, order {order:.2}");
        assert!((2.6..3.8).contains(&order), "{links}: {order}");
    }
}

/// Elastic links in a loop are the same lumped masses in other coordinates.
#[test]
fn elastic_loops_are_lumped_masses() {
    let of = |more: &[&str]| {
        let run =
            "duration_s: 5, output_every_s: 1, integrator: Adaptive(relative_tolerance: 1e-11)";
        fly(&dumbbell(run, "damping_n_s_m: 20,"), more)
    };
    let lumped = of(&["run.formulation=LumpedMass"]);
    let elastic = of(&[POINT_MASSES, "run.elastic_links=true"]);
    assert_below("elastic", largest_distance_m(&elastic, &lumped), 1e-8);
}

/// A slender body on few heavy rods, whose own mass is small beside what the tips need, and a confluence that
/// weighs less than the rods that meet there.
#[test]
fn light_bodies_close_heavy_loops() {
    for nodes in [0, 1, 3] {
        let text = format!(
            r#"(
    name: "slender", environment: (gravity: Constant(8.87), atmosphere: Vacuum),
    entities: {{
        "anchor": (Fixed: (position_m: (0, 0, 100))),
        "body": (
            Body: (mass_kg: 10, inertia: SolidCylinder(radius_m: 0.05, height_m: 1.5)),
            Motion: (rate_rad_s: (0.1, 0, 0)),
        ),
        "ring": (Tethers: (
            count: 3, from_radius_m: 1, to_radius_m: 0.05, from: ("anchor", Centre), to: ("body", Top),
            length_m: 30, nodes: {nodes}, diameter_m: 0.004, density_kg_m3: 1440, axial_stiffness_n: 5e5,
        )),
    }},
    run: (formulation: Denoc, duration_s: 3, output_every_s: 0.5),
)"#
        );
        let results = fly(&text, &[]);
        let length_m = 30.0 / (f64::from(nodes) + 1.0);
        let segments = results.frames.iter().flat_map(|frame| &frame.segments);
        let worst = segments.map(|row| (row.length_m - length_m).abs());
        assert_below("lengths", worst.fold(0.0, f64::max), 1e-8);
    }
}

/// Four rigid tethers are redundant by one, and a body that swings and turns below them makes them stretch: as
/// springs do that pull and push, up to what the other three stretch besides, which goes with 1/EA; in every
/// integrator.
#[test]
fn redundant_tethers_stretch_as_springs_do() {
    let scene = |stiffness_n: f64| {
        format!(
            r#"(
    name: "four", environment: (gravity: Constant(8.87), atmosphere: Vacuum),
    entities: {{
        "anchor": (Fixed: (position_m: (0, 0, 1000))),
        "body": (
            Body: (mass_kg: 10, inertia: Box(1, 1, 0.5)),
            Motion: (velocity_m_s: (3, 1, 0), rate_rad_s: (0, 0, 1.5)),
        ),
        "ring": (Tethers: (
            count: 4, from_radius_m: 0.5, to_radius_m: 0.5, from: ("anchor", Centre), to: ("body", Top),
            length_m: 10, nodes: 0, axial_stiffness_n: {stiffness_n}, damping_n_s_m: 10, slack: false,
        )),
    }},
    run: (formulation: Denoc, duration_s: 5, output_every_s: 0.1),
)"#
        )
    };
    let rigid = |stiffness_n: f64, integrator: &str| {
        let integrator = format!("run.integrator={integrator}");
        fly(&scene(stiffness_n), &[&integrator])
    };
    let differences_m = [5e4, 5e5].map(|stiffness_n| {
        let springs = fly(
            &scene(stiffness_n),
            &[
                "run.formulation=LumpedMass",
                "run.integrator=Adaptive(relative_tolerance: 1e-9)",
            ],
        );
        let links = rigid(stiffness_n, "Adaptive(relative_tolerance: 1e-9)");
        for integrator in ["Auto()", "Implicit()", "Fixed(step_s: 0.01)"] {
            let other = rigid(stiffness_n, integrator);
            assert_below(integrator, largest_distance_m(&other, &links), 1e-3);
        }
        largest_distance_m(&links, &springs)
    });
    println!("EA x 1, 10: {differences_m:?} m");
    assert_below("EA x 10", differences_m[1], 1e-3);
    assert!(
        differences_m[1] < 0.2 * differences_m[0],
        "{differences_m:?}"
    );
}
