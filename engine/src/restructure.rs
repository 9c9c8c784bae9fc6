//! Going on after the topology of a world has changed: everything that depends on it is found anew from the
//! components as they are. Time, cost and the memory of step sizes go on.

use std::sync::Arc;

use aerobot_systems::integration::{Equations, StepFailure};
use bevy_ecs::resource::Resource;
use bevy_ecs::world::World;

use crate::builtin::recorder::bind_rows;
use crate::coordinates::Coordinates;
use crate::evaluation::{Integration, WorldEquations};
use crate::integrator_choice::is_linearised;
use crate::scene::{Scene, SetupError};
use crate::world::lay_out_state;

/// The scene that a world was built from.
#[derive(Resource, Clone)]
pub(crate) struct SceneOfWorld(pub(crate) Arc<Scene>);

/// Finds anew the places in the state, the topology, the coordinates, the solver of implicit stages, the
/// scales of errors, what the integrator keeps of a state's length, the rows of files, and the state itself.
/// Its rates are stale: [`evaluate`] finds them.
///
/// # Errors
/// A topology that the formulation cannot move.
pub(crate) fn restructure(
    world: &mut World,
    integration: &mut Integration,
) -> Result<(), SetupError> {
    let scene = world.resource::<SceneOfWorld>().0.clone();
    let layout = lay_out_state(world);
    let Coordinates {
        mut state,
        linearised: (topology, solver),
    } = Coordinates::of(world, &scene, layout)?;
    let trajectory = &mut integration.trajectory;
    let length = state.layout().len();
    trajectory.state.resize(length, 0.0);
    trajectory.rates.resize(length, 0.0);
    trajectory.rates_are_current = false;
    state.gather(world, &mut trajectory.state);
    let scales = state.error_scales(world);
    let first_order = scales[2 * state.layout().coordinates..].to_vec();
    let linearisation = &mut integration.implicit.linearisation;
    linearisation.renew(world, first_order, topology, solver);
    integration.integrator.resize(&scales);
    integration.state = state;
    bind_rows(world);
    Ok(())
}

/// Evaluates the state as it is now, so that what is recorded belongs to it, and linearises the motion there:
/// explicit steps, too, measure their errors with the places that this finds.
///
/// # Errors
/// It cannot be evaluated.
pub(crate) fn evaluate(
    world: &mut World,
    integration: &mut Integration,
) -> Result<(), StepFailure> {
    let Integration {
        evaluation,
        state,
        implicit,
        trajectory,
        ..
    } = integration;
    trajectory.rates_are_current = false;
    let asks = is_linearised(&world.resource::<SceneOfWorld>().0.run.integrator);
    let mut equations = WorldEquations {
        world,
        evaluation,
        state: &mut **state,
        implicit,
    };
    trajectory.refresh(&mut equations)?;
    if asks {
        equations.linearise();
    }
    Ok(())
}

#[cfg(test)]
mod tests;
