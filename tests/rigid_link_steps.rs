//! What integrators make of rigid links: orders of convergence, steps that do not depend on the number of
//! links, and accuracies that are asked for.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod flight;

use aerobot::engine::plugin::Simulator;
use aerobot::engine::recording::frame::MemorySink;
use aerobot::engine::recording::summary::Summary;
use flight::{fly, owned, run_for_summary, scene_file};
use glam::DVec3;

const LINKS: [&str; 2] = ["Rod", "PointMass"];

fn comparison(links: &str, integrator: &str, more: &[&str]) -> (MemorySink, Summary) {
    let links = format!("run.links={links}");
    let integrator = format!("run.integrator={integrator}");
    let overrides = [&["run.formulation=Denoc", &links, &integrator], more].concat();
    let simulator = Simulator::new();
    let scene = simulator
        .load(&scene_file("paper/comparison_900m.ron"), &owned(&overrides))
        .unwrap_or_else(|error| panic!("{error}"));
    run_for_summary(&simulator, &scene)
}

/// Largest distance of balloon and gondola from where they are in `exact`, m.
fn error_m(found: &MemorySink, exact: &MemorySink) -> f64 {
    let mut largest = 0.0_f64;
    for body in ["balloon", "gondola"] {
        let (found, exact) = (found.positions(body), exact.positions(body));
        assert_eq!(found.len(), exact.len());
        for (found, exact) in found.iter().zip(&exact) {
            largest = largest.max(found.1.distance(exact.1));
        }
    }
    largest
}

const EXACT: &str = "Adaptive(relative_tolerance: 1e-9)";

/// The comparison case with its gusts: the implicit method is of third order, whose derivatives are exact
/// only but for added mass and gyroscopic terms; drag has kinks where a segment turns in the wind, so the
/// order is that of a straight line through three steps. The exact run is good to 1e-8 m.
#[test]
fn rosenbrock_is_of_third_order_on_rigid_links_in_gusts() {
    for links in LINKS {
        let exact = comparison(links, EXACT, &[]).0;
        let errors = [0.05, 0.025, 0.0125].map(|step_s| {
            let integrator = format!("Fixed(step_s: {step_s}, method: Rosenbrock)");
            error_m(&comparison(links, &integrator, &[]).0, &exact)
        });
        let order = 0.5 * (errors[0] / errors[2]).log2();
        println!("{links}: {errors:?} m, order {order:.2}");
        assert!((2.7..3.6).contains(&order), "{links}: {order}");
    }
}

/// A body that turns on a swinging chain of three links in wind; its anchor swings too. Smooth.
const SMOOTH: &str = r#"(
    name: "smooth",
    environment: (
        atmosphere: Exponential(density_kg_m3: 1.2, altitude_m: 0, scale_height_m: 8000),
        wind: [Uniform(velocity_m_s: (30, 5, 2)), Shear(altitude_m: 0, gradient_per_s: 0.05)],
    ),
    entities: {
        "anchor": (Moving: (position_m: (0, 0, 0), amplitude_m: (0.3, 0, 0.1), frequency_rad_s: 2)),
        "body": (
            Body: (mass_kg: 2, inertia: Box(0.4, 0.6, 0.8)),
            Pose: (
                position_m: (3, 0, -9.6),
                attitude: YawPitchRoll(yaw_rad: 0.3, pitch_rad: -0.4, roll_rad: 0.2),
            ),
            Motion: (velocity_m_s: (0, 2, 0), rate_rad_s: (0.5, 0.3, 1.5)),
            Sphere: (radius_m: 0.2), Buoyancy: (), AddedMass: (),
            Drag: Constant(coefficient: 0.47),
        ),
        "tether": (Tether: (
            from: ("anchor", Centre), to: ("body", (0.1, 0.05, 0.4)),
            length_m: 9.7, nodes: 2, diameter_m: 0.01, density_kg_m3: 1400,
            axial_stiffness_n: 4000, damping_n_s_m: 2, slack: false, start: Straight,
            drag: (normal: 1, tangential: 0.03),
        )),
    },
    run: (formulation: Denoc, duration_s: 2, output_every_s: 2),
)"#;

fn end(links: &str, integrator: &str) -> (DVec3, DVec3) {
    let results = fly(
        SMOOTH,
        &[
            &format!("run.links={links}"),
            &format!("run.integrator={integrator}"),
        ],
    );
    let (_, row) = results.states("body").last().unwrap();
    (row.position_m, row.rotation.unwrap().1)
}

/// log2 of the ratio of errors at a step and at half of it, of place (m) and body rate (rad/s).
fn orders(links: &str, integrator: impl Fn(f64) -> String, steps_s: [f64; 3]) -> [f64; 2] {
    let exact = end(links, "Adaptive(relative_tolerance: 1e-14)");
    let errors = steps_s.map(|step_s| {
        let found = end(links, &integrator(step_s));
        found.0.distance(exact.0).max(found.1.distance(exact.1))
    });
    println!("{links}: errors {errors:?}");
    [
        (errors[0] / errors[1]).log2(),
        (errors[1] / errors[2]).log2(),
    ]
}

/// Joint coordinates are integrated to the order of every method: the classical one, Dormand and Prince's,
/// and the implicit one, which keeps its order whatever its derivatives leave out.
#[test]
fn every_integrator_has_its_order_on_rigid_links() {
    for links in LINKS {
        for (order, found) in [
            (
                4.0,
                orders(
                    links,
                    |h| format!("Fixed(step_s: {h})"),
                    [0.02, 0.01, 0.005],
                ),
            ),
            (
                // A tolerance that accepts every step leaves the longest step in charge.
                5.0,
                orders(
                    links,
                    |h| format!("Adaptive(relative_tolerance: 0.9, longest_step_s: {h})"),
                    [0.02, 0.01, 0.005],
                ),
            ),
            (
                3.0,
                orders(
                    links,
                    |h| format!("Fixed(step_s: {h}, method: Rosenbrock)"),
                    [0.004, 0.002, 0.001],
                ),
            ),
        ] {
            println!("{links}: order {order}, found {found:?}");
            for found in found {
                assert!((found - order).abs() < 0.3, "{links}: {found}");
            }
        }
    }
}

/// The motion that is followed does not depend on how finely a tether is cut, and neither do the steps. That
/// is what makes a run of N links cost N.
#[test]
fn implicit_steps_do_not_grow_with_the_number_of_links() {
    for links in LINKS {
        let steps = [10, 100, 400].map(|nodes| {
            let nodes = format!("entities.tether.Tether.nodes={nodes}");
            let (_, summary) = comparison(links, "Implicit(accuracy_m: 1e-3)", &[&nodes]);
            summary.steps + summary.rejected_steps
        });
        println!("{links}: {steps:?} steps with 10, 100, 400 nodes");
        let (least, most) = (steps.iter().min().unwrap(), steps.iter().max().unwrap());
        assert!((*most as f64) < 1.5 * *least as f64, "{steps:?}");
    }
}

/// What is asked for bounds the error of steps; over 100 s with three gusts they add up to some of it.
#[test]
fn implicit_and_auto_reach_the_accuracy_asked_of_them() {
    for links in LINKS {
        let exact = comparison(links, EXACT, &[]).0;
        for method in ["Auto", "Implicit"] {
            for accuracy_m in [1e-2, 1e-3, 1e-4, 1e-6] {
                let integrator = format!("{method}(accuracy_m: {accuracy_m:e})");
                let (found, summary) = comparison(links, &integrator, &[]);
                let error_m = error_m(&found, &exact);
                println!(
                    "{links}, {integrator}: {error_m:.1e} m in {} steps, {} implicit",
                    summary.steps, summary.implicit_steps
                );
                assert!(error_m < 3.0 * accuracy_m, "{integrator}: {error_m}");
            }
        }
    }
}
