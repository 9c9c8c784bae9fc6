//! Numbers of nodes and segments after one has come or gone: from 1 at `from`, points of a tether one after
//! the other.

use aerobot_components::segment::Segment;
use aerobot_components::tether::{TetherNode, TetherParts, TetherPoint};
use aerobot_components::torsion::Torsion;
use aerobot_systems::dynamics::segments::PointArrays;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;

use crate::world::{EntityName, SceneEntities, SpawnOrder, next_spawn_order};

/// Gives a new node among `parts` its place in the order of spawning, beside its neighbours.
pub(super) fn place_in_order(world: &mut World, parts: &TetherParts, node: Entity) {
    let after = parts
        .points
        .iter()
        .skip_while(|point| **point != node)
        .skip(1)
        .find_map(|point| world.get::<SpawnOrder>(*point));
    let before = parts
        .points
        .iter()
        .take_while(|point| **point != node)
        .filter_map(|point| world.get::<SpawnOrder>(*point))
        .last();
    let order = match (before, after) {
        (_, Some(after)) => *after,
        (Some(before), None) => SpawnOrder(before.0 + 1),
        (None, None) => next_spawn_order(world),
    };
    let mut orders = world.query::<&mut SpawnOrder>();
    for mut other in orders.iter_mut(world) {
        if *other >= order {
            other.0 += 1;
        }
    }
    world.entity_mut(node).insert(order);
}

/// Numbers the nodes, points and segments of all tethers.
pub(super) fn renumber(world: &mut World) {
    let tethers = world.resource::<SceneEntities>().in_order().to_vec();
    let mut points = 0;
    for tether in tethers {
        let (Some(parts), Some(name)) = (
            world.get::<TetherParts>(tether).cloned(),
            world.get::<EntityName>(tether).cloned(),
        ) else {
            continue;
        };
        for (place, point) in parts.points.iter().enumerate() {
            let index = TetherPoint {
                index: points + place,
            };
            let mut point = world.entity_mut(*point);
            point.insert(index);
            if point.contains::<TetherNode>() {
                let number = place as u32;
                let name = EntityName(format!("{}/{number}", name.0).into());
                point.insert((TetherNode { tether, number }, name));
            }
        }
        for (place, segment) in parts.segments.iter().enumerate() {
            world.entity_mut(*segment).insert(Segment {
                tether,
                number: place as u32 + 1,
                from_point: points + place,
            });
        }
        if let Some(mut torsion) = world.get_mut::<Torsion>(tether) {
            torsion.points = points..points + parts.points.len();
        }
        points += parts.points.len();
    }
    world.insert_resource(PointArrays::new(points));
}
