//! The steering sail and what steers it: against trajectories of a separate program, closed forms, the other
//! formulation, and scenes that are turned.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test may fail loudly, its helpers too"
)]

#[path = "../flight/mod.rs"]
mod flight;

mod held_latitude;
mod own_law;
mod small_motions;

use std::f64::consts::PI;

use aerobot::engine::plugin::Simulator;
use aerobot::engine::recording::frame::MemorySink;
use aerobot::reproduce::sail::RUDDER_STEP;
use flight::{assert_below, assert_relative, channel, frame_at, load, position};

/// The step of the rudder: the frame moves with the air at 56 km.
const STEP: &str = include_str!("../../scenes/examples/rudder_step.ron");
/// The shear of `scenes/sail_hold_latitude.ron` without its gusts.
const CALM: &str = "environment.wind=[Shear(altitude_m: 56000, gradient_per_s: 0.0024)]";

/// From the steady state in the scene's wind.
fn fly_from_trim(text: &str, overrides: &[&str]) -> MemorySink {
    let simulator = Simulator::new();
    let scene = load(&simulator, text, overrides);
    let mut simulation = simulator.build(&scene).unwrap_or_else(|e| panic!("{e}"));
    simulation
        .settle_in_wind(&scene)
        .unwrap_or_else(|e| panic!("{e}"));
    let mut results = MemorySink::default();
    let summary = simulation.run(&mut results, &mut |_| {});
    assert_eq!(summary.outcome, "done", "{:?}", summary.stopped);
    results
}

/// Largest differences from the separate program, deg and m.
fn step_differences(results: &MemorySink) -> (f64, f64) {
    let (mut yaw, mut place) = (0.0_f64, 0.0_f64);
    for [time_s, yaw_deg, sail_m, balloon_m] in RUDDER_STEP {
        let heading = channel(frame_at(results, time_s), "sail", "heading_rad").to_degrees();
        let (sail, balloon) = (
            position(results, "sail", time_s),
            position(results, "balloon", time_s),
        );
        println!(
            "{time_s} s: {heading:.6} deg, {:.6} m, {:.6} m",
            sail.y, balloon.y
        );
        yaw = yaw.max((heading - yaw_deg).abs());
        place = place
            .max((sail.y - sail_m).abs())
            .max((balloon.y - balloon_m).abs());
    }
    (yaw, place)
}

#[test]
fn val_the_rudder_step_on_a_rigid_massless_link() {
    let results = fly_from_trim(STEP, &[]);
    let tension = flight::channel(frame_at(&results, 0.0), "line", "tension_to_n");
    assert_relative("tension", tension, 928.2457, 1e-7);
    // Both drags are equal: r^2 = rho_s S C_D0/(rho_b C_d pi R^2) is the square of the ratio of the airspeeds,
    // which add up to the shear over 2 km (the line leans by 7e-4 rad).
    let ratio = ((2000.0 / 8619.0_f64).exp() * 3.0 * 0.02 / (0.47 * PI * 3.56 * 3.56)).sqrt();
    let airspeed = channel(frame_at(&results, 0.0), "sail", "airspeed_m_s");
    assert_relative("airspeed", airspeed, 4.8 / (1.0 + ratio), 1e-6);
    let (yaw, place) = step_differences(&results);
    assert_below("yaw, deg", yaw, 1e-4);
    assert_below("y, m", place, 1e-4);
}

/// Ten nodes of 10 g together on a stiff line without drag stand for the link.
#[test]
fn val_the_rudder_step_on_a_lumped_line() {
    let results = fly_from_trim(
        STEP,
        &[
            "run.formulation=LumpedMass",
            "run.integrator=Auto(accuracy_m: 0.001)",
            "entities.line.Tether.nodes=10",
            "entities.line.Tether.density_kg_m3=6",
            "entities.line.Tether.damping_n_s_m=100",
        ],
    );
    let (yaw, place) = step_differences(&results);
    assert_below("yaw, part of 4.03 deg", yaw / 4.03, 0.02);
    assert_below("y, part of 14.3 m", place / 14.3, 0.02);
}

/// With the wing ahead and the right downwash the bow turns away from where it goes; with the wing aft, with the
/// paper's sign or with a larger rudder, a small start dies out.
#[test]
fn instability_and_stability_are_as_predicted() {
    let heading_after = |overrides: &[&str]| {
        let mut all = vec![
            "entities.helm.Schedule.commands=Steps([(0, 0)])",
            "entities.sail.Pose=(position_m: (0, 0, 54000), attitude: YawPitchRoll(yaw_rad: 0.001, pitch_rad: 0, \
             roll_rad: 0))",
            "run.duration_s=100",
            "entities.sail.Sail.lift_slope=ThinAerofoil",
        ];
        all.extend(overrides);
        let results = flight::fly(STEP, &all);
        let headings = results.channel("sail", "heading_rad");
        let after = headings.last().unwrap().1.abs();
        println!("{overrides:?}: {after:.2e} rad");
        after
    };
    let ahead = "entities.sail.Sail.wing.side=Ahead";
    assert!(heading_after(&[ahead]) > 0.1);
    assert!(heading_after(&[ahead, "entities.sail.Sail.rudder.area_m2=2.5"]) < 1e-3);
    assert!(heading_after(&[ahead, "entities.sail.Sail.downwash=AsPrinted"]) < 1e-3);
    assert!(heading_after(&[]) < 1e-3);
}

/// Trimmed with the rudder held over, the sail flies at the incidence of the closed form (but for the drag of the
/// wing, of which 1/2 m x C_D0 is 0.3 % of the lift), in a steady drift of all.
#[test]
fn the_trimmed_sail_flies_at_the_incidence_of_the_closed_form() {
    for (side, downwash, ratio) in [
        ("Aft", "Right", 1.05263),
        ("Ahead", "AsPrinted", 0.95238),
        ("Aft", "AsPrinted", 0.39216),
    ] {
        for formulation in ["Denoc", "LumpedMass"] {
            let set = [
                "entities.helm.Schedule.commands=Steps([(0, 0.001)])".to_owned(),
                "entities.sail.Sail.lift_slope=ThinAerofoil".to_owned(),
                format!("entities.sail.Sail.wing.side={side}"),
                format!("entities.sail.Sail.downwash={downwash}"),
                format!("run.formulation={formulation}"),
                "run.duration_s=0.01".to_owned(),
            ];
            let set: Vec<&str> = set.iter().map(String::as_str).collect();
            let results = fly_from_trim(STEP, &set);
            let incidence = channel(frame_at(&results, 0.0), "sail", "alpha_wing_rad");
            println!("{side} {downwash} {formulation}: {}", incidence / 0.001);
            assert!((incidence / 0.001 / ratio - 1.0).abs() < 5e-3);
        }
    }
}

/// With everything turned about the vertical, the flight is turned and nothing else.
#[test]
fn a_turned_scene_flies_a_turned_flight() {
    let overrides = [
        "entities.sail.Sail.attitude=Free",
        "entities.sail.Sail.airspeed=Full",
        "entities.sail.Sail.stall=FlatPlate(angle_rad: 0.26)",
        "entities.sail.Pose=(position_m: (0, 0, 54000))",
        "entities.helm.Schedule.commands=Ramps([(1, 0), (5, 0.2)])",
        "run.duration_s=30",
        "run.integrator=Fixed(step_s: 0.05)",
    ];
    let plain = flight::fly(STEP, &overrides);
    let angle = 2.1_f64;
    let (sine, cosine) = (angle.sin(), angle.cos());
    let wind = format!("environment.wind.0.direction=({cosine:?}, {sine:?}, 0)");
    let pose = format!(
        "entities.sail.Pose.attitude=YawPitchRoll(yaw_rad: {angle:?}, pitch_rad: 0, roll_rad: 0)"
    );
    let mut turned = overrides.to_vec();
    turned.extend([wind.as_str(), pose.as_str()]);
    let turned = flight::fly(STEP, &turned);
    let turn = glam::DQuat::from_rotation_z(angle);
    let mut worst = 0.0_f64;
    for name in ["balloon", "sail"] {
        for ((_, a), (_, b)) in plain.positions(name).iter().zip(&turned.positions(name)) {
            worst = worst.max((turn * *a - *b).length());
        }
    }
    let loads = |results: &MemorySink| results.channel("sail", "yaw_moment_n_m");
    for (a, b) in loads(&plain).iter().zip(&loads(&turned)) {
        worst = worst.max((a.1 - b.1).abs());
    }
    assert_below("turned, m and N m", worst, 1e-9);
}

#[test]
fn the_report_warns_of_a_sail_that_turns_away() {
    let simulator = Simulator::new();
    let contents = |side: &str| {
        let side = format!("entities.sail.Sail.wing.side={side}");
        let scene = load(&simulator, STEP, &[&side]);
        simulator.build(&scene).unwrap().contents(&scene).join("\n")
    };
    assert!(contents("Aft").contains("statically stable"));
    let ahead = contents("Ahead");
    assert!(
        ahead.contains("warning") && ahead.contains("UNSTABLE"),
        "{ahead}"
    );
    // 0.5 m x 3 m2 x (a + C_D0) over 4 m x (a (1 - 2 a/(5 pi)) + 0), a = 2 pi/1.4.
    let a = 2.0 * PI / 1.4;
    let least = 1.5 * (a + 0.02) / (4.0 * a * (1.0 - 2.0 * a / (5.0 * PI)));
    assert!(ahead.contains(&format!("{least:.3}")), "{ahead}");
}
