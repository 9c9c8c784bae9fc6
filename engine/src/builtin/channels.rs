//! Built-in channels: which entities record which.

use std::collections::{BTreeMap, BTreeSet};

use aerobot_components::body::{Anchor, Body};
use aerobot_components::docking::{Docking, Latch};
use aerobot_components::rotorcraft::Rotorcraft;
use aerobot_components::run::ChannelSelection;
use aerobot_components::sail::Sail;
use aerobot_components::scene_component::FieldReport;
use aerobot_components::state::{Air, FirstOrderState, Inertia};
use aerobot_components::tether::{Attachment, Tether, TetherParts};
use aerobot_components::winch::Winch;
use aerobot_systems::clock::Clock;
use aerobot_systems::dynamics::attachments::accelerate_attachments;
use aerobot_systems::instruments::airspeed::{AIRSPEED, airspeed};
use aerobot_systems::instruments::attachment_tension::{
    TENSION_FROM, TENSION_TO, attachment_tension,
};
use aerobot_systems::instruments::attitude::{HEADING, TILT, attitude};
use aerobot_systems::instruments::channel_log::{BuiltInChannels, ChannelLog};
use aerobot_systems::instruments::energy::{
    KINETIC, MECHANICAL, POTENTIAL, WORK, WorkIntegral, energy, nonconservative_power,
};
use aerobot_systems::instruments::momentum::{
    IMPULSE, ImpulseIntegral, MOMENTUM, momentum, outer_impulse,
};
use aerobot_systems::instruments::sail::{
    RUDDER, RUDDER_COMMAND, RUDDER_INCIDENCE, RUDDER_LIFT, SAIL_DRAG, WING_INCIDENCE, WING_LIFT,
    YAW_MOMENT, actuators, sail,
};
use aerobot_systems::instruments::swing::{SWING, SWING_X, SWING_Y, Support, swing};
use aerobot_systems::instruments::twist::{TORSION, TWIST, twist};
use aerobot_systems::instruments::winch::{LINE_OUT, WINCH_POWER, WINCH_WORK, winch};
use bevy_ecs::entity::Entity;
use bevy_ecs::schedule::IntoScheduleConfigs;
use bevy_ecs::system::{IntoSystem, Res};
use bevy_ecs::world::World;

use super::actuators::is_actuated;
use super::recorder::Recorder;
use super::torsion::has_torsion;
use super::{docking, rotorcraft, winches};
use crate::placement::attachment_position;
use crate::plugin::{Plugin, Simulator};
use crate::scene::source::nearest;
use crate::scene::{Scene, SceneEntity, SetupError};
use crate::schedule::Phase;
use crate::world::{SceneEntities, next_spawn_order};

const BODY_CHANNELS: [&str; 6] = [AIRSPEED, TILT, HEADING, SWING, SWING_X, SWING_Y];
const SAIL_CHANNELS: [&str; 14] = [
    AIRSPEED,
    TILT,
    HEADING,
    SWING,
    SWING_X,
    SWING_Y,
    WING_INCIDENCE,
    RUDDER_INCIDENCE,
    WING_LIFT,
    RUDDER_LIFT,
    SAIL_DRAG,
    YAW_MOMENT,
    RUDDER,
    RUDDER_COMMAND,
];
const TETHER_CHANNELS: [&str; 2] = [TENSION_FROM, TENSION_TO];
const TWISTED_TETHER_CHANNELS: [&str; 4] = [TENSION_FROM, TENSION_TO, TWIST, TORSION];
const WINCH_CHANNELS: [&str; 5] = [TENSION_FROM, TENSION_TO, WINCH_POWER, WINCH_WORK, LINE_OUT];
const TWISTED_WINCH_CHANNELS: [&str; 7] = [
    TENSION_FROM,
    TENSION_TO,
    TWIST,
    TORSION,
    WINCH_POWER,
    WINCH_WORK,
    LINE_OUT,
];
const ENERGY_CHANNELS: [&str; 4] = [KINETIC, POTENTIAL, MECHANICAL, WORK];
const SYSTEM_CHANNELS: [&str; 10] = [
    KINETIC,
    POTENTIAL,
    MECHANICAL,
    WORK,
    MOMENTUM[0],
    MOMENTUM[1],
    MOMENTUM[2],
    IMPULSE[0],
    IMPULSE[1],
    IMPULSE[2],
];

/// Airspeed, tilt, heading, swing, attachment tensions, twist, energy and momentum.
pub struct ChannelsPlugin;

impl Plugin for ChannelsPlugin {
    fn build(&self, simulator: &mut Simulator) {
        simulator
            .add_check(check_names)
            .add_setup(set_up)
            .add_systems_if(Phase::Dynamics, records_energy, || nonconservative_power)
            .add_systems_if(Phase::Dynamics, records_momentum, || outer_impulse)
            .add_systems(Phase::Observe, || {
                // One system after the other, but one to ask whether it is due.
                accelerate_attachments
                    .pipe(airspeed)
                    .pipe(attitude)
                    .pipe(swing)
                    .pipe(attachment_tension)
                    .run_if(channels_due)
            })
            .add_systems_if(Phase::Observe, has_torsion, || twist.run_if(channels_due))
            .add_systems_for::<Sail, _, _>(Phase::Observe, || sail.run_if(channels_due))
            .add_systems_if(Phase::Observe, is_actuated, || {
                actuators.run_if(channels_due)
            })
            .add_systems_for::<Winch, _, _>(Phase::Observe, || winch.run_if(channels_due))
            .add_systems_if(Phase::Observe, records_energy, || {
                energy.run_if(channels_due)
            })
            .add_systems_if(Phase::Observe, records_momentum, || {
                momentum.run_if(channels_due)
            });
    }
}

/// The channels that exist on an entity of a scene.
fn known_channels(entity: &SceneEntity) -> Vec<&'static str> {
    let mut known = own_channels(entity).to_vec();
    if entity
        .get::<Winch>()
        .is_some_and(|winch| winch.drive.is_some())
    {
        known.extend(winches::DRUM_CHANNELS);
    }
    if entity.has::<Rotorcraft>() {
        known.extend(rotorcraft::CHANNELS);
    }
    if entity.has::<Latch>() {
        known.extend(docking::LATCH_CHANNELS);
    }
    if entity.has::<Docking>() {
        known.extend(docking::GUIDANCE_CHANNELS);
    }
    known
}

/// Those of a tether or a body.
fn own_channels(entity: &SceneEntity) -> &'static [&'static str] {
    if let Some(tether) = entity.get::<Tether>() {
        match (tether.torsion.is_some(), entity.has::<Winch>()) {
            (false, false) => &TETHER_CHANNELS,
            (true, false) => &TWISTED_TETHER_CHANNELS,
            (false, true) => &WINCH_CHANNELS,
            (true, true) => &TWISTED_WINCH_CHANNELS,
        }
    } else if entity.has::<Sail>() {
        &SAIL_CHANNELS
    } else if entity.has::<Body>() {
        &BODY_CHANNELS
    } else {
        &[]
    }
}

/// Whether energy or work of the whole system is recorded.
fn records_energy(scene: &Scene) -> bool {
    !wanted(&scene.run.record.channels, "system", &ENERGY_CHANNELS).is_empty()
}

/// Whether its momentum, or the impulse on it, is recorded.
fn records_momentum(scene: &Scene) -> bool {
    (0..3).any(|axis| !momentum_wanted(scene, axis).is_empty())
}

/// The channels of momentum and impulse along an axis that are recorded.
fn momentum_wanted(scene: &Scene, axis: usize) -> BTreeSet<&'static str> {
    let known = [MOMENTUM[axis], IMPULSE[axis]];
    wanted(&scene.run.record.channels, "system", &known)
}

/// Whether built-in channels are due at the time of the accepted state.
pub(super) fn channels_due(clock: Res<Clock>, recorder: Res<Recorder>) -> bool {
    recorder.channels_due(clock.time_s)
}

fn check_names(scene: &Scene, report: &mut FieldReport) {
    let ChannelSelection::Only(channels) = &scene.run.record.channels else {
        return;
    };
    for (name, wanted) in channels {
        let known = match scene.entity(name) {
            Some(entity) if !entity.complete => continue,
            Some(entity) => known_channels(entity),
            None if name == "system" => SYSTEM_CHANNELS.to_vec(),
            None => continue,
        };
        for channel in wanted
            .iter()
            .filter(|channel| !known.contains(&channel.as_str()))
        {
            let near = nearest(channel, known.iter().copied());
            let help = near.map_or_else(
                || format!("it has `{}`", known.join("`, `")),
                |near| format!("did you mean `{near}`?"),
            );
            report.add(
                &format!("run.record.channels.{name}"),
                format!("`{name}` has no channel `{channel}`"),
                help,
            );
        }
    }
}

fn set_up(world: &mut World, scene: &Scene) -> Result<(), SetupError> {
    world.init_resource::<ChannelLog>();
    for entity in &scene.entities {
        let Some(id) = world.resource::<SceneEntities>().get(&entity.name) else {
            continue;
        };
        let wanted = wanted(
            &scene.run.record.channels,
            &entity.name,
            &known_channels(entity),
        );
        let mut spawned = world.entity_mut(id);
        let is_body = entity.has::<Body>();
        let asks_for_air = matches!(&scene.run.record.channels, ChannelSelection::Only(_))
            && wanted.contains(AIRSPEED);
        if asks_for_air && is_body && spawned.get::<Air>().is_none() {
            spawned.insert(Air::default());
        }
        let turns = spawned.get::<Inertia>().is_some();
        let channels = wanted
            .into_iter()
            .filter(|name| turns || (*name != TILT && *name != HEADING));
        spawned.insert(BuiltInChannels(channels.collect()));
    }
    // What is integrated follows from the motion and does not steer it.
    let integral = FirstOrderState {
        value: 0.0,
        rate_per_s: 0.0,
        error_scale: f64::INFINITY,
    };
    let energy = wanted(&scene.run.record.channels, "system", &ENERGY_CHANNELS);
    if !energy.is_empty() {
        let order = next_spawn_order(world);
        world.spawn((order, WorkIntegral, integral, BuiltInChannels(energy)));
    }
    for axis in 0..3 {
        let momentum = momentum_wanted(scene, axis);
        if !momentum.is_empty() {
            let order = next_spawn_order(world);
            let channels = BuiltInChannels(momentum);
            world.spawn((order, ImpulseIntegral(axis), integral, channels));
        }
    }
    Ok(())
}

fn wanted(
    selection: &ChannelSelection,
    name: &str,
    known: &[&'static str],
) -> BTreeSet<&'static str> {
    match selection {
        ChannelSelection::None => BTreeSet::new(),
        ChannelSelection::Standard if name == "system" => BTreeSet::new(),
        ChannelSelection::Standard | ChannelSelection::All => known.iter().copied().collect(),
        ChannelSelection::Only(channels) => match channels.get(name) {
            Some(wanted) => known
                .iter()
                .copied()
                .filter(|name| wanted.iter().any(|w| w == name))
                .collect(),
            None => BTreeSet::new(),
        },
    }
}

/// Finds what each body hangs from, once everything is placed: the carrier of the attachment highest
/// above the body's own, by all tethers between the two.
pub(crate) fn find_supports(world: &mut World) {
    let bodies = world.resource::<SceneEntities>().in_order().to_vec();
    for body in bodies {
        world.entity_mut(body).remove::<Support>();
    }
    let mut hangings: Vec<Hanging> = Vec::new();
    let mut tethers = world.query::<&TetherParts>();
    for parts in tethers.iter(world) {
        hangings.extend(hanging(world, parts));
    }
    let mut supports: BTreeMap<Entity, (Hanging, Support)> = BTreeMap::new();
    for found in &hangings {
        let highest = supports
            .get(&found.body)
            .is_none_or(|(known, _)| found.rise_m > known.rise_m);
        if highest {
            let together = hangings
                .iter()
                .filter(|other| other.body == found.body && other.support == found.support);
            let (above, below) = together.map(|other| (other.above, other.below)).unzip();
            supports.insert(found.body, (*found, Support { above, below }));
        }
    }
    for (body, (_, support)) in supports {
        world.entity_mut(body).insert(support);
    }
}

/// A body that hangs from a support by one tether.
#[derive(Clone, Copy)]
struct Hanging {
    body: Entity,
    support: Entity,
    above: Entity,
    below: Entity,
    rise_m: f64,
}

fn hanging(world: &World, parts: &TetherParts) -> Option<Hanging> {
    let (first, last) = (*parts.points.first()?, *parts.points.last()?);
    // Where nothing had to be found, attachments have not been placed yet.
    let height = |point| {
        let end = world.get::<Attachment>(point)?;
        Some(attachment_position(world, end.carrier, end.offset_m).z)
    };
    let rise = height(first)? - height(last)?;
    let (above, below) = if rise >= 0.0 {
        (first, last)
    } else {
        (last, first)
    };
    let body = world.get::<Attachment>(below)?.carrier;
    let support = world.get::<Attachment>(above)?.carrier;
    let hangs = rise != 0.0 && world.get::<Anchor>(body).is_none();
    hangs.then_some(Hanging {
        body,
        support,
        above,
        below,
        rise_m: rise.abs(),
    })
}

/// Whether a channel of this name is a built-in one.
pub(crate) fn is_built_in(channel: &str) -> bool {
    [
        &BODY_CHANNELS[..],
        &SAIL_CHANNELS,
        &TWISTED_TETHER_CHANNELS,
        &WINCH_CHANNELS,
        &SYSTEM_CHANNELS,
        &winches::DRUM_CHANNELS,
        &rotorcraft::CHANNELS,
        &docking::LATCH_CHANNELS,
        &docking::GUIDANCE_CHANNELS,
    ]
    .iter()
    .any(|channels| channels.contains(&channel))
}
