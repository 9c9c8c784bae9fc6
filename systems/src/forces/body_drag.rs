//! Drag of a body: F = -1/2 rho C_d S |v| v at the centre of mass, v relative to the air.
//!
//! rho density (kg/m^3), C_d drag coefficient, S reference area (m^2), v = body velocity - wind
//! (m/s). C_d is constant, or that of a smooth sphere by its Reynolds number Re = rho |v| D / mu
//! (Morrison 2016), mu the dynamic viscosity (Pa s). No lift and no moment (paper, sec. 3.3.1).

use aerobot_components::aerodynamics::{ConstantDragArea, SphereDrag};
use aerobot_components::state::{Air, Force, Position, Velocity};
use bevy_ecs::entity::Entity;
use bevy_ecs::resource::Resource;
use bevy_ecs::system::{Query, Res, ResMut};

use crate::environment::EnvironmentModel;
use crate::environment::sphere_drag::{HIGHEST_REYNOLDS, drag_factor};
use crate::fault::FaultSlot;

/// Adds drag of constant coefficient.
pub fn constant_drag(mut bodies: Query<(&ConstantDragArea, &Air, &Velocity, &mut Force)>) {
    for (area, air, velocity, mut force) in &mut bodies {
        let relative = velocity.0 - air.velocity_m_s;
        let speed = relative.length_squared().sqrt();
        force.0 -= 0.5 * air.density_kg_m3 * area.0 * speed * relative;
    }
}

/// Spheres whose Reynolds number has been beyond the correlation, in the order in which they were.
#[derive(Resource, Debug, Default)]
pub struct BeyondMorrison(pub Vec<Entity>);

/// Adds the drag of smooth spheres.
///
/// With C_d Re finite at rest, 1/2 rho C_d S |v| v = 1/2 (C_d Re) (mu S / D) v needs no division by
/// the speed.
pub fn sphere_drag(
    environment: Res<EnvironmentModel>,
    mut beyond: ResMut<BeyondMorrison>,
    mut faults: ResMut<FaultSlot>,
    mut bodies: Query<(Entity, &SphereDrag, &Air, &Position, &Velocity, &mut Force)>,
) {
    for (entity, sphere, air, position, velocity, mut force) in &mut bodies {
        let viscosity = match environment.atmosphere.viscosity_pa_s(position.0.z) {
            Ok(Some(viscosity)) => viscosity,
            // Vacuum, or a density of zero: no drag. Air without a temperature is refused earlier.
            Ok(None) => continue,
            Err(outside) => {
                faults.report(Some(entity), || outside.to_string());
                continue;
            }
        };
        let relative = velocity.0 - air.velocity_m_s;
        let speed = relative.length_squared().sqrt();
        let reynolds = air.density_kg_m3 * speed * sphere.diameter_m / viscosity;
        if reynolds > HIGHEST_REYNOLDS && !beyond.0.contains(&entity) {
            beyond.0.push(entity);
        }
        force.0 -=
            0.5 * drag_factor(reynolds) * viscosity * sphere.area_m2 / sphere.diameter_m * relative;
    }
}
