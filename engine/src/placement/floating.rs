//! The altitude at which a system floats that nothing fixes: where no vertical force remains on its
//! balloon.

use aerobot_components::aerodynamics::DisplacedVolume;
use aerobot_components::state::{Force, Position};
use aerobot_systems::environment::EnvironmentModel;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;

use super::Unplaced;
use super::equilibrium::{Scales, fault_on_the_way, no_equilibrium};
use crate::balloon_sizing::tethered_together;
use crate::evaluation::Evaluation;
use crate::scene::{Scene, SetupError};
use crate::world::{EntityName, SceneEntities};

/// Moves each floating system towards the altitude where no vertical force remains on its balloon;
/// says whether one moved.
pub(super) fn shift_altitudes(
    world: &mut World,
    evaluation: &mut Evaluation,
    scene: &Scene,
    unplaced: &Unplaced,
) -> Result<bool, SetupError> {
    if unplaced.floating.is_empty() {
        return Ok(false);
    }
    evaluation
        .run(world)
        .map_err(|fault| fault_on_the_way(world, &fault))?;
    let scales = Scales::of(world);
    let mut moved = false;
    for balloon in unplaced.floating.clone() {
        let force = world.get::<Force>(balloon).map_or(0.0, |force| force.0.z);
        if force.abs() <= 1e-10_f64.max(2.0 * scales.floor) * scales.force_n {
            continue;
        }
        let slope = lift_slope_n_m(world, scene, balloon);
        if slope >= 0.0 {
            return Err(no_equilibrium(
                world,
                Some(balloon),
                &format!("{force:.3e} N of lift remain, and no altitude changes that"),
            ));
        }
        let shift = (-force / slope).clamp(-1000.0, 1000.0);
        // Its load follows in the next solution.
        if let Some(mut position) = world.get_mut::<Position>(balloon) {
            position.0.z += shift;
        }
        moved = true;
    }
    Ok(moved)
}

/// Change with altitude of the lift of everything tethered together with `balloon`, N/m.
fn lift_slope_n_m(world: &World, scene: &Scene, balloon: Entity) -> f64 {
    let environment = world.resource::<EnvironmentModel>();
    let name = world.get::<EntityName>(balloon).map_or("", |name| &name.0);
    tethered_together(scene, name)
        .into_iter()
        .filter_map(|name| world.resource::<SceneEntities>().get(name))
        .filter_map(|id| {
            Some((
                world.get::<DisplacedVolume>(id)?,
                world.get::<Position>(id)?.0.z,
            ))
        })
        .map(|(volume, z)| {
            let slope = environment.atmosphere.density_slope(z).unwrap_or(0.0);
            slope * volume.0 * environment.gravity.acceleration_m_s2(z)
        })
        .sum()
}
