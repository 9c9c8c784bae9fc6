//! Newton's second law for the nodes of a tether: a = F / m.

use aerobot_components::state::{Acceleration, Force, Mass};
use aerobot_components::tether::TetherNode;
use bevy_ecs::change_detection::DetectChangesMut;
use bevy_ecs::query::With;
use bevy_ecs::system::Query;

/// Accelerates every interior node.
pub fn accelerate_nodes(mut nodes: Query<(&Force, &Mass, &mut Acceleration), With<TetherNode>>) {
    for (force, mass, mut acceleration) in &mut nodes {
        // One division, not three.
        acceleration.bypass_change_detection().0 = force.0 * (1.0 / mass.0);
    }
}
