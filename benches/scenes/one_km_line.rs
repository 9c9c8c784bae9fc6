//! The 1 km line of the comparison with MoorDyn: a 4 kg sphere of 0.1 m on 0.237 kg of line in a wind of
//! 5 m/s, let go from a slant.

use std::fmt::Write as _;

/// The line of `nodes` nodes and axial stiffness `stiffness_n`, at rest and straight, tilted by 0.3 rad
/// towards +x, each segment stretched by the weight below it times cos 0.3; for 60 s, with an output every
/// `output_every_s` (s).
pub(crate) fn one_km_line(nodes: usize, stiffness_n: f64, output_every_s: f64) -> String {
    let (length_m, line_kg, probe_kg, gravity) = (1000.0, 0.237, 4.0, 8.87);
    let segments = nodes as f64 + 1.0;
    let node_kg = line_kg / nodes as f64;
    let stiffness_n_m = stiffness_n / length_m * segments;
    let damping_n_s_m = 0.2 * (stiffness_n_m * node_kg).sqrt() / segments;
    let diameter_m = 0.458e-3;
    let density_kg_m3 = 2.37e-4 / (0.25 * std::f64::consts::PI * diameter_m * diameter_m);
    let (sin, cos) = libm::sincos(0.3);
    let mut along_m = 0.0;
    let mut positions = String::new();
    for number in 1..=nodes + 1 {
        let below_kg = probe_kg + node_kg * (nodes + 1 - number) as f64;
        along_m += length_m / segments + below_kg * gravity * cos / stiffness_n_m;
        if number <= nodes {
            let _ = write!(positions, "({}, 0, {}),", along_m * sin, -along_m * cos);
        }
    }
    let (x_m, z_m) = (along_m * sin, -along_m * cos);
    format!(
        r#"(
            name: "line",
            environment: (
                atmosphere: Uniform(density_kg_m3: 1), wind: [Uniform(velocity_m_s: (4, 3, 0))],
            ),
            entities: {{
                "top": (Fixed: (position_m: (0, 0, 0))),
                "probe": (
                    Body: (mass_kg: {probe_kg}),
                    Sphere: (radius_m: 0.05),
                    Drag: Constant(coefficient: 0.47),
                    Pose: (position_m: ({x_m}, 0, {z_m})),
                ),
                "line": (Tether: (
                    from: ("top", Centre), to: ("probe", Centre),
                    length_m: {length_m}, nodes: {nodes},
                    diameter_m: {diameter_m}, density_kg_m3: {density_kg_m3},
                    axial_stiffness_n: {stiffness_n}, damping_n_s_m: {damping_n_s_m},
                    lumping: Interior, drag: (normal: 1, tangential: 0.03),
                    start: Positions([{positions}]),
                )),
            }},
            run: (duration_s: 60, output_every_s: {output_every_s}),
        )"#
    )
}
