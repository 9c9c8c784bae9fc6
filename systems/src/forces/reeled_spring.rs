//! Axial force of a segment whose unstretched length L0 changes at the rate r = dL0/dt (m/s):
//! T = k (L - L0) + c (dL/dt - r L/L0), k = EA/L0 (N/m), c = c'/L0 (N s/m). The damper acts on the rate of
//! the strain L/L0 - 1: a line that is paid out at a constant strain is not damped.

use aerobot_components::derivatives::SegmentDerivatives;
use aerobot_components::segment::{KelvinVoigt, SegmentGeometry, SegmentLoad, Tension};
use aerobot_components::winch::Reeled;
use bevy_ecs::system::Query;

use super::spring::axial_force_n;

/// Finds the tension of every segment at a winch and passes it to its ends.
pub fn reeled_spring(
    mut segments: Query<(
        &KelvinVoigt,
        &Reeled,
        &SegmentGeometry,
        &mut Tension,
        &mut SegmentLoad,
    )>,
) {
    for (spring, reeled, geometry, mut tension, mut load) in &mut segments {
        let straining_m_s = straining_m_s(spring, reeled, geometry);
        tension.0 = axial_force_n(spring, geometry.length_m, straining_m_s);
        let pull = tension.0 * geometry.direction;
        load.from_n += pull;
        load.to_n -= pull;
    }
}

/// Rate of the length less that of unstretched line at the same strain, m/s.
#[must_use]
pub fn straining_m_s(spring: &KelvinVoigt, reeled: &Reeled, geometry: &SegmentGeometry) -> f64 {
    geometry.length_rate_m_s - reeled.rate_m_s * geometry.length_m / spring.rest_length_m
}

/// Finds how the tension changes with the unstretched length, and how a gap closes that is also reeled in.
pub fn reeled_spring_derivatives(
    mut segments: Query<(
        &KelvinVoigt,
        &mut Reeled,
        &SegmentGeometry,
        &Tension,
        &mut SegmentDerivatives,
    )>,
) {
    for (spring, mut reeled, geometry, tension, mut derivatives) in &mut segments {
        derivatives.closing_m_s -= reeled.rate_m_s;
        // k and c go as 1/L0: dT/dL0 = -T/L0 - k + c r L/L0^2.
        let (rest_m, length_m) = (spring.rest_length_m, geometry.length_m);
        let is_taut = tension.0 > 0.0 || !spring.slack;
        reeled.tension_by_length_n_m = if is_taut {
            let damping = spring.damping_n_s_m * reeled.rate_m_s * length_m / rest_m;
            (damping - tension.0) / rest_m - spring.stiffness_n_m
        } else {
            0.0
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy_ecs::entity::Entity;

    fn tension_n(rest_length_m: f64) -> f64 {
        let spring = KelvinVoigt {
            rest_length_m,
            stiffness_n_m: 500.0 / rest_length_m,
            damping_n_s_m: 30.0 / rest_length_m,
            slack: true,
        };
        let reeled = Reeled {
            line: Entity::PLACEHOLDER,
            rate_m_s: 0.7,
            shortest_part: 0.4,
            tension_by_length_n_m: 0.0,
        };
        let geometry = SegmentGeometry {
            length_m: 11.0,
            length_rate_m_s: 0.9,
            ..SegmentGeometry::default()
        };
        let rate = straining_m_s(&spring, &reeled, &geometry);
        axial_force_n(&spring, geometry.length_m, rate)
    }

    /// The formula of the derivative against central differences.
    #[test]
    fn the_tension_changes_with_the_length_that_is_out() {
        let h = 1e-5;
        let slope = (tension_n(10.0 + h) - tension_n(10.0 - h)) / (2.0 * h);
        let (k, c) = (50.0, 3.0);
        let formula = (c * 0.7 * 11.0 / 10.0 - tension_n(10.0)) / 10.0 - k;
        assert!((slope - formula).abs() < 1e-6, "{slope} {formula}");
    }
}
