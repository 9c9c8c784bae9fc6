//! Where everything is and how it moves, to be returned to.

use aerobot_components::state::{AngularVelocity, Attitude, Position, Velocity};
use bevy_ecs::entity::Entity;
use bevy_ecs::query::Without;
use bevy_ecs::world::World;

use aerobot_components::tether::Attachment;

/// The state of motion of everything that has one; attachments follow their carriers.
pub(crate) struct Snapshot {
    points: Vec<(Entity, Position, Velocity)>,
    turns: Vec<(Entity, Attitude, AngularVelocity)>,
}

impl Snapshot {
    /// As it is now.
    pub(crate) fn of(world: &mut World) -> Self {
        let points = world
            .query_filtered::<(Entity, &Position, &Velocity), Without<Attachment>>()
            .iter(world)
            .map(|(entity, position, velocity)| (entity, *position, *velocity))
            .collect();
        let turns = world
            .query::<(Entity, &Attitude, &AngularVelocity)>()
            .iter(world)
            .map(|(entity, attitude, rate)| (entity, *attitude, *rate))
            .collect();
        Self { points, turns }
    }

    /// Puts everything back.
    pub(crate) fn restore(&self, world: &mut World) {
        for (entity, position, velocity) in &self.points {
            world.entity_mut(*entity).insert((*position, *velocity));
        }
        for (entity, attitude, rate) in &self.turns {
            world.entity_mut(*entity).insert((*attitude, *rate));
        }
    }
}
