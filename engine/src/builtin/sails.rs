//! Sails: their forces, their rudders, and what is said of their stability.

use aerobot_components::actuator::ActuatorChannels;
use aerobot_components::body::Body;
use aerobot_components::inertia::InertiaShape;
use aerobot_components::sail::{
    LevelHold, RudderActuator, Sail, SailAttitude, SailLoads, SailShape,
};
use aerobot_components::scene_component::FieldReport;
use aerobot_components::state::{Air, Inertia};
use aerobot_systems::forces::sail::{
    hold_level, hold_level_derivatives, least_rudder_area_m2, sail, yaw_stiffness_m3_rad,
};
use aerobot_systems::instruments::sail::{RUDDER, RUDDER_COMMAND};
use bevy_ecs::world::World;
use glam::{DMat3, DVec3};

use super::actuators::{add_actuator, scheduled_start};
use crate::plugin::{Plugin, Simulator};
use crate::scene::{Scene, SetupError};
use crate::schedule::Phase;
use crate::world::{SceneEntities, Warnings};

/// Name of the actuator of a sail.
pub const RUDDER_NAME: &str = "rudder";

/// A sail that is held level turns about x and y as if it had this times its moment about z: what holds it
/// gives way by no more than a torque over that.
const HOLDING_INERTIA: f64 = 1e4;
/// And swings back at this rate, rad/s, critically damped.
const HOLDING_RATE_RAD_S: f64 = 10.0;

/// Steering sails.
pub struct SailsPlugin;

impl Plugin for SailsPlugin {
    fn build(&self, simulator: &mut Simulator) {
        simulator
            .register_component::<Sail>()
            .add_check(check)
            .add_setup(set_up)
            .add_systems_for::<Sail, _, _>(Phase::Forces, || sail)
            .add_systems_if(Phase::Forces, is_held_level, || hold_level)
            .add_systems_if(Phase::Derivatives, is_held_level, || hold_level_derivatives);
    }
}

fn is_held_level(scene: &Scene) -> bool {
    scene
        .with::<Sail>()
        .any(|(_, sail)| sail.attitude == SailAttitude::Level)
}

fn check(scene: &Scene, report: &mut FieldReport) {
    for (entity, _) in scene.with::<Sail>() {
        let is_point = entity
            .get::<Body>()
            .is_some_and(|body| matches!(body.inertia, InertiaShape::Point));
        if is_point {
            report.add(
                &entity.path::<Sail>(),
                "a sail turns, and a point does not",
                "give its `Body` an `inertia`",
            );
        }
    }
}

fn set_up(world: &mut World, scene: &Scene) -> Result<(), SetupError> {
    for (entity, sail) in scene.with::<Sail>() {
        let Some(id) = world.resource::<SceneEntities>().get(&entity.name) else {
            continue;
        };
        let channels = ActuatorChannels {
            value: RUDDER,
            command: RUDDER_COMMAND,
        };
        let start = scheduled_start(scene, &entity.name, RUDDER_NAME);
        let limits = sail.rudder.deflection;
        let name = (entity.name.as_str(), RUDDER_NAME);
        let Some(rudder) = add_actuator(world, name, limits, channels, start) else {
            continue;
        };
        let shape = sail.shape();
        let mut spawned = world.entity_mut(id);
        spawned.insert((shape, RudderActuator(rudder), SailLoads::default()));
        if spawned.get::<Air>().is_none() {
            spawned.insert(Air::default());
        }
        if sail.attitude == SailAttitude::Level
            && let Some(Inertia(tensor)) = spawned.get::<Inertia>().copied()
        {
            let holding = HOLDING_INERTIA * tensor.z_axis.z;
            let level = DMat3::from_diagonal(DVec3::new(holding, holding, 0.0));
            spawned.insert((
                Inertia(tensor + level),
                LevelHold {
                    stiffness_n_m: holding * HOLDING_RATE_RAD_S * HOLDING_RATE_RAD_S,
                    damping_n_m_s: 2.0 * holding * HOLDING_RATE_RAD_S,
                },
            ));
        }
        if yaw_stiffness_m3_rad(&shape) <= 0.0 {
            let warning = instability(&entity.name, &shape);
            world.resource_mut::<Warnings>().0.push(warning);
        }
    }
    Ok(())
}

fn instability(name: &str, shape: &SailShape) -> String {
    let remedy = least_rudder_area_m2(shape).map_or_else(
        || "no rudder there makes it stable".to_owned(),
        |area_m2| format!("a rudder of more than {area_m2:.3} m2 there makes it stable"),
    );
    format!(
        "the sail `{name}` is statically unstable in yaw: it turns away from where it goes; {remedy}"
    )
}

/// What is said of the stability of the sails of a scene, a line each.
pub(crate) fn describe(world: &World, scene: &Scene) -> Vec<String> {
    let mut lines = Vec::new();
    for (entity, _) in scene.with::<Sail>() {
        let id = world.resource::<SceneEntities>().get(&entity.name);
        let Some(shape) = id.and_then(|id| world.get::<SailShape>(id)) else {
            continue;
        };
        let stiffness = yaw_stiffness_m3_rad(shape);
        let word = if stiffness > 0.0 {
            "stable"
        } else {
            "UNSTABLE"
        };
        lines.push(format!(
            "sail `{}`: yaw stiffness {stiffness:.4} m3/rad times the dynamic pressure, statically {word}",
            entity.name
        ));
        if let Some(area_m2) = least_rudder_area_m2(shape).filter(|area_m2| *area_m2 > 0.0) {
            lines.push(format!(
                "sail `{}`: stable with a rudder of more than {area_m2:.4} m2",
                entity.name
            ));
        }
        if stiffness <= 0.0 {
            lines.push(format!("warning: {}", instability(&entity.name, shape)));
        }
    }
    lines
}
