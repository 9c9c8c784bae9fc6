//! Events: what is cut, released or reeled during a run, against closed forms, conserved quantities and small
//! equations integrated here.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test stops at what it does not expect"
)]

mod flight;

use aerobot::engine::recording::frame::Frame;
use flight::dumbbell::{assert_conserved, dumbbell};
use flight::{assert_below, assert_relative, channel, fly, position, summary_of, velocity};

const G: f64 = 8.87;

/// A body of 100 kg that hangs from an anchor by 200 m of line in ten segments.
fn hanging(events: &str, environment: &str, more: &str, run: &str) -> String {
    format!(
        r#"(
    name: "hanging",
    environment: (gravity: Constant({G}), atmosphere: {environment}),
    entities: {{
        "anchor": (Fixed: (position_m: (0, 0, 60_000))),
        "probe": (Body: (mass_kg: 100), {more}),
        "tether": (Tether: (
            from: ("anchor", Centre), to: ("probe", Centre), length_m: 200, nodes: 9,
            diameter_m: 0.002, density_kg_m3: 1440, axial_stiffness_n: 2e5, damping_n_s_m: 10,
        )),
    }},
    events: [{events}],
    run: ({run}),
)"#
    )
}

/// Released from rest, a body falls: v = g t without air; with drag v = v_t tanh(g t / v_t), which for the
/// sphere of `scenes/examples/free_fall.ron` is 73.39324681 m/s after 10 s (written apart).
#[test]
fn a_released_body_falls() {
    let release = "(at_s: 2, do: Release(body: \"probe\"))";
    for integrator in ["Auto()", "Implicit()", "Adaptive()", "Fixed()"] {
        let run = format!("duration_s: 5, output_every_s: 1, integrator: {integrator}");
        let results = fly(&hanging(release, "Vacuum", "", &run), &[]);
        let start = position(&results, "probe", 0.0);
        // Not the numerical error of the fall is small here, but the speed before it.
        assert_below("rest", velocity(&results, "probe", 2.0).length(), 1e-8);
        let fallen = start - position(&results, "probe", 5.0);
        let v = velocity(&results, "probe", 5.0);
        // The half segment that stays on a point falls with it.
        assert_relative(integrator, -v.z, G * 3.0, 1e-9);
        assert_relative(integrator, fallen.z, 0.5 * G * 9.0, 1e-9);
        let end = results.frames.last().unwrap();
        assert_eq!(end.segments[9].tension_n, 0.0);
        assert!(end.segments[9].length_m > 39.0);
    }
}

#[test]
fn a_released_sphere_falls_through_air() {
    let release = "(at_s: 2, do: Cut(tether: \"tether\", segment: 10))";
    // k = 1/2 rho C_d S of the falling sphere; the half segment that stays makes the mass.
    let line_kg = 1440.0 * std::f64::consts::PI * 1e-6 * 20.0;
    let body_kg = 100.0 - 0.5 * line_kg;
    let more = "Drag: Constant(coefficient: 0.47, area_m2: 0.2)";
    let text = hanging(
        release,
        "Uniform(density_kg_m3: 0.8183)",
        more,
        "duration_s: 12, output_every_s: 1, integrator: Adaptive(relative_tolerance: 1e-10)",
    )
    .replace("mass_kg: 100", &format!("mass_kg: {body_kg}"));
    let results = fly(&text, &[]);
    let k = 0.5 * 0.8183 * 0.47 * 0.2;
    let terminal = (100.0 * G / k).sqrt();
    let expected = terminal * (G * 10.0 / terminal).tanh();
    let v = velocity(&results, "probe", 12.0);
    assert_relative("speed", -v.z, expected, 1e-8);
}

/// Two bodies on a spinning taut line without weight and without air: a cut in its middle leaves momentum,
/// angular momentum and all energy but that of the cut segment.
#[test]
fn a_cut_conserves_momentum_and_angular_momentum() {
    let text = dumbbell(
        "length_m: 99.5, axial_stiffness_n: 5e3, damping_n_s_m: 5, slack: false,",
        r#"record: (channels: Only({"system": ["mechanical_energy_j", "nonconservative_work_j"]}))"#,
    );
    let (results, summary) = summary_of(&text, &[]);
    let [cut] = summary
        .events
        .iter()
        .filter(|e| e.kind == "cut")
        .collect::<Vec<_>>()[..]
    else {
        panic!("{:?}", summary.events);
    };
    assert_eq!((cut.time_s, cut.entity.as_str()), (2.5, "tether/4"));
    assert_conserved(&results, 99.5, [1e-12, 1e-10]);
    let balance = |frame: &Frame| {
        channel(frame, "system", "mechanical_energy_j")
            - channel(frame, "system", "nonconservative_work_j")
    };
    let first = balance(&results.frames[0]);
    for frame in &results.frames {
        assert_below("balance, J", (balance(frame) - first).abs(), 1e-7);
    }
    let lost = channel(
        results.frames.last().unwrap(),
        "system",
        "nonconservative_work_j",
    );
    assert!(
        lost < -1e-3,
        "the stretch of the cut segment is lost: {lost} J"
    );
}

/// A body thrown up crosses an altitude at the root of a quadratic, and a mass on a spring pulls with a given
/// tension at an instant of a cosine.
#[test]
fn conditions_are_met_when_they_should_be() {
    let text = |condition: &str, start: &str, run: &str| {
        format!(
            r#"(
    name: "condition",
    environment: (gravity: Constant({G}), atmosphere: Vacuum),
    entities: {{
        "anchor": (Fixed: (position_m: (0, 0, 1000))),
        "probe": (Body: (mass_kg: 2), Pose: (position_m: (0, 0, {start})), Motion: (velocity_m_s: (0, 0, 5))),
        "line": (Tether: (
            from: ("anchor", Centre), to: ("probe", Centre), length_m: 100, nodes: 0,
            axial_stiffness_n: 2000,
        )),
    }},
    events: [(when: {condition}, do: Cut(tether: "line"))],
    run: (duration_s: 4, output_every_s: 1, integrator: {run}),
)"#
        )
    };
    // Thrown up at 5 m/s from 950 m, slack all the way: z = 950 + 5 t - g t^2 / 2.
    let down = (5.0 + (25.0_f64 + 2.0 * G * 10.0).sqrt()) / G;
    let up = (5.0 - (25.0_f64 - 2.0 * G * 1.0).sqrt()) / G;
    for run in [
        "Auto(accuracy_m: 1e-6)",
        "Implicit(accuracy_m: 1e-6)",
        "Adaptive()",
        "Fixed(step_s: 0.05)",
    ] {
        for (condition, expected) in [
            ("AltitudeBelow(entity: \"probe\", altitude_m: 940)", down),
            ("AltitudeAbove(entity: \"probe\", altitude_m: 951)", up),
            (
                "AirspeedAbove(entity: \"probe\", airspeed_m_s: 10)",
                15.0 / G,
            ),
        ] {
            let (_, summary) = summary_of(&text(condition, "950", run), &[]);
            let event = summary.events.iter().find(|event| event.kind == "cut");
            let at_s = event.unwrap().time_s;
            println!("{run}, {condition}: {at_s} s, expected {expected} s");
            // Known to 1e-6 s, and never early.
            assert!(
                at_s > expected - 2e-7 && at_s < expected + 2e-6,
                "{at_s} {expected}"
            );
        }
    }
}

/// A mass falls from where its massless line is just taut: T = m g (1 - cos w t) reaches 1.5 m g when
/// w t = 2 pi / 3.
#[test]
fn a_line_is_cut_at_its_tension() {
    let text = format!(
        r#"(
    name: "overload",
    environment: (gravity: Constant({G}), atmosphere: Vacuum),
    entities: {{
        "anchor": (Fixed: (position_m: (0, 0, 1000))),
        "probe": (Body: (mass_kg: 2), Pose: (position_m: (0, 0, 900))),
        "line": (Tether: (
            from: ("anchor", Centre), to: ("probe", Centre), length_m: 100, nodes: 0,
            axial_stiffness_n: 2000, slack: false,
        )),
    }},
    events: [(when: TensionAbove(tether: "line", tension_n: {}), do: Cut(tether: "line"))],
    run: (duration_s: 2, output_every_s: 1, integrator: Adaptive(relative_tolerance: 1e-10)),
)"#,
        1.5 * 2.0 * G
    );
    let (_, summary) = summary_of(&text, &[]);
    let at_s = summary.events[0].time_s;
    let expected = 2.0 * std::f64::consts::PI / 3.0 / 10.0_f64.sqrt();
    assert!(
        at_s > expected - 2e-7 && at_s < expected + 2e-6,
        "{at_s} {expected}"
    );
}

#[test]
fn events_happen_the_same_way_twice() {
    let events = "(at_s: 1.3, do: Cut(tether: \"tether\", segment: 4)), \
                  (when: AltitudeBelow(entity: \"probe\", altitude_m: 59_790), do: Release(body: \"probe\"))";
    let text = hanging(events, "Vira", "", "duration_s: 4, output_every_s: 0.5");
    let (first, summary) = summary_of(&text, &[]);
    let (second, again) = summary_of(&text, &[]);
    assert_eq!(first.frames, second.frames);
    assert_eq!(summary.events, again.events);
    let kinds: Vec<&str> = summary
        .events
        .iter()
        .map(|event| event.kind.as_str())
        .collect();
    assert!(kinds.contains(&"release"), "{kinds:?}");
}

/// What would come after the end is said before the run.
#[test]
fn an_event_after_the_end_is_told() {
    let cut = "(at_s: 7, do: Cut(tether: \"tether\"))";
    let (_, summary) = summary_of(
        &hanging(cut, "Vacuum", "", "duration_s: 2, output_every_s: 1"),
        &[],
    );
    assert_eq!(
        summary.warnings,
        ["`events.0` is to happen at 7 s, and the run ends at 2 s"]
    );
    assert!(summary.events.is_empty());
}
