//! Airspeed: |v - w|, v velocity of the centre of mass and w the wind there (m/s).

use aerobot_components::state::{Air, Velocity};
use bevy_ecs::entity::Entity;
use bevy_ecs::system::{Query, ResMut};

use super::channel_log::{BuiltInChannels, ChannelLog};

/// Name of the channel.
pub const AIRSPEED: &str = "airspeed_m_s";

/// Records the airspeed of every body that asks for it.
pub fn airspeed(
    mut log: ResMut<ChannelLog>,
    bodies: Query<(Entity, &BuiltInChannels, &Velocity, &Air)>,
) {
    for (entity, channels, velocity, air) in &bodies {
        if channels.has(AIRSPEED) {
            log.record(entity, AIRSPEED, (velocity.0 - air.velocity_m_s).length());
        }
    }
}
