//! Drag of a segment of a line, split along and across it (Morison's form, mooring convention):
//! F_n = -1/2 rho C_n d L |v_n| v_n, F_t = -1/2 rho pi C_t d L |v_t| v_t, half to each end.
//!
//! rho density at the midpoint (kg/m^3), d diameter (m), L current length (m), v = mean velocity of
//! the ends - wind at the midpoint (m/s), v_t its part along the segment and v_n the rest. The factor
//! pi (wetted area) is the convention of mooring codes (Hall and Goupee 2015; paper, sec. 3.3.1).

use aerobot_components::segment::{SegmentDrag, SegmentGeometry, SegmentLoad};
use aerobot_components::state::Air;
use bevy_ecs::change_detection::DetectChangesMut;
use bevy_ecs::system::Query;
use glam::DVec3;

/// Adds the drag of every segment that has one.
pub fn segment_drag(mut segments: Query<(&SegmentDrag, &SegmentGeometry, &Air, &mut SegmentLoad)>) {
    for (drag, geometry, air, mut load) in &mut segments {
        let half = 0.5 * drag_force_n(drag, geometry, air);
        let load = load.bypass_change_detection();
        load.from_n += half;
        load.to_n += half;
    }
}

/// Drag of one segment, inertial frame, N.
#[inline]
#[must_use]
pub fn drag_force_n(drag: &SegmentDrag, geometry: &SegmentGeometry, air: &Air) -> DVec3 {
    let relative = geometry.velocity_m_s - air.velocity_m_s;
    let along = relative.dot(geometry.direction);
    let tangential = along * geometry.direction;
    let normal = relative - tangential;
    let normal_speed = normal.length_squared().sqrt();
    let pressure_area = -0.5 * air.density_kg_m3 * drag.diameter_m * geometry.length_m;
    pressure_area
        * (drag.normal * normal_speed * normal
            + std::f64::consts::PI * drag.tangential * along.abs() * tangential)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A segment at 30 degrees to the flow, against the resolved components worked by hand.
    #[test]
    fn drag_of_an_inclined_segment() {
        let drag = SegmentDrag {
            diameter_m: 0.01,
            normal: 1.2,
            tangential: 0.05,
        };
        let (sin, cos) = (0.5, 0.75_f64.sqrt());
        let geometry = SegmentGeometry {
            direction: DVec3::new(cos, 0.0, sin),
            length_m: 3.0,
            ..SegmentGeometry::default()
        };
        let air = Air {
            density_kg_m3: 2.0,
            velocity_m_s: DVec3::new(4.0, 0.0, 0.0),
        };
        let force = drag_force_n(&drag, &geometry, &air);
        // 1/2 rho d L = 0.03; normal speed 2, tangential speed 4 cos 30.
        let across = 0.03 * 1.2 * 2.0 * 2.0;
        let along = 0.03 * std::f64::consts::PI * 0.05 * 12.0;
        let expected = across * DVec3::new(sin, 0.0, -cos) + along * DVec3::new(cos, 0.0, sin);
        assert!((force - expected).length() < 1e-15, "{force} {expected}");
    }
}
