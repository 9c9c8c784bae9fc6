//! Optima of design searches that are known in closed form, or found by other means.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod program;

use std::fs;

use program::searches::{GUSTS, THROW, Table, optimised};
use program::{Scratch, aerobot, text};

/// A point of 1 kg that falls into a line without damping or mass, of 10 m.
const BOUNCE: &str = r#"(
    name: "bounce",
    environment: (gravity: Constant(8.87), atmosphere: Vacuum),
    entities: {
        "pivot": (Fixed: (position_m: (0, 0, 0))),
        "bob": (Body: (mass_kg: 1), Pose: (position_m: (0, 0, -10))),
        "line": (Tether: (
            from: ("pivot", Centre), to: ("bob", Centre), length_m: 10, nodes: 0, axial_stiffness_n: 1e4,
        )),
    },
    run: (duration_s: 0.3, output_every_s: 0.0005, integrator: Adaptive(relative_tolerance: 1e-10)),
)
"#;

/// Farthest throw with a given energy that is back at its height after 10 s: v_z = g t / 2, and v_x has what is left.
#[test]
fn the_farthest_throw_in_closed_form() {
    let scratch = Scratch::folder();
    let best = optimised(
        &scratch,
        THROW,
        r#"
        variables: {
            "entities.ball.Motion.velocity_m_s.0": (from: 0, to: 200),
            "entities.ball.Motion.velocity_m_s.2": (from: 0, to: 200),
        },
        objective: Maximise(Value("range_x_m")),
        constraints: {
            "height_z_m": (of: Value("height_z_m"), at_least: 0),
            "energy_j": (of: Value("energy_j"), at_most: 6400),
        },
        metrics: {
            "range_x_m": Final(entity: "ball", channel: "x_m"),
            "height_z_m": Final(entity: "ball", channel: "z_m"),
            "energy_j": Largest(entity: "system", channel: "kinetic_energy_j"),
        },
        search: (tolerance: 1e-6),"#,
    );
    let up = 0.5 * 8.87 * 10.0;
    let along = libm::sqrt(6400.0 - up * up);
    let found = best.objective();
    assert!(
        (found / (10.0 * along) - 1.0).abs() < 1e-4,
        "{found} {}",
        10.0 * along
    );
    let found = best.named("variables", "entities.ball.Motion.velocity_m_s.2");
    assert!((found / up - 1.0).abs() < 1e-4, "{found} {up}");
    // The scene of the best design is that flight.
    let run = scratch.path("run");
    let output = aerobot(&["run", &scratch.path("out/best.ron"), "--out", &run]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let states = Table::read(&format!("{run}/states.csv"));
    assert_eq!(states.numbers("x_m").last(), Some(&best.objective()));
}

/// What falls into a spring without loss stretches it by 2 m g L / EA: the softest line that lets it fall 20 mm.
#[test]
fn the_softest_line_in_closed_form() {
    let scratch = Scratch::folder();
    let best = optimised(
        &scratch,
        BOUNCE,
        r#"
        variables: {"entities.line.Tether.axial_stiffness_n": (from: 100, to: 1e6, scale: Log)},
        objective: Minimise(Variable("entities.line.Tether.axial_stiffness_n")),
        constraints: {"lowest_z_m": (of: Value("lowest_z_m"), at_least: -10.02)},
        metrics: {"lowest_z_m": Smallest(entity: "bob", channel: "z_m")},
        search: (tolerance: 1e-7),"#,
    );
    let stiffness_n = 2.0 * 8.87 * 10.0 / 0.02;
    // Rows every 0.0005 s miss the lowest place by 1e-5 of the stretch at most; the tolerance is 1e-6 of the value.
    let error = best.objective() / stiffness_n - 1.0;
    assert!(error.abs() < 5e-5, "{error}");
    let lowest_m = best.named("constraints", "lowest_z_m");
    assert!((-10.02..-10.0199).contains(&lowest_m), "{lowest_m}");
}

/// (v^2 + c^2 / v^2) is least where v = sqrt(c): inside of the bounds, with a law of power -1; and of whole v at the
/// best of its neighbours.
#[test]
fn an_optimum_inside_and_one_of_whole_numbers() {
    for (integer, at) in [("false", libm::sqrt(1400.0)), ("true", 37.0)] {
        let scratch = Scratch::folder();
        let best = optimised(
            &scratch,
            THROW,
            &format!(
                r#"
                variables: {{
                    "speed_m_s": (from: 1, to: 100, integer: {integer}, start: 90, sets: {{
                        "entities.ball.Motion.velocity_m_s.0": (),
                        "entities.ball.Motion.velocity_m_s.1": (factor: 1400, power: -1),
                    }}),
                }},
                set: {{"run.duration_s": 0.1, "entities.ball.Motion.velocity_m_s.2": 0}},
                objective: Minimise(Value("energy_j")),
                metrics: {{"energy_j": Smallest(entity: "system", channel: "kinetic_energy_j")}},
                "#
            ),
        );
        let found = best.named("variables", "speed_m_s");
        // A valley is flat at its floor: 1e-3 of the value is 4e-6 of what is to be least.
        assert!((found / at - 1.0).abs() < 2e-3, "{found} {at}");
        let energy = at * at + 1400.0 * 1400.0 / at / at;
        assert!((best.objective() / energy - 1.0).abs() < 1e-5);
    }
}

/// The percentile of the same flights, by a campaign and by hand.
fn swing_90_rad(scratch: &Scratch, length_m: f64) -> f64 {
    let campaign = format!(
        r#"(name: "flights", scene: "scene.ron", runs: 12, seed: 3,
            set: {{"run.duration_s": 8, "entities.tether.Tether.nodes": 1, "entities.tether.Tether.length_m": {length_m:?}}},
            metrics: {{"swing_rad": Largest(entity: "gondola", channel: "swing_rad")}})"#
    );
    let file = scratch.file("flights.ron", &campaign);
    let out = scratch.path(&format!("flights-{length_m}"));
    let output = aerobot(&["campaign", "run", &file, "--out", &out]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let mut swings = Table::read(&format!("{out}/runs.csv")).numbers("swing_rad");
    swings.sort_by(f64::total_cmp);
    // 0.9 x 11 = 9.9.
    swings[9] + 0.9 * (swings[10] - swings[9])
}

/// At the optimum the percentile is the limit; a grid over all lengths has its shortest just beyond; and the mass
/// is that of a cylinder.
#[test]
fn gusts_by_a_campaign_and_by_a_grid() {
    let scratch = Scratch::folder();
    let scene = fs::read_to_string("scenes/gust_response.ron").unwrap();
    let best = optimised(&scratch, &scene, GUSTS);
    let length_m = best.named("variables", "entities.tether.Tether.length_m");
    let swing_rad = best.named("constraints", "swing_90_rad");
    let again_rad = swing_90_rad(&scratch, length_m);
    assert!(
        (swing_rad / again_rad - 1.0).abs() < 1e-12,
        "{swing_rad} {again_rad}"
    );
    assert!(
        swing_rad <= 0.008 && swing_rad > 0.008 * 0.999,
        "{swing_rad}"
    );
    let mass_kg = 1440.0 * std::f64::consts::PI * 0.25 * 0.002 * 0.002 * length_m;
    assert!((best.objective() / mass_kg - 1.0).abs() < 1e-12);
    let grid = (0..=18).map(|k| 100.0 + 50.0 * f64::from(k));
    let kept = grid
        .into_iter()
        .find(|length_m| swing_90_rad(&scratch, *length_m) <= 0.008);
    let shortest_m = kept.unwrap();
    assert!(
        shortest_m >= length_m && shortest_m - length_m <= 50.0,
        "{shortest_m} {length_m}"
    );
}
