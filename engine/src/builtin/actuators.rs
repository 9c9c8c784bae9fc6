//! Actuators, and the schedules and controllers that command them.

use std::collections::BTreeMap;

use aerobot_components::actuator::{
    Actuator, ActuatorChannels, ActuatorLimits, ActuatorValue, Command,
};
use aerobot_components::body::{Body, Fixed, Moving};
use aerobot_components::control::{
    ActuatorName, BoundController, BoundSchedule, Controller, Law, LawState, Measurement, Quantity,
    Schedule,
};
use aerobot_components::sail::Sail;
use aerobot_components::sampling::Sampling;
use aerobot_components::scene_component::{FieldReport, SceneComponent};
use aerobot_components::state::FirstOrderState;
use aerobot_systems::control::actuators::{
    AppliedCommand, FollowsSchedule, follow_commands, take_commands,
};
use aerobot_systems::control::laws::sample_controllers;
use aerobot_systems::control::schedules::{command_at, follow_schedules};
use aerobot_systems::instruments::channel_log::BuiltInChannels;
use bevy_ecs::entity::Entity;
use bevy_ecs::query::Without;
use bevy_ecs::resource::Resource;
use bevy_ecs::world::World;

use super::channels::is_built_in;
use super::winches::has_drive;
use crate::plugin::{Plugin, Simulator};
use crate::scene::checks::meant;
use crate::scene::source::nearest;
use crate::scene::{Scene, SceneEntity, SetupError};
use crate::schedule::Phase;
use crate::world::{Edges, SceneEntities, next_spawn_order};

/// Actuators, schedules and controllers.
pub struct ActuatorsPlugin;

impl Plugin for ActuatorsPlugin {
    fn build(&self, simulator: &mut Simulator) {
        simulator
            .register_component::<Schedule>()
            .register_component::<Controller>()
            .add_check(check)
            .add_setup(set_up)
            .add_systems_for::<Controller, _, _>(Phase::Control, || sample_controllers)
            .add_systems_for::<Schedule, _, _>(Phase::Prepare, || follow_schedules);
        add_systems(simulator, is_actuated);
    }
}

/// Whether a scene has what this crate gives actuators to or commands them with.
pub(crate) fn is_actuated(scene: &Scene) -> bool {
    scene.with::<Sail>().next().is_some()
        || has_drive(scene)
        || scene.with::<Schedule>().next().is_some()
        || scene.with::<Controller>().next().is_some()
}

/// Has the actuators of a plugin's component `C` follow their commands. Its setup makes them by
/// [`add_actuator`].
pub fn drive_actuators_of<C: SceneComponent>(simulator: &mut Simulator) {
    add_systems(simulator, |scene| {
        scene.with::<C>().next().is_some() && !is_actuated(scene)
    });
}

fn add_systems(simulator: &mut Simulator, needed: impl Fn(&Scene) -> bool + Send + Sync + 'static) {
    simulator.add_systems_if(Phase::Prepare, needed, || follow_commands);
}

/// Whether a command has changed since this was asked last, so that the rates of the present are stale.
pub(crate) fn commands_have_changed(world: &mut World) -> bool {
    if !world.contains_resource::<Actuators>() {
        return false;
    }
    let mut actuators = world
        .query_filtered::<(&Actuator, &Command, &mut AppliedCommand), Without<FollowsSchedule>>();
    take_commands(actuators.iter_mut(world))
}

/// The actuators of a world by the names of their owners and their own.
#[derive(Resource, Clone, Debug, Default)]
pub struct Actuators(BTreeMap<ActuatorName, Entity>);

impl Actuators {
    /// The actuator `name` of the entity `owner`. What commands it writes its [`Command`].
    #[must_use]
    pub fn get(&self, owner: &str, name: &str) -> Option<Entity> {
        self.0.get(&(owner.to_owned(), name.to_owned())).copied()
    }

    /// The name of an actuator: `sail.rudder`.
    #[must_use]
    pub fn name(&self, actuator: Entity) -> Option<String> {
        let mut all = self.0.iter();
        all.find(|(_, entity)| **entity == actuator)
            .map(|((owner, name), _)| format!("{owner}.{name}"))
    }
}

/// Gives the entity `owner` of a scene an actuator, in a setup. It starts from the value `start`.
pub fn add_actuator(
    world: &mut World,
    (owner, name): (&str, &str),
    limits: ActuatorLimits,
    channels: ActuatorChannels,
    start: f64,
) -> Option<Entity> {
    let owner_entity = world.resource::<SceneEntities>().get(owner)?;
    let order = next_spawn_order(world);
    let start = limits.cut(start);
    let actuator = Actuator {
        owner: owner_entity,
        limits,
        channels,
    };
    let mut spawned = world.spawn((
        order,
        actuator,
        Command(start),
        AppliedCommand(start),
        ActuatorValue(start),
    ));
    if limits.lag_s > 0.0 {
        spawned.insert(FirstOrderState {
            value: start,
            rate_per_s: 0.0,
            // From stop to middle matters as a metre does.
            error_scale: if limits.limit > 0.0 {
                limits.limit
            } else {
                f64::INFINITY
            },
        });
    }
    let entity = spawned.id();
    world
        .get_resource_or_insert_with(Actuators::default)
        .0
        .insert((owner.to_owned(), name.to_owned()), entity);
    Some(entity)
}

/// The command that a schedule of the scene gives an actuator at the start of a run.
#[must_use]
pub fn scheduled_start(scene: &Scene, owner: &str, name: &str) -> f64 {
    let mut schedules = scene.with::<Schedule>();
    let own = schedules.find(|(_, schedule)| {
        (schedule.actuator.0.as_str(), schedule.actuator.1.as_str()) == (owner, name)
    });
    own.map_or(0.0, |(_, schedule)| {
        command_at(&schedule.commands, 0.0, 0.0)
    })
}

fn set_up(world: &mut World, scene: &Scene) -> Result<(), SetupError> {
    let times = scene
        .with::<Schedule>()
        .flat_map(|(_, schedule)| schedule.commands.points().iter().map(|(time_s, _)| *time_s));
    world.resource_mut::<Edges>().add(times);
    Ok(())
}

/// What schedules and controllers name must exist, and nothing has two masters.
fn check(scene: &Scene, report: &mut FieldReport) {
    let schedules = scene
        .with::<Schedule>()
        .map(|(entity, schedule)| (entity.path::<Schedule>(), &schedule.actuator));
    let controllers = scene
        .with::<Controller>()
        .map(|(entity, controller)| (entity.path::<Controller>(), &controller.actuator));
    let mut commanded: Vec<&ActuatorName> = Vec::new();
    for (path, actuator) in schedules.chain(controllers) {
        if commanded.contains(&actuator) {
            report.add(
                &format!("{path}.actuator"),
                format!(
                    "something else commands `{}.{}` already",
                    actuator.0, actuator.1
                ),
                "an actuator follows one schedule or one controller",
            );
        }
        commanded.push(actuator);
        check_entity(scene, &format!("{path}.actuator.0"), &actuator.0, report);
    }
    for (entity, controller) in scene.with::<Controller>() {
        for (field, quantity) in controller.law.measured() {
            let path = format!("{}.law.{field}", entity.path::<Controller>());
            check_quantity(scene, &path, quantity, report);
        }
    }
}

fn check_quantity(scene: &Scene, path: &str, quantity: &Quantity, report: &mut FieldReport) {
    for (_, _, name) in quantity.parts() {
        if check_entity(scene, path, name, report).is_some_and(|entity| {
            entity.complete
                && !entity.has::<Body>()
                && !entity.has::<Fixed>()
                && !entity.has::<Moving>()
        }) {
            report.add(
                path,
                format!("`{name}` has no position to measure"),
                "name a body or an anchor",
            );
        }
    }
}

fn check_entity<'a>(
    scene: &'a Scene,
    path: &str,
    name: &str,
    report: &mut FieldReport,
) -> Option<&'a SceneEntity> {
    let found = scene.entity(name);
    if found.is_none() && !scene.may_be_unread(name) {
        let help = scene.groups.help(name);
        let help = help.unwrap_or_else(|| meant(name, scene.entities.iter()));
        report.add(path, format!("there is no entity `{name}`"), help);
    }
    found
}

/// Joins schedules and controllers to actuators and to what they measure, when every setup has run.
///
/// # Errors
/// An actuator that its entity does not have.
pub(crate) fn bind(world: &mut World, scene: &Scene) -> Result<(), SetupError> {
    record_those_of_plugins(world);
    for (entity, schedule) in scene.with::<Schedule>() {
        let path = entity.path::<Schedule>();
        let actuator = find(world, &path, &schedule.actuator)?;
        if let Some(id) = world.resource::<SceneEntities>().get(&entity.name) {
            world.entity_mut(id).insert(BoundSchedule(actuator));
            world.entity_mut(actuator).insert(FollowsSchedule);
        }
    }
    for (entity, controller) in scene.with::<Controller>() {
        let path = entity.path::<Controller>();
        let actuator = find(world, &path, &controller.actuator)?;
        let limit = world
            .get::<Actuator>(actuator)
            .map_or(0.0, |actuator| actuator.limits.limit);
        let (least, most) = controller.saturation.unwrap_or((-limit, limit));
        let bound = BoundController {
            measurements: measurements(world, &controller.law),
            actuator,
            range: (least.max(-limit).min(limit), most.min(limit).max(-limit)),
        };
        if let Some(id) = world.resource::<SceneEntities>().get(&entity.name) {
            let sampling = Sampling::every(controller.period_s);
            world
                .entity_mut(id)
                .insert((bound, sampling, LawState::default()));
        }
    }
    Ok(())
}

fn measurements(world: &World, law: &Law) -> Vec<Measurement> {
    let names = world.resource::<SceneEntities>();
    let bound = |quantity: &Quantity, target: f64| Measurement {
        parts: quantity
            .parts()
            .into_iter()
            .filter_map(|(sign, kind, name)| Some((sign, kind, names.get(name)?)))
            .collect(),
        is_angle: quantity.is_angle(),
        target,
    };
    match law {
        Law::Proportional {
            measured, target, ..
        }
        | Law::Pid {
            measured, target, ..
        } => vec![bound(measured, *target)],
        Law::StateFeedback { terms, .. } => terms
            .iter()
            .map(|term| bound(&term.measured, term.target))
            .collect(),
    }
}

fn find(world: &World, path: &str, (owner, name): &ActuatorName) -> Result<Entity, SetupError> {
    let actuators = world.get_resource::<Actuators>();
    if let Some(found) = actuators.and_then(|actuators| actuators.get(owner, name)) {
        return Ok(found);
    }
    let all: Vec<&str> = actuators
        .iter()
        .flat_map(|actuators| actuators.0.keys())
        .filter(|(other, _)| other == owner)
        .map(|(_, name)| name.as_str())
        .collect();
    let help = match nearest(name, all.iter().copied()) {
        Some(near) => format!("did you mean `{near}`?"),
        None if all.is_empty() => format!("`{owner}` has no actuators"),
        None => format!("it has `{}`", all.join("`, `")),
    };
    Err(SetupError::new(
        format!("{path}.actuator.1"),
        format!("`{owner}` has no actuator `{name}`"),
        &help,
    ))
}

/// Channels that are no built-in ones are recorded as those of instruments.
fn record_those_of_plugins(world: &mut World) {
    let actuators: Vec<Actuator> = world.query::<&Actuator>().iter(world).copied().collect();
    for actuator in actuators {
        if let Some(mut wanted) = world.get_mut::<BuiltInChannels>(actuator.owner) {
            let channels = [actuator.channels.value, actuator.channels.command];
            let own = channels.into_iter().filter(|name| !is_built_in(name));
            wanted.0.extend(own);
        }
    }
}
