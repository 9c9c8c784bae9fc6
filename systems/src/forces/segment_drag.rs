//! Drag of a segment of a line, split along and across it (Morison's form, mooring convention):
//! F_n = -1/2 rho C_n d L |v_n| v_n, F_t = -1/2 rho pi C_t d L |v_t| v_t, half to each end.
//!
//! rho density at the midpoint (kg/m^3), d diameter (m), L current length (m), v = mean velocity of
//! the ends - wind at the midpoint (m/s), v_t its part along the segment and v_n the rest. The factor
//! pi (wetted area) is the convention of mooring codes (Hall and Goupee 2015; paper, sec. 3.3.1).

use aerobot_components::derivatives::SegmentDerivatives;
use aerobot_components::segment::{SegmentDrag, SegmentGeometry, SegmentLoad};
use aerobot_components::state::Air;
use bevy_ecs::change_detection::DetectChangesMut;
use bevy_ecs::system::Query;
use glam::{DMat3, DVec3};

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

/// Finds how the drag of every segment changes with its velocity.
pub fn segment_drag_derivatives(
    mut segments: Query<(
        &SegmentDrag,
        &SegmentGeometry,
        &Air,
        &mut SegmentDerivatives,
    )>,
) {
    for (drag, geometry, air, mut derivatives) in &mut segments {
        derivatives.bypass_change_detection().drag_n_s_m += drag_damping_n_s_m(drag, geometry, air);
    }
}

/// Minus the change of [`drag_force_n`] with the velocity of the segment, N s/m:
/// `1/2 rho d L (C_n (|v_n| (I - t t') + v_n v_n'/|v_n|) + 2 pi C_t |v_t| t t')`.
#[inline]
#[must_use]
pub fn drag_damping_n_s_m(drag: &SegmentDrag, geometry: &SegmentGeometry, air: &Air) -> DMat3 {
    let relative = geometry.velocity_m_s - air.velocity_m_s;
    let t = geometry.direction;
    let along = relative.dot(t);
    let normal = relative - along * t;
    let normal_speed = normal.length_squared().sqrt();
    let area = 0.5 * air.density_kg_m3 * drag.diameter_m * geometry.length_m;
    let across = area * drag.normal;
    let all = across * normal_speed;
    let by_normal = if normal_speed > 0.0 {
        across / normal_speed
    } else {
        0.0
    };
    let by_t = 2.0 * std::f64::consts::PI * area * drag.tangential * along.abs() - all;
    let (n, s) = (by_normal * normal, by_t * t);
    DMat3::from_cols(
        DVec3::new(all, 0.0, 0.0) + n * normal.x + s * t.x,
        DVec3::new(0.0, all, 0.0) + n * normal.y + s * t.y,
        DVec3::new(0.0, 0.0, all) + n * normal.z + s * t.z,
    )
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

    /// The derivative against central differences of the force.
    #[test]
    fn the_damping_is_the_slope_of_the_drag() {
        let drag = SegmentDrag {
            diameter_m: 0.01,
            normal: 1.2,
            tangential: 0.05,
        };
        let air = Air {
            density_kg_m3: 2.0,
            velocity_m_s: DVec3::new(4.0, -1.0, 0.5),
        };
        let at = |velocity_m_s: DVec3| SegmentGeometry {
            direction: DVec3::new(0.6, 0.0, 0.8),
            length_m: 3.0,
            velocity_m_s,
            ..SegmentGeometry::default()
        };
        let velocity = DVec3::new(-1.0, 2.0, 0.3);
        let found = drag_damping_n_s_m(&drag, &at(velocity), &air);
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            let h = 1e-5;
            let slope = (drag_force_n(&drag, &at(velocity + h * axis), &air)
                - drag_force_n(&drag, &at(velocity - h * axis), &air))
                / (2.0 * h);
            assert!((found * axis + slope).length() < 1e-9, "{axis}");
        }
        assert!(found.abs_diff_eq(found.transpose(), 1e-16));
    }
}
