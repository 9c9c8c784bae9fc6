//! Tethers that resist being twisted: torsional pendulums, turns, what they conserve, and both formulations.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod flight;

use aerobot::engine::plugin::Simulator;
use aerobot::engine::recording::frame::MemorySink;
use aerobot::engine::trim::scene_file::write_trimmed_scene;
use flight::torsional_pendulum::{POSE, TIGHT, pendulum, pendulum_text};
use flight::{assert_below, fly, load, summary_of};

fn largest_error(samples: &[(f64, f64)], expected: impl Fn(f64) -> f64) -> f64 {
    assert!(samples.len() > 4);
    samples
        .iter()
        .map(|(time_s, value)| (value - expected(*time_s)).abs())
        .fold(0.0, f64::max)
}

/// phi(t) = phi_0 cos(omega t), omega^2 = GJ / (L Izz): linear at any amplitude, here nearly three turns.
#[test]
fn a_body_on_one_tether_is_a_torsional_pendulum() {
    for start_rad in [0.3, 18.0] {
        let results = pendulum(&format!("twist_rad: {start_rad}"), POSE, TIGHT, &[]);
        let omega = (0.5_f64 / 5.0 / 0.4).sqrt();
        let error = largest_error(&results.channel("line", "twist_rad"), |t| {
            start_rad * (omega * t).cos()
        });
        assert_below("twist, rad", error, 1e-8);
        let error = largest_error(&results.channel("line", "torsion_n_m"), |t| {
            0.1 * start_rad * (omega * t).cos()
        });
        assert_below("torque, N m", error, 1e-9);
    }
}

/// The same with damping: exponents -c/(2 Izz) +- i sqrt(omega^2 - (c/(2 Izz))^2).
#[test]
fn damping_takes_the_twist_away_at_its_rate() {
    let results = pendulum("damping_n_m_s: 0.08, twist_rad: 0.5", POSE, TIGHT, &[]);
    let decay = 0.08 / (2.0 * 0.4);
    let omega = (0.25_f64 - decay * decay).sqrt();
    let error = largest_error(&results.channel("line", "twist_rad"), |t| {
        0.5 * (-decay * t).exp() * ((omega * t).cos() + decay / omega * (omega * t).sin())
    });
    assert_below("twist, rad", error, 1e-8);
}

/// A body that spins at 25 rad/s winds the line up by 50 rad and back; every integrator counts the turns,
/// in either formulation.
#[test]
fn many_turns_are_followed() {
    let spin = format!("{POSE} Motion: (rate_rad_s: (0, 0, 25)),");
    for (integrator, bound) in [
        ("integrator: Auto(accuracy_m: 1e-4)", 0.05),
        ("integrator: Implicit(accuracy_m: 1e-4)", 0.05),
        (TIGHT, 1e-6),
    ] {
        for formulation in ["LumpedMass", "Denoc"] {
            let run = format!("{integrator}, formulation: {formulation}");
            let results = pendulum("", &spin, &run, &["run.duration_s=13"]);
            let error = largest_error(&results.channel("line", "twist_rad"), |t| {
                -50.0 * (0.5 * t).sin()
            });
            assert_below(&run, error, bound);
        }
    }
}

/// Two bodies on a tether in free space: omega^2 = (GJ/L) (1/I_1 + 1/I_2) about the line.
#[test]
fn two_bodies_turn_against_each_other() {
    let (results, _) = free_pair(
        "stiffness_n_m2: 0.5, twist_rad: 0.4",
        "duration_s: 20, output_every_s: 0.1",
        TIGHT,
    );
    let omega = (0.5_f64 / 4.0 * (1.0 / 0.3 + 1.0 / 0.7)).sqrt();
    let error = largest_error(&results.channel("line", "twist_rad"), |t| {
        0.4 * (omega * t).cos()
    });
    assert_below("twist, rad", error, 1e-8);
}

fn free_pair(torsion: &str, times: &str, integrator: &str) -> (MemorySink, u64) {
    let (results, summary) = summary_of(
        &format!(
            r#"(
        name: "pair", environment: (gravity: Constant(0), atmosphere: Vacuum),
        entities: {{
            "a": (
                Body: (mass_kg: 3, inertia: Tensor(xx_kg_m2: 0.3, yy_kg_m2: 0.5, zz_kg_m2: 0.6)),
                Pose: (position_m: (0, 0, 0)),
            ),
            "b": (
                Body: (mass_kg: 4, inertia: Tensor(xx_kg_m2: 0.7, yy_kg_m2: 0.8, zz_kg_m2: 0.9)),
                Pose: (position_m: (4, 0, 0)), Motion: (rate_rad_s: (0, 0, 0)),
            ),
            "line": (Tether: (
                from: ("a", Centre), to: ("b", Centre), length_m: 4, nodes: 0, axial_stiffness_n: 100,
                slack: false, torsion: ({torsion}),
            )),
        }},
        run: ({times}, record: (channels: All), {integrator}),
    )"#
        ),
        &[],
    );
    (results, summary.steps)
}

/// Two tethers side by side, twisted: omega^2 = (m g a^2 / L + 2 GJ / L_0) / Izz, a half their distance, L
/// their length under load; small angles. The body has no pose: it hangs untwisted.
#[test]
fn torsion_adds_to_a_bifilar_pendulum() {
    let (mass, half, length, ea, gj, izz) = (10.0, 0.5, 2.0, 1e6, 4.0, 1.5);
    let line = |x: f64| {
        format!(
            r#"Tether: (
                from: ("top", ({x}, 0, 0)), to: ("load", ({x}, 0, 0.1)), length_m: {length}, nodes: 0,
                axial_stiffness_n: {ea}, torsion: (stiffness_n_m2: {gj}),
            ),"#
        )
    };
    let results = fly(
        &format!(
            r#"(
        name: "bifilar", environment: (atmosphere: Vacuum),
        entities: {{
            "top": (Fixed: (position_m: (0, 0, 50))),
            "load": (
                Body: (mass_kg: {mass}, inertia: Tensor(xx_kg_m2: 1, yy_kg_m2: 1.2, zz_kg_m2: {izz})),
                Motion: (rate_rad_s: (0, 0, 0.003)),
            ),
            "left": ({}),
            "right": ({}),
        }},
        run: (duration_s: 6, output_every_s: 0.05, record: (channels: All), {TIGHT}),
    )"#,
            line(-half),
            line(half)
        ),
        &[],
    );
    let loaded = length * (1.0 + 0.5 * mass * 8.87 / ea);
    let gravity = mass * 8.87 * half * half / loaded;
    let omega = ((gravity + 2.0 * gj / length) / izz).sqrt();
    let amplitude = 0.003 / omega;
    let error = largest_error(&results.channel("load", "heading_rad"), |t| {
        amplitude * (omega * t).sin()
    });
    assert_below("heading, of its amplitude", error / amplitude, 1e-5);
}

/// A torsion stiff against everything else costs an implicit step nothing: on an anchor, and between two
/// free bodies.
#[test]
fn stiff_torsion_costs_no_implicit_steps() {
    let stiff = [
        "entities.line.Tether.torsion.stiffness_n_m2=1e7",
        "run.duration_s=20",
    ];
    for formulation in ["LumpedMass", "Denoc"] {
        let text = pendulum_text(
            "damping_n_m_s: 100",
            &format!("{POSE} Motion: (rate_rad_s: (0, 0, 0.01)),"),
            &format!("integrator: Implicit(accuracy_m: 1e-3), formulation: {formulation}"),
        );
        let (results, summary) = summary_of(&text, &stiff);
        let twist = results.channel("line", "twist_rad");
        let largest = twist
            .iter()
            .map(|sample| sample.1.abs())
            .fold(0.0, f64::max);
        println!(
            "{formulation}: {} steps, twist up to {largest:.1e} rad",
            summary.steps
        );
        assert!(summary.steps < 2000 && largest < 1e-4);
    }
    let (results, steps) = free_pair(
        "stiffness_n_m2: 1e7, twist_rad: 1e-6",
        "duration_s: 20, output_every_s: 1",
        "integrator: Implicit(accuracy_m: 1e-3)",
    );
    println!("free pair: {steps} steps");
    let heading = results.channel("line", "twist_rad");
    let last = heading[heading.len() - 1].1;
    assert!(
        steps < 2000 && last.abs() < 1e-6,
        "{steps} steps, {last} rad"
    );
}

/// The stable step of RK4 knows the torsion, and says so: omega = sqrt(GJ / (L Izz)), 2 sqrt(2) / omega.
#[test]
fn the_stable_step_knows_the_torsion() {
    let simulator = Simulator::new();
    let text = pendulum_text("", POSE, "integrator: Fixed(method: RungeKutta4)");
    let stiff = "entities.line.Tether.torsion.stiffness_n_m2=2e7";
    for formulation in ["LumpedMass", "Denoc"] {
        let overrides = [
            stiff,
            "entities.line.Tether.axial_stiffness_n=200",
            "entities.line.Tether.damping_n_s_m=0",
            &format!("run.formulation={formulation}")[..],
        ];
        let scene = load(&simulator, &text, &overrides);
        let simulation = simulator
            .build(&scene)
            .unwrap_or_else(|error| panic!("{error}"));
        let stable = simulation.stable_step();
        let expected = 8.0_f64.sqrt() / (2e7_f64 / 5.0 / 0.4).sqrt();
        assert!(
            (stable.step_s / expected - 1.0).abs() < 0.06,
            "{stable:?} {expected}"
        );
        assert!(stable.step_s <= expected * 1.001, "{stable:?} {expected}");
        assert!(
            stable.segment.starts_with("line") || stable.segment == "load",
            "{stable:?}"
        );
    }
}

/// What has no pose hangs untwisted: a line that is clamped with a twist turns the body by it.
#[test]
fn a_body_without_a_pose_hangs_untwisted() {
    for (twist, turned) in [("", 0.0), ("twist_rad: 0.5", 0.5)] {
        let results = pendulum(twist, "", TIGHT, &["run.duration_s=1"]);
        let heading = results.channel("load", "heading_rad")[0].1;
        assert_below("heading, rad", (heading - turned).abs(), 1e-7);
        let error = largest_error(&results.channel("line", "twist_rad")[..], |_| 0.0);
        assert_below("twist, rad", error, 1e-7);
    }
}

/// Trim finds where the twists of two lines balance, and the scene that it writes stays there.
#[test]
fn a_trimmed_scene_keeps_its_twist() {
    let line = |x: f64, twist: f64| {
        format!(
            r#"Tether: (
                from: ("top", ({x}, 0, 0)), to: ("load", ({x}, 0, 0.1)), length_m: 20, nodes: 3,
                diameter_m: 0.002, density_kg_m3: 1440, axial_stiffness_n: 1e5, damping_n_s_m: 20,
                drag: (normal: 1, tangential: 0.03),
                torsion: (stiffness_n_m2: 4, damping_n_m_s: 0.1, twist_rad: {twist}),
            ),"#
        )
    };
    let text = format!(
        r#"(
        name: "bifilar", environment: (atmosphere: Vira, wind: [Uniform(velocity_m_s: (2, 1, 0))]),
        entities: {{
            "top": (Fixed: (position_m: (0, 0, 55000))),
            "load": (
                Body: (mass_kg: 10, inertia: Box(1, 1.5, 0.5)),
                Drag: Constant(coefficient: 1, area_m2: 0.3),
            ),
            "left": ({}),
            "right": ({}),
        }},
        run: (duration_s: 3, output_every_s: 0.5, record: (channels: All)),
    )"#,
        line(-0.5, 8.0),
        line(0.5, 0.0)
    );
    let simulator = Simulator::new();
    let scene = load(&simulator, &text, &[]);
    let mut simulation = simulator
        .build(&scene)
        .unwrap_or_else(|error| panic!("{error}"));
    let trim = simulation
        .trim(&scene)
        .unwrap_or_else(|error| panic!("{error}"));
    let [left, right] = ["left", "right"].map(|name| trim.tether(name).unwrap().twist_rad.unwrap());
    let heading = trim.body("load").unwrap().heading_rad;
    println!("twists {left:.4}, {right:.4} rad, heading {heading:.4} rad");
    assert!(heading > 0.1 && left > 6.0 && right < -0.1);
    let file = std::env::temp_dir().join(format!("aerobot-torsion-{}.ron", std::process::id()));
    let folder = std::path::Path::new(".");
    let written = write_trimmed_scene(&scene, &trim, folder, &file, true);
    let text = std::fs::read_to_string(&file);
    let _ = std::fs::remove_file(&file);
    written.unwrap_or_else(|error| panic!("{error}"));
    let results = fly(&text.unwrap(), &[]);
    for (name, twist) in [("left", left), ("right", right)] {
        let error = largest_error(&results.channel(name, "twist_rad"), |_| twist);
        assert_below(name, error, 1e-6);
    }
}

/// A line that has been cut passes on no torque, and a winch elsewhere that numbers points anew changes nothing:
/// the body keeps the spin it had, or swings in its own line's torsion alone.
#[test]
fn torsion_ends_with_a_cut_and_survives_a_winch() {
    let scene = |more: &str, events: &str| {
        format!(
            r#"(
    name: "spun", environment: (gravity: Constant(8.87), atmosphere: Vacuum),
    entities: {{
        "anchor": (Fixed: (position_m: (0, 0, 100))),
        {more}
        "body": (
            Body: (mass_kg: 20, inertia: SolidSphere), Sphere: (radius_m: 0.5), Motion: (rate_rad_s: (0, 0, 1)),
        ),
        "line": (Tether: (
            from: ("anchor", Centre), to: ("body", Top), length_m: 10, nodes: 5, diameter_m: 0.002,
            density_kg_m3: 1440, axial_stiffness_n: 5e4, damping_n_s_m: 1, torsion: (stiffness_n_m2: 5),
        )),
    }},
    events: [{events}],
    run: (duration_s: 6, output_every_s: 1, integrator: Adaptive()),
)"#
        )
    };
    let spins = |text: &str, more: &[&str]| -> Vec<f64> {
        let results = fly(text, more);
        let rows = results.frames.iter().map(|frame| {
            let row = frame.states.iter().find(|row| &*row.entity == "body");
            row.unwrap().rotation.unwrap().1.z
        });
        rows.collect()
    };
    let cut = scene("", r#"(at_s: 2, do: Cut(tether: "line", segment: 6))"#);
    for formulation in ["run.formulation=LumpedMass", "run.formulation=Denoc"] {
        let found = spins(&cut, &[formulation]);
        for spin in &found[2..] {
            assert_below("spin after the cut", (spin - found[2]).abs(), 1e-9);
        }
    }
    let winch = r#""load": (Body: (mass_kg: 20)), "winch": (
        Tether: (
            from: ("anchor", (-5, 0, 0)), to: ("load", Centre), length_m: 10, nodes: 5, diameter_m: 0.002,
            density_kg_m3: 1440, axial_stiffness_n: 5e4, damping_n_s_m: 1,
        ),
        Winch: (stored_m: 20),
    ),"#;
    let reeled = scene(
        winch,
        r#"(at_s: 1, do: Reel(tether: "winch", rate_m_s: 1, length_m: 8))"#,
    );
    let (with, without) = (spins(&reeled, &[]), spins(&scene("", ""), &[]));
    for (with, without) in with.iter().zip(&without) {
        assert_below("spin beside a winch", (with - without).abs(), 1e-6);
    }
}
