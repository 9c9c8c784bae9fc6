//! Stochastic gusts in a flight: the wind is a function of time, seed and altitude, whoever flies through it.
//! (That it has the statistics it is to have is tested where it is drawn, `-p aerobot-systems gust`.)

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod flight;
mod program;

use std::fs;
use std::path::Path;

use aerobot::engine::builtin::environment::environment_model;
use aerobot::engine::plugin::Simulator;
use aerobot::engine::recording::frame::MemorySink;
use aerobot::systems::environment::EnvironmentModel;
use aerobot::systems::environment::wind::Wind;
use flight::{load, owned, run, scene_file};
use glam::DVec3;
use program::{Scratch, aerobot, text};

const SCENE: &str = "examples/gusty_tether.ron";

/// A sphere that is held in the wind, and in the same wind a body that flies.
const HELD: &str = r#"(
    name: "held",
    environment: (
        atmosphere: Uniform(density_kg_m3: 1),
        wind: [
            Uniform(velocity_m_s: (3, 0, 0)),
            Gust(
                zonal: (decay_per_s: 0.05, frequency_rad_s: 0.2, marginal: Normal(standard_deviation_m_s: 1)),
                vertical: (decay_per_s: 0.3, marginal: Weibull(scale_m_s: 0.8, shape: 1.9)),
            ),
        ],
    ),
    entities: {
        "mast": (Fixed: (position_m: (0, 0, 100))),
        "ball": (
            Body: (mass_kg: 5, inertia: Box(1, 1, 1)),
            Drag: Constant(coefficient: 1, area_m2: 0.3),
        ),
        "line": (Tether: (
            from: ("mast", Centre), to: ("ball", Top), length_m: 20, nodes: 3, diameter_m: 0.002,
            density_kg_m3: 1440, axial_stiffness_n: 2e4, damping_n_s_m: 5,
        )),
    },
    run: (duration_s: 20, output_every_s: 0.5, seed: 4),
)"#;

/// The wind of a scene, drawn without any flight.
fn wind_of(text: &str, overrides: &[&str]) -> Wind {
    let scene = load(&Simulator::new(), text, overrides);
    environment_model(&scene)
        .unwrap_or_else(|error| panic!("{error:?}"))
        .wind
}

fn velocity(wind: &mut Wind, time_s: f64, altitude_m: f64) -> DVec3 {
    wind.begin_interval(time_s);
    wind.advance_gusts(time_s);
    wind.velocity_m_s(altitude_m).unwrap()
}

/// At every output of a flight, whatever its integrator, step and formulation, the air has the velocity that
/// the scene's wind has at that time, to the last bit.
#[test]
fn the_wind_of_a_flight_is_that_of_its_time_and_seed() {
    let simulator = Simulator::new();
    let mut expected = wind_of(HELD, &[]);
    for integrator in [
        "Auto()",
        "Implicit(accuracy_m: 0.1)",
        "Adaptive(relative_tolerance: 1e-6)",
        "Fixed(step_s: 0.0009)",
        "Fixed(step_s: 0.0004)",
        "Fixed(step_s: 0.11, method: Rosenbrock)",
    ] {
        for formulation in ["LumpedMass", "Denoc"] {
            let overrides = [
                format!("run.integrator={integrator}"),
                format!("run.formulation={formulation}"),
            ];
            let overrides: Vec<&str> = overrides.iter().map(String::as_str).collect();
            let scene = load(&simulator, HELD, &overrides);
            for until_s in [0.5, 7.0, 20.0] {
                let mut scene = scene.clone();
                scene.run.duration_s = until_s;
                let mut simulation = simulator
                    .build(&scene)
                    .unwrap_or_else(|error| panic!("{error}"));
                let summary = simulation.run(&mut MemorySink::default(), &mut |_| {});
                assert_eq!(summary.outcome, "done");
                let air = &simulation.world().resource::<EnvironmentModel>().wind;
                let found = air.velocity_m_s(90.0).unwrap();
                let expected = velocity(&mut expected, until_s, 90.0);
                assert_eq!(found, expected, "{integrator}, {formulation}, {until_s} s");
            }
        }
    }
}

/// Another source, another axis or another seed elsewhere leave a gust as it is.
#[test]
fn a_gust_does_not_depend_on_others() {
    let along_x = "zonal: (decay_per_s: 0.05, marginal: Normal(standard_deviation_m_s: 1))";
    let along_y = "meridional: (decay_per_s: 3, marginal: Weibull(scale_m_s: 1, shape: 2))";
    let with = |wind: String| wind_of(HELD, &[&format!("environment.wind=[{wind}]")]);
    let mut alone = with(format!("Gust({along_x})"));
    let mut with_axis = with(format!("Gust({along_x}, {along_y})"));
    let mut with_source = with(format!("Gust({along_x}), Gust({along_y}), VenusZonal"));
    let mut later = with(format!(
        "Gust({along_y}, stream: 7), Gust({along_x}, stream: 0)"
    ));
    for time_s in [0.0, 0.3, 17.2, 400.0] {
        let x = velocity(&mut alone, time_s, 0.0).x;
        assert_eq!(velocity(&mut with_axis, time_s, 0.0).x, x);
        assert_eq!(velocity(&mut with_source, time_s, 0.0).x, x);
        assert_eq!(velocity(&mut later, time_s, 0.0).x, x);
    }
    let mut other_seed = wind_of(HELD, &["run.seed=5"]);
    let mut seed = wind_of(HELD, &[]);
    assert_ne!(
        velocity(&mut other_seed, 1.0, 0.0),
        velocity(&mut seed, 1.0, 0.0)
    );
}

/// Implicit steps from knot to knot fly as explicit ones hundreds of times as short do, to the accuracy of a
/// centimetre that was asked for.
#[test]
fn integrators_agree_in_gusts() {
    let simulator = Simulator::new();
    let end = |seed: u64, integrator: &str| {
        let overrides = owned(&[
            &format!("run.integrator={integrator}"),
            &format!("run.seed={seed}"),
        ]);
        let scene = simulator.load(&scene_file(SCENE), &overrides);
        let results = run(&simulator, &scene.unwrap_or_else(|error| panic!("{error}")));
        results.positions("gondola").last().copied().unwrap()
    };
    for seed in [1, 2] {
        let reference = end(seed, "Adaptive(relative_tolerance: 1e-6)");
        let found = end(seed, "Auto(accuracy_m: 0.01)");
        let distance_m = (found.1 - reference.1).length();
        println!("seed {seed}: {distance_m:.4} m");
        assert!(distance_m < 0.01, "seed {seed}: {distance_m} m");
    }
}

/// A run, and the scene that it wrote with its samples, give the same bytes.
#[test]
fn a_run_in_gusts_repeats_itself() {
    let scratch = Scratch::folder();
    let sample: String = (0..50)
        .map(|k| format!("{}\n", f64::from(k * k % 31) / 10.0))
        .collect();
    scratch.file("speeds.csv", &format!("speed_m_s\n{sample}"));
    let empirical = HELD.replace(
        "marginal: Weibull(scale_m_s: 0.8, shape: 1.9)",
        "marginal: Empirical(file: \"speeds.csv\"), mean_m_s: 0, autocorrelation: Target",
    );
    assert_ne!(empirical, HELD);
    let scene = scratch.file("scene.ron", &empirical);
    let (first, second) = (scratch.path("first"), scratch.path("second"));
    let again = format!("{first}/scene.ron");
    for (scene, out) in [(&scene, &first), (&again, &second)] {
        let output = aerobot(&["run", scene, "--out", out, "--quiet"]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    }
    for file in [
        "scene.ron",
        "states.csv",
        "channels.csv",
        "summary.json",
        "speeds.csv",
    ] {
        let read = |folder: &str| fs::read(Path::new(folder).join(file)).unwrap();
        assert!(read(&first) == read(&second), "`{file}` differs");
    }
}
