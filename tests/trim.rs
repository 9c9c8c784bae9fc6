//! The steady state of a scene in its wind, against closed forms, a continuous cable and balances of force
//! written apart.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod flight;

use std::f64::consts::PI;

use aerobot::engine::plugin::Simulator;
use aerobot::engine::recording::frame::MemorySink;
use aerobot::engine::trim::Trim;
use flight::{assert_below, assert_relative, load};
use glam::{DVec2, DVec3};

const G: f64 = 8.87;

fn trim(text: &str, overrides: &[&str]) -> Trim {
    let simulator = Simulator::new();
    let scene = load(&simulator, text, overrides);
    simulator
        .build(&scene)
        .and_then(|mut simulation| simulation.trim(&scene))
        .unwrap_or_else(|error| panic!("{error}"))
}

fn place(trim: &Trim, body: &str) -> DVec3 {
    trim.body(body).unwrap().position_m
}

/// A scene of these parts, run for a minute.
fn scene(environment: &str, entities: &str) -> String {
    format!(
        r#"(
            name: "trimmed", environment: ({environment}), entities: {{ {entities} }},
            run: (
                duration_s: 60, output_every_s: 10,
                integrator: Adaptive(relative_tolerance: 1e-9),
            ),
        )"#
    )
}

/// The towline of the paper (sec. 5.1) in a relative wind that grows downward to `speed_m_s`.
fn towline(nodes: u32, speed_m_s: f64) -> String {
    let area = PI * 0.05 * 0.05;
    scene(
        &format!(
            "atmosphere: Exponential(density_kg_m3: 1.594, altitude_m: 50000, scale_height_m: 7000), \
             wind: [Shear(altitude_m: 52000, gradient_per_s: {})]",
            -speed_m_s / 9700.0
        ),
        &format!(
            r#""balloon": (Fixed: (position_m: (0, 0, 52000))),
            "probe": (Body: (mass_kg: 4), Drag: Constant(coefficient: 0.47, area_m2: {area})),
            "towline": (Tether: (
                from: ("balloon", Centre), to: ("probe", Centre), length_m: 9700, nodes: {nodes},
                diameter_m: 0.00043991707, density_kg_m3: 1560, axial_stiffness_n: 27359.24,
                damping_n_s_m: 0.05, drag: (normal: 1, tangential: 0.03),
            )),"#
        ),
    )
}

/// Place of the probe and force on the top of the continuous elastic cable, from a separate program.
#[test]
fn the_towline_converges_to_the_continuous_cable() {
    for (speed_m_s, x_m, z_m, top_n, allowed_m) in [
        (5.0, 4906.649, 43_714.633, 53.4911, 0.02),
        (10.0, 6939.230, 45_413.413, 51.9502, 0.05),
    ] {
        let errors_m = [50, 100, 200].map(|nodes| {
            let found = trim(&towline(nodes, speed_m_s), &[]);
            let probe = place(&found, "probe");
            let towline = found.tether("towline").unwrap();
            let error_m = DVec2::new(probe.x - x_m, probe.z - z_m);
            let force_error_n = towline.from.force_n - top_n;
            println!(
                "{speed_m_s} m/s, {nodes} nodes: {error_m} m, {force_error_n:.2e} N at the top"
            );
            assert!(found.warnings.is_empty(), "{:?}", found.warnings);
            // Second order too, and four decimals are known.
            let allowed_n = 0.01 * (50.0 / f64::from(nodes)).powi(2) + 1e-4;
            assert!(force_error_n.abs() < allowed_n, "{force_error_n}");
            error_m
        });
        assert_below("depth at 200 nodes, m", errors_m[2].y.abs(), allowed_m);
        for pair in errors_m.windows(2) {
            let order = (pair[0].length() / pair[1].length()).log2();
            println!("order {order:.3}");
            assert!((order - 2.0).abs() < 0.1, "{order}");
        }
    }
}

/// Balloon, line and probe in an exponential atmosphere with the given wind.
fn sounding(wind: &str) -> String {
    scene(
        &format!(
            "atmosphere: Exponential(density_kg_m3: 0.8183, altitude_m: 56000, scale_height_m: 8200), \
             wind: [{wind}]"
        ),
        SOUNDING,
    )
}

const SOUNDING: &str = r#"
    "balloon": (
        Body: (mass_kg: 50, inertia: ThinSphere), Sphere: (radius: Equilibrium(altitude_m: 56000)),
        Buoyancy: (), Drag: Constant(coefficient: 0.47),
    ),
    "probe": (Body: (mass_kg: 100, inertia: Box(1, 1, 1)), Drag: Constant(coefficient: 1, area_m2: 1)),
    "line": (Tether: (
        from: ("balloon", Bottom), to: ("probe", Top), length_m: 900, nodes: 10, diameter_m: 0.002,
        density_kg_m3: 1440, axial_stiffness_n: 2e5, damping_n_s_m: 10,
        drag: (normal: 1, tangential: 0.03),
    )),
"#;

/// Nothing moves against uniform wind, and a line hangs plumb: segment i of 11 carries the probe, half a
/// segment and (11 - i) nodes, and is stretched by its tension.
#[test]
fn in_uniform_wind_it_drifts_with_the_wind_and_hangs_plumb() {
    let found = trim(&sounding("Uniform(velocity_m_s: (3, -2, 0))"), &[]);
    let system = &found.systems[0];
    assert_eq!(system.velocity_m_s, DVec3::new(3.0, -2.0, 0.0));
    assert_eq!(system.reference.as_deref(), Some("balloon"));
    let line = found.tether("line").unwrap();
    let aside = line
        .node_positions_m
        .iter()
        .map(|node| node.truncate().length());
    assert_below(
        "nodes off the plumb line, m",
        aside.fold(0.0, f64::max),
        1e-9,
    );
    let node_kg = 1440.0 * 900.0 * PI * 1e-6 / 11.0;
    let (mut stretch_m, mut top_n) = (0.0, 0.0);
    for segment in 1..=11 {
        top_n = G * (100.0 + 0.5 * node_kg + node_kg * f64::from(11 - segment));
        stretch_m += top_n * 900.0 / 11.0 / 2e5;
        if segment == 1 {
            assert_relative("tension at the top, N", line.from.tension_n, top_n, 1e-10);
        }
    }
    assert_relative("tension at the bottom, N", line.to.tension_n, top_n, 1e-10);
    let radius_m = (3.0 * (150.0 + 11.0 * node_kg) / (4.0 * PI * 0.8183)).cbrt();
    let expected_m = 56_000.0 - radius_m - 900.0 - stretch_m - 0.5;
    assert_below(
        "altitude, m",
        (place(&found, "balloon").z - 56_000.0).abs(),
        1e-7,
    );
    assert_below(
        "depth, m",
        (place(&found, "probe").z - expected_m).abs(),
        1e-7,
    );
    assert_eq!(found.body("probe").unwrap().tilt_rad, 0.0);
}

/// Two bodies of one drag area on a stiff massless line in linear shear: each has half the difference of
/// wind, and the line leans by the drag over the weight below it.
#[test]
fn two_equal_bodies_in_shear_drift_at_the_wind_midway() {
    let (shear_per_s, density) = (0.002_f64, 0.8183_f64);
    let text = scene(
        "atmosphere: Uniform(density_kg_m3: 0.8183), \
         wind: [Shear(altitude_m: 50000, gradient_per_s: 0.002), Uniform(velocity_m_s: (0, 7, 0))]",
        r#"
        "balloon": (
            Body: (mass_kg: 50), Sphere: (radius: Equilibrium(altitude_m: 56000)), Buoyancy: (),
            Drag: Constant(coefficient: 1, area_m2: 2),
        ),
        "gondola": (Body: (mass_kg: 100), Drag: Constant(coefficient: 0.5, area_m2: 4)),
        "link": (Tether: (
            from: ("balloon", Centre), to: ("gondola", Centre), length_m: 2000, nodes: 0,
            axial_stiffness_n: 1e9,
        )),"#,
    );
    let found = trim(&text, &[]);
    let (balloon, gondola) = (place(&found, "balloon"), place(&found, "gondola"));
    // By hand, with the stretch: height h = L (1 + T / EA) cos(lean), T cos(lean) = W.
    let weight_n = 100.0 * G;
    let mut height_m = 2000.0_f64;
    let mut drag_n = 0.0;
    for _ in 0..60 {
        drag_n = 0.5 * density * 2.0 * (0.5 * shear_per_s * height_m).powi(2);
        let tension_n = f64::hypot(weight_n, drag_n);
        height_m = 2000.0 * (1.0 + tension_n / 1e9) * weight_n / tension_n;
    }
    assert_below("height, m", (balloon.z - gondola.z - height_m).abs(), 1e-8);
    let behind_m = height_m * drag_n / weight_n;
    assert_below("behind, m", (balloon.x - gondola.x - behind_m).abs(), 1e-8);
    let midway_m_s = shear_per_s * (0.5 * (balloon.z + gondola.z) - 50_000.0);
    let drift = found.systems[0].velocity_m_s;
    // The round-off of an altitude is 4e-6 N of the link's tension, a part of it along the wind.
    let error_m_s = (drift - DVec3::new(midway_m_s, 7.0, 0.0)).length();
    assert_below("drift, m/s", error_m_s, 1e-8);
    let lean_rad = (drag_n / weight_n).atan();
    let line = found.tether("link").unwrap();
    assert_below(
        "lean, rad",
        (line.from.angle_from_vertical_rad - lean_rad).abs(),
        1e-11,
    );
    assert_eq!(line.from.force_n, line.to.force_n);
}

/// All outer forces on the sounding in two crossed shears, from its places and its drift alone.
#[test]
fn outer_forces_balance_in_shear() {
    let found = trim(
        &sounding(
            "Shear(altitude_m: 50000, gradient_per_s: 0.004), \
             Shear(altitude_m: 56000, gradient_per_s: 0.002, direction: (0, 1, 0))",
        ),
        &[],
    );
    let drift = found.systems[0].velocity_m_s;
    let density = |z: f64| 0.8183 * (-(z - 56_000.0) / 8200.0).exp();
    let against_air =
        |z: f64| drift - DVec3::new(0.004 * (z - 50_000.0), 0.002 * (z - 56_000.0), 0.0);
    let (balloon, probe) = (place(&found, "balloon"), place(&found, "probe"));
    let line_kg = 1440.0 * 900.0 * PI * 1e-6;
    let volume_m3 = (150.0 + line_kg) / 0.8183;
    let radius_m = (3.0 * volume_m3 / (4.0 * PI)).cbrt();
    let mut total = DVec3::Z * G * (density(balloon.z) * volume_m3 - 150.0 - line_kg);
    for (at, area) in [(balloon, 0.47 * PI * radius_m * radius_m), (probe, 1.0)] {
        let v = against_air(at.z);
        total -= 0.5 * density(at.z) * area * v.length() * v;
    }
    let line = found.tether("line").unwrap();
    let mut points = vec![line.from.position_m];
    points.extend(&line.node_positions_m);
    points.push(line.to.position_m);
    for ends in points.windows(2) {
        let (span, middle) = (ends[1] - ends[0], 0.5 * (ends[0] + ends[1]));
        let v = against_air(middle.z);
        let along = v.dot(span.normalize()) * span.normalize();
        let across = v - along;
        let drag = across.length() * across + PI * 0.03 * along.length() * along;
        total -= 0.5 * density(middle.z) * 0.002 * span.length() * drag;
    }
    println!("drift {drift}, balloon at {balloon}, probe at {probe}, sum of forces {total} N");
    assert_below("horizontal sum, N", total.truncate().length(), 1e-8);
    // The round-off of an altitude, seen through the top segment, is 3e-8 N.
    assert_below("vertical sum, N", total.z.abs(), 1e-6);
    let winds = [balloon.z, probe.z].map(|z| 0.004 * (z - 50_000.0));
    assert!(
        winds[1] < drift.x && drift.x < winds[0],
        "{winds:?} {drift}"
    );
    assert!(balloon.z > 56_000.0, "the drag of the leaning line lifts");
}

/// Runs a trimmed simulation; the largest distance in m from where the steady drift would have taken each
/// body and node.
fn straying_m(text: &str, overrides: &[&str]) -> f64 {
    let simulator = Simulator::new();
    let scene = load(&simulator, text, overrides);
    let mut simulation = simulator.build(&scene).unwrap();
    simulation.trim(&scene).unwrap();
    let mut results = MemorySink::default();
    let summary = simulation.run(&mut results, &mut |_| {});
    assert_eq!(summary.outcome, "done", "{:?}", summary.stopped);
    let first = &results.frames[0].states;
    let mut most = 0.0_f64;
    for frame in &results.frames {
        for (row, start) in frame.states.iter().zip(first) {
            let expected = start.position_m + start.velocity_m_s * frame.time_s;
            most = most.max(row.position_m.distance(expected));
        }
    }
    most
}

#[test]
fn what_is_trimmed_stays_so() {
    let towline_m = straying_m(&towline(50, 5.0), &["run.duration_s=600"]);
    assert_below("towline after 600 s, m", towline_m, 1e-6);
    let shear = "VenusZonal, Shear(altitude_m: 55000, gradient_per_s: 0.001, direction: (0, 1, 0))";
    let sounding_m = straying_m(&sounding(shear), &[]);
    assert_below("sounding in shear after 60 s, m", sounding_m, 1e-6);
}

/// Several systems in one scene have nothing to do with each other.
#[test]
fn every_system_has_its_own_drift() {
    let others = r#"
        "small": (
            Body: (mass_kg: 20), Sphere: (radius_m: 2), Buoyancy: (), Drag: Constant(coefficient: 0.47),
            Pose: (position_m: (5, 6, 50000)), Motion: (velocity_m_s: (1, 2, 3)),
        ),
        "mast": (Fixed: (position_m: (0, 0, 100))),
        "stone": (Body: (mass_kg: 5), Pose: (position_m: (30, 0, 100))),
        "rope": (Tether: (
            from: ("mast", Centre), to: ("stone", Centre), length_m: 50, nodes: 3, diameter_m: 0.01,
            density_kg_m3: 1000, axial_stiffness_n: 1e5, damping_n_s_m: 10, start: Straight,
        )),"#;
    let wind = "Shear(altitude_m: 0, gradient_per_s: 1e-3)";
    let alone = trim(&sounding(wind), &[]);
    let text = sounding(wind).replace(SOUNDING, &format!("{SOUNDING}{others}"));
    let found = trim(&text, &[]);
    assert_eq!(found.systems.len(), 3);
    let difference = found.systems[0].velocity_m_s - alone.systems[0].velocity_m_s;
    assert_below("drift beside others, m/s", difference.length(), 1e-12);
    // m = rho V: the altitude at which the small balloon floats.
    let density = 20.0 / (4.0 / 3.0 * PI * 8.0);
    let altitude_m = 56_000.0 - 8200.0 * (density / 0.8183_f64).ln();
    let small = place(&found, "small");
    assert_below("altitude, m", (small.z - altitude_m).abs(), 1e-7);
    assert_eq!(small.truncate(), DVec2::new(5.0, 6.0));
    let drift = found.systems[1].velocity_m_s;
    assert_below("its drift, m/s", (drift.x - 1e-3 * small.z).abs(), 1e-12);
    assert_eq!(found.systems[2].anchors, ["mast"]);
    assert_eq!(found.systems[2].velocity_m_s, DVec3::ZERO);
    let stone = place(&found, "stone");
    assert!(
        stone.truncate().length() < 1e-9 && stone.z < 50.0,
        "{stone}"
    );
}

/// Towed through still air and held in a wind are the same.
#[test]
fn a_steadily_moving_anchor_is_an_anchor_in_wind() {
    let hanging = |wind: &str, ship: &str| {
        let entities =
            SOUNDING.replace(r#"from: ("balloon", Bottom)"#, r#"from: ("ship", Centre)"#);
        let probe = entities.find("\"probe\"").unwrap();
        trim(
            &scene(
                &format!("wind: [{wind}]"),
                &format!("\"ship\": ({ship}), {}", &entities[probe..]),
            ),
            &[],
        )
    };
    let held = hanging(
        "Uniform(velocity_m_s: (-6, 2, 0))",
        "Fixed: (position_m: (0, 0, 56000))",
    );
    let towed = hanging(
        "",
        "Moving: (position_m: (0, 0, 56000), velocity_m_s: (6, -2, 0))",
    );
    let difference = place(&held, "probe") - place(&towed, "probe");
    assert_below("difference of places, m", difference.length(), 1e-8);
    assert_eq!(towed.systems[0].velocity_m_s, DVec3::new(6.0, -2.0, 0.0));
    assert_eq!(
        towed.body("probe").unwrap().velocity_m_s,
        DVec3::new(6.0, -2.0, 0.0)
    );
    assert_eq!(held.body("probe").unwrap().velocity_m_s, DVec3::ZERO);
}

/// A gust that blows at the start counts, one that comes later does not, and both are mentioned.
#[test]
fn gusts_count_as_they_stand_at_the_start() {
    let found = trim(
        &sounding(
            "Step(velocity_m_s: (0, 4, 0), from_s: 0, until_s: 10), \
             Step(velocity_m_s: (9, 0, 0), from_s: 20, until_s: 30)",
        ),
        &[],
    );
    assert_eq!(found.systems[0].velocity_m_s, DVec3::new(0.0, 4.0, 0.0));
    assert!(
        found.notes[0].contains("changes at 0, 10, 20, 30 s"),
        "{:?}",
        found.notes
    );
}

/// A rod on end, of one segment and of six, falls over in sqrt(l / g): no equilibrium to keep silent of.
#[test]
fn an_unstable_equilibrium_is_pointed_out() {
    for nodes in [0, 5] {
        let found = trim(
            &scene(
                "atmosphere: Vacuum",
                &format!(
                    r#""pivot": (Fixed: (position_m: (0, 0, 0))),
                    "bob": (Body: (mass_kg: 1), Pose: (position_m: (0, 0, 10))),
                    "rod": (Tether: (
                        from: ("pivot", Centre), to: ("bob", Centre), length_m: 10, nodes: {nodes},
                        diameter_m: 0.002, density_kg_m3: 1440, axial_stiffness_n: 1e4, slack: false,
                        start: Straight,
                    )),"#
                ),
            ),
            &[],
        );
        assert!(place(&found, "bob").z > 9.9);
        assert!(found.warnings[0].contains("`bob`: the equilibrium is unstable"));
        println!("{nodes} nodes: {}", found.warnings[0]);
    }
}
