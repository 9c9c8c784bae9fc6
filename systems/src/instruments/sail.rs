//! What a sail and its actuators do.

use aerobot_components::actuator::{Actuator, ActuatorValue, Command};
use aerobot_components::sail::SailLoads;
use bevy_ecs::entity::Entity;
use bevy_ecs::system::{Query, ResMut};

use super::channel_log::{BuiltInChannels, ChannelLog};

/// Name of the channel of the incidence of the wing.
pub const WING_INCIDENCE: &str = "alpha_wing_rad";
/// Name of the channel of the incidence of the rudder.
pub const RUDDER_INCIDENCE: &str = "alpha_rudder_rad";
/// Name of the channel of the lift of the wing.
pub const WING_LIFT: &str = "wing_lift_n";
/// Name of the channel of the lift of the rudder.
pub const RUDDER_LIFT: &str = "rudder_lift_n";
/// Name of the channel of the drag of both.
pub const SAIL_DRAG: &str = "sail_drag_n";
/// Name of the channel of the aerodynamic torque about the body's z axis.
pub const YAW_MOMENT: &str = "yaw_moment_n_m";
/// Name of the channel of the deflection of the rudder.
pub const RUDDER: &str = "rudder_rad";
/// Name of the channel of its command.
pub const RUDDER_COMMAND: &str = "rudder_command_rad";

/// Records what acts on every sail that asks for it.
pub fn sail(mut log: ResMut<ChannelLog>, sails: Query<(Entity, &BuiltInChannels, &SailLoads)>) {
    for (entity, channels, loads) in &sails {
        for (channel, value) in [
            (WING_INCIDENCE, loads.wing_incidence_rad),
            (RUDDER_INCIDENCE, loads.rudder_incidence_rad),
            (WING_LIFT, loads.wing_lift_n),
            (RUDDER_LIFT, loads.rudder_lift_n),
            (SAIL_DRAG, loads.drag_n),
            (YAW_MOMENT, loads.torque_n_m.z),
        ] {
            if channels.has(channel) {
                log.record(entity, channel, value);
            }
        }
    }
}

/// Records value and command (within its limits) of every actuator whose owner asks for them.
pub fn actuators(
    mut log: ResMut<ChannelLog>,
    actuators: Query<(&Actuator, &ActuatorValue, &Command)>,
    owners: Query<&BuiltInChannels>,
) {
    for (actuator, value, command) in &actuators {
        let Ok(wanted) = owners.get(actuator.owner) else {
            continue;
        };
        let command = actuator.limits.cut(command.0);
        for (channel, value) in [
            (actuator.channels.value, value.0),
            (actuator.channels.command, command),
        ] {
            if wanted.has(channel) {
                log.record(actuator.owner, channel, value);
            }
        }
    }
}
