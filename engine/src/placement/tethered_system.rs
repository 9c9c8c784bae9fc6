//! Which bodies, tethers and anchors belong together, and how such a system can move steadily.

use aerobot_components::aerodynamics::DisplacedVolume;
use aerobot_components::body::{Anchor, Moving};
use aerobot_components::fixed_wing::FixedWing;
use aerobot_components::tether::{Tether, TetherNode, TetherParts};
use aerobot_systems::environment::EnvironmentModel;
use aerobot_systems::environment::atmosphere::Atmosphere;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;
use glam::DVec3;

use super::guess::floating_balloon;
use crate::balloon_sizing::tethered_together;
use crate::scene::{Scene, SetupError};
use crate::world::{EntityName, Free, SceneEntities};

/// Everything that tethers join.
#[derive(Clone, Debug, Default)]
pub(crate) struct TetheredSystem {
    /// Bodies that are free to move, in the order of the scene.
    pub(crate) bodies: Vec<Entity>,
    /// Anchors, in the order of the scene.
    pub(crate) anchors: Vec<Entity>,
    /// Tethers, in the order of the scene.
    pub(crate) tethers: Vec<Entity>,
    /// Nodes of the tethers.
    pub(crate) nodes: Vec<Entity>,
    /// Of a system without an anchor, the body whose horizontal place nothing restores: its balloon, or
    /// else its first body.
    pub(crate) reference: Option<Entity>,
}

impl TetheredSystem {
    /// The first of its entities, for messages.
    fn first(&self) -> Option<Entity> {
        self.reference
            .or_else(|| self.bodies.first().copied())
            .or_else(|| self.anchors.first().copied())
    }
}

/// All systems of a scene, in the order of their first entities.
pub(crate) fn find(world: &World, scene: &Scene) -> Vec<TetheredSystem> {
    let names = world.resource::<SceneEntities>();
    let mut seen: Vec<&str> = Vec::new();
    let mut systems = Vec::new();
    for entity in &scene.entities {
        let name = entity.name.as_str();
        // A drone flies, and has a trim of its own.
        if seen.contains(&name) || entity.has::<Tether>() || entity.has::<FixedWing>() {
            continue;
        }
        let together = tethered_together(scene, name);
        seen.extend(&together);
        let mut system = TetheredSystem::default();
        for member in scene.entities.iter().map(|entity| entity.name.as_str()) {
            let Some(id) = names.get(member) else {
                continue;
            };
            if let (Some(tether), Some(parts)) =
                (world.get::<Tether>(id), world.get::<TetherParts>(id))
            {
                if together.contains(&tether.from.0.as_str()) {
                    system.tethers.push(id);
                    let nodes = parts.points.iter();
                    system
                        .nodes
                        .extend(nodes.filter(|point| world.get::<TetherNode>(**point).is_some()));
                }
            } else if together.contains(&member) {
                if world.get::<Anchor>(id).is_some() {
                    system.anchors.push(id);
                } else if world.get::<Free>(id).is_some() {
                    system.bodies.push(id);
                }
            }
        }
        // A helm is no system.
        if system.anchors.is_empty() && system.bodies.is_empty() {
            continue;
        }
        if system.anchors.is_empty() {
            system.reference = system.bodies.first().copied();
            let balloons = system.bodies.iter();
            if balloons
                .clone()
                .any(|body| world.get::<DisplacedVolume>(*body).is_some())
            {
                system.reference = floating_balloon(world, scene, name).ok();
            }
        }
        systems.push(system);
    }
    systems
}

/// The name of an entity, or nothing.
pub(super) fn name(world: &World, entity: Entity) -> String {
    world
        .get::<EntityName>(entity)
        .map_or_else(String::new, |name| name.0.to_string())
}

/// Whether nothing in the air changes with altitude; then nothing restores an altitude either.
pub(super) fn is_air_uniform(environment: &EnvironmentModel) -> bool {
    matches!(
        environment.atmosphere,
        Atmosphere::Uniform { .. } | Atmosphere::Vacuum
    )
}

/// The velocity that the anchors of a held system share, m/s.
///
/// # Errors
/// Anchors that swing, that part, or that climb through air that changes with altitude: there is no
/// steady state.
pub(super) fn anchor_velocity_m_s(
    world: &World,
    system: &TetheredSystem,
) -> Result<DVec3, SetupError> {
    let mut common: Option<(DVec3, Entity)> = None;
    for &anchor in &system.anchors {
        let path = world.get::<Moving>(anchor);
        let velocity_m_s = path.map_or(DVec3::ZERO, |path| path.velocity_m_s);
        if let Some(path) = path
            && path.amplitude_m != DVec3::ZERO
            && path.frequency_rad_s != 0.0
        {
            return Err(refused(
                world,
                anchor,
                "Moving.amplitude_m",
                "swings, and what hangs from it never comes to rest",
                "set `amplitude_m: (0, 0, 0)` to find the steady state without the swing",
            ));
        }
        match common {
            None => common = Some((velocity_m_s, anchor)),
            Some((other_m_s, other)) if other_m_s != velocity_m_s => {
                let reason = format!(
                    "does not move as `{}` does, and tethers join the two",
                    name(world, other)
                );
                let help = "give both the same `velocity_m_s`";
                return Err(refused(world, anchor, "Moving", &reason, help));
            }
            Some(_) => {}
        }
    }
    let Some((velocity_m_s, anchor)) = common else {
        return Ok(DVec3::ZERO);
    };
    if velocity_m_s.z != 0.0 && !is_same_at_all_altitudes(world) {
        return Err(refused(
            world,
            anchor,
            "Moving.velocity_m_s",
            "climbs through air that changes with altitude, and nothing stays as it is",
            "leave out the vertical part of its velocity",
        ));
    }
    Ok(velocity_m_s)
}

/// The vertical velocity of a free system whose altitude nothing restores, m/s: that of the air.
///
/// # Errors
/// The wind carries it through winds that change with altitude.
pub(super) fn uniform_vertical_velocity_m_s(
    world: &World,
    system: &TetheredSystem,
    wind_m_s: DVec3,
) -> Result<f64, SetupError> {
    if wind_m_s.z == 0.0 || is_same_at_all_altitudes(world) {
        return Ok(wind_m_s.z);
    }
    let Some(first) = system.first() else {
        return Ok(0.0);
    };
    Err(refused(
        world,
        first,
        "",
        "rises or sinks with the air through wind or gravity that change with altitude, and no motion \
         of it is steady",
        "leave out the vertical wind, or give the air a density that falls with altitude",
    ))
}

fn is_same_at_all_altitudes(world: &World) -> bool {
    let environment = world.resource::<EnvironmentModel>();
    is_air_uniform(environment)
        && !environment.wind.depends_on_altitude()
        && matches!(
            environment.gravity,
            aerobot_components::environment::Gravity::Constant(_)
        )
}

/// A refusal of `entity`, at a field of it (may be empty).
pub(super) fn refused(
    world: &World,
    entity: Entity,
    field: &str,
    reason: &str,
    help: &str,
) -> SetupError {
    let name = name(world, entity);
    let dot = if field.is_empty() { "" } else { "." };
    SetupError::new(
        format!("entities.{name}{dot}{field}"),
        format!("`{name}` {reason}"),
        help,
    )
}
