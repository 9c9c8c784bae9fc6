//! Rotorcraft: against closed forms and the other formulation.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test stops at what it does not expect"
)]

mod flight;

use flight::small_rotorcraft::{DENSITY, DRAG_AREA_M2, G, POSE, drone, tail};
use flight::{assert_below, assert_relative, channel, fly, frame_at, position, velocity};
use glam::DVec3;

/// A drone alone in still air of one density.
fn alone(course: &str, more: &str, run: &str) -> String {
    let drone = drone(course, more);
    format!(
        r#"(
    name: "drone",
    environment: (gravity: Constant({G}), atmosphere: Uniform(density_kg_m3: {DENSITY})),
    entities: {{"drone": ({drone})}},
    run: ({run}),
)"#
    )
}

/// In hover the thrust is the weight, the power that of momentum theory, T^(3/2) / (FM sqrt(2 rho A)): 470 W. The
/// drone starts trimmed and stays.
#[test]
fn hover_takes_the_weight_and_470_w() {
    let run = "duration_s: 5, output_every_s: 1";
    let results = fly(&alone("", POSE, run), &[]);
    let weight_n = 6.0 * G;
    let area_m2 = std::f64::consts::PI * 0.25;
    let power_w = weight_n.powf(1.5) / (0.65 * (2.0 * DENSITY * area_m2).sqrt());
    assert_relative("thrust", tail(&results, "thrust_n"), weight_n, 1e-9);
    assert_relative("power", tail(&results, "power_w"), power_w, 1e-9);
    assert_below("power from 470 W", (power_w - 470.0).abs(), 1.0);
    let moved = position(&results, "drone", 5.0) - position(&results, "drone", 0.0);
    assert_below("moved", moved.length(), 1e-9);
}

/// At a steady 4.5 m/s the thrust balances weight and drag: tilt = atan(1/2 rho C_d S V^2 / (m g)), between one
/// and two degrees, thrust = hypot of the two.
#[test]
fn steady_flight_tilts_against_its_drag() {
    let course = "course: Along(position_m: (0, 0, 54_000), velocity_m_s: (4.5, 0, 0))";
    let start = format!("{POSE} Motion: (velocity_m_s: (4.5, 0, 0)),");
    let run = "duration_s: 20, output_every_s: 5";
    let results = fly(&alone(course, &start, run), &[]);
    let drag_n = 0.5 * DENSITY * DRAG_AREA_M2 * 4.5 * 4.5;
    let tilt_rad = (drag_n / (6.0 * G)).atan();
    assert_relative("tilt", tail(&results, "tilt_rad"), tilt_rad, 1e-6);
    assert!((1.0..2.0).contains(&tilt_rad.to_degrees()), "{tilt_rad}");
    let thrust_n = drag_n.hypot(6.0 * G);
    assert_relative("thrust", tail(&results, "thrust_n"), thrust_n, 1e-9);
    let place = position(&results, "drone", 20.0) - DVec3::new(90.0, 0.0, 54_000.0);
    assert_below("off course", place.length(), 1e-6);
}

/// A command of a small tilt about y from a level start, held for ever: the attitude follows as
/// 1 - (1 + w t) e^(-w t), w = 2 / lag. A tilt limit of 0.05 rad with the place far away is such a command.
#[test]
fn the_attitude_answers_as_a_critically_damped_oscillator() {
    let course = "course: Along(position_m: (1000, 0, 54_000)), largest_tilt_rad: 0.05, period_s: 10, \
                  largest_torque_n_m: 100";
    let run =
        "duration_s: 0.5, output_every_s: 0.05, integrator: Adaptive(relative_tolerance: 1e-10)";
    let results = fly(&alone(course, POSE, run), &[]);
    let frequency = 2.0 / 0.15;
    for frame in &results.frames {
        let wt = frequency * frame.time_s;
        let expected = 0.05 * (1.0 - (1.0 + wt) * (-wt).exp());
        let found = channel(frame, "drone", "tilt_rad");
        assert_below("tilt", (found - expected).abs(), 1e-8);
    }
}

/// A command of more thrust than the motors give ends at what momentum theory leaves them, and the body climbs no
/// faster than that: m dv/dt = T - m g at the first instant.
#[test]
fn thrust_ends_where_the_motors_do() {
    let course = "course: Along(position_m: (0, 0, 55_000)), largest_speed_m_s: 50, thrust_lag_s: 1e-3, period_s: 10";
    let run = "duration_s: 0.05, output_every_s: 0.01";
    let results = fly(&alone(course, POSE, run), &[]);
    let discs = 2.0 * DENSITY * std::f64::consts::PI * 0.25;
    let largest_n = (0.65_f64 * 1200.0).powf(2.0 / 3.0) * discs.powf(1.0 / 3.0);
    assert_relative("thrust", tail(&results, "thrust_n"), largest_n, 1e-5);
    let gained = velocity(&results, "drone", 0.05).z - velocity(&results, "drone", 0.02).z;
    assert_relative("climb", gained / 0.03, largest_n / 6.0 - G, 5e-3);
}

/// It goes to a place 40 m off and stays, with no more speed than it may have, and overshoots little.
#[test]
fn it_goes_where_it_is_sent() {
    let course = "course: Along(position_m: (30, -20, 54_010), heading_rad: 1)";
    let run = "duration_s: 40, output_every_s: 0.5";
    let results = fly(&alone(course, POSE, run), &[]);
    let aim = DVec3::new(30.0, -20.0, 54_010.0);
    let way = (aim - DVec3::Z * 54_000.0).normalize();
    let (mut fastest, mut beyond) = (0.0_f64, 0.0_f64);
    for frame in &results.frames {
        fastest = fastest.max(velocity(&results, "drone", frame.time_s).length());
        beyond = beyond.max((position(&results, "drone", frame.time_s) - aim).dot(way));
    }
    assert_below("fastest", fastest, 3.0 * 1.05);
    assert_below("overshoot", beyond, 0.1);
    let end = (position(&results, "drone", 40.0) - aim).length();
    assert_below("at the end", end, 0.01);
    assert_relative("heading", tail(&results, "heading_rad"), 1.0, 1e-6);
}

/// What it hangs on or not, whatever moves the rest: beside a tethered system the drone flies the same way in both
/// formulations.
#[test]
fn the_drone_flies_the_same_in_both_formulations() {
    let drone = drone(
        "course: Along(position_m: (5, 2, 54_001), velocity_m_s: (1, 0, 0))",
        POSE,
    );
    let text = format!(
        r#"(
    name: "beside",
    environment: (gravity: Constant({G}), atmosphere: Uniform(density_kg_m3: {DENSITY})),
    entities: {{
        "anchor": (Fixed: (position_m: (0, 10, 54_050))),
        "gondola": (Body: (mass_kg: 100, inertia: Box(1, 1, 1))),
        "tether": (Tether: (
            from: ("anchor", Centre), to: ("gondola", Top), length_m: 40, nodes: 3,
            diameter_m: 0.002, density_kg_m3: 1440, axial_stiffness_n: 2e5, damping_n_s_m: 10,
        )),
        "drone": ({drone}),
    }},
    run: (duration_s: 5, output_every_s: 1, integrator: Adaptive(relative_tolerance: 1e-9)),
)"#
    );
    let lumped = fly(&text, &[]);
    let links = fly(&text, &["run.formulation=Denoc"]);
    for time_s in [1.0, 3.0, 5.0] {
        let apart = position(&lumped, "drone", time_s) - position(&links, "drone", time_s);
        assert_below("apart", apart.length(), 1e-6);
    }
    assert!(frame_at(&lumped, 5.0).states.len() > 3);
}
