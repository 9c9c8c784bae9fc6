use std::path::Path;

use glam::DVec3;

use super::*;
use crate::evaluation::with_integration;
use crate::plugin::Simulator;
use crate::recording::frame::MemorySink;
use crate::schedule::Phase;
use aerobot_systems::clock::Clock;

/// A body and a line that swing and stretch in a gust, below an anchor's free neighbour.
const SCENE: &str = r#"(
    name: "restructured",
    environment: (
        atmosphere: Uniform(density_kg_m3: 1),
        wind: [Step(velocity_m_s: (4, 1, 0), from_s: 1, until_s: 3)],
    ),
    entities: {
        "top": (
            Body: (mass_kg: 40, inertia: ThinSphere), Sphere: (radius_m: 2.2), Buoyancy: (),
            Drag: Constant(coefficient: 0.4),
            Pose: (position_m: (0, 0, 56_000)),
        ),
        "gondola": (
            Body: (mass_kg: 5, inertia: Box(1, 1, 1)), Drag: Constant(coefficient: 1, area_m2: 1),
        ),
        "tether": (Tether: (
            from: ("top", Bottom), to: ("gondola", (0, 0, 0.5)), length_m: 60, nodes: 5,
            diameter_m: 0.002, density_kg_m3: 1440, axial_stiffness_n: 2e4, damping_n_s_m: 2,
            drag: (normal: 1, tangential: 0.03),
        )),
    },
    run: (duration_s: 6, output_every_s: 1),
)"#;

/// Where everything was at the outputs, with or without being restructured on the way.
fn flight(overrides: &[&str], at_s: f64) -> Vec<DVec3> {
    let mut simulator = Simulator::new();
    simulator.add_systems(Phase::Constrain, move || {
        move |world: &mut World| {
            let time_s = world.resource::<Clock>().time_s;
            if time_s >= at_s && time_s < at_s + 0.5 {
                with_integration(world, |world, integration| {
                    restructure(world, integration).unwrap();
                    evaluate(world, integration).unwrap();
                });
            }
        }
    });
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    let scene = simulator
        .load_text("test.ron", SCENE.to_owned(), Path::new("."), &overrides)
        .unwrap();
    let mut results = MemorySink::default();
    let summary = simulator
        .build(&scene)
        .unwrap()
        .run(&mut results, &mut |_| {});
    assert_eq!(summary.outcome, "done", "{:?}", summary.stopped);
    let states = results.frames.iter().flat_map(|frame| &frame.states);
    states.map(|row| row.position_m).collect()
}

/// With nothing changed, the trajectory goes on as it would have: to round-off, which is some 1e-11 m at
/// this altitude and grows on the way through the step control.
#[test]
fn restructuring_what_has_not_changed_changes_nothing() {
    let mut worst = 0.0_f64;
    for formulation in ["LumpedMass", "Denoc"] {
        for integrator in [
            "Auto()",
            "Implicit()",
            "Adaptive()",
            "Fixed()",
            "Fixed(step_s: 0.05, method: Rosenbrock)",
        ] {
            let formulation = format!("run.formulation={formulation}");
            let integrator = format!("run.integrator={integrator}");
            let overrides = [formulation.as_str(), integrator.as_str()];
            let (without, with) = (flight(&overrides, 100.0), flight(&overrides, 2.0));
            assert_eq!(without.len(), with.len());
            let moved = without[0].distance(without[without.len() - 1]);
            let differences = without.iter().zip(&with).map(|(a, b)| a.distance(*b));
            let largest = differences.fold(0.0, f64::max);
            println!("{overrides:?}: {largest:.1e} m of {moved:.1} m");
            worst = worst.max(largest);
        }
    }
    assert!(worst < 2e-9, "{worst:.1e} m");
}
