//! Anchors on a given path: p = p0 + v t + a sin(omega t + phi), with its derivatives.

use aerobot_components::body::Moving;
use aerobot_components::state::{Acceleration, Position, Velocity};
use bevy_ecs::system::{Query, Res};
use glam::DVec3;

use crate::clock::Clock;

/// Position (m), velocity (m/s) and acceleration (m/s^2) on a path at a time in s.
#[must_use]
pub fn on_path(path: &Moving, time_s: f64) -> (DVec3, DVec3, DVec3) {
    let omega = path.frequency_rad_s;
    let (sin, cos) = libm::sincos(omega * time_s + path.phase_rad);
    (
        path.position_m + path.velocity_m_s * time_s + path.amplitude_m * sin,
        path.velocity_m_s + path.amplitude_m * (omega * cos),
        -path.amplitude_m * (omega * omega * sin),
    )
}

/// Moves the anchors to where they are at the time of the evaluation.
pub fn move_anchors(
    clock: Res<Clock>,
    mut anchors: Query<(&Moving, &mut Position, &mut Velocity, &mut Acceleration)>,
) {
    for (path, mut position, mut velocity, mut acceleration) in &mut anchors {
        (position.0, velocity.0, acceleration.0) = on_path(path, clock.time_s);
        if clock.at_rest {
            (velocity.0, acceleration.0) = Default::default();
        }
    }
}
