//! Axial force of a segment (Kelvin-Voigt): T = k (L - L0) + c dL/dt along the segment.
//!
//! L length, L0 rest length (m), k stiffness (N/m), c damping (N s/m). A segment that goes slack
//! carries nothing where L <= L0 and never pushes; `slack: false` gives the two-sided law
//! (paper, sec. 3.1.1; Linskens and Mooij 2016).

use aerobot_components::derivatives::SegmentDerivatives;
use aerobot_components::segment::{KelvinVoigt, RigidLink, SegmentGeometry, SegmentLoad, Tension};
use aerobot_components::winch::Reeled;
use bevy_ecs::change_detection::DetectChangesMut;
use bevy_ecs::query::{With, Without};
use bevy_ecs::system::Query;
use glam::DMat3;

/// Finds the tension of every segment of constant length and passes it to its ends.
pub fn spring(
    mut segments: Query<
        (
            &KelvinVoigt,
            &SegmentGeometry,
            &mut Tension,
            &mut SegmentLoad,
        ),
        Without<Reeled>,
    >,
) {
    for (spring, geometry, mut tension, mut load) in &mut segments {
        let value = axial_force_n(spring, geometry.length_m, geometry.length_rate_m_s);
        tension.bypass_change_detection().0 = value;
        let pull = value * geometry.direction;
        let load = load.bypass_change_detection();
        load.from_n += pull;
        load.to_n -= pull;
    }
}

/// Tension in N of a segment of length `length_m` (m) that grows by `length_rate_m_s` (m/s).
#[inline]
#[must_use]
pub fn axial_force_n(spring: &KelvinVoigt, length_m: f64, length_rate_m_s: f64) -> f64 {
    let stretch = length_m - spring.rest_length_m;
    let force = spring.stiffness_n_m * stretch + spring.damping_n_s_m * length_rate_m_s;
    if !spring.slack {
        force
    } else if stretch <= 0.0 {
        0.0
    } else {
        force.max(0.0)
    }
}

/// Finds the derivatives of the tension of every segment, and clears those of its drag.
pub fn spring_derivatives(
    mut segments: Query<(
        &KelvinVoigt,
        &SegmentGeometry,
        &Tension,
        &mut SegmentDerivatives,
    )>,
) {
    for (spring, geometry, tension, mut derivatives) in &mut segments {
        let gap_m = if spring.slack {
            spring.rest_length_m - geometry.length_m
        } else {
            0.0
        };
        *derivatives.bypass_change_detection() = SegmentDerivatives {
            axial_stiffness_n_m: spring.stiffness_n_m,
            axial_damping_n_s_m: spring.damping_n_s_m,
            geometric_stiffness_n_m: if geometry.length_m > 0.0 {
                tension.0.max(0.0) / geometry.length_m
            } else {
                0.0
            },
            gap_m,
            closing_m_s: geometry.length_rate_m_s,
            drag_n_s_m: DMat3::ZERO,
        };
    }
}

/// Finds the derivatives of rigid links, which are those across them, and clears those of their drag.
pub fn rigid_link_derivatives(
    mut links: Query<(&SegmentGeometry, &Tension, &mut SegmentDerivatives), With<RigidLink>>,
) {
    for (geometry, tension, mut derivatives) in &mut links {
        *derivatives.bypass_change_detection() = SegmentDerivatives {
            geometric_stiffness_n_m: tension.0.max(0.0) / geometry.length_m,
            ..SegmentDerivatives::default()
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slack_segment_carries_nothing_and_never_pushes() {
        let mut spring = KelvinVoigt {
            rest_length_m: 2.0,
            stiffness_n_m: 10.0,
            damping_n_s_m: 3.0,
            slack: true,
        };
        assert_eq!(axial_force_n(&spring, 2.5, 1.0), 8.0);
        assert_eq!(axial_force_n(&spring, 2.5, -10.0), 0.0);
        assert_eq!(axial_force_n(&spring, 1.5, 10.0), 0.0);
        assert_eq!(axial_force_n(&spring, 2.0, 10.0), 0.0);
        spring.slack = false;
        assert_eq!(axial_force_n(&spring, 1.5, -1.0), -8.0);
    }
}
