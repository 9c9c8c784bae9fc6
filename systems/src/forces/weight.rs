//! Weight: F = -m g(z) z_hat.
//!
//! m mass (kg), without added mass; g acceleration of gravity (m/s^2), constant or inverse square.
//! It acts at the centre of mass of a body, on the nodes of a tether, and on the share of a tether's
//! mass that stands at an attachment.

use aerobot_components::state::{Force, Mass, Position};
use bevy_ecs::change_detection::DetectChangesMut;
use bevy_ecs::system::{Query, Res};

use crate::environment::EnvironmentModel;

/// Adds the weight of everything that has a mass.
pub fn weight(
    environment: Res<EnvironmentModel>,
    mut bodies: Query<(&Mass, &Position, &mut Force)>,
) {
    let gravity = environment.gravity;
    for (mass, position, mut force) in &mut bodies {
        force.bypass_change_detection().0.z -= mass.0 * gravity.acceleration_m_s2(position.0.z);
    }
}
