//! Tilt, the angle between a body's z axis and the vertical, and heading, the angle from the inertial
//! x axis to the horizontal part of the body's x axis, counted towards y (rad).

use aerobot_components::state::Attitude;
use bevy_ecs::entity::Entity;
use bevy_ecs::system::{Query, ResMut};
use glam::{DQuat, DVec3};

use super::channel_log::{BuiltInChannels, ChannelLog};

/// Name of the channel of tilt.
pub const TILT: &str = "tilt_rad";
/// Name of the channel of heading.
pub const HEADING: &str = "heading_rad";

/// Records tilt and heading of every body that asks for them.
pub fn attitude(mut log: ResMut<ChannelLog>, bodies: Query<(Entity, &BuiltInChannels, &Attitude)>) {
    for (entity, channels, attitude) in &bodies {
        if channels.has(TILT) {
            log.record(entity, TILT, tilt_rad(attitude.0));
        }
        if channels.has(HEADING) {
            log.record(entity, HEADING, heading_rad(attitude.0));
        }
    }
}

/// Tilt of an attitude, rad, in [0, pi].
#[must_use]
pub fn tilt_rad(attitude: DQuat) -> f64 {
    let axis = attitude * DVec3::Z;
    libm::atan2(libm::hypot(axis.x, axis.y), axis.z)
}

/// Heading of an attitude, rad, in (-pi, pi].
#[must_use]
pub fn heading_rad(attitude: DQuat) -> f64 {
    let axis = attitude * DVec3::X;
    libm::atan2(axis.y, axis.x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_yawed_and_a_rolled_body() {
        let yawed = DQuat::from_rotation_z(0.7);
        assert!((heading_rad(yawed) - 0.7).abs() < 1e-15 && tilt_rad(yawed) < 1e-15);
        let rolled = DQuat::from_rotation_x(2.0);
        assert!((tilt_rad(rolled) - 2.0).abs() < 1e-15 && heading_rad(rolled).abs() < 1e-15);
    }
}
