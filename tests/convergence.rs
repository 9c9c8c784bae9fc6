//! Orders of convergence: of the integrators in the step, of the lumpings in the number of nodes.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod flight;

use aerobot::engine::plugin::Simulator;
use flight::{fly, load};
use glam::DVec3;

/// A spinning body on an elastic tether of three nodes, in air that shears: smooth, and everything
/// takes part (springs, dampers, drag, buoyancy, added mass, rotation, offsets).
const SMOOTH: &str = r#"(
    name: "smooth",
    environment: (
        atmosphere: Exponential(density_kg_m3: 1.2, altitude_m: 0, scale_height_m: 8000),
        wind: [Shear(altitude_m: 0, gradient_per_s: 0.05)],
    ),
    entities: {
        "anchor": (Moving: (position_m: (0, 0, 0), amplitude_m: (0.3, 0, 0.1), frequency_rad_s: 2)),
        "body": (
            Body: (mass_kg: 2, inertia: Box(0.4, 0.6, 0.8)),
            Pose: (position_m: (3, 0, -9.6), attitude: YawPitchRoll(yaw_rad: 0.3, pitch_rad: -0.4, roll_rad: 0.2)),
            Motion: (velocity_m_s: (0, 2, 0), rate_rad_s: (0.5, 0.3, 1.5)),
            Sphere: (radius_m: 0.4), Buoyancy: (), AddedMass: (),
            Drag: Constant(coefficient: 0.47),
        ),
        "tether": (Tether: (
            from: ("anchor", Centre), to: ("body", (0.1, 0.05, 0.4)),
            length_m: 9.4, nodes: 3, diameter_m: 0.01, density_kg_m3: 1400,
            axial_stiffness_n: 4000, damping_n_s_m: 2, slack: false, start: Straight,
            drag: (normal: 1, tangential: 0.03),
        )),
    },
    run: (duration_s: 2, output_every_s: 2, integrator: Adaptive(relative_tolerance: 1e-13)),
)"#;

fn end(integrator: &str) -> (DVec3, DVec3) {
    let results = fly(SMOOTH, &[&format!("run.integrator={integrator}")]);
    let (_, row) = results.states("body").last().unwrap();
    (row.position_m, row.rotation.unwrap().1)
}

fn error(found: (DVec3, DVec3), exact: (DVec3, DVec3)) -> f64 {
    found.0.distance(exact.0).max(found.1.distance(exact.1))
}

/// log2 of the ratio of errors at a step and at half of it.
fn orders(integrator: impl Fn(f64) -> String, steps: &[f64]) -> Vec<f64> {
    let exact = end("Adaptive(relative_tolerance: 1e-14)");
    let errors: Vec<f64> = steps
        .iter()
        .map(|step| error(end(&integrator(*step)), exact))
        .collect();
    println!("errors {errors:?}");
    errors
        .windows(2)
        .map(|pair| (pair[0] / pair[1]).log2())
        .collect()
}

#[test]
fn runge_kutta_is_of_fourth_order() {
    let orders = orders(
        |step| format!("Fixed(step_s: {step})"),
        &[0.004, 0.002, 0.001],
    );
    println!("RK4: {orders:?}");
    assert!(
        orders.iter().all(|order| (order - 4.0).abs() < 0.15),
        "{orders:?}"
    );
}

/// A tolerance that accepts every step leaves the longest step in charge.
#[test]
fn dormand_prince_is_of_fifth_order() {
    let orders = orders(
        |step| format!("Adaptive(relative_tolerance: 0.9, longest_step_s: {step})"),
        &[0.008, 0.004, 0.002],
    );
    println!("Dormand-Prince: {orders:?}");
    assert!(
        orders.iter().all(|order| (order - 5.0).abs() < 0.25),
        "{orders:?}"
    );
}

/// The error of the adaptive method follows the tolerance it is given.
#[test]
fn the_error_follows_the_tolerance() {
    let exact = end("Adaptive(relative_tolerance: 1e-14)");
    for tolerance in [1e-5, 1e-7, 1e-9, 1e-11] {
        let found = error(
            end(&format!("Adaptive(relative_tolerance: {tolerance:e})")),
            exact,
        );
        println!("tolerance {tolerance:e}: error {found:.2e}");
        assert!(found < 20.0 * tolerance, "{tolerance}: {found}");
    }
}

/// The towline of the paper (sec. 5.1) with a relative wind of 5 m/s at the probe.
mod towline {
    pub(super) const LENGTH_M: f64 = 9700.0;
    pub(super) const DIAMETER_M: f64 = 0.00043991707;
    pub(super) const MATERIAL_KG_M3: f64 = 1560.0;
    pub(super) const STIFFNESS_N: f64 = 27359.24;
    pub(super) const SPEED_M_S: f64 = 5.0;
    /// Depth of the probe on the continuous elastic cable, solved by a separate program, m.
    pub(super) const CONTINUOUS_Z_M: f64 = 43_714.632_962_28;

    pub(super) fn mass_kg() -> f64 {
        MATERIAL_KG_M3 * LENGTH_M * std::f64::consts::PI * 0.25 * DIAMETER_M * DIAMETER_M
    }
}

/// Altitude of the probe in the steady state that the simulator finds, m.
fn towline_probe_z_m(nodes: u32, lumping: &str) -> f64 {
    use towline::{DIAMETER_M, LENGTH_M, MATERIAL_KG_M3, SPEED_M_S, STIFFNESS_N};
    let text = format!(
        r#"(
        name: "towline",
        environment: (
            atmosphere: Exponential(density_kg_m3: 1.594, altitude_m: 50000, scale_height_m: 7000),
            wind: [Shear(altitude_m: 52000, gradient_per_s: {})],
        ),
        entities: {{
            "balloon": (Fixed: (position_m: (0, 0, 52000))),
            "probe": (Body: (mass_kg: 4), Drag: Constant(coefficient: 0.47, area_m2: {})),
            "towline": (Tether: (
                from: ("balloon", Centre), to: ("probe", Centre),
                length_m: {LENGTH_M}, nodes: {nodes}, diameter_m: {DIAMETER_M},
                density_kg_m3: {MATERIAL_KG_M3}, axial_stiffness_n: {STIFFNESS_N},
                damping_n_s_m: 0.05, lumping: {lumping},
                drag: (normal: 1, tangential: 0.03),
            )),
        }},
        run: (duration_s: 1, output_every_s: 1),
    )"#,
        -SPEED_M_S / LENGTH_M,
        std::f64::consts::PI * 0.05 * 0.05
    );
    let simulator = Simulator::new();
    let scene = load(&simulator, &text, &[]);
    let trim = simulator
        .build(&scene)
        .and_then(|mut simulation| simulation.trim(&scene))
        .unwrap_or_else(|error| panic!("{error}"));
    trim.body("probe").unwrap().position_m.z
}

/// The same discrete line by shooting, in the plane: from a guess of the probe's place upwards, segment
/// by segment, to where the top comes out; Newton on the two coordinates of the probe.
fn towline_by_shooting_z_m(nodes: u32, node_kg: f64, end_kg: f64) -> f64 {
    let top = |x: f64, z: f64| shoot(nodes, node_kg, end_kg, x, z);
    let (mut x, mut z) = (4906.0, 43714.0);
    for _ in 0..60 {
        let (h, here) = (1e-3, top(x, z));
        let (by_x, by_z) = (top(x + h, z), top(x, z + h));
        let (a, b) = ((by_x.0 - here.0) / h, (by_z.0 - here.0) / h);
        let (c, d) = ((by_x.1 - here.1) / h, (by_z.1 - here.1) / h);
        let (miss_x, miss_z) = (-here.0, 52_000.0 - here.1);
        let determinant = a * d - b * c;
        let step = (
            (miss_x * d - b * miss_z) / determinant,
            (a * miss_z - c * miss_x) / determinant,
        );
        (x, z) = (x + step.0, z + step.1);
        if step.0.abs() + step.1.abs() < 1e-9 {
            break;
        }
    }
    z
}

fn shoot(nodes: u32, node_kg: f64, end_kg: f64, mut x: f64, mut z: f64) -> (f64, f64) {
    use towline::{DIAMETER_M, LENGTH_M, SPEED_M_S, STIFFNESS_N};
    let gravity = 8.87;
    let density = |z: f64| 1.594 * (-(z - 50_000.0) / 7000.0).exp();
    let wind = |z: f64| SPEED_M_S * (52_000.0 - z) / LENGTH_M;
    let rest = LENGTH_M / f64::from(nodes + 1);
    let area = std::f64::consts::PI * 0.05 * 0.05;
    // What pulls on the lower end of the next segment, but that segment itself.
    let mut pull = (
        0.5 * density(z) * 0.47 * area * wind(z) * wind(z).abs(),
        -(4.0 + end_kg) * gravity,
    );
    for _ in 0..=nodes {
        let mut drag = (0.0_f64, 0.0_f64);
        let (mut tension, mut along, mut length) = (0.0, (0.0, 0.0), rest);
        for _ in 0..200 {
            let force = (-(pull.0 + 0.5 * drag.0), -(pull.1 + 0.5 * drag.1));
            tension = force.0.hypot(force.1);
            along = (force.0 / tension, force.1 / tension);
            length = rest * (1.0 + tension / STIFFNESS_N);
            let middle = z + 0.5 * length * along.1;
            let slip = -wind(middle);
            let tangential = slip * along.0;
            let normal = (slip - tangential * along.0, -tangential * along.1);
            let q = -0.5 * density(middle) * DIAMETER_M * length;
            let skin = std::f64::consts::PI * 0.03 * tangential.abs() * tangential;
            let speed = normal.0.hypot(normal.1);
            let next = (
                q * (speed * normal.0 + skin * along.0),
                q * (speed * normal.1 + skin * along.1),
            );
            let change = (next.0 - drag.0).abs() + (next.1 - drag.1).abs();
            drag = next;
            if change < 1e-15 {
                break;
            }
        }
        (x, z) = (x + length * along.0, z + length * along.1);
        pull = (
            0.5 * drag.0 - tension * along.0,
            0.5 * drag.1 - tension * along.1 - node_kg * gravity,
        );
    }
    (x, z)
}

/// Errors of depth against the continuous cable; each discrete line agrees with its shooting solution
/// to the round-off of an altitude seen through a long line.
fn depth_errors_m(
    lumping: &str,
    node_kg: impl Fn(u32) -> f64,
    end_kg: impl Fn(u32) -> f64,
) -> [f64; 4] {
    let errors = [50, 100, 200, 400].map(|nodes| {
        let z = towline_probe_z_m(nodes, lumping);
        let shot = towline_by_shooting_z_m(nodes, node_kg(nodes), end_kg(nodes));
        assert!((z - shot).abs() < 1e-5, "{nodes} nodes: {z} against {shot}");
        (z - towline::CONTINUOUS_Z_M).abs()
    });
    println!("{lumping}: {errors:?}");
    errors
}

/// A separate program gave 0.2416, 0.0615, 0.0155, 0.0039 m, half a percent above the shooting solution
/// of the same line; hence the 1 % beside the 1e-5 m of the shooting.
#[test]
fn half_segment_lumping_is_of_second_order() {
    let mass = towline::mass_kg();
    let errors = depth_errors_m(
        "HalfSegment",
        |nodes| mass / f64::from(nodes + 1),
        |nodes| 0.5 * mass / f64::from(nodes + 1),
    );
    for (error, expected) in errors.into_iter().zip([0.2416, 0.0615, 0.0155, 0.0039]) {
        assert!((error / expected - 1.0).abs() < 0.01, "{error} {expected}");
    }
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 2.0).abs() < 0.05, "{order}");
    }
}

/// A separate program gave 1.02, 0.453, 0.212, 0.102 m: three digits.
#[test]
fn interior_lumping_is_of_first_order() {
    let mass = towline::mass_kg();
    let errors = depth_errors_m("Interior", |nodes| mass / f64::from(nodes), |_| 0.0);
    for (error, expected) in errors.into_iter().zip([1.02, 0.453, 0.212, 0.102]) {
        assert!((error / expected - 1.0).abs() < 0.01, "{error} {expected}");
    }
    let orders: Vec<f64> = errors
        .windows(2)
        .map(|pair| (pair[0] / pair[1]).log2())
        .collect();
    assert!(
        orders.windows(2).all(|pair| pair[1] < pair[0]),
        "{orders:?}"
    );
    assert!((orders[2] - 1.0).abs() < 0.1, "{orders:?}");
}
