//! Drag of a body: F = -1/2 rho C_d S |v| v at the centre of mass, v relative to the air.
//!
//! rho density (kg/m^3), C_d drag coefficient, S reference area (m^2), v = body velocity - wind
//! (m/s). C_d is constant, or that of a smooth sphere by its Reynolds number Re = rho |v| D / mu
//! (Morrison 2016), mu the dynamic viscosity (Pa s). No lift and no moment (paper, sec. 3.3.1).

use aerobot_components::aerodynamics::{ConstantDragArea, SphereDrag};
use aerobot_components::derivatives::ForceDerivatives;
use aerobot_components::state::{Air, Force, Position, Velocity};
use bevy_ecs::entity::Entity;
use bevy_ecs::resource::Resource;
use bevy_ecs::system::{Query, Res, ResMut};
use glam::{DMat3, DVec3};

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

/// Finds how drag of constant coefficient changes with velocity.
pub fn constant_drag_derivatives(
    mut bodies: Query<(&ConstantDragArea, &Air, &Velocity, &mut ForceDerivatives)>,
) {
    for (area, air, velocity, mut derivatives) in &mut bodies {
        let relative = velocity.0 - air.velocity_m_s;
        let coefficient = 0.5 * air.density_kg_m3 * area.0;
        derivatives.by_velocity_n_s_m -= square_law_damping(coefficient, relative);
    }
}

/// Finds how the drag of smooth spheres changes with velocity, with the coefficient held as it is.
pub fn sphere_drag_derivatives(
    environment: Res<EnvironmentModel>,
    mut bodies: Query<(
        &SphereDrag,
        &Air,
        &Position,
        &Velocity,
        &mut ForceDerivatives,
    )>,
) {
    for (sphere, air, position, velocity, mut derivatives) in &mut bodies {
        let Ok(Some(viscosity)) = environment.atmosphere.viscosity_pa_s(position.0.z) else {
            continue;
        };
        let relative = velocity.0 - air.velocity_m_s;
        let speed = relative.length_squared().sqrt();
        let reynolds = air.density_kg_m3 * speed * sphere.diameter_m / viscosity;
        let by_speed = 0.5 * drag_factor(reynolds) * viscosity * sphere.area_m2 / sphere.diameter_m;
        // b |v| v has the slope b (|v| I + v v'/|v|); here b |v| is known, finite at rest.
        let direction = if speed > 0.0 {
            relative / speed
        } else {
            DVec3::ZERO
        };
        derivatives.by_velocity_n_s_m -= by_speed * (DMat3::IDENTITY + outer(direction, direction));
    }
}

/// Slope of `coefficient |v| v`: `coefficient (|v| I + v v'/|v|)`, N s/m.
fn square_law_damping(coefficient: f64, v: DVec3) -> DMat3 {
    let speed = v.length_squared().sqrt();
    if speed == 0.0 {
        return DMat3::ZERO;
    }
    coefficient * (speed * DMat3::IDENTITY + outer(v, v) * (1.0 / speed))
}

/// `a b'`.
fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The slope against central differences of the law.
    #[test]
    fn the_damping_is_the_slope_of_the_square_law() {
        let law = |v: DVec3| 0.7 * v.length() * v;
        let v = DVec3::new(1.0, -2.0, 0.5);
        let found = square_law_damping(0.7, v);
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            let h = 1e-5;
            let slope = (law(v + h * axis) - law(v - h * axis)) / (2.0 * h);
            assert!((found * axis - slope).length() < 1e-9, "{axis}");
        }
    }
}
