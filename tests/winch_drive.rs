//! Winches that a controller or a schedule turns: closed forms of sampled loops, and the ends of the line.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test stops at what it does not expect"
)]

mod flight;

use flight::{assert_below, channel, fly, frame_at, summary_of};

/// A probe of 10 kg straight below an anchor at 1000 m on a massless line of 50 m with 60 m on its drum.
fn hanging(commanded: &str, run: &str) -> String {
    format!(
        r#"(
    name: "hanging",
    environment: (gravity: Constant(8.87), atmosphere: Vacuum),
    entities: {{
        "anchor": (Fixed: (position_m: (0, 0, 1000))),
        "probe": (Body: (mass_kg: 10)),
        "line": (
            Tether: (
                from: ("anchor", Centre), to: ("probe", Centre), length_m: 50, nodes: 0, axial_stiffness_n: 1e7,
                damping_n_s_m: 2000,
            ),
            Winch: (stored_m: 60, drive: (limit: 2)),
        ),
        "operator": ({commanded}),
    }},
    run: ({run}),
)"#
    )
}

const LOOP: &str = r#"Controller: (
    actuator: ("line", "drum"), period_s: 0.5,
    law: Proportional(measured: Altitude("probe"), target: 946, gain: -0.4),
)"#;

/// Below a held rate the error of altitude falls by 1 - K T from sample to sample: e_k = e_0 (1 - K T)^k, here 4 m
/// and 0.8. A rigid line follows to round-off, a stiff one but for its stretch and what each new rate makes it ring.
#[test]
fn an_altitude_is_held_by_its_winch() {
    let run = "duration_s: 20, output_every_s: 0.5, integrator: Auto(accuracy_m: 1e-6)";
    let text = hanging(LOOP, run);
    for (formulation, tolerance_m) in [("Denoc", 1e-9), ("LumpedMass", 5e-3)] {
        let results = fly(&text, &[&format!("run.formulation={formulation}")]);
        for sample in 0..=40 {
            let time_s = 0.5 * f64::from(sample);
            let frame = frame_at(&results, time_s);
            let probe = frame.states.iter().find(|row| &*row.entity == "probe");
            let altitude_m = probe.unwrap().position_m.z;
            let expected_m = 946.0 + 4.0 * 0.8_f64.powi(sample);
            assert_below("altitude", (altitude_m - expected_m).abs(), tolerance_m);
        }
        assert_below(
            "rate at the end",
            channel(frame_at(&results, 20.0), "line", "reel_rate_m_s").abs(),
            1e-3,
        );
    }
}

/// The command of a schedule, cut at the limit, is the rate; at the end of the line the drum stands still, is told of
/// once, and turns again when the command does.
#[test]
fn a_schedule_turns_the_drum_as_far_as_there_is_line() {
    let schedule = r#"Schedule: (
        actuator: ("line", "drum"), commands: Steps([(1, 0.5), (11, 5), (51, -1), (61, 0)]),
    )"#;
    let text = hanging(
        schedule,
        "duration_s: 70, output_every_s: 1, formulation: Denoc",
    );
    let (results, summary) = summary_of(&text, &[]);
    // 5 m by 11 s, then 2 m/s until 60 m are out at 38.5 s.
    for (time_s, out_m, rate_m_s) in [
        (0.0, 0.0, 0.0),
        (6.0, 2.5, 0.5),
        (11.0, 5.0, 2.0),
        (21.0, 25.0, 2.0),
        (45.0, 60.0, 0.0),
        (56.0, 55.0, -1.0),
        (70.0, 50.0, 0.0),
    ] {
        let frame = frame_at(&results, time_s);
        let out = channel(frame, "line", "line_out_m") - 50.0;
        assert_below("line out", (out - out_m).abs(), 1e-9);
        assert_eq!(
            channel(frame, "line", "reel_rate_m_s"),
            rate_m_s,
            "{time_s}"
        );
    }
    let told = summary
        .warnings
        .iter()
        .filter(|text| text.contains("beyond an end"));
    assert_eq!(told.count(), 1, "{:?}", summary.warnings);
}
