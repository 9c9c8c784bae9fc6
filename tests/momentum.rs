//! Momentum of the whole system and the impulse of the outer forces on it: closed forms, and their balance through
//! cuts, winches and latches.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test stops at what it does not expect"
)]

mod flight;

use aerobot::engine::recording::frame::{Frame, MemorySink};
use flight::dumbbell::dumbbell;
use flight::{assert_below, channel, fly, fly_scene, frame_at, summary_of};
use glam::DVec3;

const G: f64 = 8.87;
const RECORD: &str = r#"record: (channels: Only({"system": [
    "momentum_x_kg_m_s", "momentum_y_kg_m_s", "momentum_z_kg_m_s", "impulse_x_n_s", "impulse_y_n_s", "impulse_z_n_s",
]}))"#;

fn vector(frame: &Frame, names: [&str; 3]) -> DVec3 {
    DVec3::from(names.map(|name| channel(frame, "system", name)))
}

fn momentum(frame: &Frame) -> DVec3 {
    vector(
        frame,
        [
            "momentum_x_kg_m_s",
            "momentum_y_kg_m_s",
            "momentum_z_kg_m_s",
        ],
    )
}

fn impulse(frame: &Frame) -> DVec3 {
    vector(frame, ["impulse_x_n_s", "impulse_y_n_s", "impulse_z_n_s"])
}

/// Largest departure of momentum less impulse from its start, kg m/s.
fn imbalance(results: &MemorySink) -> f64 {
    let start = momentum(&results.frames[0]);
    let departures = results
        .frames
        .iter()
        .map(|frame| (momentum(frame) - impulse(frame) - start).length());
    departures.fold(0.0, f64::max)
}

/// A body alone in air of 0.8 kg/m3.
fn alone(more: &str, run: &str) -> String {
    format!(
        r#"(
    name: "alone",
    environment: (gravity: Constant({G}), atmosphere: Uniform(density_kg_m3: 0.8)),
    entities: {{"body": (
        Body: (mass_kg: 5), Pose: (position_m: (0, 0, 1000)), Motion: (velocity_m_s: (0, 0, 0)), {more}
    )}},
    run: (duration_s: 8, output_every_s: 1, integrator: Adaptive(relative_tolerance: 1e-11), {run}),
)"#
    )
}

/// Falling through air, m v = I = -m v_t tanh(g t / v_t). Of a balloon that carries air along, the momentum is that
/// of its own mass: m (B - m g) t / (m + m_a), with B = rho V g and m_a = rho V / 2.
#[test]
fn a_falling_sphere_and_a_rising_balloon_have_the_momentum_of_closed_forms() {
    let falls = fly(
        &alone("Drag: Constant(coefficient: 0.5, area_m2: 0.4)", RECORD),
        &[],
    );
    let terminal = (2.0 * 5.0 * G / (0.8 * 0.5 * 0.4)).sqrt();
    let rises = fly(
        &alone(
            "Sphere: (radius_m: 1.5), Buoyancy: (), AddedMass: ()",
            RECORD,
        ),
        &[],
    );
    let displaced_kg = 0.8 * 4.0 / 3.0 * std::f64::consts::PI * 1.5_f64.powi(3);
    let acceleration = (displaced_kg - 5.0) * G / (5.0 + 0.5 * displaced_kg);
    for k in 0..=8 {
        let time_s = f64::from(k);
        for (what, results, expected_z) in [
            (
                "fall",
                &falls,
                -5.0 * terminal * (G * time_s / terminal).tanh(),
            ),
            ("rise", &rises, 5.0 * acceleration * time_s),
        ] {
            let frame = frame_at(results, time_s);
            let expected = DVec3::new(0.0, 0.0, expected_z);
            for (of, found) in [("momentum", momentum(frame)), ("impulse", impulse(frame))] {
                assert_below(&format!("{what}: {of}"), (found - expected).length(), 1e-8);
            }
        }
    }
}

/// A body that circles on a massless line: an anchor's pull and weight turn its momentum m v (-sin, cos), and their
/// impulse is the difference from its start. An elastic line is shorter by what it stretches.
#[test]
fn the_pull_of_an_anchor_turns_the_momentum_of_a_conical_pendulum() {
    let (length_m, mass_kg, tilt) = (20.0, 3.0, 0.7_f64);
    let rate = (G / (length_m * tilt.cos())).sqrt();
    let radius_m = length_m * tilt.sin();
    let speed = rate * radius_m;
    let stretch = mass_kg * G / tilt.cos() / 2e4;
    for (formulation, natural_m) in [
        ("Denoc", length_m),
        ("LumpedMass", length_m / (1.0 + stretch)),
    ] {
        let text = format!(
            r#"(
    name: "circling",
    environment: (gravity: Constant({G}), atmosphere: Vacuum),
    entities: {{
        "anchor": (Fixed: (position_m: (0, 0, 1000))),
        "bob": (
            Body: (mass_kg: {mass_kg}), Pose: (position_m: ({radius_m}, 0, {z_m})),
            Motion: (velocity_m_s: (0, {speed}, 0)),
        ),
        "line": (Tether: (
            from: ("anchor", Centre), to: ("bob", Centre), length_m: {natural_m}, nodes: 0, axial_stiffness_n: 2e4,
        )),
    }},
    run: (
        formulation: {formulation}, duration_s: 15, output_every_s: 0.5,
        integrator: Adaptive(relative_tolerance: 1e-11), {RECORD},
    ),
)"#,
            z_m = 1000.0 - length_m * tilt.cos(),
        );
        let results = fly(&text, &[]);
        let of = |time_s: f64| {
            let (sine, cosine) = (rate * time_s).sin_cos();
            mass_kg * speed * DVec3::new(-sine, cosine, 0.0)
        };
        for frame in &results.frames {
            let expected = of(frame.time_s);
            let what = format!("{formulation}: momentum");
            assert_below(&what, (momentum(frame) - expected).length(), 1e-9);
            let what = format!("{formulation}: impulse");
            assert_below(&what, (impulse(frame) - expected + of(0.0)).length(), 1e-9);
        }
    }
}

/// What falls without air has the impulse -M g t, whatever its lines, rods and cuts do inside.
fn assert_falls(what: &str, results: &MemorySink, mass_kg: f64) {
    for frame in &results.frames {
        let expected = DVec3::new(0.0, 0.0, -mass_kg * G * frame.time_s);
        let by_weight = (impulse(frame) - expected).length() / (mass_kg * G);
        assert_below(&format!("{what}: impulse in s of weight"), by_weight, 1e-10);
    }
    let balance = imbalance(results) / momentum(&results.frames[0]).length();
    assert_below(&format!("{what}: momentum less impulse"), balance, 1e-10);
}

/// Two bodies on a whirling line that is cut in its middle: elastic, and links of either kind.
#[test]
fn a_line_that_is_cut_keeps_the_balance() {
    for (what, length_m, more) in [
        ("elastic", 99.5, ""),
        (
            "point masses",
            100.0,
            "formulation: Denoc, links: PointMass,",
        ),
        ("rods", 100.0, "formulation: Denoc,"),
    ] {
        let line = format!(
            "length_m: {length_m}, axial_stiffness_n: 5e3, damping_n_s_m: 5, slack: false,"
        );
        let text = dumbbell(&line, &format!("{more} {RECORD}"));
        let (results, summary) =
            summary_of(&text, &[&format!("environment.gravity=Constant({G})")]);
        assert_eq!(summary.events.iter().filter(|e| e.kind == "cut").count(), 1);
        let mass_kg = 11.0 + 1440.0 * std::f64::consts::PI * 1e-6 * length_m;
        assert_falls(what, &results, mass_kg);
    }
}

/// A line of 1.81 kg on a winch `at`, paid out and reeled in again, between `from` and a probe of 7 kg.
fn reeled(from: &str, run: &str) -> String {
    format!(
        r#"(
    name: "reeled",
    environment: (gravity: Constant({G}), atmosphere: Vacuum),
    entities: {{
        "from": ({from}),
        "to": (
            Body: (mass_kg: 7), Pose: (position_m: (0, 0, 900)), Motion: (velocity_m_s: (4, 0.5, 0)),
        ),
        "line": (
            Tether: (
                from: ("from", Centre), to: ("to", Centre), length_m: 100, nodes: 3, diameter_m: 0.004,
                density_kg_m3: 1440, axial_stiffness_n: 2e4, damping_n_s_m: 20, slack: false, start: Straight,
            ),
            Winch: (stored_m: 60),
        ),
    }},
    events: [
        (at_s: 1, do: Reel(tether: "line", rate_m_s: 5, length_m: 40)),
        (at_s: 11, do: Reel(tether: "line", rate_m_s: -4, length_m: 30)),
    ],
    run: (
        duration_s: 20, output_every_s: 0.5, integrator: Adaptive(relative_tolerance: 1e-10), {run} {RECORD},
    ),
)"#
    )
}

/// Two free bodies: line that is paid out through new nodes, and taken in again, is inside.
#[test]
fn a_winch_on_a_free_body_keeps_the_balance() {
    let from =
        "Body: (mass_kg: 40), Pose: (position_m: (0, 0, 1000)), Motion: (velocity_m_s: (-2, 0, 0))";
    let mass_kg = 47.0 + 1440.0 * std::f64::consts::PI * 4e-6 * 160.0;
    for formulation in ["LumpedMass", "Denoc"] {
        let text = reeled(from, &format!("formulation: {formulation},"));
        assert_falls(formulation, &fly(&text, &[]), mass_kg);
    }
}

/// On an anchor, line comes in with the anchor's velocity and goes out with its own; the jerk of rigid links is the
/// anchor's.
#[test]
fn a_winch_on_a_moving_anchor_keeps_the_balance() {
    let from = "Moving: (position_m: (0, 0, 1000), velocity_m_s: (1, 0.5, 0.2))";
    for formulation in ["LumpedMass", "Denoc"] {
        let text = reeled(from, &format!("formulation: {formulation},"));
        let results = fly(&text, &[]);
        let largest = results.frames.iter().map(|frame| momentum(frame).length());
        let part = imbalance(&results) / largest.fold(0.0, f64::max);
        assert_below(&format!("{formulation}: of momentum"), part, 1e-10);
    }
}

/// Two falling bodies meet, ride together, and part: there is no anchor, so what the latch does is inside.
#[test]
fn docking_and_undocking_keep_the_balance() {
    let text = format!(
        r#"(
    name: "pair",
    environment: (gravity: Constant({G}), atmosphere: Vacuum),
    entities: {{
        "gondola": (
            Body: (mass_kg: 100, inertia: Box(1, 1.2, 0.8)), Pose: (position_m: (0, 0, 1000)),
            Motion: (velocity_m_s: (-0.05, 0.1, 0), rate_rad_s: (0.01, 0, -0.05)),
            DockingPort: (at_m: (-0.5, 0, -0.1), axis: (-1, 0, 0)),
        ),
        "rider": (
            Body: (mass_kg: 6, inertia: Box(0.5, 0.4, 0.3)), Pose: (position_m: (-1.2, 0.04, 999.93)),
            Motion: (velocity_m_s: (0.35, -0.03, 0.02), rate_rad_s: (0.02, -0.03, 0.04)),
            DockingPort: (at_m: (0.3, 0, 0), axis: (1, 0, 0)),
            Latch: (to: "gondola"),
        ),
    }},
    events: [(at_s: 4, do: Undock(body: "rider"))],
    run: (duration_s: 6, output_every_s: 0.25, integrator: Adaptive(relative_tolerance: 1e-12), {RECORD}),
)"#
    );
    let (results, summary) = summary_of(&text, &[]);
    for kind in ["docked", "released"] {
        assert!(summary.events.iter().any(|event| event.kind == kind));
    }
    assert_falls("pair", &results, 106.0);
}

/// Balloon, line and gondola through gusts, with added mass. Explicit methods keep sums to round-off; the implicit one
/// knows of the impulse by its values alone, and keeps it to its accuracy.
#[test]
fn the_comparison_case_keeps_the_balance_in_gusts() {
    for (formulation, integrator, tolerance) in [
        ("LumpedMass", "Adaptive(relative_tolerance: 1e-9)", 1e-11),
        ("Denoc", "Adaptive(relative_tolerance: 1e-9)", 1e-11),
        ("LumpedMass", "Implicit(accuracy_m: 1e-3)", 1e-4),
        ("LumpedMass", "Implicit(accuracy_m: 1e-5)", 1e-6),
    ] {
        let results = fly_scene(
            "paper/comparison_900m.ron",
            &[
                &format!("run.formulation={formulation}"),
                &format!("run.integrator={integrator}"),
                "run.duration_s=20",
                &RECORD.replacen("record: ", "run.record=", 1),
            ],
        );
        let moved = impulse(frame_at(&results, 20.0)).length();
        assert!(moved > 100.0, "{moved}");
        let part = imbalance(&results) / moved;
        let what = format!("{formulation}, {integrator}: of impulse");
        assert_below(&what, part, tolerance);
    }
}
