//! Where everything starts that has no pose: in static equilibrium in still air.
//!
//! A geometric guess (everything hangs plumb from what holds it) is carried to equilibrium by
//! Newton's method on the same forces that the run uses, with the air still and everything at rest.
//! A system that nothing fixes floats: its balloon's altitude is where the vertical force vanishes,
//! its horizontal place is x = y = 0.

mod equilibrium;
mod floating;
mod guess;
mod nodes;

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

/// Brings a system that an anchor holds to rest in the scene's own wind, from where it stands.
///
/// The wind is brought up in parts: a part that Newton's method cannot follow is halved.
///
/// # Errors
/// Which entity finds no rest, or which one no anchor holds.
pub(crate) fn settle_in_wind(
    world: &mut World,
    evaluation: &mut Evaluation,
    scene: &Scene,
) -> Result<(), SetupError> {
    check_held(world, scene)?;
    let free: Vec<Entity> = world
        .query_filtered::<Entity, (With<crate::world::Free>, With<Attitude>)>()
        .iter(world)
        .collect();
    let unplaced = Unplaced {
        bodies: free,
        floating: Vec::new(),
    };
    let wind = world.resource::<EnvironmentModel>().wind.clone();
    let (mut reached, mut part) = (0.0_f64, 1.0_f64);
    while reached < 1.0 {
        let target = (reached + part).min(1.0);
        let before = Poses::of(world);
        world.resource_mut::<EnvironmentModel>().wind = wind.scaled(target);
        let solved = at_rest(world, |world| {
            equilibrium::solve(world, evaluation, scene, &unplaced)
        });
        match solved {
            Ok(()) => {
                reached = target;
                part *= 2.0;
            }
            Err(error) if part < SMALLEST_PART_OF_WIND => return Err(error),
            Err(_) => {
                before.restore(world);
                part *= 0.5;
            }
        }
    }
    world.resource_mut::<EnvironmentModel>().wind = wind;
    take_as_origin(world);
    Ok(())
}

/// A wind that cannot be brought up in parts as small as this has no rest.
const SMALLEST_PART_OF_WIND: f64 = 1e-3;

/// Every body must be tethered to an anchor: what floats drifts, and has no rest in wind.
fn check_held(world: &World, scene: &Scene) -> Result<(), SetupError> {
    let names = world.resource::<SceneEntities>();
    for (entity, _) in scene.with::<aerobot_components::body::Body>() {
        let held = crate::balloon_sizing::tethered_together(scene, &entity.name)
            .into_iter()
            .filter_map(|name| names.get(name))
            .any(|id| world.entity(id).contains::<Anchor>());
        if !held {
            return Err(SetupError::new(
                format!("entities.{}", entity.name),
                format!(
                    "`{}` is held by no anchor: it drifts with the wind",
                    entity.name
                ),
                "tether it to an entity with `Fixed`",
            ));
        }
    }
    Ok(())
}

/// Where everything is, to be returned to.
struct Poses {
    positions: Vec<(Entity, Position)>,
    attitudes: Vec<(Entity, Attitude)>,
}

impl Poses {
    fn of(world: &mut World) -> Self {
        let positions = world
            .query::<(Entity, &Position)>()
            .iter(world)
            .map(|(entity, position)| (entity, *position))
            .collect();
        let attitudes = world
            .query::<(Entity, &Attitude)>()
            .iter(world)
            .map(|(entity, attitude)| (entity, *attitude))
            .collect();
        Self {
            positions,
            attitudes,
        }
    }

    fn restore(self, world: &mut World) {
        for (entity, position) in self.positions {
            world.entity_mut(entity).insert(position);
        }
        for (entity, attitude) in self.attitudes {
            world.entity_mut(entity).insert(attitude);
        }
    }
}

/// What placement has to know of the scene.
pub(crate) struct Unplaced {
    /// Bodies without a pose, in the order of the scene.
    bodies: Vec<Entity>,
    /// Bodies among them whose position floats, one for each system that nothing fixes.
    floating: Vec<Entity>,
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
    let unplaced = Unplaced { bodies, floating };
    in_still_air(world, |world| {
        equilibrium::solve(world, evaluation, scene, &unplaced)
    })?;
    place_given_nodes(world);
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
            TetherStart::Equilibrium => {}
            TetherStart::Straight => nodes::place_on_line(world, tether),
            TetherStart::Positions(positions) => {
                nodes::set_node_positions(world, tether, &positions);
            }
        }
    }
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
fn attachment_position(world: &World, carrier: Entity, offset_m: DVec3) -> DVec3 {
    let position = world
        .get::<Position>(carrier)
        .map_or(DVec3::ZERO, |position| position.0);
    let attitude = world.get::<Attitude>(carrier).copied().unwrap_or_default();
    position + attitude.0 * offset_m
}
