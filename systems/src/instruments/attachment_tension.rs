//! Force of a tether on what it is attached to, with the half segment of mass that stands there:
//! |F_load + W - m a|; F_load from the end segment, weight W and mass m of the share (N, kg), a the
//! acceleration of the attachment (m/s^2). This, not the tension of the end segment, compares with the
//! end of a continuous cable.

use aerobot_components::state::{Acceleration, Force, Mass};
use aerobot_components::tether::TetherParts;
use bevy_ecs::entity::Entity;
use bevy_ecs::system::{Query, ResMut};
use glam::DVec3;

use super::channel_log::{BuiltInChannels, ChannelLog};

/// Name of the channel of the end at `from`.
pub const TENSION_FROM: &str = "tension_from_n";
/// Name of the channel of the end at `to`.
pub const TENSION_TO: &str = "tension_to_n";

/// Records the force on the attachments of every tether that asks for it.
pub fn attachment_tension(
    mut log: ResMut<ChannelLog>,
    tethers: Query<(Entity, &BuiltInChannels, &TetherParts)>,
    ends: Query<(&Force, &Mass, &Acceleration)>,
) {
    for (entity, channels, parts) in &tethers {
        for (channel, point) in [
            (TENSION_FROM, parts.points.first()),
            (TENSION_TO, parts.points.last()),
        ] {
            let Some(Ok((force, mass, acceleration))) = point.map(|point| ends.get(*point)) else {
                continue;
            };
            if channels.has(channel) {
                log.record(
                    entity,
                    channel,
                    force_on_carrier_n(force.0, mass.0, acceleration.0),
                );
            }
        }
    }
}

/// Magnitude in N of what remains for the carrier of a force in N on an attachment of mass in kg.
#[must_use]
pub fn force_on_carrier_n(force_n: DVec3, mass_kg: f64, acceleration_m_s2: DVec3) -> f64 {
    (force_n - mass_kg * acceleration_m_s2).length()
}
