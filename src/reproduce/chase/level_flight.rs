//! Level flight of the case's drone on Earth and on Venus, beside a separate program.

use std::path::Path;

use aerobot_engine::builtin::fixed_wing::DroneTrim;
use aerobot_engine::plugin::Simulator;
use aerobot_engine::scene::SceneError;

use super::super::check::{Check, Tolerance};
use super::{DRONE, of};

/// The drone of the case alone.
const SCENE: &str = r#"(
    name: "level-flight",
    environment: (gravity: Constant(8.87), atmosphere: Uniform(density_kg_m3: 1.03)),
    entities: {
        "drone": (
            Body: (
                mass_kg: 11,
                inertia: Tensor(xx_kg_m2: 0.8244, yy_kg_m2: 1.135, zz_kg_m2: 1.759, xz_kg_m2: 0.1204),
            ),
            Pose: (position_m: (0, 0, 0)),
            FixedWing: (aircraft: Aerosonde, start: Trim(airspeed_m_s: 25), guidance: None),
        ),
    },
    run: (duration_s: 1, output_every_s: 1),
)"#;

/// Where, density (kg/m^3) and gravity (m/s^2), and by a separate program, which leaves out the torque of the propeller:
/// angle of attack and elevator (deg), throttle, thrust (N).
type Level = (&'static str, f64, f64, [f64; 4]);
const LEVEL: [Level; 2] = [
    (
        "on Earth",
        1.2682,
        9.81,
        [2.85005, -7.10671, 0.763_993, 9.34464],
    ),
    (
        "at 54 km above Venus",
        1.03,
        8.87,
        [3.45716, -8.78699, 0.762_292, 7.58007],
    ),
];

/// The drone's trim at 25 m/s beside that program's.
pub(super) fn checks(simulator: &Simulator) -> Result<Vec<Check>, SceneError> {
    let mut checks = Vec::new();
    for (place, density_kg_m3, gravity_m_s2, expected) in LEVEL {
        let overrides = [
            format!("environment.gravity=Constant({gravity_m_s2:?})"),
            format!("environment.atmosphere=Uniform(density_kg_m3: {density_kg_m3:?})"),
        ];
        let name = "the drone in level flight";
        let scene = simulator.load_text(name, SCENE.to_owned(), Path::new("."), &overrides)?;
        let simulation = simulator.build(&scene)?;
        let trim = &of::<DroneTrim>(&simulation, DRONE)?.flight;
        let rows = [
            ("angle of attack", "deg", trim.alpha_rad.to_degrees()),
            ("elevator", "deg", trim.controls.elevator_rad.to_degrees()),
            ("throttle", "", trim.controls.throttle),
            ("thrust", "N", trim.thrust_n),
        ];
        for ((what, unit, ours), expected) in rows.into_iter().zip(expected) {
            let check = Check::of(format!("{what} at 25 m/s {place}"), unit, ours);
            checks.push(check.against(expected, Tolerance::Relative(1e-4), "a separate program"));
        }
    }
    Ok(checks)
}
