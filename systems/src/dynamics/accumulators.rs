//! Clears what forces add to, at the start of every evaluation.

use aerobot_components::segment::SegmentLoad;
use aerobot_components::state::{Force, Torque};
use bevy_ecs::change_detection::DetectChangesMut;
use bevy_ecs::system::Query;
use glam::DVec3;

/// Sets every force, torque and segment load to zero.
pub fn clear_accumulators(
    mut forces: Query<&mut Force>,
    mut torques: Query<&mut Torque>,
    mut loads: Query<&mut SegmentLoad>,
) {
    for mut force in &mut forces {
        force.bypass_change_detection().0 = DVec3::ZERO;
    }
    for mut torque in &mut torques {
        torque.bypass_change_detection().0 = DVec3::ZERO;
    }
    for mut load in &mut loads {
        *load.bypass_change_detection() = SegmentLoad::default();
    }
}
