//! The steering sail and what steers it: against trajectories of a separate program, closed forms, the other
//! formulation, and scenes that are turned.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test may fail loudly, its helpers too"
)]

mod flight;

use aerobot::engine::plugin::Simulator;
use aerobot::engine::recording::frame::MemorySink;
use flight::{assert_below, assert_relative, channel, frame_at, load, position};

/// The step of the rudder: the frame moves with the air at 56 km.
const STEP: &str = r#"(
    name: "rudder-step",
    about: "",
    environment: (
        gravity: Constant(8.87),
        atmosphere: Exponential(density_kg_m3: 0.8183, altitude_m: 56000, scale_height_m: 8619),
        wind: [Shear(altitude_m: 56000, gradient_per_s: 0.0024)],
    ),
    entities: {
        "balloon": (
            Body: (mass_kg: 50),
            Sphere: (radius_m: 3.56),
            Buoyancy: (), AddedMass: (), Drag: Constant(coefficient: 0.47),
            Pose: (position_m: (0, 0, 56000)),
        ),
        "sail": (
            Body: (mass_kg: 104.65, inertia: Tensor(xx_kg_m2: 90, yy_kg_m2: 90, zz_kg_m2: 90)),
            Sail: (
                wing: (area_m2: 3, aspect_ratio: 5, oswald_factor: 0.7, zero_lift_drag: 0.02, arm_m: 0.5, side: Aft),
                rudder: (area_m2: 0.5, arm_m: 4, deflection: (limit: 0.27)),
                airspeed: Horizontal,
                attitude: Level,
            ),
        ),
        "line": (
            Tether: (
                from: ("balloon", Centre), to: ("sail", Centre), length_m: 2000, nodes: 0, diameter_m: 0.001,
                density_kg_m3: 0, axial_stiffness_n: 1e7, damping_n_s_m: 0, drag: (normal: 0, tangential: 0),
            ),
        ),
        "helm": (
            Schedule: (
                actuator: ("sail", "rudder"),
                commands: Steps([(10, 0.017453292519943295), (50, 0)]),
            ),
        ),
    },
    run: (
        formulation: Denoc, duration_s: 100, output_every_s: 10,
        integrator: Adaptive(relative_tolerance: 1e-9),
    ),
)"#;

/// From the steady state in the scene's wind.
fn fly_from_trim(text: &str, overrides: &[&str]) -> MemorySink {
    let simulator = Simulator::new();
    let scene = load(&simulator, text, overrides);
    let mut simulation = simulator.build(&scene).unwrap_or_else(|e| panic!("{e}"));
    simulation
        .settle_in_wind(&scene)
        .unwrap_or_else(|e| panic!("{e}"));
    let mut results = MemorySink::default();
    let summary = simulation.run(&mut results, &mut |_| {});
    assert_eq!(summary.outcome, "done", "{:?}", summary.stopped);
    results
}

/// Yaw (deg), y of the sail and of the balloon (m) at some times (s), from a separate program.
const STEP_RESULTS: [(f64, f64, f64, f64); 4] = [
    (20.0, -2.378296, -0.610464, -0.014730),
    (30.0, -3.662328, -2.444368, -0.260770),
    (50.0, -4.033063, -7.480072, -3.180744),
    (100.0, -2.647805, -13.106748, -14.334736),
];

/// Largest differences from them, deg and m.
fn step_differences(results: &MemorySink) -> (f64, f64) {
    let (mut yaw, mut place) = (0.0_f64, 0.0_f64);
    for (time_s, yaw_deg, sail_m, balloon_m) in STEP_RESULTS {
        let heading = channel(frame_at(results, time_s), "sail", "heading_rad").to_degrees();
        let (sail, balloon) = (
            position(results, "sail", time_s),
            position(results, "balloon", time_s),
        );
        println!(
            "{time_s} s: {heading:.6} deg, {:.6} m, {:.6} m",
            sail.y, balloon.y
        );
        yaw = yaw.max((heading - yaw_deg).abs());
        place = place
            .max((sail.y - sail_m).abs())
            .max((balloon.y - balloon_m).abs());
    }
    (yaw, place)
}

#[test]
fn val_the_rudder_step_on_a_rigid_massless_link() {
    let results = fly_from_trim(STEP, &[]);
    let tension = flight::channel(frame_at(&results, 0.0), "line", "tension_to_n");
    assert_relative("tension", tension, 928.2457, 1e-7);
    let airspeed = channel(frame_at(&results, 0.0), "sail", "airspeed_m_s");
    assert_relative("airspeed", airspeed, 4.5132, 2e-5);
    let (yaw, place) = step_differences(&results);
    assert_below("yaw, deg", yaw, 1e-4);
    assert_below("y, m", place, 1e-4);
}
