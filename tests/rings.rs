//! Rings of equal tethers: the same as tethers written one by one, at rest where statics by hand puts them.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod flight;
mod program;

use std::fs;

use aerobot::components::state::{Acceleration, AngularAcceleration};
use aerobot::engine::plugin::Simulator;
use aerobot::engine::trim::Trim;
use flight::{assert_below, assert_relative, load};
use glam::DVec3;
use program::{Scratch, aerobot, text};

const G: f64 = 8.87;

/// A hollow cylinder of 20 kg (paper, sec. 4.4) under an anchor, with these lines between.
fn hanging(anchor: &str, lines: &str) -> String {
    format!(
        r#"(
            name: "ring", environment: (atmosphere: Vacuum),
            entities: {{
                "anchor": (Fixed: (position_m: (0, 0, 0) {anchor})),
                "body": (
                    Body: (mass_kg: 20, inertia: HollowCylinder(
                        outer_radius_m: 2.1, inner_radius_m: 1.3, height_m: 0.2,
                    )),
                    Motion: (rate_rad_s: (0, 0, 0.1)),
                ),
                {lines}
            }},
            run: (duration_s: 2, output_every_s: 0.5, record: (channels: All)),
        )"#
    )
}

/// A ring of lines of 10 m and EA 50 kN.
fn ring(count: u32, radii_m: [f64; 2], line: &str) -> String {
    let [from_m, to_m] = radii_m;
    format!(
        r#""suspension": (Tethers: (
            count: {count}, from_radius_m: {from_m}, to_radius_m: {to_m},
            from: ("anchor", Centre), to: ("body", Top), length_m: 10, axial_stiffness_n: 5e4, {line}
        )),"#
    )
}

const MASSLESS: &str = "nodes: 0";
/// 0.05 kg each.
const HEAVY: &str = "nodes: 5, diameter_m: 0.0021026, density_kg_m3: 1440, damping_n_s_m: 1";
const HEAVY_KG: f64 = 1440.0 * 10.0 * std::f64::consts::PI * 0.0010513 * 0.0010513;

fn trim(text: &str) -> Trim {
    let simulator = Simulator::new();
    let scene = load(&simulator, text, &[]);
    let mut simulation = simulator.build(&scene).unwrap_or_else(|e| panic!("{e}"));
    simulation.trim(&scene).unwrap_or_else(|e| panic!("{e}"))
}

/// Where the body stands when the scene is built, and how far its x axis has turned, m and rad.
fn start(text: &str) -> (DVec3, f64) {
    let sink = flight::fly(text, &["run.duration_s=0.5"]);
    let row = sink.frames[0]
        .states
        .iter()
        .find(|row| &*row.entity == "body");
    let row = row.unwrap();
    let x = row.rotation.unwrap().0 * DVec3::X;
    (row.position_m, x.y.atan2(x.x))
}

#[test]
fn a_ring_is_the_tethers_that_it_stands_for() {
    let scratch = Scratch::folder();
    let line = format!("{HEAVY}, drag: (normal: 1, tangential: 0.03)");
    let mut written_out = String::new();
    for number in 1..=3 {
        let angle_rad = (120.0 * f64::from(number - 1)).to_radians();
        let (x, y) = (libm::cos(angle_rad), libm::sin(angle_rad));
        written_out.push_str(&format!(
            r#""suspension/{number}": (Tether: (
                from: ("anchor", ({x}, {y}, 0)), to: ("body", ({}, {}, 0.1)),
                length_m: 10, axial_stiffness_n: 5e4, {line}
            )),"#,
            0.5 * x,
            0.5 * y
        ));
    }
    let texts = [ring(3, [1.0, 0.5], &line), written_out];
    let folders = texts.map(|lines| {
        let name = format!("of_{}", lines.len());
        let scene = scratch.file(&format!("{name}.ron"), &hanging("", &lines));
        let folder = scratch.path(&name);
        let run = aerobot(&["run", &scene, "--out", &folder]);
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        folder
    });
    for file in ["states.csv", "tethers.csv", "channels.csv", "summary.json"] {
        let [of_ring, of_tethers] = folders
            .each_ref()
            .map(|folder| fs::read_to_string(format!("{folder}/{file}")).unwrap());
        assert!(of_ring.contains("suspension/3"), "{file}");
        assert_eq!(of_ring, of_tethers, "{file}");
    }
}

/// n lines share the weight: each is stretched by (m g / n + w / 2) L / EA, w its own weight.
#[test]
fn a_body_hangs_at_the_stretch_of_its_share() {
    for count in [2, 3, 4, 6] {
        for (line, line_kg) in [(MASSLESS, 0.0), (HEAVY, HEAVY_KG)] {
            let (place, turn_rad) = start(&hanging("", &ring(count, [1.0, 1.0], line)));
            let share_n = 20.0 * G / f64::from(count) + 0.5 * line_kg * G;
            let expected = DVec3::new(0.0, 0.0, -10.0 * (1.0 + share_n / 5e4) - 0.1);
            assert_below("place, m", (place - expected).length(), 1e-9);
            assert_below("turn, rad", turn_rad.abs(), 1e-9);
        }
    }
}

/// Springs from a circle of 2 m to one of 0.5 m: n EA (l/L - 1) h/l = m g at the height h, l^2 = h^2 + 1.5^2.
#[test]
fn a_cone_of_lines_hangs_where_their_vertical_parts_carry_the_weight() {
    for (count, radii_m) in [(3, [2.0, 0.5]), (4, [0.5, 2.0]), (6, [2.0, 0.5])] {
        let (place, turn_rad) = start(&hanging("", &ring(count, radii_m, MASSLESS)));
        let (mut low, mut high) = (9.0_f64, 11.0_f64);
        for _ in 0..100 {
            let h = 0.5 * (low + high);
            let l = h.hypot(1.5);
            let lift_n = f64::from(count) * 5e4 * (l / 10.0 - 1.0) * h / l;
            if lift_n < 20.0 * G {
                low = h;
            } else {
                high = h;
            }
        }
        assert_relative("height, m", -place.z - 0.1, low, 1e-9);
        assert_below("off the axis, m", place.truncate().length(), 1e-9);
        assert_below("turn, rad", turn_rad.abs(), 1e-9);
    }
}

/// Whatever the heading of the upper circle, the lower one comes to rest below it.
#[test]
fn a_ring_at_rest_has_no_twist() {
    for count in [2, 3, 4] {
        for turn_rad in [-1.2, 0.4, 2.9] {
            let anchor = format!(", attitude: AxisAngle(axis: (0, 0, 1), angle_rad: {turn_rad})");
            let lines = ring(count, [1.0, 1.0], HEAVY);
            let (_, found_rad) = start(&hanging(&anchor, &lines));
            assert_below("twist, rad", (found_rad - turn_rad).abs(), 1e-8);
        }
    }
}

#[test]
fn a_body_starts_to_turn_while_the_nodes_are_at_rest() {
    let sink = flight::fly(&hanging("", &ring(3, [1.0, 1.0], HEAVY)), &[]);
    let mut nodes = 0;
    for row in &sink.frames[0].states {
        match row.rotation {
            Some((_, rate)) if &*row.entity == "body" => {
                assert_eq!(rate, DVec3::new(0.0, 0.0, 0.1));
            }
            _ => nodes += 1,
        }
        assert_eq!(row.velocity_m_s, DVec3::ZERO, "{}", row.entity);
    }
    assert_eq!(nodes, 16);
}

/// A balloon, a ring below it and a gondola, in this wind.
fn ballooning(count: u32, wind: &str) -> String {
    format!(
        r#"(
            name: "ballooning", environment: (atmosphere: Vira, wind: [{wind}]),
            entities: {{
                "balloon": (
                    Body: (mass_kg: 50, inertia: ThinSphere),
                    Sphere: (radius: Equilibrium(altitude_m: 55000)), Buoyancy: (),
                    Drag: Constant(coefficient: 0.47),
                ),
                "gondola": (
                    Body: (mass_kg: 100, inertia: Box(1, 1, 1)),
                    Drag: Constant(coefficient: 1, area_m2: 1),
                ),
                // what carries it
                "suspension": (Tethers: (
                    count: {count}, from_radius_m: 1.5, to_radius_m: 0.5, first_angle_deg: 15,
                    from: ("balloon", Bottom), to: ("gondola", Top), length_m: 30, nodes: 3,
                    diameter_m: 0.002, density_kg_m3: 1440, axial_stiffness_n: 2e5, damping_n_s_m: 10,
                    drag: (normal: 1, tangential: 0.03),
                )),
            }},
            run: (duration_s: 10, output_every_s: 5),
        )"#
    )
}

/// What the round-off of positions, 7e-12 m at 55 km, makes of the stiffness of a segment on a node, m/s^2;
/// four of these come together at most.
fn round_off_m_s2() -> f64 {
    let node_kg = 1440.0 * 30.0 / 4.0 * std::f64::consts::PI * 0.001 * 0.001;
    4.0 * (55_000.0_f64.next_up() - 55_000.0) * (2e5 / 7.5) / node_kg
}

/// The largest acceleration of anything at the start of a scene, m/s^2 and rad/s^2.
fn acceleration_at_start(text: &str) -> f64 {
    let simulator = Simulator::new();
    let scene = load(&simulator, text, &[]);
    let mut simulation = simulator.build(&scene).unwrap_or_else(|e| panic!("{e}"));
    simulation.evaluate(1).unwrap();
    let entities = simulation.world().iter_entities();
    entities
        .flat_map(|entity| {
            let linear = entity.get::<Acceleration>().map(|a| a.0.length());
            let angular = entity.get::<AngularAcceleration>().map(|a| a.0.length());
            [linear, angular]
        })
        .flatten()
        .fold(0.0, f64::max)
}

#[test]
fn a_gondola_under_a_balloon_starts_at_rest() {
    for count in [2, 3, 4, 6] {
        let left = acceleration_at_start(&ballooning(count, ""));
        assert_below("acceleration at the start", left, round_off_m_s2());
    }
}

/// A tethered balloon above an anchor on the ground, its ring below it: the lift that is left is shared.
#[test]
fn a_balloon_stands_above_a_ring() {
    let scene = r#"(
        name: "moored", environment: (atmosphere: Uniform(density_kg_m3: 1)),
        entities: {
            "mast": (Fixed: (position_m: (0, 0, 0))),
            "body": (
                Body: (mass_kg: 5, inertia: ThinSphere), Sphere: (radius_m: 2), Buoyancy: (),
            ),
            "mooring": (Tethers: (
                count: 3, from_radius_m: 1, to_radius_m: 1, from: ("mast", Centre),
                to: ("body", Bottom), length_m: 20, nodes: 0, axial_stiffness_n: 1e4,
            )),
        },
        run: (duration_s: 2, output_every_s: 0.5),
    )"#;
    let (place, _) = start(scene);
    let volume_m3 = 4.0 / 3.0 * std::f64::consts::PI * 8.0;
    let share_n = (volume_m3 - 5.0) * G / 3.0;
    let expected = DVec3::new(0.0, 0.0, 20.0 * (1.0 + share_n / 1e4) + 2.0);
    assert_below("place, m", (place - expected).length(), 1e-9);
}

#[test]
fn a_trimmed_ring_is_a_ring_that_starts_at_rest() {
    let scratch = Scratch::folder();
    let wind = "Uniform(velocity_m_s: (3, 1, 0)), Shear(altitude_m: 55000, gradient_per_s: 0.02)";
    let scene = scratch.file("scene.ron", &ballooning(3, wind));
    let trimmed = scratch.path("trimmed.ron");
    let trim = aerobot(&["trim", &scene, "--out", &trimmed]);
    assert_eq!(trim.status.code(), Some(0), "{}", text(&trim.stderr));
    let written = fs::read_to_string(&trimmed).unwrap();
    assert!(written.contains("start: Each([[") && written.contains("// what carries it"));
    assert_eq!(written.matches("Motion: (velocity_m_s").count(), 3);
    let before = acceleration_at_start(&fs::read_to_string(&scene).unwrap());
    let left = acceleration_at_start(&written);
    assert!(before > 1e-3, "{before}");
    assert_below("acceleration at the start", left, round_off_m_s2());
}

/// The three lines of a symmetric ring carry the same, which is told of each by its name.
#[test]
fn the_tethers_of_a_ring_share_the_load() {
    let found = trim(&ballooning(3, ""));
    let forces_n: Vec<f64> = (1..=3)
        .map(|number| {
            found
                .tether(&format!("suspension/{number}"))
                .unwrap()
                .to
                .force_n
        })
        .collect();
    // Vertical parts carry the gondola: the lines lean by 1 m on their length and stretch.
    let length_m = 30.0 * (1.0 + forces_n[0] / 2e5);
    let share_n = 100.0 * G / 3.0 / (1.0 - (1.0 / length_m).powi(2)).sqrt();
    for force_n in &forces_n {
        // The sag of the lines turns their ends by less than a thousandth.
        assert_relative("force on the gondola, N", *force_n, share_n, 1e-3);
        assert_relative("the same on each, N", *force_n, forces_n[0], 1e-9);
    }
}

#[test]
fn what_is_recorded_of_a_ring_is_recorded_of_each_tether() {
    let scene = hanging("", &ring(3, [1.0, 1.0], HEAVY));
    let channels = "run.record.channels=Only({\"suspension\": [\"tension_to_n\"]})";
    let sink = flight::fly(&scene, &[channels]);
    let rows = &sink.frames[0].channels;
    let names: Vec<&str> = rows.iter().map(|row| &*row.entity).collect();
    assert_eq!(names, ["suspension/1", "suspension/2", "suspension/3"]);
    let four = "entities.suspension.Tethers.count=4";
    let sink = flight::fly(&scene, &[channels, four]);
    assert_eq!(sink.frames[0].channels.len(), 4);
}
