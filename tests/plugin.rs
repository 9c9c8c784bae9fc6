//! What a user's crate can do: the tutorial's plugin, and a force of its own, through the public door.

#![allow(
    clippy::expect_used,
    clippy::panic,
    reason = "a test may fail loudly, its helpers too"
)]

#[path = "../examples/atmosphere_sensor/plugin.rs"]
mod sensor;

mod flight;

use std::path::{Path, PathBuf};

use aerobot::components::scene_component::{FieldReport, SceneComponent};
use aerobot::components::state::Force;
use aerobot::engine::plugin::{Plugin, Simulator};
use aerobot::engine::recording::frame::MemorySink;
use aerobot::engine::schedule::Phase;
use aerobot::systems::environment::atmosphere::Atmosphere;
use bevy_ecs::component::Component;
use bevy_ecs::system::Query;
use flight::run;
use glam::DVec3;
use sensor::{AtmosphereSensorPlugin, PRESSURE, TEMPERATURE};
use serde::Deserialize;

/// What the sensor of the scene reads above the true pressure, Pa.
const BIAS_PA: f64 = 25.0;
/// Its period, s: a binary fraction, so that multiples of it are exact.
const PERIOD_S: f64 = 0.5;

fn scene_file() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/examples/atmosphere_sensor.ron")
}

fn simulator() -> Simulator {
    let mut simulator = Simulator::new();
    simulator.add_plugin(&AtmosphereSensorPlugin);
    simulator
}

/// The shipped scene with overrides, run.
fn descent(overrides: &[&str]) -> MemorySink {
    let simulator = simulator();
    let overrides: Vec<String> = overrides.iter().map(|o| (*o).to_owned()).collect();
    let scene = simulator
        .load(&scene_file(), &overrides)
        .unwrap_or_else(|e| panic!("{e}"));
    run(&simulator, &scene)
}

#[test]
fn samples_stand_at_multiples_of_the_period_although_outputs_are_elsewhere() {
    let sink = descent(&["run.duration_s=20", "run.output_every_s=0.7"]);
    for channel in [PRESSURE, TEMPERATURE] {
        let times: Vec<f64> = sink.channel("probe", channel).iter().map(|s| s.0).collect();
        let expected: Vec<f64> = (0..=40).map(|k| f64::from(k) * PERIOD_S).collect();
        assert_eq!(times, expected, "{channel}");
    }
    // Rows of the state stand at the output times and at the end, and nowhere else.
    let times: Vec<f64> = sink.states("probe").map(|row| row.0).collect();
    let mut expected: Vec<f64> = (0..=28).map(|k| f64::from(k) * 0.7).collect();
    expected.push(20.0);
    assert_eq!(times, expected);
}

/// With outputs at the sensor's times every sample has its position beside it. The sensor must show the
/// atmosphere there to the bit, and the atmosphere an ideal gas of 43.45 g/mol: p = rho R T / M, which
/// the published rows are to 0.4 % and their interpolation to little more.
#[test]
fn samples_show_the_air_where_the_probe_is() {
    let sink = descent(&["run.output_every_s=0.5"]);
    let (pressures, temperatures) = (
        sink.channel("probe", PRESSURE),
        sink.channel("probe", TEMPERATURE),
    );
    let positions = sink.positions("probe");
    assert_eq!((pressures.len(), positions.len()), (2023, 2023));
    let air = Atmosphere::vira();
    let gas_constant = 8.314_462_618 / 43.45e-3;
    let mut largest = 0.0_f64;
    for ((pressure, temperature), (time, position)) in
        pressures.iter().zip(&temperatures).zip(&positions)
    {
        assert_eq!(pressure.0, *time);
        let altitude = position.z;
        let known = air.pressure_pa(altitude).unwrap().unwrap();
        assert_eq!(pressure.1, known + BIAS_PA, "at {altitude} m");
        assert_eq!(Ok(Some(temperature.1)), air.temperature_k(altitude));
        let ideal = air.density_kg_m3(altitude).unwrap() * gas_constant * temperature.1;
        largest = largest.max(((pressure.1 - BIAS_PA) / ideal - 1.0).abs());
    }
    println!("largest departure from the ideal gas: {largest:.3e}");
    assert!(largest < 5e-3, "{largest}");
    let last = positions.last().map_or(0.0, |(_, position)| position.z);
    assert!((last - 50_000.0).abs() < 10.0, "the descent ends at {last}");
}

/// The row of the published table at 56 km; ln p is interpolated, so round-off of exp and ln remains.
#[test]
fn a_sample_at_a_row_of_the_table_is_that_row() {
    let sink = descent(&[
        "entities.probe.Pose.position_m=(0, 0, 56_000)",
        "run.duration_s=1",
    ]);
    let first = |channel| sink.channel("probe", channel)[0];
    let (time, pressure) = first(PRESSURE);
    assert_eq!(time, 0.0);
    assert!(
        (pressure - (45_590.0 + BIAS_PA)).abs() < 1e-9,
        "{pressure} Pa"
    );
    assert_eq!(first(TEMPERATURE).1, 291.8);
}

/// An instrument looks and does not touch. Its samples bound the steps, so the two trajectories differ
/// by the errors of integration and no more. Each step errs by less than the tolerance times the
/// displacement (1e-13 of 1.3 km), and drag makes the fall forget it within seconds.
#[test]
fn the_sensor_leaves_the_trajectory_alone() {
    let accurate = [
        "run.duration_s=100",
        "run.output_every_s=7",
        "run.integrator=Adaptive(relative_tolerance: 1e-13)",
    ];
    let with_sensor = descent(&accurate);
    let plain = Simulator::new();
    let text = std::fs::read_to_string(scene_file()).expect("the scene can be read");
    let without: String = text
        .lines()
        .filter(|line| !line.trim_start().starts_with("AtmosphereSensor:"))
        .map(|line| format!("{line}\n"))
        .collect();
    let overrides = accurate.map(str::to_owned);
    let scene = plain
        .load_text("without.ron", without, Path::new("."), &overrides)
        .unwrap_or_else(|e| panic!("{e}"));
    let without_sensor = run(&plain, &scene);
    assert!(!with_sensor.channel("probe", PRESSURE).is_empty());
    assert!(without_sensor.channel("probe", PRESSURE).is_empty());
    let (a, b) = (
        with_sensor.positions("probe"),
        without_sensor.positions("probe"),
    );
    assert_eq!(a.len(), b.len());
    let mut largest = 0.0_f64;
    for ((time_a, position_a), (time_b, position_b)) in a.iter().zip(&b) {
        assert_eq!(time_a, time_b);
        largest = largest.max((*position_a - *position_b).length());
    }
    println!("largest difference with and without the sensor: {largest:.3e} m");
    assert!(largest < 1e-9, "{largest} m");
}

/// The message for the scene with `right` misspelt as `wrong`.
fn message_for_misspelt(right: &str, wrong: &str) -> (String, usize, usize) {
    let text = std::fs::read_to_string(scene_file()).expect("the scene can be read");
    let misspelt = text.replace(&format!("{right}:"), &format!("{wrong}:"));
    let at = misspelt
        .find(&format!("{wrong}:"))
        .expect("the field is there");
    let line = 1 + misspelt[..at].matches('\n').count();
    let column = 1 + misspelt[..at]
        .chars()
        .rev()
        .take_while(|c| *c != '\n')
        .count();
    match simulator().load_text("probe.ron", misspelt, Path::new("."), &[]) {
        Ok(_) => panic!("`{wrong}` was accepted"),
        Err(error) => (error.text, line, column),
    }
}

#[test]
fn a_misspelt_field_of_a_plugin_is_refused_like_a_built_in_one() {
    for (component, right, wrong) in [
        ("AtmosphereSensor", "pressure_bias_pa", "presure_bias_pa"),
        ("Body", "mass_kg", "mas_kg"),
    ] {
        let (text, line, column) = message_for_misspelt(right, wrong);
        for expected in [
            format!("error: unexpected field `{wrong}` in `{component}`"),
            format!("--> probe.ron:{line}:{column}  (at entities.probe.{component}.{wrong})"),
            format!("help: did you mean `{right}`?"),
        ] {
            assert!(text.contains(&expected), "no `{expected}` in:\n{text}");
        }
    }
}

#[test]
fn what_the_plugin_checks_is_refused_at_its_place() {
    for (change, message) in [
        (
            "entities.probe.AtmosphereSensor.period_s=0",
            "`period_s` must be above zero, it is 0",
        ),
        (
            "environment.atmosphere=Uniform(density_kg_m3: 1)",
            "`AtmosphereSensor` needs an atmosphere with pressure and temperature",
        ),
    ] {
        let Err(error) = simulator().load(&scene_file(), &[change.to_owned()]) else {
            panic!("`{change}` was accepted");
        };
        assert!(error.text.contains(message), "{}", error.text);
        assert!(
            error.text.contains("entities.probe.AtmosphereSensor"),
            "{}",
            error.text
        );
    }
}

/// A thrust that a user adds.
#[derive(Component, Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Thrust {
    /// Inertial frame, N.
    force_n: DVec3,
}

impl SceneComponent for Thrust {
    const NAME: &'static str = "Thrust";
    const REQUIRES: &'static [&'static [&'static str]] = &[&["Body"]];

    fn check(&self, report: &mut FieldReport) {
        report.finite_vector("force_n", self.force_n);
    }
}

struct ThrustPlugin;

impl Plugin for ThrustPlugin {
    fn build(&self, simulator: &mut Simulator) {
        simulator
            .register_component::<Thrust>()
            .add_systems_for::<Thrust, _, _>(Phase::Forces, || thrust);
    }
}

fn thrust(mut bodies: Query<(&Thrust, &mut Force)>) {
    for (thrust, mut force) in &mut bodies {
        force.0 += thrust.force_n;
    }
}

/// x = x0 + v0 t + (F/m + g) t^2 / 2: a polynomial of degree 2, which the method integrates exactly;
/// what remains is round-off of the 1e3 m that are summed over some hundred steps.
#[test]
fn a_force_from_outside_accelerates_by_f_over_m() {
    const SCENE: &str = r#"(
        name: "thrust",
        environment: (gravity: Constant(8.87), atmosphere: Vacuum),
        entities: {
            "probe": (
                Body: (mass_kg: 4),
                Pose: (position_m: (1, 2, 3)),
                Motion: (velocity_m_s: (-3, 0.5, 7)),
                Thrust: (force_n: (6, -2, 40)),
            ),
        },
        run: (duration_s: 30, output_every_s: 0.3),
    )"#;
    let mut simulator = Simulator::new();
    simulator.add_plugin(&ThrustPlugin);
    let scene = simulator
        .load_text("thrust.ron", SCENE.to_owned(), Path::new("."), &[])
        .unwrap_or_else(|e| panic!("{e}"));
    let sink = run(&simulator, &scene);
    let acceleration = DVec3::new(6.0 / 4.0, -2.0 / 4.0, 40.0 / 4.0 - 8.87);
    let (start, velocity) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(-3.0, 0.5, 7.0));
    let mut largest = 0.0_f64;
    for (t, row) in sink.states("probe") {
        let position = start + velocity * t + 0.5 * acceleration * t * t;
        largest = largest.max((row.position_m - position).length());
        largest = largest.max((row.velocity_m_s - velocity - acceleration * t).length());
    }
    println!("largest departure from the closed form: {largest:.3e}");
    assert_eq!(sink.states("probe").count(), 101);
    assert!(largest < 1e-11, "{largest}");
}

/// A plugin's scene under the implicit integrator: to 1 um over 60 s where the explicit one has it.
#[test]
fn implicit_and_explicit_agree_on_the_scene_of_a_plugin() {
    let run = |integrator| descent(&["run.duration_s=60", "run.output_every_s=20", integrator]);
    let expected = run("run.integrator=Adaptive(relative_tolerance: 1e-12)");
    let found = run("run.integrator=Implicit(accuracy_m: 1e-8)");
    let error = flight::largest_distance_m(&found, &expected);
    flight::assert_below("the descent", error, 1e-6);
}
