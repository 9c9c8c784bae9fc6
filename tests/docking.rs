//! Guidance to a port: the scene of docking, what cannot be reached, and release on command.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test stops at what it does not expect"
)]

mod flight;

use aerobot::engine::plugin::Simulator;
use aerobot::engine::recording::frame::{Frame, MemorySink};
use aerobot::engine::recording::summary::Summary;
use flight::small_rotorcraft::{DENSITY, DRAG_AREA_M2, G, POSE, drone, tail, time_of};
use flight::{
    assert_below, assert_relative, channel, fly_scene, owned, run_for_summary, scene_file,
    summary_of, velocity,
};
use glam::DVec3;

/// The scene, in gusts and with errors of navigation, for a few seeds in both formulations: docked within 120 s at less
/// than 0.5 m/s, after all phases in order; from then on the tether carries more, and no energy appears.
#[test]
fn drones_dock_with_a_swinging_gondola() {
    for (seed, formulation) in [(1, "LumpedMass"), (2, "LumpedMass"), (1, "Denoc")] {
        let overrides = [
            format!("run.seed={seed}"),
            format!("run.formulation={formulation}"),
            "run.integrator=Auto(accuracy_m: 1e-3)".to_owned(),
            format!("run.{}", ENERGY_AND_DRONE.replacen(": ", "=", 1)),
        ];
        let overrides = overrides.each_ref().map(String::as_str);
        let simulator = Simulator::new();
        let scene = simulator
            .load(&scene_file("mav_dock.ron"), &owned(&overrides))
            .unwrap_or_else(|error| panic!("{error}"));
        let (results, summary) = run_for_summary(&simulator, &scene);
        let kinds: Vec<&str> = summary.events.iter().map(|event| &*event.kind).collect();
        let expected = ["approach", "station-keeping", "contact", "docked"];
        assert_eq!(kinds, expected, "seed {seed}");
        let docked_s = time_of(&summary, "docked");
        let end = results.frames.last().unwrap();
        let speed_m_s = channel(end, "drone", "contact_speed_m_s");
        println!("{formulation}, seed {seed}: docked after {docked_s} s at {speed_m_s:.3} m/s");
        assert!(docked_s < 120.0 && speed_m_s < 0.5);
        assert_eq!(channel(end, "drone", "docking_phase"), 4.0);
        let balance = |frame: &Frame| {
            channel(frame, "system", "mechanical_energy_j")
                - channel(frame, "system", "nonconservative_work_j")
        };
        let first = balance(&results.frames[0]);
        for frame in &results.frames {
            // Of 135 kJ that drag and buoyancy take once the system sinks with the drone.
            assert_below("balance, J", (balance(frame) - first).abs(), 0.1);
        }
    }
}

const ENERGY_AND_DRONE: &str = r#"record.channels: Only({
    "system": ["mechanical_energy_j", "nonconservative_work_j"],
    "drone": ["docking_phase", "contact_speed_m_s"],
})"#;

/// Two seeds are two flights, and one seed is one.
#[test]
fn errors_of_navigation_follow_from_the_seed() {
    let fly = |seed: &str| fly_scene("mav_dock.ron", &["run.duration_s=8", seed]);
    let first = fly("run.seed=5");
    assert_eq!(first.frames, fly("run.seed=5").frames);
    assert_ne!(first.frames, fly("run.seed=6").frames);
}

/// A port on an anchor that moves at `velocity`, 40 m from the drone, without a sensor in the way.
fn chase(velocity: &str, rotorcraft: &str, docking: &str, latch: &str) -> (MemorySink, Summary) {
    let drone = drone(rotorcraft, POSE);
    let text = format!(
        r#"(
    name: "chase",
    environment: (gravity: Constant({G}), atmosphere: Uniform(density_kg_m3: {DENSITY})),
    entities: {{
        "port": (
            Moving: (position_m: (40, 5, 54_000), velocity_m_s: {velocity}),
            DockingPort: (at_m: (0, 0, 0), axis: (-1, 0, 0)),
        ),
        "drone": (
            {drone}
            DockingPort: (at_m: (0.5, 0, 0), axis: (1, 0, 0)),
            Latch: (to: "port", {latch}),
            Docking: ({docking}),
        ),
    }},
    run: (duration_s: 120, output_every_s: 1, integrator: Auto(accuracy_m: 0.01)),
)"#
    );
    summary_of(&text, &[])
}

/// What can be caught is caught, and held by what moves it.
#[test]
fn a_steady_port_is_reached_and_holds_the_drone() {
    let (results, summary) = chase("(2, 1, 0)", "", "", "");
    let docked_s = time_of(&summary, "docked");
    assert!(docked_s < 60.0, "{docked_s}");
    let end = results.frames.last().unwrap();
    let moves = velocity(&results, "drone", 120.0) - DVec3::new(2.0, 1.0, 0.0);
    assert_below("against the port", moves.length(), 1e-12);
    let drag_n = 0.5 * DENSITY * DRAG_AREA_M2 * 5.0;
    let expected = drag_n.hypot(6.0 * G);
    assert_relative(
        "latch",
        channel(end, "drone", "latch_force_n"),
        expected,
        1e-9,
    );
}

/// What cannot be reached ends as a phase and as an event with its reason, a sentence in the summary, and numbers
/// that are finite: a port that is too fast, a drone that is too weak, a port out of sight, and a latch that has to be
/// nearer at one of its looks than a drone comes.
#[test]
fn what_cannot_be_reached_is_told() {
    let seeing = "navigation: Measured(period_s: 0.05, delay_s: 0.05, noise_m_per_m: 0.005, least_noise_m: 0.01, \
                  most_noise_m: 0.5, range_m: 30, observer_rad_s: 3, observer_near_m: 30)";
    for (velocity, rotorcraft, docking, latch, kind, words) in [
        (
            "(40, 0, 0)",
            "",
            "",
            "",
            "unreachable: too fast",
            "40.0 m/s",
        ),
        (
            "(0, 0, 0)",
            "thrust_coefficient: 0.002",
            "",
            "",
            "unreachable: out of thrust",
            "give 36.4 N",
        ),
        (
            "(0, 0, 0)",
            "",
            seeing,
            "",
            "unreachable: not seen",
            "range",
        ),
        (
            "(0, 0, 0)",
            "",
            "attempts: 2",
            "distance_m: 1e-5",
            "unreachable: approaches missed",
            "2 approaches",
        ),
    ] {
        let (results, summary) = chase(velocity, rotorcraft, docking, latch);
        assert!(time_of(&summary, kind) < 120.0);
        assert!(
            matches!(&summary.warnings[..], [told] if told.contains(words) && told.contains("`port`")),
            "{:?}",
            summary.warnings
        );
        assert_eq!(tail(&results, "docking_phase"), 6.0);
        assert!(!summary.events.iter().any(|event| event.kind == "docked"));
        for row in results.frames.iter().flat_map(|frame| &frame.states) {
            assert!(row.position_m.is_finite() && row.velocity_m_s.is_finite());
        }
    }
}

/// A port holds one body: the drone that comes second is told that it is taken, and does not close its latch.
#[test]
fn a_port_holds_one_drone() {
    let drone = |y_m: f64| {
        let pose = format!("Pose: (position_m: (0, {y_m}, 54_000)),");
        let drone = drone("", &pose);
        format!(
            r#"({drone} DockingPort: (at_m: (0.5, 0, 0), axis: (1, 0, 0)), Latch: (to: "port"), Docking: ())"#
        )
    };
    let text = format!(
        r#"(
    name: "two",
    environment: (gravity: Constant({G}), atmosphere: Uniform(density_kg_m3: {DENSITY})),
    entities: {{
        "port": (
            Moving: (position_m: (40, 5, 54_000), velocity_m_s: (1, 0, 0)),
            DockingPort: (at_m: (0, 0, 0), axis: (-1, 0, 0)),
        ),
        "drone": {},
        "late": {},
    }},
    run: (duration_s: 120, output_every_s: 1, integrator: Auto(accuracy_m: 0.01)),
)"#,
        drone(0.0),
        drone(150.0)
    );
    let (results, summary) = summary_of(&text, &[]);
    let of = |name: &str| {
        let mut own = summary
            .events
            .iter()
            .rev()
            .filter(|event| event.entity == name);
        own.next().map(|event| &*event.kind)
    };
    assert_eq!(of("drone"), Some("docked"));
    assert_eq!(of("late"), Some("unreachable: port taken"));
    assert_eq!(tail(&results, "docking_phase"), 4.0);
}

/// Released on command the drone backs off, keeps station in front of the port, and stays released.
#[test]
fn a_drone_is_released_on_command() {
    let overrides = [
        r#"events=[(at_s: 90, do: Undock(body: "drone"))]"#,
        "run.duration_s=115",
    ];
    let simulator = Simulator::new();
    let scene = simulator
        .load(&scene_file("mav_dock.ron"), &owned(&overrides))
        .unwrap_or_else(|error| panic!("{error}"));
    let (results, summary) = run_for_summary(&simulator, &scene);
    assert_eq!(time_of(&summary, "released"), 90.0);
    assert_eq!(tail(&results, "docking_phase"), 5.0);
    // 6 m in front, as near as the swing of the gondola after the release lets it be.
    let distance_m = tail(&results, "distance_m");
    assert!((5.0..7.0).contains(&distance_m), "{distance_m}");
    assert!(tail(&results, "thrust_n") > 45.0);
}
