//! Winches: what pays tethers out and reels them in.

use aerobot_components::actuator::ActuatorChannels;
use aerobot_components::control::{ActuatorName, Commands, Controller, Schedule};
use aerobot_components::run::Formulation;
use aerobot_components::scene_component::FieldReport;
use aerobot_components::state::{Acceleration, FirstOrderState, Force, Mass, Position, Velocity};
use aerobot_components::tether::{Attachment, Lumping, Tether, TetherParts, TetherSide};
use aerobot_components::winch::{DRUM_NAME, Reeled, ReeledLine, Winch};
use aerobot_systems::dynamics::rigid_body::CarriedMass;
use aerobot_systems::dynamics::winch::{CarriesReeledLine, carry, pay_out, take_up};
use aerobot_systems::forces::reeled_spring::{reeled_spring, reeled_spring_derivatives};
use aerobot_systems::instruments::winch::{ReelPower, WinchWork, winch_power};
use bevy_ecs::entity::Entity;
use bevy_ecs::schedule::IntoScheduleConfigs;
use bevy_ecs::world::World;

use super::actuators::{add_actuator, scheduled_start};
use super::tethers;
use crate::plugin::{Plugin, Simulator};
use crate::scene::{Scene, SetupError};
use crate::schedule::Phase;
use crate::topology_change::apply;
use crate::topology_change::driving::{self, Drive};
use crate::topology_change::reeling::SHORTEST_PART;
use crate::world::{SceneEntities, next_spawn_order};

/// Winches.
pub struct WinchesPlugin;

impl Plugin for WinchesPlugin {
    fn build(&self, simulator: &mut Simulator) {
        simulator
            .register_component::<Winch>()
            .add_check(check)
            .add_check(check_commands)
            .add_setup(set_up)
            .add_systems_if(Phase::Control, has_drive, || turn_drums)
            .add_systems_for::<Winch, _, _>(Phase::Prepare, || (pay_out, carry).chain())
            .add_systems_in(Phase::Forces, has_springs, || reeled_spring)
            .add_systems_for::<Winch, _, _>(Phase::Forces, || take_up)
            .add_systems_in(Phase::Derivatives, has_springs, || {
                reeled_spring_derivatives
            });
    }
}

/// The power of winches, once the tensions of rigid links are known.
pub struct WinchPowerPlugin;

impl Plugin for WinchPowerPlugin {
    fn build(&self, simulator: &mut Simulator) {
        simulator.add_systems_for::<Winch, _, _>(Phase::Dynamics, || winch_power);
    }
}

/// Whether a controller or a schedule may turn a drum.
pub(super) fn has_drive(scene: &Scene) -> bool {
    scene
        .with::<Winch>()
        .any(|(_, winch)| winch.drive.is_some())
}

/// Turns drums as they have been commanded now.
fn turn_drums(world: &mut World) {
    let changes = driving::due(world);
    if !changes.is_empty() {
        apply(world, &changes);
    }
}

/// Whether segments at winches stretch.
fn has_springs(scene: &Scene, formulation: Formulation) -> bool {
    scene.with::<Winch>().next().is_some() && tethers::has_springs(scene, formulation)
}

fn check(scene: &Scene, report: &mut FieldReport) {
    for (entity, _) in scene.with::<Winch>() {
        let path = entity.path::<Winch>();
        if entity
            .get::<Tether>()
            .is_some_and(|tether| tether.torsion.is_some())
        {
            report.add(
                &path,
                "a tether with `torsion` has no winch: its stiffness is that of one length",
                "leave out the `torsion` or the `Winch`",
            );
        }
        let is_interior = |tether: &Tether| tether.lumping == Lumping::Interior;
        if entity.get::<Tether>().is_some_and(is_interior) {
            report.add(
                &path,
                "a winch needs the lumping `HalfSegment`: line that leaves it has mass at both ends",
                "leave `lumping` out",
            );
        }
    }
}

/// A drum that is commanded has a drive, and its rate is held from one command to the next.
fn check_commands(scene: &Scene, report: &mut FieldReport) {
    let schedules = scene
        .with::<Schedule>()
        .map(|(entity, schedule)| (entity.path::<Schedule>(), &schedule.actuator));
    let controllers = scene
        .with::<Controller>()
        .map(|(entity, controller)| (entity.path::<Controller>(), &controller.actuator));
    for (path, actuator) in schedules.chain(controllers) {
        if drum(scene, actuator).is_some_and(|winch| winch.drive.is_none()) {
            report.add(
                &format!("{path}.actuator.1"),
                format!("the winch of `{}` has no drive", actuator.0),
                "give it one: `Winch: (drive: (limit: largest rate in m/s), ..)`",
            );
        }
    }
    for (entity, schedule) in scene.with::<Schedule>() {
        let is_drum = drum(scene, &schedule.actuator).is_some();
        if is_drum && matches!(schedule.commands, Commands::Ramps(_)) {
            report.add(
                &format!("{}.commands", entity.path::<Schedule>()),
                "the rate of a drum is held from one command to the next",
                "give `Steps([(time in s, rate in m/s), ..])`",
            );
        }
    }
}

/// The winch whose drum an actuator is.
fn drum<'a>(scene: &'a Scene, (owner, name): &ActuatorName) -> Option<&'a Winch> {
    let owner = scene.entity(owner).filter(|_| name == DRUM_NAME)?;
    owner.get::<Winch>()
}

fn set_up(world: &mut World, scene: &Scene) -> Result<(), SetupError> {
    for (entity, winch) in scene.with::<Winch>() {
        let Some(id) = world.resource::<SceneEntities>().get(&entity.name) else {
            continue;
        };
        let (Some(tether), Some(parts)) = (
            entity.get::<Tether>(),
            world.get::<TetherParts>(id).cloned(),
        ) else {
            continue;
        };
        let line = mount(world, (id, tether), &parts, winch);
        let Some((limits, line)) = winch.drive.zip(line) else {
            continue;
        };
        let name = (entity.name.as_str(), DRUM_NAME);
        let start = scheduled_start(scene, &entity.name, DRUM_NAME);
        let [value, command] = DRUM_CHANNELS;
        let channels = ActuatorChannels { value, command };
        if let Some(actuator) = add_actuator(world, name, limits, channels, start) {
            world.entity_mut(line).insert(Drive::by(actuator));
        }
    }
    Ok(())
}

/// Channels of a drum with a drive: its rate and what it is commanded.
pub(super) const DRUM_CHANNELS: [&str; 2] = ["reel_rate_m_s", "reel_rate_command_m_s"];

/// Puts a winch at its end of a tether; the line that it pays out.
fn mount(
    world: &mut World,
    (id, tether): (Entity, &Tether),
    parts: &TetherParts,
    winch: &Winch,
) -> Option<Entity> {
    let (points, segments) = (&parts.points, &parts.segments);
    let last = points.len() - 1;
    let (near, far, segment) = match winch.end {
        TetherSide::From => (points[0], points[1], segments[0]),
        TetherSide::To => (points[last], points[last - 1], segments[last - 1]),
    };
    let attachment = world.get::<Attachment>(near).copied()?;
    let nominal_m = tether.segment_length_m();
    let line_kg_m = tether.mass_kg() / tether.length_m;
    let drum_kg = line_kg_m * winch.stored_m;
    for point in [points[0], points[last]] {
        if let Some(end) = world.get::<Attachment>(point).copied() {
            world.entity_mut(end.carrier).insert(CarriesReeledLine);
        }
    }
    if let Some(mut carried) = world.get_mut::<CarriedMass>(attachment.carrier) {
        carried.add(drum_kg, attachment.offset_m);
    }
    let drum = world
        .spawn((
            attachment,
            Mass(drum_kg),
            Position::default(),
            Velocity::default(),
            Force::default(),
            Acceleration::default(),
        ))
        .id();
    let far_kg = world.get::<Mass>(far).map_or(0.0, |mass| mass.0);
    let steady = |value| FirstOrderState {
        value,
        rate_per_s: 0.0,
        // The length is known beforehand, and the work follows from the motion.
        error_scale: f64::INFINITY,
    };
    let line = ReeledLine {
        tether: id,
        segment,
        near,
        far,
        drum,
        stiffness_n: tether.axial_stiffness_n,
        damping_n_s: tether.damping_n_s_m * tether.length_m,
        line_kg_m,
        far_mass_kg: far_kg - 0.5 * line_kg_m * nominal_m,
        near_and_stored_m: nominal_m + winch.stored_m,
        nominal_m,
        rate_m_s: 0.0,
    };
    let order = next_spawn_order(world);
    let line = world
        .spawn((order, line, ReelPower::default(), steady(nominal_m)))
        .id();
    world.entity_mut(segment).insert(Reeled {
        line,
        rate_m_s: 0.0,
        shortest_part: SHORTEST_PART,
        tension_by_length_n_m: 0.0,
    });
    let order = next_spawn_order(world);
    world.spawn((order, WinchWork(line), steady(0.0)));
    Some(line)
}
