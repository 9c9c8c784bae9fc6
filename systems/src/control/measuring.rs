//! What controllers measure.

use aerobot_components::control::{Measurement, QuantityKind};
use aerobot_components::state::{AngularVelocity, Attitude, Position, Velocity};
use glam::DVec3;

use crate::instruments::attitude::heading_rad;

/// The motion of an entity that is measured.
pub type Measured = (
    &'static Position,
    &'static Velocity,
    Option<&'static Attitude>,
    Option<&'static AngularVelocity>,
);

/// A quantity of a motion.
#[must_use]
pub fn quantity(
    kind: QuantityKind,
    (position, velocity, attitude, rate): (
        &Position,
        &Velocity,
        Option<&Attitude>,
        Option<&AngularVelocity>,
    ),
) -> f64 {
    let attitude = attitude.copied().unwrap_or_default();
    match kind {
        QuantityKind::X => position.0.x,
        QuantityKind::Y => position.0.y,
        QuantityKind::Altitude => position.0.z,
        QuantityKind::VelocityX => velocity.0.x,
        QuantityKind::VelocityY => velocity.0.y,
        QuantityKind::VelocityZ => velocity.0.z,
        QuantityKind::Heading => heading_rad(attitude.0),
        QuantityKind::HeadingRate => {
            let bow = attitude.0 * DVec3::X;
            let rate = rate.map_or(DVec3::ZERO, |rate| rate.0);
            let turning = attitude.0 * rate.cross(DVec3::X);
            let across = bow.truncate().length_squared();
            (bow.x * turning.y - bow.y * turning.x) / across.max(f64::MIN_POSITIVE)
        }
    }
}

/// Target less what is measured, of parts whose values `value` gives; of an angle the nearest turn.
#[must_use]
pub fn error_of(measurement: &Measurement, mut value: impl FnMut(usize) -> f64) -> f64 {
    let measured: f64 = measurement
        .parts
        .iter()
        .enumerate()
        .map(|(index, (sign, ..))| sign * value(index))
        .sum();
    let error = measurement.target - measured;
    if measurement.is_angle {
        libm::atan2(libm::sin(error), libm::cos(error))
    } else {
        error
    }
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;

    /// Of a body that turns about an axis of its own the heading changes as differences of it say.
    #[test]
    fn the_rate_of_heading_is_its_derivative() {
        let attitude = DQuat::from_rotation_z(2.5) * DQuat::from_rotation_y(0.4);
        let rate = DVec3::new(0.3, -0.2, 0.5);
        let at = |t: f64| heading_rad(attitude * DQuat::from_scaled_axis(rate * t));
        let slope = (at(1e-6) - at(-1e-6)) / 2e-6;
        let found = quantity(
            QuantityKind::HeadingRate,
            (
                &Position::default(),
                &Velocity::default(),
                Some(&Attitude(attitude)),
                Some(&AngularVelocity(rate)),
            ),
        );
        assert!((found - slope).abs() < 1e-8, "{found} {slope}");
    }

    #[test]
    fn a_heading_errs_by_the_shorter_way() {
        let measurement = Measurement {
            parts: vec![(
                1.0,
                QuantityKind::Heading,
                bevy_ecs::entity::Entity::PLACEHOLDER,
            )],
            is_angle: true,
            target: 3.0,
        };
        let error = error_of(&measurement, |_| -3.0);
        assert!((error - (6.0 - std::f64::consts::TAU)).abs() < 1e-12);
    }
}
