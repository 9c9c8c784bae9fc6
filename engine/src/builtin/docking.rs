//! Docking: ports, latches that close and hold, guidance to a port, and what they record.

use aerobot_components::body::{Body, Fixed, Moving};
use aerobot_components::docking::{
    Docked, Docking, DockingPort, Latch, LatchState, Navigation, is_multiple,
};
use aerobot_components::inertia::InertiaShape;
use aerobot_components::rotorcraft::Rotorcraft;
use aerobot_components::sampling::Sampling;
use aerobot_components::scene_component::FieldReport;
use aerobot_components::state::{
    Acceleration, AngularAcceleration, AngularVelocity, Attitude, Force, Inertia, Mass, Torque,
};
use aerobot_components::tether::Tether;
use aerobot_systems::clock::Clock;
use aerobot_systems::docking::guidance::{Guidance, News};
use aerobot_systems::docking::observer::PortObserver;
use aerobot_systems::docking::ports::{PortCarrier, PortsApart};
use aerobot_systems::docking::ridden_body::{
    LatchLoad, accelerate_riders, load_carriers_of_riders, place_riders,
};
use aerobot_systems::instruments::attitude::heading_rad;
use aerobot_systems::instruments::channel_log::{BuiltInChannels, ChannelLog};
use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use bevy_ecs::query::Has;
use bevy_ecs::schedule::IntoScheduleConfigs;
use bevy_ecs::system::{Query, Res, ResMut};
use bevy_ecs::world::World;

use super::channels::channels_due;
use crate::plugin::{Plugin, Simulator};
use crate::scene::checks::meant;
use crate::scene::{Scene, SceneEntity, SetupError};
use crate::schedule::Phase;
use crate::topology_change::{Change, apply};
use crate::world::{EntityName, EventLog, SceneEntities, Warnings};

const PHASE: &str = "docking_phase";
const DISTANCE: &str = "distance_m";
const CLOSING_SPEED: &str = "closing_speed_m_s";
const LATERAL_ERROR: &str = "lateral_error_m";
const MISALIGNMENT: &str = "misalignment_rad";
const CONTACT_SPEED: &str = "contact_speed_m_s";
const LATCH_FORCE: &str = "latch_force_n";
const LATCH_TORQUE: &str = "latch_torque_n_m";

/// The channels of a latch. The speed of contact is zero until it has closed, what it carries while it is open.
pub(crate) const LATCH_CHANNELS: [&str; 7] = [
    DISTANCE,
    CLOSING_SPEED,
    LATERAL_ERROR,
    MISALIGNMENT,
    CONTACT_SPEED,
    LATCH_FORCE,
    LATCH_TORQUE,
];
/// That of a guidance, by number ([`aerobot_components::docking::DockingPhase`]).
pub(crate) const GUIDANCE_CHANNELS: [&str; 1] = [PHASE];

/// Docking, before everything is accelerated.
pub struct DockingPlugin;

impl Plugin for DockingPlugin {
    fn build(&self, simulator: &mut Simulator) {
        simulator
            .register_component::<DockingPort>()
            .register_component::<Latch>()
            .register_component::<Docking>()
            .add_check(check)
            .add_setup(set_up)
            .add_systems_for::<Latch, _, _>(Phase::Prepare, || place_riders)
            .add_systems_for::<Latch, _, _>(Phase::Dynamics, || load_carriers_of_riders)
            .add_systems_for::<Latch, _, _>(Phase::Constrain, || close_latches)
            .add_systems_for::<Docking, _, _>(Phase::Observe, || tell)
            .add_systems_for::<Latch, _, _>(Phase::Observe, || {
                (record, record_loads).chain().run_if(channels_due)
            });
    }
}

/// How bodies that ride on others are accelerated, once these are.
pub struct RidersPlugin;

impl Plugin for RidersPlugin {
    fn build(&self, simulator: &mut Simulator) {
        simulator.add_systems_for::<Latch, _, _>(Phase::Dynamics, || accelerate_riders);
    }
}

/// What looks whether a latch can close: an entity of its own, with a [`Sampling`].
#[derive(Component, Clone, Copy, Debug)]
struct LatchSensor(Entity);

/// Speed of one port against the other when the latch closed, m/s.
#[derive(Component, Clone, Copy, Debug)]
struct ContactSpeed(f64);

fn set_up(world: &mut World, scene: &Scene) -> Result<(), SetupError> {
    for (place, (entity, latch)) in (0..).zip(scene.with::<Latch>()) {
        let names = world.resource::<SceneEntities>();
        let (Some(body), Some(target)) = (names.get(&entity.name), names.get(&latch.to)) else {
            continue;
        };
        let docking = entity.get::<Docking>();
        world.entity_mut(body).insert(LatchState {
            target,
            is_armed: docking.is_none(),
        });
        world.spawn((LatchSensor(body), Sampling::every(latch.period_s)));
        if let Some(docking) = docking {
            let attitude = world.get::<Attitude>(body).copied().unwrap_or_default();
            world.entity_mut(body).insert((
                PortObserver::new(docking.navigation, scene.run.seed, place),
                Guidance::new(heading_rad(attitude.0)),
            ));
        }
    }
    Ok(())
}

fn is_point(entity: &SceneEntity) -> bool {
    entity
        .get::<Body>()
        .is_some_and(|body| body.inertia == InertiaShape::Point)
}

fn check(scene: &Scene, report: &mut FieldReport) {
    for (entity, latch) in scene.with::<Latch>() {
        let path = entity.path::<Latch>();
        check_target(scene, entity, latch, report);
        if is_point(entity) {
            report.add(
                &format!("{}.inertia", entity.path::<Body>()),
                "a latch holds attitudes too, and a point has none",
                "give the body an `inertia`",
            );
        }
        let held = scene
            .with::<Tether>()
            .find(|(_, tether)| tether.from.0 == entity.name || tether.to.0 == entity.name);
        if let Some((tether, _)) = held {
            report.add(
                &path,
                format!(
                    "`{}` is held by `{}`, and what is tethered cannot ride on another body",
                    entity.name, tether.name
                ),
                "give the latch to the other body",
            );
        }
        if let Some(docking) = entity.get::<Docking>() {
            check_speed(entity, docking, latch, report);
            check_guidance(entity, docking, report);
        }
    }
}

fn check_target(scene: &Scene, entity: &SceneEntity, latch: &Latch, report: &mut FieldReport) {
    let path = format!("{}.to", entity.path::<Latch>());
    let Some(target) = scene.entity(&latch.to) else {
        if !scene.may_be_unread(&latch.to) {
            let ports = scene
                .with::<DockingPort>()
                .map(|(port, _)| port)
                .filter(|port| port.name != entity.name);
            let help = meant(&latch.to, ports);
            report.add(
                &path,
                format!("there is no entity `{}` to dock to", latch.to),
                help,
            );
        }
        return;
    };
    if !target.complete {
        return;
    }
    let is_anchor = target.has::<Fixed>() || target.has::<Moving>();
    let (message, help) = if latch.to == entity.name {
        ("a body cannot dock to itself".to_owned(), "")
    } else if !target.has::<DockingPort>() {
        (
            format!("`{}` has no port to dock to", latch.to),
            "give it one: `DockingPort: (at_m: (0, 0, 0), axis: (1, 0, 0))`",
        )
    } else if target.has::<Latch>() {
        (
            format!("`{}` has a latch itself", latch.to),
            "of two bodies that dock one has the latch, the other a port alone",
        )
    } else if is_point(target) && !is_anchor {
        (
            format!(
                "`{}` is a point, which cannot be turned by what rides on it",
                latch.to
            ),
            "give its body an `inertia`",
        )
    } else {
        return;
    };
    report.add(&path, message, help);
}

/// A sensor's measurements must come at ticks of the flight computer that uses them.
fn check_guidance(entity: &SceneEntity, docking: &Docking, report: &mut FieldReport) {
    let (Navigation::Measured { period_s, .. }, Some(rotorcraft)) =
        (&docking.navigation, entity.get::<Rotorcraft>())
    else {
        return;
    };
    if !is_multiple(*period_s, rotorcraft.period_s) || *period_s < 0.5 * rotorcraft.period_s {
        report.add(
            &format!("{}.navigation.period_s", entity.path::<Docking>()),
            format!(
                "the sensor measures every {period_s} s, and the flight computer looks every {} s",
                rotorcraft.period_s
            ),
            "the first has to be the second or a multiple of it (`Rotorcraft.period_s`)",
        );
    }
}

/// A latch that closes more slowly than the drone comes never does.
fn check_speed(entity: &SceneEntity, docking: &Docking, latch: &Latch, report: &mut FieldReport) {
    if docking.closing_speed_m_s > latch.speed_m_s {
        report.add(
            &format!("{}.closing_speed_m_s", entity.path::<Docking>()),
            format!(
                "the drone would come at {} m/s, and its latch closes at {} m/s at most",
                docking.closing_speed_m_s, latch.speed_m_s
            ),
            "close in more slowly, or raise `Latch.speed_m_s`",
        );
    }
}

/// Closes every latch that is armed and within its limits at a tick of its sensor.
fn close_latches(world: &mut World) {
    let time_s = world.resource::<Clock>().time_s;
    let mut sensors = world.query::<(&LatchSensor, &mut Sampling)>();
    let mut due = Vec::new();
    for (sensor, mut sampling) in sensors.iter_mut(world) {
        if sampling.is_due(time_s) {
            sampling.done(time_s);
            due.push(sensor.0);
        }
    }
    due.sort_unstable();
    for body in due {
        if let Some(speed_m_s) = meets(world, body) {
            apply(world, &[Change::Latch(body)]);
            world.entity_mut(body).insert(ContactSpeed(speed_m_s));
        }
    }
}

/// At which speed a latch meets its port, m/s, where it can close now.
fn meets(world: &mut World, body: Entity) -> Option<f64> {
    let state = *world.get::<LatchState>(body)?;
    if !state.is_armed || world.get::<Docked>(body).is_some() {
        return None;
    }
    let mut riders = world.query::<&Docked>();
    if riders
        .iter(world)
        .any(|docked| docked.carrier == state.target)
    {
        return None;
    }
    let mut ports = world.query::<PortCarrier>();
    let own = ports.get(world, body).ok()?.motion();
    let target = ports.get(world, state.target).ok()?.motion();
    let apart = PortsApart::between(&own, &target);
    let latch = world.get::<Latch>(body)?;
    let is_within = apart.distance_m <= latch.distance_m
        && apart.speed_m_s <= latch.speed_m_s
        && apart.misalignment_rad <= latch.angle_rad;
    is_within.then_some(apart.speed_m_s)
}

/// Tells of phases, of missed approaches, and of what cannot be reached.
fn tell(
    clock: Res<Clock>,
    mut events: ResMut<EventLog>,
    mut warnings: ResMut<Warnings>,
    mut drones: Query<(&EntityName, &LatchState, &mut Guidance)>,
    names: Query<&EntityName>,
) {
    for (name, latch, mut guidance) in &mut drones {
        if guidance.news.is_empty() {
            continue;
        }
        for news in std::mem::take(&mut guidance.news) {
            match news {
                News::Phase(phase) => events.add(clock.time_s, phase.name(), &name.0),
                News::MissedApproach => events.add(clock.time_s, "missed approach", &name.0),
                News::Unreachable(reason) => {
                    let kind = format!("unreachable: {}", reason.word());
                    events.add(clock.time_s, &kind, &name.0);
                    let target = names.get(latch.target).map_or("", |name| &name.0);
                    warnings.0.push(format!(
                        "`{}` has given up docking to `{target}` at {} s: {reason}",
                        name.0, clock.time_s
                    ));
                }
            }
        }
    }
}

/// Records how ports are to each other, and what the guidance does.
fn record(
    mut log: ResMut<ChannelLog>,
    drones: Query<(
        Entity,
        &BuiltInChannels,
        &LatchState,
        PortCarrier,
        Option<&Guidance>,
        Option<&ContactSpeed>,
    )>,
    targets: Query<PortCarrier>,
) {
    for (entity, channels, latch, own, guidance, contact) in &drones {
        let Ok(target) = targets.get(latch.target) else {
            continue;
        };
        let apart = PortsApart::between(&own.motion(), &target.motion());
        let values = [
            (
                PHASE,
                guidance.map(|guidance| f64::from(guidance.phase as u8)),
            ),
            (DISTANCE, Some(apart.distance_m)),
            (CLOSING_SPEED, Some(apart.closing_speed_m_s)),
            (LATERAL_ERROR, Some(apart.lateral_error_m)),
            (MISALIGNMENT, Some(apart.misalignment_rad)),
            (CONTACT_SPEED, Some(contact.map_or(0.0, |speed| speed.0))),
        ];
        for (channel, value) in values {
            if let (Some(value), true) = (value, channels.has(channel)) {
                log.record(entity, channel, value);
            }
        }
    }
}

/// Records what closed latches carry.
fn record_loads(
    mut log: ResMut<ChannelLog>,
    riders: Query<(
        (Entity, &BuiltInChannels, &LatchState, Has<Docked>),
        (&Mass, &Inertia, &DockingPort),
        (&Attitude, &AngularVelocity),
        (&Acceleration, &AngularAcceleration),
        (&Force, &Torque),
    )>,
) {
    for ((entity, channels, _, is_docked), what, turn, motion, forces) in &riders {
        let load = if is_docked {
            LatchLoad::of(what, turn, motion, forces)
        } else {
            LatchLoad::default()
        };
        for (channel, value) in [(LATCH_FORCE, load.force_n), (LATCH_TORQUE, load.torque_n_m)] {
            if channels.has(channel) {
                log.record(entity, channel, value.length_squared().sqrt());
            }
        }
    }
}
