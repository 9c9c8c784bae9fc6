//! Swing of a body about its support: the angle between the vertical and the line from where it hangs
//! to what it hangs from (the means of the attachments, where several tethers join the two), and the parts of that angle along x and y (rad).

use aerobot_components::state::Position;
use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use bevy_ecs::system::{Query, ResMut};
use glam::DVec3;

use super::channel_log::{BuiltInChannels, ChannelLog};

/// Name of the channel of the whole angle.
pub const SWING: &str = "swing_rad";
/// Name of the channel of its part along x.
pub const SWING_X: &str = "swing_x_rad";
/// Name of the channel of its part along y.
pub const SWING_Y: &str = "swing_y_rad";

/// What a body hangs from: the tethers that join it to one support, found at the start of a run.
#[derive(Component, Clone, Debug, Default, PartialEq, Eq)]
pub struct Support {
    /// The attachments above.
    pub above: Vec<Entity>,
    /// Those on the body itself.
    pub below: Vec<Entity>,
}

/// Records the swing of every body that hangs and asks for it.
pub fn swing(
    mut log: ResMut<ChannelLog>,
    bodies: Query<(Entity, &BuiltInChannels, &Support)>,
    positions: Query<&Position>,
) {
    for (entity, channels, support) in &bodies {
        // Displaced along +x means swung towards +x.
        let hanging = mean(&positions, &support.below) - mean(&positions, &support.above);
        for (channel, value) in [
            (SWING, swing_rad(hanging)),
            (SWING_X, libm::atan2(hanging.x, -hanging.z)),
            (SWING_Y, libm::atan2(hanging.y, -hanging.z)),
        ] {
            if channels.has(channel) {
                log.record(entity, channel, value);
            }
        }
    }
}

/// Mean position of `points`, m.
fn mean(positions: &Query<&Position>, points: &[Entity]) -> DVec3 {
    let sum: DVec3 = points
        .iter()
        .filter_map(|point| positions.get(*point).ok())
        .map(|p| p.0)
        .sum();
    sum / points.len() as f64
}

/// Angle between the downward vertical and `hanging`, rad.
#[must_use]
pub fn swing_rad(hanging: DVec3) -> f64 {
    libm::atan2(libm::hypot(hanging.x, hanging.y), -hanging.z)
}
