//! Airspeed: |v - w|, v velocity of the centre of mass and w the wind there (m/s), which of a drone may be its own.

use aerobot_components::fixed_wing::FixedWing;
use aerobot_components::state::{Air, Velocity};
use bevy_ecs::entity::Entity;
use bevy_ecs::system::{Query, ResMut};

use super::channel_log::{BuiltInChannels, ChannelLog};

/// Name of the channel.
pub const AIRSPEED: &str = "airspeed_m_s";

/// Records the airspeed of every body that asks for it.
pub fn airspeed(
    mut log: ResMut<ChannelLog>,
    bodies: Query<(
        Entity,
        &BuiltInChannels,
        &Velocity,
        &Air,
        Option<&FixedWing>,
    )>,
) {
    for (entity, channels, velocity, air, drone) in &bodies {
        if channels.has(AIRSPEED) {
            let air_m_s = air.velocity_m_s;
            let air_m_s = drone.map_or(air_m_s, |drone| drone.wind.velocity_m_s(air_m_s));
            log.record(entity, AIRSPEED, (velocity.0 - air_m_s).length());
        }
    }
}
