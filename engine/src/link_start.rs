//! How a tree of rigid links starts from a scene that was written for tethers: where the poses and
//! motions of a scene stretch them, bodies start where, and as fast as, the links let them.

use aerobot_components::segment::{RigidLink, Segment, SegmentGeometry};
use aerobot_components::state::{Attitude, Position, StateIndex, Velocity};
use aerobot_components::tether::{Attachment, Tether, TetherNode, TetherParts, TetherStart};
use aerobot_systems::denoc::articulated_link::Stretch;
use aerobot_systems::dynamics::link_mechanism::LinkMechanism;
use bevy_ecs::entity::Entity;
use bevy_ecs::query::{With, Without};
use bevy_ecs::world::World;
use glam::DVec3;

use crate::scene::SetupError;
use crate::world::{EntityName, Warnings};

/// The ends of a tether may be moved against one another by this part of its length: about what tethers
/// stretch at most.
const LARGEST_SHIFT: f64 = 0.02;
/// Rigid links that close loops are right within this part of their length.
const LARGEST_STRAIN: f64 = 1e-6;
/// Links that lean less than this against each other are on one line, rad.
const LEAST_BEND: f64 = 1e-3;
/// Shifts of which nobody is told, m.
const NO_SHIFT_M: f64 = 1e-5;
/// Changes of velocity of which nobody is told, m/s.
const NO_SPEED_M_S: f64 = 1e-6;

/// Where things were before links took hold of them.
pub(crate) struct Start {
    /// Free bodies: position (m) and velocity (m/s).
    bodies: Vec<(Entity, DVec3, DVec3)>,
    /// Tethers of rigid links: from end to end, m.
    tethers: Vec<(Entity, DVec3)>,
}

impl Start {
    /// As the components have them.
    pub(crate) fn of(world: &mut World) -> Self {
        Self {
            bodies: bodies(world),
            tethers: tethers(world),
        }
    }

    /// Compares with what the links have made of it; warns of small changes.
    ///
    /// # Errors
    /// A tether whose ends its links cannot join.
    pub(crate) fn check(&self, world: &mut World) -> Result<(), SetupError> {
        for ((tether, before), (_, now)) in self.tethers.iter().zip(tethers(world)) {
            let shift_m = before.distance(now);
            let length_m = world.get::<Tether>(*tether).map_or(0.0, |t| t.length_m);
            if shift_m > LARGEST_SHIFT * length_m {
                return Err(out_of_reach(world, *tether, shift_m));
            }
        }
        if self.tethers.is_empty() {
            return Ok(());
        }
        check_loops(world)?;
        for ((entity, was_m, was_m_s), (_, is_m, is_m_s)) in self.bodies.iter().zip(bodies(world)) {
            let name = name(world, *entity);
            let (shift_m, speed_m_s) = (was_m.distance(is_m), was_m_s.distance(is_m_s));
            let warnings = &mut world.resource_mut::<Warnings>().0;
            if shift_m > NO_SHIFT_M {
                warnings.push(format!(
                    "`{name}` starts {shift_m:.6} m from its place in the scene: rigid links do not \
                     stretch"
                ));
            }
            if speed_m_s > NO_SPEED_M_S {
                warnings.push(format!(
                    "`{name}` starts at another velocity than in the scene, by {speed_m_s:.6} m/s: rigid \
                     links do not let it move as told"
                ));
            }
        }
        Ok(())
    }
}

/// Tethers that close loops must reach, and must have a direction in which they can give way.
fn check_loops(world: &World) -> Result<(), SetupError> {
    let Some(mechanism) = world.get_resource::<LinkMechanism>() else {
        return Ok(());
    };
    for closure in &mechanism.tree.closures {
        let (limb, kind) = (
            &mechanism.tree.limbs[closure.limb],
            &mechanism.tree.kinds[closure.limb],
        );
        let segments = &mechanism.entities.segments[limb.links.clone()];
        if kind.stretch == Stretch::Elastic {
            continue;
        }
        let (mut stretch_m, mut tether) = (0.0_f64, None);
        for segment in segments {
            if let (Some(geometry), Some(segment)) = (
                world.get::<SegmentGeometry>(*segment),
                world.get::<Segment>(*segment),
            ) {
                stretch_m = stretch_m.max((geometry.length_m - kind.length_m).abs());
                tether = Some(segment.tether);
            }
        }
        let Some(tether) = tether else { continue };
        if stretch_m > LARGEST_STRAIN * kind.length_m {
            return Err(out_of_reach(world, tether, stretch_m));
        }
        let spans = &mechanism.links.span_m[limb.links.clone()];
        let first = spans[0];
        let across = |span: &DVec3| span.cross(first).length() / first.length_squared();
        let is_folded = spans.iter().any(|span| span.dot(first) < 0.0);
        if is_folded && spans.iter().all(|span| across(span) < LEAST_BEND) {
            let name = name(world, tether);
            return Err(SetupError::new(
                format!("entities.{name}"),
                format!("the rigid links of `{name}` are folded along one line"),
                "a slack tether beside a taut one needs `LumpedMass`, or `run.elastic_links: true`",
            ));
        }
    }
    Ok(())
}

fn out_of_reach(world: &World, tether: Entity, shift_m: f64) -> SetupError {
    let name = name(world, tether);
    let is_laid = world
        .get::<Tether>(tether)
        .is_some_and(|tether| tether.start != TetherStart::Equilibrium);
    let help = if is_laid {
        "let its `start` and the poses at its ends make it as long as it is, or set \
         `run.elastic_links: true`"
    } else {
        "let the poses at its ends be as far apart as it is long, leave out a `Pose`, or set \
         `run.elastic_links: true`"
    };
    SetupError::new(
        format!("entities.{name}"),
        format!("the rigid links of `{name}` miss the places of its ends by {shift_m:.6} m"),
        help,
    )
}

fn name(world: &World, entity: Entity) -> String {
    world
        .get::<EntityName>(entity)
        .map_or_else(String::new, |name| name.0.to_string())
}

fn bodies(world: &mut World) -> Vec<(Entity, DVec3, DVec3)> {
    let mut bodies = world
        .query_filtered::<(Entity, &Position, &Velocity), (With<StateIndex>, Without<TetherNode>)>(
        );
    bodies
        .iter(world)
        .map(|(entity, position, velocity)| (entity, position.0, velocity.0))
        .collect()
}

fn tethers(world: &mut World) -> Vec<(Entity, DVec3)> {
    let found: Vec<(Entity, TetherParts)> = world
        .query::<(Entity, &TetherParts)>()
        .iter(world)
        .map(|(tether, parts)| (tether, parts.clone()))
        .collect();
    let place = |point: Entity| {
        let end = world.get::<Attachment>(point)?;
        let attitude = world.get::<Attitude>(end.carrier)?;
        Some(world.get::<Position>(end.carrier)?.0 + attitude.0 * end.offset_m)
    };
    found
        .iter()
        .filter(|(_, parts)| {
            let first = parts.segments.first();
            first.is_some_and(|first| world.get::<RigidLink>(*first).is_some())
        })
        .filter_map(|(tether, parts)| {
            let span = place(*parts.points.last()?)? - place(*parts.points.first()?)?;
            Some((*tether, span))
        })
        .collect()
}
