//! Rigid and elastic links that are paid out and reeled in: pendulums of changing length, what is conserved, and
//! lumped masses.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test stops at what it does not expect"
)]

mod flight;

use aerobot::engine::plugin::Simulator;
use aerobot::engine::recording::frame::{Frame, MemorySink};
use flight::{assert_below, channel, fly, frame_at, largest_distance_m, load, position};
use glam::DVec3;

const G: f64 = 8.87;

/// A body of 10 kg that swings below an anchor at 1000 m on a massless rigid line of 50 m; `motion` is its start.
fn pendulum(motion: &str, reel: &str, run: &str) -> String {
    format!(
        r#"(
    name: "reeled-pendulum",
    environment: (gravity: Constant({G}), atmosphere: Vacuum),
    entities: {{
        "anchor": (Fixed: (position_m: (0, 0, 1000))),
        "probe": (Body: (mass_kg: 10), Motion: (velocity_m_s: ({motion}, 0, 0))),
        "line": (
            Tether: (
                from: ("anchor", Centre), to: ("probe", Centre), length_m: 50, nodes: 0, axial_stiffness_n: 2e4,
                damping_n_s_m: 20, slack: false,
            ),
            Winch: (stored_m: 200),
        ),
    }},
    events: [{reel}],
    run: (formulation: Denoc, {run}),
)"#
    )
}

/// Angle (rad) and its rate (rad/s) at `until_s` of L theta'' = -g sin(theta) - 2 L' theta', L = 50 m + L' t, from
/// straight down at 4 m/s, by the classical Runge-Kutta method in steps of 1 ms.
fn swung(length_rate_m_s: f64, until_s: f64) -> (f64, f64) {
    let rates = |t: f64, (theta, omega): (f64, f64)| {
        let length_m = 50.0 + length_rate_m_s * t;
        (
            omega,
            -(G * theta.sin() + 2.0 * length_rate_m_s * omega) / length_m,
        )
    };
    let moved = |y: (f64, f64), h: f64, k: (f64, f64)| (y.0 + h * k.0, y.1 + h * k.1);
    let (mut y, h) = ((0.0, 4.0 / 50.0), 1e-3);
    for step in 0..(until_s / h).round() as u32 {
        let t = h * f64::from(step);
        let k1 = rates(t, y);
        let k2 = rates(t + 0.5 * h, moved(y, 0.5 * h, k1));
        let k3 = rates(t + 0.5 * h, moved(y, 0.5 * h, k2));
        let k4 = rates(t + h, moved(y, h, k3));
        y.0 += h / 6.0 * (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0);
        y.1 += h / 6.0 * (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1);
    }
    y
}

/// Place, and tension m (L theta'^2 + g cos(theta)) for a steady rate, in every integrator.
#[test]
fn a_reeled_pendulum_swings_as_its_equation_says() {
    for rate_m_s in [2.0, -1.5] {
        let (theta, omega) = swung(rate_m_s, 15.0);
        let length_m = 50.0 + 15.0 * rate_m_s;
        let expected = DVec3::new(theta.sin(), 0.0, -theta.cos()) * length_m + 1000.0 * DVec3::Z;
        let tension_n = 10.0 * (length_m * omega * omega + G * theta.cos());
        let reel =
            format!("(at_s: 0, do: Reel(tether: \"line\", rate_m_s: {rate_m_s}, length_m: 40))");
        for (integrator, tolerance_m) in [
            ("Adaptive(relative_tolerance: 1e-11)", 1e-8),
            ("Fixed(step_s: 0.02)", 1e-7),
            ("Fixed(step_s: 0.005, method: Rosenbrock)", 1e-5),
            ("Auto(accuracy_m: 1e-3)", 1e-2),
        ] {
            let run = format!("duration_s: 16, output_every_s: 1, integrator: {integrator}");
            let results = fly(&pendulum("4", &reel, &run), &[]);
            let found = position(&results, "probe", 15.0);
            assert_below(integrator, found.distance(expected), tolerance_m);
            let found_n = frame_at(&results, 15.0).segments[0].tension_n;
            assert_below("tension", (found_n / tension_n - 1.0).abs(), tolerance_m);
        }
    }
}

/// Two free bodies on a line with mass, whirling about each other without weight and air, as in `reeling.rs`; paid
/// out by half its length and reeled in by more, beginning at `end`.
fn whirling(end: &str, run: &str) -> String {
    format!(
        r#"(
    name: "whirling",
    environment: (gravity: Constant(0), atmosphere: Vacuum),
    entities: {{
        "a": (
            Body: (mass_kg: 40, inertia: Box(1, 1, 1)),
            Pose: (position_m: (0, 0, 50)), Motion: (velocity_m_s: (3, 0.5, 0.2), rate_rad_s: (0, 0.1, 0)),
        ),
        "b": (Body: (mass_kg: 7), Pose: (position_m: (0, 0, -49.5)), Motion: (velocity_m_s: (-2, 0.3, 0))),
        "tether": (
            Tether: (
                from: ("a", (0, 0, -0.5)), to: ("b", Centre), length_m: 99, nodes: 5, diameter_m: 0.004,
                density_kg_m3: 1440, axial_stiffness_n: 5e4, damping_n_s_m: 5, slack: false, start: Straight,
            ),
            Winch: (end: {end}, stored_m: 60),
        ),
    }},
    events: [
        (at_s: 1, do: Reel(tether: "tether", rate_m_s: 5, length_m: 50)),
        (at_s: 13, do: Reel(tether: "tether", rate_m_s: -5, length_m: 60)),
    ],
    run: (
        formulation: Denoc, duration_s: 26, output_every_s: 0.5, {run}
        record: (channels: Only({{"system": ["mechanical_energy_j", "nonconservative_work_j"]}})),
    ),
)"#
    )
}

/// Momentum and angular momentum of the whirling bodies, their line of point masses and the drum at `a` or `b`.
fn sums(frame: &Frame, end: &str, out_m: f64, nodes: u32) -> [DVec3; 2] {
    let line_kg_m = 1440.0 * std::f64::consts::PI * 0.002_f64.powi(2);
    let nominal_m = 99.0 / f64::from(nodes + 1);
    let count = frame.segments.len();
    let first_m = out_m - nominal_m * (count - 1) as f64;
    let drum_kg = line_kg_m * (99.0 + 60.0 - out_m);
    let segment_m = |k: usize| {
        let is_reeled = k == if end == "From" { 0 } else { count - 1 };
        if is_reeled { first_m } else { nominal_m }
    };
    let mut sums = [DVec3::ZERO; 2];
    let mut add = |kg: f64, x: DVec3, v: DVec3| {
        sums[0] += kg * v;
        sums[1] += x.cross(kg * v);
    };
    let mut spin = DVec3::ZERO;
    for row in &frame.states {
        let (x, v) = (row.position_m, row.velocity_m_s);
        match &*row.entity {
            "a" => {
                let (q, w) = row.rotation.map(|motion| (motion.0, motion.1)).unwrap();
                let r = DVec3::new(0.0, 0.0, -0.5);
                let own = if end == "From" { drum_kg } else { 0.0 };
                let half_kg = 0.5 * line_kg_m * segment_m(0);
                add(40.0, x, v);
                add(half_kg + own, x + q * r, v + q * w.cross(r));
                // A box of 1 m: m/6 on every axis.
                spin += q * (40.0 / 6.0 * w);
            }
            "b" => {
                let own = if end == "From" { 0.0 } else { drum_kg };
                add(7.0 + own + 0.5 * line_kg_m * segment_m(count - 1), x, v);
            }
            name => {
                let number: usize = name.rsplit('/').next().unwrap().parse().unwrap();
                let kg = 0.5 * line_kg_m * (segment_m(number - 1) + segment_m(number));
                add(kg, x, v);
            }
        }
    }
    sums[1] += spin;
    sums
}

/// Length out at a time, m.
fn out_m(time_s: f64) -> f64 {
    99.0 + 5.0 * (time_s.clamp(1.0, 11.0) - 1.0) - 5.0 * (time_s.clamp(13.0, 25.0) - 13.0)
}

/// Through new nodes and as many that are taken away again, and the jerks of a winch that starts and stops at once;
/// energy less work stays in both kinds of links.
#[test]
fn momenta_are_conserved_and_energy_is_accounted_for() {
    for end in ["From", "To"] {
        for links in ["PointMass", "Rod"] {
            let run = format!("integrator: Adaptive(relative_tolerance: 1e-10), links: {links},");
            let results = fly(&whirling(end, &run), &[]);
            let count = |time_s: f64| frame_at(&results, time_s).segments.len();
            assert!(count(12.0) > count(0.0) + 1 && count(26.0) < count(12.0));
            let balance = |frame: &Frame| {
                channel(frame, "system", "mechanical_energy_j")
                    - channel(frame, "system", "nonconservative_work_j")
            };
            let energy_j = channel(&results.frames[0], "system", "mechanical_energy_j");
            let drift = results
                .frames
                .iter()
                .map(|frame| (balance(frame) - balance(&results.frames[0])).abs() / energy_j);
            let what = format!("{end}, {links}: energy less work");
            assert_below(&what, drift.fold(0.0, f64::max), 1e-7);
            let start = sums(&results.frames[0], end, 99.0, 5)[0];
            for frame in &results.frames {
                let now = sums(frame, end, out_m(frame.time_s), 5)[0];
                let change = now.distance(start) / start.length();
                assert!(
                    change < 1e-11,
                    "{end}, {links}, {} s: {change:e}",
                    frame.time_s
                );
            }
        }
    }
}

/// Line that leaves the winch is lumped at both ends of its segment at once: angular momentum is kept as far as
/// segments are short.
#[test]
fn angular_momentum_is_kept_by_short_segments() {
    let changes = [5, 11, 23].map(|nodes| {
        let own = "integrator: Adaptive(relative_tolerance: 1e-9), links: PointMass,";
        let set = format!("entities.tether.Tether.nodes={nodes}");
        let results = fly(&whirling("From", own), &[&set]);
        let at = |time_s: f64| {
            let frame = frame_at(&results, time_s);
            sums(frame, "From", out_m(time_s), nodes)[1]
        };
        at(10.5).distance(at(0.0)) / at(0.0).length()
    });
    println!("{changes:?}");
    assert!(
        changes[1] < 0.6 * changes[0] && changes[2] < 0.6 * changes[1],
        "{changes:?}"
    );
}

/// Elastic links of point masses are lumped masses in other coordinates, and these tend to rigid links with EA.
#[test]
fn reeled_links_are_lumped_masses() {
    let run = |more: &[&str]| -> MemorySink {
        let own = "integrator: Adaptive(relative_tolerance: 1e-10), links: PointMass,";
        fly(&whirling("From", own), more)
    };
    let lumped = run(&["run.formulation=LumpedMass"]);
    let elastic = run(&["run.elastic_links=true"]);
    assert_below("elastic", largest_distance_m(&elastic, &lumped), 1e-9);
}

/// A body of 20 kg that hangs 1 m below a beam by two lines, each with a winch on the beam.
fn hoist(events: &str, run: &str) -> String {
    let line = |x: &str| {
        format!(
            r#"(
            Tether: (
                from: ("beam", ({x}, 0, 0)), to: ("body", ({x}, 0, 0.2)), length_m: 20, nodes: 3, diameter_m: 0.004,
                density_kg_m3: 1440, axial_stiffness_n: 1e6, damping_n_s_m: 200, slack: false,
            ),
            Winch: (stored_m: 30),
        )"#
        )
    };
    format!(
        r#"(
    name: "hoist",
    environment: (gravity: Constant({G}), atmosphere: Vacuum),
    entities: {{
        "beam": (Fixed: (position_m: (0, 0, 100))),
        "body": (Body: (mass_kg: 20, inertia: Box(1, 1, 0.4))),
        "left": {},
        "right": {},
    }},
    events: [{events}],
    run: (duration_s: 12, output_every_s: 0.5, {run}),
)"#,
        line("-0.5"),
        line("0.5")
    )
}

/// Two lines between a beam and a body are a closed loop. Paid out together they lower the body at their rate; one
/// alone tilts it, as stiff lumped masses do.
#[test]
fn loops_of_reeled_links_stay_closed() {
    let reel = |line: &str, rate_m_s: f64, length_m: f64| {
        format!(
            "(at_s: 1, do: Reel(tether: \"{line}\", rate_m_s: {rate_m_s}, length_m: {length_m})), "
        )
    };
    let both = reel("left", 1.0, 10.0) + &reel("right", 1.0, 10.0);
    let one = reel("left", 0.05, 0.4);
    for (integrator, tolerance_m) in [
        ("integrator: Adaptive(relative_tolerance: 1e-8)", 1e-6),
        ("integrator: Auto()", 1e-3),
    ] {
        let run = format!("formulation: Denoc, {integrator}");
        let lowered = fly(&hoist(&both, &run), &[]);
        for time_s in [1.0_f64, 3.0, 8.0, 12.0] {
            let z = 100.0 - 20.2 - (time_s.min(11.0) - 1.0);
            let place = position(&lowered, "body", time_s);
            let error_m = place.distance(DVec3::new(0.0, 0.0, z));
            assert_below(integrator, error_m, tolerance_m);
        }
        for frame in &lowered.frames {
            let total: f64 = frame.segments.iter().map(|row| row.length_m).sum();
            let out_m = 40.0 + 2.0 * (frame.time_s.clamp(1.0, 11.0) - 1.0);
            assert!(
                (total - out_m).abs() < 1e-7,
                "{} s: {total} m",
                frame.time_s
            );
        }
        let tilted = fly(&hoist(&one, &run), &[]);
        let lumped = fly(&hoist(&one, integrator), &[]);
        assert_below("tilted", largest_distance_m(&tilted, &lumped), 0.02);
        let [at, of] = [&tilted, &lumped].map(|results| {
            let mut rows = frame_at(results, 12.0).states.iter();
            let row = rows.find(|row| &*row.entity == "body");
            row.unwrap().rotation.unwrap().0
        });
        assert_below("tilt, rad", at.angle_between(of), 0.02);
        println!("tilt {} rad", at.angle_between(glam::DQuat::IDENTITY));
        assert!(at.angle_between(glam::DQuat::IDENTITY) > 0.3);
    }
}

/// A heavy body that swings on a line that is paid out and reeled in: lumped masses stretch, and bounce where the
/// winch starts and stops, by what goes with 1/EA and 1/sqrt(EA); without that they are rigid links.
#[test]
fn stiff_lumped_masses_are_reeled_as_rigid_links() {
    let run = |more: &[&str]| -> MemorySink {
        let text = format!(
            r#"(
    name: "lowered",
    environment: (gravity: Constant({G}), atmosphere: Uniform(density_kg_m3: 0.8)),
    entities: {{
        "anchor": (Fixed: (position_m: (0, 0, 1000))),
        "probe": (
            Body: (mass_kg: 100, inertia: Box(1, 1, 1)), Drag: Constant(coefficient: 1, area_m2: 1),
            Motion: (velocity_m_s: (3, 1, 0)),
        ),
        "line": (
            Tether: (
                from: ("anchor", Centre), to: ("probe", Top), length_m: 100, nodes: 4, diameter_m: 0.004,
                density_kg_m3: 1440, axial_stiffness_n: 2e5, damping_n_s_m: 100, drag: (normal: 1, tangential: 0.03),
            ),
            Winch: (stored_m: 60),
        ),
    }},
    events: [
        (at_s: 2, do: Reel(tether: "line", rate_m_s: 1, length_m: 50)),
        (at_s: 60, do: Reel(tether: "line", rate_m_s: -1, length_m: 30)),
    ],
    run: (duration_s: 100, output_every_s: 5, links: PointMass, integrator: Auto(accuracy_m: 1e-3)),
)"#
        );
        fly(&text, more)
    };
    let links = run(&["run.formulation=Denoc"]);
    // The body alone: waves that a jerk leaves on the line have phases of their own.
    let differences_m = [2e5, 2e7].map(|stiffness_n| {
        let stiff = format!("entities.line.Tether.axial_stiffness_n={stiffness_n}");
        let lumped = run(&[&stiff]);
        let times = links.frames.iter().map(|frame| frame.time_s);
        let each = times.map(|time_s| {
            position(&links, "probe", time_s).distance(position(&lumped, "probe", time_s))
        });
        each.fold(0.0, f64::max)
    });
    println!("EA x 1, 100: {differences_m:?} m");
    assert!(
        differences_m[1] < 0.2 * differences_m[0],
        "{differences_m:?}"
    );
}

/// A body on four parallel lines, which are redundant by one, each with a winch on the body: paid out together
/// while it swings, energy less work stays in implicit steps, and the lines have the lengths that are out.
#[test]
fn redundant_lines_are_reeled_in_implicit_steps() {
    let reels: String = (1..=4)
        .map(|k| format!("(at_s: 2, do: Reel(tether: \"t/{k}\", rate_m_s: 0.5, length_m: 4)), "))
        .collect();
    let text = format!(
        r#"(
    name: "four", environment: (gravity: Constant({G}), atmosphere: Vacuum),
    entities: {{
        "a": (Fixed: (position_m: (0, 0, 1000))),
        "p": (Body: (mass_kg: 10, inertia: Box(1, 1, 0.5)), Motion: (velocity_m_s: (0.3, 0, 0))),
        "t": (
            Tethers: (
                count: 4, from_radius_m: 0.5, to_radius_m: 0.5, from: ("a", Centre), to: ("p", Top), length_m: 20,
                nodes: 2, diameter_m: 0.002, density_kg_m3: 1440, axial_stiffness_n: 1e5, damping_n_s_m: 1,
            ),
            Winch: (end: To, stored_m: 50),
        ),
    }},
    events: [{reels}],
    run: (
        formulation: Denoc, duration_s: 12, output_every_s: 0.5,
        record: (channels: Only({{"system": ["mechanical_energy_j", "nonconservative_work_j"]}})),
    ),
)"#
    );
    let results = fly(&text, &[]);
    let balance = |frame: &Frame| {
        channel(frame, "system", "mechanical_energy_j")
            - channel(frame, "system", "nonconservative_work_j")
    };
    let drift_j = results
        .frames
        .iter()
        .map(|frame| (balance(frame) - balance(&results.frames[0])).abs());
    // Of 7 J of swing, and 350 J that the winches take.
    assert_below("energy less work, J", drift_j.fold(0.0, f64::max), 0.01);
    let end = results.frames.last().unwrap();
    let total: f64 = end.segments.iter().map(|row| row.length_m).sum();
    assert_below("lengths, m", (total - 4.0 * 24.0).abs(), 1e-5);
}

/// A line between two anchors that is reeled in until it is straight cannot be reeled in further: the run stops and
/// says so.
#[test]
fn a_line_reeled_in_until_it_is_straight_stops_the_run() {
    let text = format!(
        r#"(
    name: "span", environment: (gravity: Constant({G}), atmosphere: Vacuum),
    entities: {{
        "left": (Fixed: (position_m: (0, 0, 1000))),
        "right": (Fixed: (position_m: (15, 0, 1000))),
        "line": (
            Tether: (
                from: ("left", Centre), to: ("right", Centre), length_m: 20, nodes: 4, diameter_m: 0.002,
                density_kg_m3: 1440, axial_stiffness_n: 1e5, damping_n_s_m: 1,
            ),
            Winch: (stored_m: 10),
        ),
    }},
    events: [(at_s: 2, do: Reel(tether: "line", rate_m_s: -0.3, length_m: 5.4))],
    run: (formulation: Denoc, duration_s: 25, output_every_s: 1),
)"#
    );
    let simulator = Simulator::new();
    let mut simulation = simulator.build(&load(&simulator, &text, &[])).unwrap();
    let summary = simulation.run(&mut MemorySink::default(), &mut |_| {});
    let stop = summary.stopped.expect("it cannot go on");
    // 5 m are in after 16.7 s.
    assert!((stop.time_s - 18.0 - 2.0 / 3.0).abs() < 0.05, "{stop}");
    assert_eq!(stop.entity.as_deref(), Some("line"), "{stop}");
}
