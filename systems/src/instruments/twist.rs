//! Twist of a tether that resists it (rad, turns included), and the torque along it (N m).

use aerobot_components::torsion::Twist;
use bevy_ecs::entity::Entity;
use bevy_ecs::system::{Query, ResMut};

use super::channel_log::{BuiltInChannels, ChannelLog};

/// Name of the channel of twist.
pub const TWIST: &str = "twist_rad";
/// Name of the channel of torque.
pub const TORSION: &str = "torsion_n_m";

/// Records twist and torque of every tether that asks for them.
pub fn twist(mut log: ResMut<ChannelLog>, tethers: Query<(Entity, &BuiltInChannels, &Twist)>) {
    for (entity, channels, twist) in &tethers {
        for (channel, value) in [(TWIST, twist.twist_rad), (TORSION, twist.torque_n_m)] {
            if channels.has(channel) {
                log.record(entity, channel, value);
            }
        }
    }
}
