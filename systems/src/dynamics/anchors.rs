//! Anchors on a given path: p = p0 + v t + a sin(omega t + phi), with its derivatives.

use aerobot_components::body::Moving;
use aerobot_components::state::{Acceleration, Position, Velocity};
use bevy_ecs::system::{Query, Res};

use crate::clock::Clock;

/// Moves the anchors to where they are at the time of the evaluation.
pub fn move_anchors(
    clock: Res<Clock>,
    mut anchors: Query<(&Moving, &mut Position, &mut Velocity, &mut Acceleration)>,
) {
    for (path, mut position, mut velocity, mut acceleration) in &mut anchors {
        let omega = path.frequency_rad_s;
        let (sin, cos) = libm::sincos(omega * clock.time_s + path.phase_rad);
        position.0 = path.position_m + path.velocity_m_s * clock.time_s + path.amplitude_m * sin;
        if clock.at_rest {
            (velocity.0, acceleration.0) = Default::default();
            continue;
        }
        velocity.0 = path.velocity_m_s + path.amplitude_m * (omega * cos);
        acceleration.0 = -path.amplitude_m * (omega * omega * sin);
    }
}
