//! Buoyancy (Archimedes): F = +rho(z) V g(z) z_hat, at the centre of mass.
//!
//! rho density of the air (kg/m^3), V displaced volume (m^3), g gravity (m/s^2). The paper (sec. 3.3)
//! prints it along g; it acts against it.

use aerobot_components::aerodynamics::DisplacedVolume;
use aerobot_components::state::{Air, Force, Position};
use bevy_ecs::system::{Query, Res};

use crate::environment::EnvironmentModel;

/// Adds the lift of the displaced air.
pub fn buoyancy(
    environment: Res<EnvironmentModel>,
    mut bodies: Query<(&DisplacedVolume, &Air, &Position, &mut Force)>,
) {
    for (volume, air, position, mut force) in &mut bodies {
        let gravity = environment.gravity.acceleration_m_s2(position.0.z);
        force.0.z += air.density_kg_m3 * volume.0 * gravity;
    }
}
