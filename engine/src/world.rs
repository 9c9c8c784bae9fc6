//! Building a world from a scene: every entity with its components, then the setups of the plugins.

use std::collections::BTreeMap;
use std::sync::Arc;

use aerobot_components::state::{FirstOrderState, StateIndex};
use aerobot_components::tether::TetherNode;
use aerobot_systems::clock::Clock;
use aerobot_systems::dynamics::first_order::FirstOrderIndex;
use aerobot_systems::dynamics::state_space::Layout;
use aerobot_systems::dynamics::state_vector::{BODY_COORDINATES, NODE_COORDINATES};
use aerobot_systems::fault::FaultSlot;
use aerobot_systems::forces::body_drag::BeyondMorrison;
use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use bevy_ecs::resource::Resource;
use bevy_ecs::world::World;

use crate::plugin::Simulator;
use crate::scene::{Scene, SetupError};

/// The name of an entity in files and messages: `gondola`, or `tether/3` for a node.
#[derive(Component, Clone, Debug, PartialEq, Eq)]
pub struct EntityName(pub Arc<str>);

/// Marks what the run integrates, before it is given its place in the state.
///
/// A setup that inserts it on a body or node makes it free to move.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct Free;

/// The entities of a scene by name, and in the order of the scene.
#[derive(Resource, Clone, Debug, Default)]
pub struct SceneEntities {
    by_name: BTreeMap<Arc<str>, Entity>,
    in_order: Vec<Entity>,
}

impl SceneEntities {
    /// The entity of a name of the scene.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<Entity> {
        self.by_name.get(name).copied()
    }

    /// All of them, in the order of the scene.
    #[must_use]
    pub fn in_order(&self) -> &[Entity] {
        &self.in_order
    }
}

/// The order in which entities were spawned: scene entities, then nodes. It orders the state vector
/// and the rows of files.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct SpawnOrder(pub usize);

/// The instants of the scene that no step may cross, s, sorted.
///
/// Gust edges are here; a plugin adds its own in a setup.
#[derive(Resource, Clone, Debug, Default)]
pub struct Edges {
    times_s: Vec<f64>,
    next: usize,
}

impl Edges {
    /// Adds instants in s; those at or before the start of the run have no effect.
    pub fn add(&mut self, times_s: impl IntoIterator<Item = f64>) {
        self.times_s
            .extend(times_s.into_iter().filter(|time| time.is_finite()));
        self.times_s.sort_by(f64::total_cmp);
        self.times_s.dedup();
    }

    /// The next instant after the last one passed, s.
    #[must_use]
    pub fn next_s(&self) -> f64 {
        self.times_s
            .get(self.next)
            .copied()
            .unwrap_or(f64::INFINITY)
    }

    /// Passes every instant up to `time_s`; says whether there was one.
    pub fn pass(&mut self, time_s: f64) -> bool {
        let before = self.next;
        while self.next_s() <= time_s {
            self.next += 1;
        }
        self.next > before
    }
}

/// Set by a system that has changed the state at once, so that it is gathered and its rates are found anew.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub struct Discontinuity(pub bool);

/// Things worth knowing that happened: at first occurrence, and not without bound.
#[derive(Resource, Clone, Debug, Default)]
pub struct EventLog {
    events: Vec<Event>,
    dropped: u64,
}

/// Something that happened.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// When, s.
    pub time_s: f64,
    /// What: a word such as `slack` or `taut`.
    pub kind: String,
    /// To which entity.
    pub entity: String,
}

impl EventLog {
    /// More than this are counted and not kept, so that memory does not grow with simulated time.
    const MOST: usize = 1000;

    /// Adds an event.
    pub fn add(&mut self, time_s: f64, kind: &str, entity: &str) {
        if self.events.len() < Self::MOST {
            self.events.push(Event {
                time_s,
                kind: kind.to_owned(),
                entity: entity.to_owned(),
            });
        } else {
            self.dropped += 1;
        }
    }

    /// The events kept, in the order of time.
    #[must_use]
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// How many more there were.
    #[must_use]
    pub fn dropped(&self) -> u64 {
        self.dropped
    }
}

/// What is worth knowing of a run, as sentences: for its summary and its user.
#[derive(Resource, Clone, Debug, Default)]
pub struct Warnings(pub Vec<String>);

/// Builds the world of a scene, with every setup run.
pub(crate) fn build_world(simulator: &Simulator, scene: &Scene) -> Result<World, SetupError> {
    let mut world = World::new();
    world.init_resource::<Clock>();
    world.init_resource::<FaultSlot>();
    world.init_resource::<BeyondMorrison>();
    world.init_resource::<Edges>();
    world.init_resource::<Discontinuity>();
    world.init_resource::<EventLog>();
    world.init_resource::<Warnings>();
    let mut names = SceneEntities::default();
    for (order, entity) in scene.entities.iter().enumerate() {
        let name: Arc<str> = entity.name.as_str().into();
        let mut spawned = world.spawn((EntityName(name.clone()), SpawnOrder(order)));
        for (_, component) in &entity.components {
            component.insert(&mut spawned);
        }
        names.in_order.push(spawned.id());
        names.by_name.insert(name, spawned.id());
    }
    world.insert_resource(names);
    for setup in &simulator.setups {
        setup(&mut world, scene)?;
    }
    Ok(world)
}

/// Gives everything that is integrated its place in the state vector, in the order of spawning.
pub(crate) fn lay_out_state(world: &mut World) -> Layout {
    let mut free: Vec<(SpawnOrder, Entity, bool)> = world
        .query_filtered::<(&SpawnOrder, Entity, Option<&TetherNode>), bevy_ecs::query::With<Free>>()
        .iter(world)
        .map(|(order, entity, node)| (*order, entity, node.is_some()))
        .collect();
    free.sort();
    let mut layout = Layout::default();
    for (_, entity, is_node) in free {
        world
            .entity_mut(entity)
            .insert(StateIndex(layout.coordinates));
        layout.coordinates += if is_node {
            NODE_COORDINATES
        } else {
            BODY_COORDINATES
        };
    }
    let mut first_order: Vec<(SpawnOrder, Entity)> = world
        .query_filtered::<(&SpawnOrder, Entity), bevy_ecs::query::With<FirstOrderState>>()
        .iter(world)
        .map(|(order, entity)| (*order, entity))
        .collect();
    first_order.sort();
    for (_, entity) in first_order {
        world
            .entity_mut(entity)
            .insert(FirstOrderIndex(layout.first_order));
        layout.first_order += 1;
    }
    layout
}

/// The next free place in the order of spawning.
pub fn next_spawn_order(world: &mut World) -> SpawnOrder {
    let last = world.query::<&SpawnOrder>().iter(world).max().copied();
    SpawnOrder(last.map_or(0, |order| order.0 + 1))
}
