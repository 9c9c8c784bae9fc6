//! A body that turns on one tether with torsion.

use aerobot::engine::recording::frame::MemorySink;

use super::fly;

/// Where it hangs at rest.
pub(crate) const POSE: &str = "Pose: (position_m: (0, 0, 94.79)),";
/// For errors below those that are looked for.
pub(crate) const TIGHT: &str = "integrator: Adaptive(relative_tolerance: 1e-11)";

/// A body on one tether from an anchor, with Izz = 0.4 kg m^2 and GJ/L = 0.1 N m.
pub(crate) fn pendulum(torsion: &str, body: &str, run: &str, overrides: &[&str]) -> MemorySink {
    fly(&pendulum_text(torsion, body, run), overrides)
}

/// Its scene.
pub(crate) fn pendulum_text(torsion: &str, body: &str, run: &str) -> String {
    format!(
        r#"(
        name: "torsional-pendulum",
        environment: (atmosphere: Vacuum),
        entities: {{
            "top": (Fixed: (position_m: (0, 0, 100), attitude: YawPitchRoll(yaw_rad: 0.7, pitch_rad: 0, roll_rad: 0))),
            "load": (
                Body: (mass_kg: 5, inertia: Tensor(xx_kg_m2: 0.3, yy_kg_m2: 0.35, zz_kg_m2: 0.4)),
                {body}
            ),
            "line": (Tether: (
                from: ("top", Centre), to: ("load", (0, 0, 0.2)), length_m: 5, nodes: 3, diameter_m: 0.004,
                density_kg_m3: 1440, axial_stiffness_n: 2e4, damping_n_s_m: 20,
                torsion: (stiffness_n_m2: 0.5, {torsion}),
            )),
        }},
        run: (duration_s: 40, output_every_s: 0.25, record: (channels: All), {run}),
    )"#
    )
}
