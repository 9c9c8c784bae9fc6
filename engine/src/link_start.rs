//! How a tree of rigid links starts from a scene that was written for tethers: where the poses and
//! motions of a scene stretch them, bodies start where, and as fast as, the links let them.

use aerobot_components::segment::RigidLink;
use aerobot_components::state::{Position, StateIndex, Velocity};
use aerobot_components::tether::{Tether, TetherNode};
use aerobot_systems::dynamics::link_mechanism::LinkMechanism;
use aerobot_systems::linearised_motion::topology::BodyIndex;
use bevy_ecs::entity::Entity;
use bevy_ecs::query::{With, Without};
use bevy_ecs::world::World;
use glam::DVec3;

use crate::scene::SetupError;
use crate::stopping::owner_name;
use crate::world::{EntityName, Warnings};

/// Bodies may be moved by this part of the longest tether, about what a tether stretches at most.
const LARGEST_SHIFT: f64 = 0.02;
/// Moved by less than this part of the longest tether, nobody is told.
const NO_SHIFT: f64 = 1e-7;
/// A change of velocity of which nobody is told, m/s.
const NO_SPEED_M_S: f64 = 1e-7;

/// Where free bodies were, and how they moved.
pub(crate) struct Start(Vec<(Entity, DVec3, DVec3)>);

impl Start {
    /// As the components have them.
    pub(crate) fn of(world: &mut World) -> Self {
        let mut bodies = world
            .query_filtered::<(Entity, &Position, &Velocity), (With<StateIndex>, Without<TetherNode>)>(
            );
        Self(
            bodies
                .iter(world)
                .map(|(entity, position, velocity)| (entity, position.0, velocity.0))
                .collect(),
        )
    }

    /// Compares with what the links have made of it; warns of small changes.
    ///
    /// # Errors
    /// A body is not where its links can be.
    pub(crate) fn check(&self, world: &mut World) -> Result<(), SetupError> {
        let is_rigid = world
            .query_filtered::<(), With<RigidLink>>()
            .iter(world)
            .next()
            .is_some();
        if !is_rigid {
            return Ok(());
        }
        let longest_m = world
            .query::<&Tether>()
            .iter(world)
            .map(|tether| tether.length_m)
            .fold(0.0, f64::max);
        for (entity, position_m, velocity_m_s) in &self.0 {
            let name = world
                .get::<EntityName>(*entity)
                .map_or_else(String::new, |name| name.0.to_string());
            let now = world.get::<Position>(*entity).copied().unwrap_or_default();
            let shift_m = now.0.distance(*position_m);
            if shift_m > LARGEST_SHIFT * longest_m {
                return Err(SetupError::new(
                    format!("entities.{name}"),
                    format!(
                        "`{name}` starts {shift_m:.6} m from where the rigid links of `{}` can hold it",
                        carrier(world, *entity)
                    ),
                    "place the bodies as far apart as the tether is long, leave out a `Pose`, or set \
                     `elastic_links: true`",
                ));
            }
            let speed = world.get::<Velocity>(*entity).copied().unwrap_or_default();
            let speed_m_s = speed.0.distance(*velocity_m_s);
            let mut warn = |text: String| world.resource_mut::<Warnings>().0.push(text);
            if shift_m > NO_SHIFT * longest_m {
                warn(format!(
                    "`{name}` starts {shift_m:.6} m from its place in the scene: rigid links do not \
                     stretch"
                ));
            }
            if speed_m_s > NO_SPEED_M_S {
                warn(format!(
                    "`{name}` starts at another velocity than in the scene, by {speed_m_s:.6} m/s: rigid \
                     links do not let it move as told"
                ));
            }
        }
        Ok(())
    }
}

/// The tether that carries a body in the tree.
fn carrier(world: &World, body: Entity) -> String {
    let found = || {
        let index = world.get::<BodyIndex>(body)?.0;
        let mechanism = world.get_resource::<LinkMechanism>()?;
        let limb = mechanism.tree.carried_by[index]?;
        let first = mechanism.tree.limbs[limb].links.start;
        owner_name(world, mechanism.entities.segments[first])
    };
    found().unwrap_or_default()
}
