//! The small rotorcraft that tests fly and dock.

use aerobot::engine::recording::frame::MemorySink;
use aerobot::engine::recording::summary::Summary;

use super::channel;

pub(crate) const G: f64 = 8.87;
/// Density at 54 km of VIRA, rounded, kg/m^3.
pub(crate) const DENSITY: f64 = 1.03;
/// Drag coefficient times area of the drone, m^2.
pub(crate) const DRAG_AREA_M2: f64 = 0.12;

/// The drone that all of these fly: 6 kg, four rotors of 0.5 m.
pub(crate) fn drone(course: &str, more: &str) -> String {
    format!(
        r#"Body: (mass_kg: 6, inertia: Tensor(xx_kg_m2: 0.2, yy_kg_m2: 0.2, zz_kg_m2: 0.35)),
            Drag: Constant(coefficient: 1, area_m2: {DRAG_AREA_M2}),
            Rotorcraft: (rotors: 4, rotor_diameter_m: 0.5, motor_power_w: 1200, {course}),
            {more}"#
    )
}

pub(crate) const POSE: &str = "Pose: (position_m: (0, 0, 54_000)),";

/// A channel of the drone at the end.
pub(crate) fn tail(results: &MemorySink, name: &str) -> f64 {
    results
        .frames
        .last()
        .map_or(f64::NAN, |end| channel(end, "drone", name))
}

/// When the first event of a kind was.
pub(crate) fn time_of(summary: &Summary, kind: &str) -> f64 {
    let found = summary.events.iter().find(|event| event.kind == kind);
    found
        .unwrap_or_else(|| panic!("{:?}", summary.events))
        .time_s
}
