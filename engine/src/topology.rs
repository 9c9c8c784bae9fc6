//! What tethers join in a world, as flat lists: lines, and the free bodies at their ends.

use std::collections::BTreeMap;

use aerobot_components::state::{Inertia, Mass, StateIndex};
use aerobot_components::tether::{Attachment, TetherNode, TetherParts, TetherPoint, TetherSide};
use aerobot_systems::dynamics::state_space::Layout;
use aerobot_systems::linearised_motion::topology::{BodyIndex, BodySite, End, Line, Topology};
use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use bevy_ecs::query::Without;
use bevy_ecs::world::World;

use crate::scene::SetupError;

/// Place of an attachment on a free body: line and side.
#[derive(Component, Clone, Copy, Debug)]
pub(crate) struct LineEnd(pub(crate) usize, pub(crate) usize);

/// A topology with the entities that it was made of.
#[derive(Clone, Debug, Default)]
pub(crate) struct WorldTopology {
    pub(crate) topology: Topology,
    /// Of each body.
    pub(crate) bodies: Vec<Entity>,
    /// Of each line.
    pub(crate) tethers: Vec<Entity>,
}

/// What is joined to what; leaves [`BodyIndex`] on free bodies and [`LineEnd`] on their ends.
pub(crate) fn find(world: &mut World, layout: Layout) -> Result<WorldTopology, SetupError> {
    let mut found = WorldTopology::default();
    found.topology.coordinates = layout.coordinates;
    let indices = find_bodies(world, &mut found);
    let mut tethers: Vec<(usize, Entity, TetherParts)> = world
        .query::<(Entity, &TetherParts)>()
        .iter(world)
        .filter_map(|(tether, parts)| {
            let first = *parts.points.first()?;
            let first_point = world.get::<TetherPoint>(first)?.index;
            Some((first_point, tether, parts.clone()))
        })
        .collect();
    tethers.sort_by_key(|(first_point, ..)| *first_point);
    for (first_point, tether, parts) in &tethers {
        let topology = &mut found.topology;
        let index = topology.lines.len();
        let nodes = parts.points.len() - 2;
        let mut ends = [End::Held; 2];
        for point in [parts.points.first(), parts.points.last()]
            .into_iter()
            .flatten()
        {
            let Some(end) = world.get::<Attachment>(*point).copied() else {
                continue;
            };
            let Some(body) = indices.get(&end.carrier).copied() else {
                continue;
            };
            let side = usize::from(end.side == TetherSide::To);
            ends[side] = End::OnBody(body);
            world.entity_mut(*point).insert(LineEnd(index, side));
            let arm_m = &mut topology.bodies[body].arm_m;
            *arm_m = arm_m.max(end.offset_m.length());
        }
        topology.lines.push(Line {
            first_point: *first_point,
            nodes,
            first_state: first_state(world, parts)?,
            from: ends[0],
            to: ends[1],
        });
        topology.points = topology.points.max(first_point + nodes + 2);
        found.tethers.push(*tether);
    }
    Ok(found)
}

/// The free bodies in the order of the state; their indices.
fn find_bodies(world: &mut World, found: &mut WorldTopology) -> BTreeMap<Entity, usize> {
    let mut free: Vec<(usize, Entity)> = world
        .query_filtered::<(&StateIndex, Entity), Without<TetherNode>>()
        .iter(world)
        .map(|(index, entity)| (index.0, entity))
        .collect();
    free.sort_unstable();
    let mut indices = BTreeMap::new();
    for (index, (first_state, entity)) in free.into_iter().enumerate() {
        indices.insert(entity, index);
        found.topology.bodies.push(BodySite {
            first_state,
            turns: world.get::<Inertia>(entity).is_some(),
            arm_m: gyration_radius_m(world, entity),
        });
        found.bodies.push(entity);
        world.entity_mut(entity).insert(BodyIndex(index));
    }
    indices
}

/// Where the nodes of a tether begin in the state, in which they must be consecutive.
fn first_state(world: &World, parts: &TetherParts) -> Result<usize, SetupError> {
    let nodes = &parts.points[1..parts.points.len() - 1];
    let places = nodes
        .iter()
        .filter_map(|node| world.get::<StateIndex>(*node));
    let Some(first) = places.clone().next().map(|place| place.0) else {
        return Ok(0);
    };
    let in_order = places
        .enumerate()
        .all(|(k, place)| place.0 == first + 3 * k);
    if in_order {
        Ok(first)
    } else {
        Err(SetupError::new(
            "entities",
            "a plugin has held a node of a tether, or changed the order of nodes",
            "hold bodies, not nodes, or use `Adaptive()`",
        ))
    }
}

/// By how much an error of attitude moves a body, m: its largest radius of gyration.
fn gyration_radius_m(world: &World, body: Entity) -> f64 {
    let Some(mass) = world.get::<Mass>(body) else {
        return 0.0;
    };
    world.get::<Inertia>(body).map_or(0.0, |inertia| {
        let diagonal = inertia
            .0
            .x_axis
            .x
            .max(inertia.0.y_axis.y)
            .max(inertia.0.z_axis.z);
        (diagonal / mass.0).sqrt()
    })
}
