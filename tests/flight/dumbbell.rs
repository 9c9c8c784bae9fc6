//! Two bodies on a spinning line without weight and without air, cut in its middle, and their sums.

use aerobot::engine::recording::frame::{Frame, MemorySink};
use glam::DVec3;

use super::assert_below;

/// The scene: a body `a` of 4 kg and `b` of 7 kg on `tether`, of seven segments, cut in the fourth at 2.5 s.
/// `line` has its length, stiffness and whatever else is asked of it, `run` what is asked of the run.
pub(crate) fn dumbbell(line: &str, run: &str) -> String {
    format!(
        r#"(
    name: "dumbbell",
    environment: (gravity: Constant(0), atmosphere: Vacuum),
    entities: {{
        "a": (Body: (mass_kg: 4), Pose: (position_m: (0, 0, 100)), Motion: (velocity_m_s: (3, 0.5, 0.2))),
        "b": (Body: (mass_kg: 7), Pose: (position_m: (0, 0, 0)), Motion: (velocity_m_s: (-1, 0.3, 0))),
        "tether": (
            Tether: (
                from: ("a", Centre), to: ("b", Centre), nodes: 6, diameter_m: 0.002, density_kg_m3: 1440,
                start: Straight, {line}
            ),
            Motion: (velocity_m_s: (1, 0.4, 0.1)),
        ),
    }},
    events: [(at_s: 2.5, do: Cut(tether: "tether", segment: 4))],
    run: (
        duration_s: 5, output_every_s: 0.5, integrator: Adaptive(relative_tolerance: 1e-11), {run}
    ),
)"#
    )
}

/// Momentum and angular momentum of the dumbbell on a line of this length, its masses on its nodes.
fn sums(frame: &Frame, length_m: f64) -> [DVec3; 2] {
    let segment_kg = 1440.0 * std::f64::consts::PI * 1e-6 * length_m / 7.0;
    let mut sums = [DVec3::ZERO; 2];
    for row in &frame.states {
        let mass_kg = match &*row.entity {
            "a" => 4.0 + 0.5 * segment_kg,
            "b" => 7.0 + 0.5 * segment_kg,
            _ => segment_kg,
        };
        sums[0] += mass_kg * row.velocity_m_s;
        sums[1] += row.position_m.cross(mass_kg * row.velocity_m_s);
    }
    sums
}

/// Momentum and angular momentum must stay, relative.
pub(crate) fn assert_conserved(results: &MemorySink, length_m: f64, tolerances: [f64; 2]) {
    let start = sums(&results.frames[0], length_m);
    for frame in &results.frames {
        let now = sums(frame, length_m);
        for (what, k) in [("momentum", 0), ("angular momentum", 1)] {
            let change = now[k].distance(start[k]) / start[k].length();
            let what = format!("{what} at {} s", frame.time_s);
            assert_below(&what, change, tolerances[k]);
        }
    }
}
