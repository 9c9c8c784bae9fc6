//! Animations of short runs against what geometry says of them.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test that cannot go on fails"
)]

use std::path::Path;

use aerobot_engine::plugin::Simulator;
use glam::DVec3;

use super::{Animation, TetherMotion};
use crate::record::{Record, Tables};

/// Runs a scene and keeps what it records.
fn flown(scene: &str) -> Animation {
    let simulator = Simulator::new();
    let scene = simulator.load_text("test", scene.to_owned(), Path::new("."), &[]);
    let scene = scene.unwrap();
    let geometry = simulator.geometry(&scene).unwrap();
    let mut tables = Tables::default();
    let mut simulation = simulator.build(&scene).unwrap();
    let summary = simulation.run(&mut tables, &mut |_| ());
    let record = Record {
        label: "test".into(),
        scene,
        geometry,
        summary,
        timing: None,
        tables,
    };
    Animation::of(&record, 1000)
}

/// The longest of the segments that are there in a frame, m.
fn longest_m(tether: &TetherMotion, frame: usize) -> f64 {
    let points = &tether.points_m[frame];
    let tensions = tether.tensions_n[frame].iter().enumerate();
    tensions
        .filter(|(_, tension)| tension.is_some())
        .map(|(index, _)| points[index].distance(points[index + 1]))
        .fold(0.0, f64::max)
}

/// A body that falls and turns on a line too long to pull: an attachment on its x axis, 1 m out, turns with
/// it, from where a yaw of a right angle has brought it.
#[test]
fn an_attachment_turns_with_its_body() {
    let animation = flown(
        r#"(
        name: "turning", environment: (gravity: Constant(8.87), atmosphere: Vacuum),
        entities: {
            "top": (Fixed: (position_m: (0, 0, 100))),
            "body": (
                Body: (mass_kg: 5, inertia: Box(1, 1, 1)),
                Pose: (position_m: (0, 0, 90), attitude: YawPitchRoll(yaw_rad: 1.5707963267948966, pitch_rad: 0, roll_rad: 0)),
                Motion: (rate_rad_s: (0, 0, 0.5)),
            ),
            "line": (Tether: (
                from: ("body", (1, 0, 0)), to: ("top", Centre), length_m: 200, nodes: 0, diameter_m: 0.001,
                density_kg_m3: 0, axial_stiffness_n: 1e4, damping_n_s_m: 1, start: Straight,
            )),
        },
        run: (duration_s: 2, output_every_s: 0.25, integrator: Fixed(step_s: 0.01)),
    )"#,
    );
    let body = animation.bodies.iter().find(|body| body.name == "body");
    let body = body.expect("the body is shown");
    let line = &animation.tethers[0];
    assert_eq!(animation.times_s.len(), 9);
    for (frame, time_s) in animation.times_s.iter().enumerate() {
        let angle = std::f64::consts::FRAC_PI_2 + 0.5 * time_s;
        let expected = DVec3::new(libm::cos(angle), libm::sin(angle), 0.0);
        let found = line.points_m[frame][0] - body.positions_m[frame];
        assert!(found.distance(expected) < 1e-6, "{time_s} s: {found}");
        assert_eq!(line.points_m[frame][1], DVec3::new(0.0, 0.0, 100.0));
        assert_eq!(line.tensions_n[frame], [Some(0.0)]);
    }
}

/// A line that is cut in the middle: both of its parts stay on their bodies, and nothing is drawn between them.
#[test]
fn a_cut_segment_is_not_there() {
    let animation = flown(
        r#"(
        name: "cut", environment: (gravity: Constant(8.87), atmosphere: Vacuum),
        entities: {
            "top": (Fixed: (position_m: (0, 0, 100))),
            "body": (Body: (mass_kg: 5, inertia: Box(1, 1, 1))),
            "line": (Tether: (
                from: ("top", Centre), to: ("body", Top), length_m: 20, nodes: 3, diameter_m: 0.002,
                density_kg_m3: 1440, axial_stiffness_n: 1e4, damping_n_s_m: 10,
            )),
        },
        events: [(at_s: 0.5, do: Cut(tether: "line", segment: 2))],
        run: (duration_s: 2, output_every_s: 0.25),
    )"#,
    );
    let body = animation.bodies.iter().find(|body| body.name == "body");
    let body = body.expect("the body is shown");
    let line = &animation.tethers[0];
    for (frame, time_s) in animation.times_s.iter().enumerate() {
        let there: Vec<bool> = line.tensions_n[frame].iter().map(Option::is_some).collect();
        assert_eq!(there, [true, *time_s < 0.5, true, true], "{time_s} s");
        assert_eq!(line.points_m[frame][0], DVec3::new(0.0, 0.0, 100.0));
        let top = body.positions_m[frame] + body.attitudes[frame] * DVec3::new(0.0, 0.0, 0.5);
        assert!(line.points_m[frame][4].distance(top) < 1e-9);
        assert!(longest_m(line, frame) < 6.0, "{time_s} s");
    }
    let last = line.points_m.last().expect("there are frames");
    assert!(last[1].distance(last[2]) > 10.0);
}

/// A winch goes on to pay out line after its probe was released: its segments are numbered anew, and no line
/// is drawn to the probe that falls away.
#[test]
fn a_released_probe_leaves_its_line() {
    let animation = flown(
        r#"(
        name: "released", environment: (gravity: Constant(8.87), atmosphere: Vacuum),
        entities: {
            "top": (Fixed: (position_m: (0, 0, 1000))),
            "probe": (Body: (mass_kg: 10, inertia: Box(1, 1, 1))),
            "line": (
                Tether: (
                    from: ("top", Centre), to: ("probe", Top), length_m: 20, nodes: 3, diameter_m: 0.002,
                    density_kg_m3: 1440, axial_stiffness_n: 5e4, damping_n_s_m: 5,
                ),
                Winch: (end: From, stored_m: 60),
            ),
        },
        events: [
            (at_s: 1, do: Reel(tether: "line", rate_m_s: 4, length_m: 60)),
            (at_s: 3.1, do: Release(body: "probe")),
        ],
        run: (duration_s: 8, output_every_s: 0.5),
    )"#,
    );
    let probe = animation.bodies.iter().find(|body| body.name == "probe");
    let probe = probe.expect("the probe is shown");
    let line = &animation.tethers[0];
    let most = |frame: usize| line.tensions_n[frame].iter().flatten().count();
    let last = animation.times_s.len() - 1;
    assert!(most(last) > most(0), "line was paid out");
    for (frame, time_s) in animation.times_s.iter().enumerate() {
        // Segments of 5 m; the one at the winch is divided before it is twice as long.
        assert!(longest_m(line, frame) < 10.5, "{time_s} s");
        let end = line.points_m[frame].last().expect("a line has points");
        let apart_m = end.distance(probe.positions_m[frame]);
        assert_eq!(apart_m > 0.6, *time_s > 3.2, "{time_s} s: {apart_m} m");
    }
}
