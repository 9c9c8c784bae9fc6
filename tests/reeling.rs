//! Tethers that are paid out and reeled in, against small equations integrated here, an adiabatic invariant,
//! and what is conserved.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test stops at what it does not expect"
)]

mod flight;

use aerobot::components::state::{Mass, Position, Velocity};
use aerobot::engine::plugin::Simulator;
use aerobot::engine::recording::frame::{Frame, MemorySink};
use aerobot::engine::simulation::Simulation;
use flight::{assert_below, assert_relative, channel, fly, frame_at, load, position, summary_of};
use glam::DVec3;

const G: f64 = 8.87;

/// A body of 10 kg below an anchor at 1000 m on a massless line of one segment with EA = 2e4 N.
fn on_massless_line(length_m: f64, start: &str, reel: &str, run: &str) -> String {
    format!(
        r#"(
    name: "massless",
    environment: (gravity: Constant({G}), atmosphere: Vacuum),
    entities: {{
        "anchor": (Fixed: (position_m: (0, 0, 1000))),
        "probe": (Body: (mass_kg: 10) {start}),
        "line": (
            Tether: (
                from: ("anchor", Centre), to: ("probe", Centre), length_m: {length_m}, nodes: 0,
                axial_stiffness_n: 2e4, damping_n_s_m: 20, slack: false,
            ),
            Winch: (stored_m: 200),
        ),
    }},
    events: [{reel}],
    run: ({run}),
)"#
    )
}

/// Length and its rate at 1 s and 4 s of m L'' = m g - EA (L/L0 - 1) - c' d(L/L0)/dt from rest in
/// equilibrium, with L0 = 50 m + 6 m/s t up to 3 s, by the classical Runge-Kutta method in steps of 0.1 ms.
fn paid_out_fast() -> [f64; 2] {
    let (stiffness, damping, mass) = (2e4, 20.0 * 50.0, 10.0);
    let acceleration = |t: f64, length: f64, rate: f64, reel: f64| {
        let rest = 50.0 + 6.0 * t.min(3.0);
        let straining = (rate - reel * length / rest) / rest;
        G - (stiffness * (length / rest - 1.0) + damping * straining) / mass
    };
    let mut found = [0.0; 2];
    let (mut x, mut v) = (50.0 * (1.0 + mass * G / stiffness), 0.0);
    let h = 1e-4;
    for step in 0..40_000 {
        let t = h * f64::from(step);
        let reel = if step < 30_000 { 6.0 } else { 0.0 };
        let k1 = (v, acceleration(t, x, v, reel));
        let k2 = (
            v + 0.5 * h * k1.1,
            acceleration(t + 0.5 * h, x + 0.5 * h * k1.0, v + 0.5 * h * k1.1, reel),
        );
        let k3 = (
            v + 0.5 * h * k2.1,
            acceleration(t + 0.5 * h, x + 0.5 * h * k2.0, v + 0.5 * h * k2.1, reel),
        );
        let k4 = (
            v + h * k3.1,
            acceleration(t + h, x + h * k3.0, v + h * k3.1, reel),
        );
        x += h / 6.0 * (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0);
        v += h / 6.0 * (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1);
        if step + 1 == 10_000 {
            found[0] = x;
        }
    }
    found[1] = x;
    found
}

#[test]
fn a_fast_pay_out_follows_its_equation() {
    let expected = paid_out_fast();
    for (integrator, tolerance_m) in [
        ("Adaptive(relative_tolerance: 1e-10)", 1e-7),
        ("Fixed(step_s: 0.005)", 1e-5),
        ("Implicit(accuracy_m: 1e-5)", 1e-4),
        ("Auto(accuracy_m: 1e-5)", 1e-4),
    ] {
        let run = format!("duration_s: 4, output_every_s: 1, integrator: {integrator}");
        let reel = "(at_s: 0, do: Reel(tether: \"line\", rate_m_s: 6, length_m: 18))";
        let results = fly(&on_massless_line(50.0, "", reel, &run), &[]);
        for (time_s, length_m) in [(1.0, expected[0]), (4.0, expected[1])] {
            let found_m = 1000.0 - position(&results, "probe", time_s).z;
            assert_below(integrator, (found_m - length_m).abs(), tolerance_m);
        }
    }
}

/// The implicit method keeps its third order where the length of a stiff line changes in the step.
#[test]
fn a_stiff_line_is_paid_out_to_third_order() {
    let error = |step_s: f64| {
        let run = format!(
            "duration_s: 2, output_every_s: 2, integrator: Fixed(step_s: {step_s}, method: Rosenbrock)"
        );
        let reel = "(at_s: 0, do: Reel(tether: \"line\", rate_m_s: 1, until_s: 10))";
        let text = on_massless_line(50.0, "", reel, &run);
        let exact = "run.integrator=Adaptive(relative_tolerance: 1e-12)";
        let (found, expected) = (fly(&text, &[]), fly(&text, &[exact]));
        position(&found, "probe", 2.0).distance(position(&expected, "probe", 2.0))
    };
    let errors = [error(0.02), error(0.01), error(0.005)];
    println!("{errors:?}");
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!(order > 2.7, "order {order}, {errors:?}");
    }
}

/// The action E/w of a pendulum whose length changes slowly is constant: the angle goes as L^(-3/4)
/// (Landau and Lifshitz 1976, sec. 49).
#[test]
fn a_slow_pendulum_keeps_its_action() {
    let angle = 0.05_f64;
    let length_m = 50.0 * (1.0 + 10.0 * G * angle.cos() / 2e4);
    let place = (length_m * angle.sin(), 1000.0 - length_m * angle.cos());
    let start = format!(", Pose: (position_m: ({}, 0, {}))", place.0, place.1);
    let reel = "(at_s: 20, do: Reel(tether: \"line\", rate_m_s: 0.1, length_m: 50))";
    let run =
        "duration_s: 560, output_every_s: 0.25, integrator: Adaptive(relative_tolerance: 1e-7)";
    let results = fly(&on_massless_line(50.0, &start, reel, run), &[]);
    let largest = |from_s: f64, until_s: f64| {
        let frames = results.frames.iter();
        let within = frames.filter(|frame| frame.time_s >= from_s && frame.time_s <= until_s);
        within
            .map(|frame| {
                let row = frame.states.iter().find(|row| &*row.entity == "probe");
                let place = row.unwrap().position_m;
                (place.x / (1000.0 - place.z)).atan().abs()
            })
            .fold(0.0, f64::max)
    };
    let ratio = largest(525.0, 560.0) / largest(0.0, 20.0);
    assert_relative("angle", ratio, 0.5_f64.powf(0.75), 0.01);
}

/// Two free bodies on a line with mass, whirling about each other without weight and air.
const WHIRLING: &str = r#"(
    name: "whirling",
    environment: (gravity: Constant(0), atmosphere: Vacuum),
    entities: {
        "a": (
            Body: (mass_kg: 40, inertia: Box(1, 1, 1)),
            Pose: (position_m: (0, 0, 50)), Motion: (velocity_m_s: (3, 0.5, 0.2), rate_rad_s: (0, 0.1, 0)),
        ),
        "b": (Body: (mass_kg: 7), Pose: (position_m: (0, 0, -49.52)), Motion: (velocity_m_s: (-2, 0.3, 0))),
        "tether": (
            Tether: (
                from: ("a", (0, 0, -0.5)), to: ("b", Centre), length_m: 99, nodes: 5, diameter_m: 0.004,
                density_kg_m3: 1440, axial_stiffness_n: 5e4, damping_n_s_m: 5, slack: false, start: Straight,
            ),
            Winch: (stored_m: 60),
        ),
    },
    events: [
        (at_s: 1, do: Reel(tether: "tether", rate_m_s: 5, length_m: 50)),
        (at_s: 13, do: Reel(tether: "tether", rate_m_s: -5, length_m: 60)),
    ],
    run: (
        duration_s: 26, output_every_s: 1, integrator: Adaptive(relative_tolerance: 1e-9),
        record: (channels: All),
    ),
)"#;

/// Sums of mass, momentum and mass times place of everything.
fn sums(simulation: &Simulation) -> (f64, DVec3, DVec3) {
    let world = simulation.world();
    let mut all = world.try_query::<(&Mass, &Position, &Velocity)>().unwrap();
    let mut sums = (0.0, DVec3::ZERO, DVec3::ZERO);
    for (mass, position, velocity) in all.iter(world) {
        sums.0 += mass.0;
        sums.1 += mass.0 * velocity.0;
        sums.2 += mass.0 * position.0;
    }
    sums
}

/// Through eight new nodes and as many that are taken away again.
#[test]
fn mass_and_momentum_are_conserved_and_energy_is_accounted_for() {
    for end in ["From", "To"] {
        let simulator = Simulator::new();
        let text = WHIRLING.replace("stored_m: 60", &format!("end: {end}, stored_m: 60"));
        let mut simulation = simulator.build(&load(&simulator, &text, &[])).unwrap();
        let before = sums(&simulation);
        let mut results = MemorySink::default();
        let summary = simulation.run(&mut results, &mut |_| {});
        assert_eq!(summary.outcome, "done", "{:?}", summary.stopped);
        let after = sums(&simulation);
        assert_below("mass", (after.0 / before.0 - 1.0).abs(), 1e-14);
        let momentum = after.1.distance(before.1) / before.1.length();
        assert_below("momentum", momentum, 1e-9);
        let nodes = |time_s: f64| frame_at(&results, time_s).segments.len();
        println!("{} {} {} segments", nodes(0.0), nodes(12.0), nodes(26.0));
        assert!(nodes(12.0) > nodes(0.0) + 1 && nodes(26.0) < nodes(12.0));
        let balance = |frame: &Frame| {
            channel(frame, "system", "mechanical_energy_j")
                - channel(frame, "system", "nonconservative_work_j")
        };
        let energy = channel(&results.frames[0], "system", "mechanical_energy_j");
        for frame in &results.frames {
            let drift = (balance(frame) - balance(&results.frames[0])).abs();
            assert!(
                drift < 1e-5 * energy,
                "{} s: {drift} J of {energy} J",
                frame.time_s
            );
        }
    }
}

/// 400 m and back, with a body of 100 kg at the end: what hangs afterwards is what hung before, the winch
/// carries the whole weight at its rate, and the stretch of every segment stays that of its load.
#[test]
fn a_long_pay_out_and_back_stays_calm() {
    let text = format!(
        r#"(
    name: "there-and-back",
    environment: (gravity: Constant({G}), atmosphere: Vira),
    entities: {{
        "anchor": (Fixed: (position_m: (0, 0, 60_000))),
        "probe": (Body: (mass_kg: 100), Drag: Constant(coefficient: 1, area_m2: 1)),
        "tether": (
            Tether: (
                from: ("anchor", Centre), to: ("probe", Centre), length_m: 100, nodes: 4,
                diameter_m: 0.003, density_kg_m3: 1440, axial_stiffness_n: 2e5, damping_n_s_m: 500,
                drag: (normal: 1, tangential: 0.03),
            ),
            Winch: (stored_m: 500),
        ),
    }},
    events: [
        (at_s: 10, do: Reel(tether: "tether", rate_m_s: 1, length_m: 400)),
        (at_s: 450, do: Reel(tether: "tether", rate_m_s: -1, length_m: 400)),
    ],
    run: (duration_s: 900, output_every_s: 5),
)"#
    );
    let (results, summary) = summary_of(&text, &[]);
    println!(
        "{} steps, {} rejected",
        summary.steps, summary.rejected_steps
    );
    assert!(summary.steps < 10_000, "{} steps", summary.steps);
    let kinds: Vec<&str> = summary
        .events
        .iter()
        .map(|event| event.kind.as_str())
        .collect();
    assert_eq!(kinds, ["reel start", "reel end", "reel start", "reel end"]);
    let line_kg_m = 1440.0 * std::f64::consts::PI * 0.0015_f64.powi(2);
    let weight_n = |out_m: f64| (100.0 + line_kg_m * out_m) * G;
    for (time_s, out_m) in [(5.0, 100.0), (445.0, 500.0), (895.0, 100.0)] {
        let frame = frame_at(&results, time_s);
        assert_relative("out", channel(frame, "tether", "line_out_m"), out_m, 1e-10);
        assert_relative(
            "top",
            channel(frame, "tether", "tension_from_n"),
            weight_n(out_m),
            2e-4,
        );
    }
    // 300 m are out at 210 s, with a strain of 0.0046. 1 mm, what is asked for, are 10 N of the segment at the
    // winch: means over some seconds are ten times as good.
    let power_w = channel(frame_at(&results, 210.0), "tether", "winch_power_w");
    assert_relative(
        "power",
        power_w,
        -weight_n(300.0) * (1.0 + 0.5 * 0.0046),
        5e-3,
    );
    let largest_n = summary.largest_tension.unwrap().tension_n;
    // The winch stops at once, and for a moment the damper of its segment, 500 N s/m x 5, has all of 1 m/s.
    let stop_n = weight_n(500.0) + 2500.0;
    assert!(largest_n < 1.02 * stop_n, "{largest_n}");
    let (start, end) = (
        position(&results, "probe", 0.0),
        position(&results, "probe", 900.0),
    );
    assert_below("back", start.distance(end), 2e-3);
    let speeds = results.frames.iter().flat_map(|frame| &frame.states);
    let fastest = speeds
        .map(|row| row.velocity_m_s.length())
        .fold(0.0, f64::max);
    assert!(fastest < 2.0, "{fastest} m/s");
    let (again, _) = summary_of(&text, &[]);
    assert_eq!(results.frames, again.frames);
}

/// Where a node is put in, the row of that instant is as those beside it: the load of 10 kg and of the line below, by
/// Kelvin-Voigt dampers that would show a step of the velocity as 60 N.
#[test]
fn a_new_node_moves_as_the_line_does() {
    let more = [
        "events=[(at_s: 10, do: Reel(tether: \"tether\", rate_m_s: 2, length_m: 200))]",
        "run.duration_s=110",
        "run.output_every_s=0.5",
    ];
    let results = flight::fly_scene("examples/reel_and_release.ron", &more);
    let segments = |time_s: f64| {
        let rows = &frame_at(&results, time_s).segments;
        rows.iter().map(|row| row.tension_n).collect::<Vec<f64>>()
    };
    let line_kg_m = 1440.0 * std::f64::consts::PI * 0.001_f64.powi(2);
    let mut counts = Vec::new();
    // The bounce of the start has died out.
    for half_seconds in 160..=219 {
        let time_s = 0.5 * f64::from(half_seconds);
        let tensions = segments(time_s);
        let count = tensions.len();
        counts.push(count);
        let out_m = 100.0 + 2.0 * (time_s - 10.0);
        for (index, tension_n) in tensions.iter().enumerate() {
            let below_m = (count - index) as f64 - 0.5;
            // All segments but that at the winch are of 10 m.
            let below_m = if index == 0 { out_m } else { 10.0 * below_m };
            let load_n = G * (10.0 + line_kg_m * below_m);
            // The drag of 2 m/s on the probe, half a newton, and half of the segment at the winch.
            assert!(
                (tension_n - load_n).abs() < 1.0,
                "{time_s} s, segment {index}: {tension_n} N for {load_n} N"
            );
        }
        let power_w = channel(frame_at(&results, time_s), "tether", "winch_power_w");
        assert_relative("power", power_w, -2.0 * tensions[0], 0.02);
    }
    assert!(counts[0] < counts[counts.len() - 1], "nodes are put in");
}
