//! Modes of the sail, and margins of the loops that steer it.

use std::f64::consts::PI;

use aerobot::engine::plugin::Simulator;

use crate::flight::{self, load};
use crate::{CALM, STEP, fly_from_trim};

fn modes_of(text: &str, overrides: &[&str]) -> aerobot::engine::modes::Modes {
    let simulator = Simulator::new();
    let scene = load(&simulator, text, overrides);
    let mut simulation = simulator.build(&scene).unwrap_or_else(|e| panic!("{e}"));
    let request = aerobot::engine::modes::ModesRequest::default();
    simulation
        .modes(&scene, &request)
        .unwrap_or_else(|e| panic!("{e}"))
}

/// The modes that a separate program has found without control: 106 s, 73 s (damping 0.05) and 5.2 s (0.53).
#[test]
fn val_modes_without_control() {
    let found = modes_of(STEP, &["entities.helm.Schedule.commands=Steps([(0, 0)])"]);
    for mode in &found.modes {
        println!(
            "{:?} s, {:.3}: {}",
            mode.period_s(),
            mode.damping_ratio(),
            mode.name
        );
    }
    // The time constant of what does not oscillate; 2 pi/|lambda| of what does.
    for (time_s, damping) in [(106.0, 1.0), (73.0, 0.05), (5.2, 0.53)] {
        let is_found = found.modes.iter().any(|mode| {
            let own_s = if mode.oscillates() {
                2.0 * PI / mode.rate_per_s()
            } else {
                mode.time_constant_s()
            };
            (own_s / time_s - 1.0).abs() < 0.01 && (mode.damping_ratio() - damping).abs() < 0.005
        });
        assert!(is_found, "{time_s} s");
    }
}

/// The rudder that the static report asks for is the one at which a mode of the whole scene ceases to grow.
#[test]
fn a_mode_grows_below_the_least_rudder_and_none_above() {
    let a = 2.0 * PI;
    // As in the report: the wing's lift and drag ahead, the rudder's lift in the downwash aft.
    let least = 1.5 * (a + 0.02) / (4.0 * a * (1.0 - 2.0 * a / (5.0 * PI)));
    for (part, grows) in [(0.7, true), (0.95, true), (1.02, false), (1.2, false)] {
        let area = format!("entities.sail.Sail.rudder.area_m2={:?}", part * least);
        let found = modes_of(
            STEP,
            &[
                "entities.helm.Schedule.commands=Steps([(0, 0)])",
                "entities.sail.Sail.lift_slope=ThinAerofoil",
                "entities.sail.Sail.wing.side=Ahead",
                "entities.sail.Sail.attitude=Free",
                "entities.line.Tether.to=(\"sail\", (0, 0, 1))",
                &area,
            ],
        );
        let growth = found
            .modes
            .iter()
            .map(|mode| mode.growth_per_s)
            .fold(f64::MIN, f64::max);
        println!("{part}: {growth:.2e} 1/s");
        assert_eq!(growth > 0.0, grows, "{part}");
    }
}

fn helm_with(gain_factor: f64) -> String {
    let scene = std::fs::read_to_string(flight::scene_file("sail_hold_latitude.ron")).unwrap();
    let gain = |gain: f64| format!("gain: {:?}", gain * gain_factor);
    scene
        .replace("gain: -0.005236", &gain(-0.005236))
        .replace("gain: -0.17453", &gain(-0.17453))
        .replace("gain: -0.0069813", &gain(-0.006_981_3))
        .replace("target: 10,", "target: 0.01,")
}

/// With its gains times the gain margin the loop neither grows nor dies: a little below small motions die out in a
/// flight, a little above they grow. Both formulations tell the same loop.
#[test]
fn the_gain_margin_is_where_flights_begin_to_oscillate() {
    let calm = [
        CALM,
        "run.formulation=Denoc",
        "entities.tether.Tether.nodes=2",
    ];
    let found = modes_of(&helm_with(1.0), &calm);
    let closed = &found.closed_loops[0];
    let (factor, frequency) = closed.margins.gain_up.unwrap();
    println!(
        "factor {factor:.4} at {frequency:.4} rad/s, phase {:?}, {:?}",
        closed.margins.phase_rad,
        &closed.modes[..4]
    );
    assert!(closed.is_stable() && closed.actuator == "sail.rudder");
    let lumped = modes_of(&helm_with(1.0), &[CALM, "entities.tether.Tether.nodes=2"]);
    let other = lumped.closed_loops[0].margins.gain_up.unwrap();
    assert!(
        (other.0 / factor - 1.0).abs() < 0.01,
        "{} {factor}",
        other.0
    );
    let swing = |factor: f64| {
        let mut set = calm.to_vec();
        set.extend(["run.duration_s=200", "run.output_every_s=0.25"]);
        let results = fly_from_trim(&helm_with(factor), &set);
        let rudder = results.channel("sail", "rudder_rad");
        let largest = |from_s: f64, to_s: f64| {
            let within = rudder.iter().filter(|(t, _)| (from_s..to_s).contains(t));
            within.map(|(_, value)| value.abs()).fold(0.0, f64::max)
        };
        largest(150.0, 200.0) / largest(50.0, 100.0)
    };
    let (below, above) = (swing(0.93 * factor), swing(1.07 * factor));
    println!("below {below:.3}, above {above:.3}");
    assert!(below < 1.0 && above > 1.0);
}

/// The paper's law is stable; a law on the balloon's y and its rate alone is not: it drives the pendulum.
#[test]
fn feedback_of_the_balloon_alone_drives_the_pendulum() {
    let lag = STEP.replace("(limit: 0.27)", "(limit: 0.27, lag_s: 0.5)");
    let start = lag.find("Schedule: (").unwrap();
    let end = lag.find("    },\n    run:").unwrap();
    let with = |law: &str| {
        format!(
            "{}Controller: (actuator: (\"sail\", \"rudder\"), period_s: 0.5, law: {law}),\n        ),\n{}",
            &lag[..start],
            &lag[end..]
        )
    };
    for (law, is_stable) in [
        (
            "Proportional(measured: Y(\"balloon\"), target: 0, gain: -0.001745)",
            true,
        ),
        (
            "Proportional(measured: Y(\"sail\"), target: 0, gain: -0.001745)",
            true,
        ),
        (
            "Pid(measured: Y(\"balloon\"), target: 0, proportional: -0.005236, derivative_s: -0.17453, filter_s: 0.5)",
            false,
        ),
    ] {
        let found = modes_of(&with(law), &[]);
        let closed = &found.closed_loops[0];
        println!("{law}: {:?}", &closed.modes[..4]);
        assert_eq!(closed.is_stable(), is_stable, "{law}");
    }
}
