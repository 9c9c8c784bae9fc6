//! Where everything starts that has no pose: in static equilibrium in still air.
//!
//! A geometric guess (everything hangs plumb from what holds it) is carried to equilibrium by
//! Newton's method on the same forces that the run uses, with the air still and everything at rest.
//! A system that nothing fixes floats: its balloon's altitude is where the vertical force vanishes,
//! its horizontal place is x = y = 0.
//!
//! From there, or from any other start, `settle` finds the steady state in the scene's own wind.

mod buoyant_altitude;
mod drift;
mod equilibrium;
mod floating;
mod guess;
mod nodes;
mod rigid_lengths;
mod sites;
pub(crate) mod snapshot;
mod stability;
mod steady;
mod tethered_system;
mod twists;

pub(crate) use steady::{SteadySystem, settle};
pub(crate) use tethered_system::{TetheredSystem, find as tethered_systems};
pub(crate) use twists::accept_twists;

use aerobot_components::body::{Anchor, Pose};
use aerobot_components::state::{
    AngularVelocity, Attitude, ChartAttitude, Origin, Position, Velocity,
};
use aerobot_components::tether::{Tether, TetherNode, TetherStart};
use aerobot_systems::clock::Clock;
use aerobot_systems::environment::EnvironmentModel;
use aerobot_systems::environment::wind::Wind;
use bevy_ecs::entity::Entity;
use bevy_ecs::query::{Or, With};
use bevy_ecs::world::World;
use glam::DVec3;

use crate::evaluation::Evaluation;
use crate::scene::{Scene, SetupError};
use crate::world::SceneEntities;

/// What placement has to know of the scene.
pub(crate) struct Unplaced {
    /// Bodies without a pose, in the order of the scene.
    bodies: Vec<Entity>,
    /// Bodies among them whose position floats, one for each system that nothing fixes.
    floating: Vec<Entity>,
    /// The tethers whose nodes find their places; without a list, those that start in equilibrium and
    /// those that hold one of the bodies.
    tethers: Option<Vec<Entity>>,
}

/// Places every body and node of the scene.
pub(crate) fn place(
    world: &mut World,
    evaluation: &mut Evaluation,
    scene: &Scene,
) -> Result<(), SetupError> {
    let bodies = bodies_without_pose(world, scene);
    let floating = guess::place_bodies(world, scene, &bodies)?;
    nodes::place_nodes(world);
    twists::refer(world);
    let unplaced = Unplaced {
        bodies,
        floating,
        tethers: None,
    };
    in_still_air(world, |world| {
        equilibrium::solve(world, evaluation, scene, &unplaced)
    })?;
    place_given_nodes(world);
    twists::refer_given(world, &unplaced.bodies);
    take_as_origin(world);
    Ok(())
}

fn bodies_without_pose(world: &World, scene: &Scene) -> Vec<Entity> {
    let names = world.resource::<SceneEntities>();
    scene
        .with::<aerobot_components::body::Body>()
        .filter(|(entity, _)| !entity.has::<Pose>())
        .filter_map(|(entity, _)| names.get(&entity.name))
        .filter(|id| !world.entity(*id).contains::<Anchor>())
        .collect()
}

/// Runs `work` without wind and with everything at rest, then restores both.
fn in_still_air<R>(world: &mut World, work: impl FnOnce(&mut World) -> R) -> R {
    let wind = std::mem::replace(
        &mut world.resource_mut::<EnvironmentModel>().wind,
        Wind::still(),
    );
    let result = at_rest(world, work);
    world.resource_mut::<EnvironmentModel>().wind = wind;
    result
}

/// Runs `work` with everything at rest, then gives everything its motion again.
fn at_rest<R>(world: &mut World, work: impl FnOnce(&mut World) -> R) -> R {
    let mut moving = world.query_filtered::<(Entity, &mut Velocity, Option<&mut AngularVelocity>), Or<(
        With<TetherNode>,
        With<Attitude>,
    )>>();
    let mut motions = Vec::new();
    for (entity, mut velocity, rate) in moving.iter_mut(world) {
        let old_rate = rate.map(|mut rate| std::mem::take(&mut *rate));
        motions.push((entity, std::mem::take(&mut *velocity), old_rate));
    }
    world.resource_mut::<Clock>().at_rest = true;
    let result = work(world);
    world.resource_mut::<Clock>().at_rest = false;
    for (entity, velocity, rate) in motions {
        let mut entity = world.entity_mut(entity);
        entity.insert(velocity);
        if let Some(rate) = rate {
            entity.insert(rate);
        }
    }
    result
}

/// Puts the nodes of tethers that do not start in equilibrium where the scene wants them.
fn place_given_nodes(world: &mut World) {
    let mut tethers = world.query::<(Entity, &Tether)>();
    let given: Vec<(Entity, TetherStart)> = tethers
        .iter(world)
        .filter(|(_, tether)| tether.start != TetherStart::Equilibrium)
        .map(|(entity, tether)| (entity, tether.start.clone()))
        .collect();
    for (tether, start) in given {
        match start {
            TetherStart::Equilibrium | TetherStart::Each(_) => {}
            TetherStart::Straight => nodes::place_on_line(world, tether),
            TetherStart::Positions(positions) => {
                nodes::set_node_positions(world, tether, &positions);
            }
        }
    }
}

/// Force in N that the round-off of positions makes of the stiffest segment.
pub(crate) fn position_noise_n(world: &mut World) -> f64 {
    equilibrium::Scales::of(world).position_noise_n
}

/// The placed state is the origin of displacements and the centre of the charts.
fn take_as_origin(world: &mut World) {
    let mut placed = world.query::<(&Position, &mut Origin)>();
    for (position, mut origin) in placed.iter_mut(world) {
        origin.0 = position.0;
    }
    let mut turned = world.query::<(&Attitude, &mut ChartAttitude)>();
    for (attitude, mut chart) in turned.iter_mut(world) {
        chart.0 = attitude.0;
    }
}

/// Position of an attachment on a carrier as it stands, inertial frame, m.
pub(crate) fn attachment_position(world: &World, carrier: Entity, offset_m: DVec3) -> DVec3 {
    let position = world
        .get::<Position>(carrier)
        .map_or(DVec3::ZERO, |position| position.0);
    let attitude = world.get::<Attitude>(carrier).copied().unwrap_or_default();
    position + attitude.0 * offset_m
}
