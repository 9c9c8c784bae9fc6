//! Clears what forces add to, at the start of every evaluation. (Loads of segments are cleared where
//! segments are measured, which passes over them anyway.)

use aerobot_components::derivatives::{ForceDerivatives, TorqueDerivatives};
use aerobot_components::state::{Force, Torque};
use bevy_ecs::change_detection::DetectChangesMut;
use bevy_ecs::system::Query;
use glam::DVec3;

/// Sets every force and torque to zero.
pub fn clear_accumulators(mut forces: Query<&mut Force>, mut torques: Query<&mut Torque>) {
    for mut force in &mut forces {
        force.bypass_change_detection().0 = DVec3::ZERO;
    }
    for mut torque in &mut torques {
        torque.bypass_change_detection().0 = DVec3::ZERO;
    }
}

/// Sets the derivatives of forces and torques to zero; those of segments are found anew as a whole.
pub fn clear_derivatives(
    mut forces: Query<&mut ForceDerivatives>,
    mut torques: Query<&mut TorqueDerivatives>,
) {
    for mut derivatives in &mut forces {
        *derivatives.bypass_change_detection() = ForceDerivatives::default();
    }
    for mut derivatives in &mut torques {
        *derivatives.bypass_change_detection() = TorqueDerivatives::default();
    }
}
