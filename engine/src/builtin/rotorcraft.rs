//! Rotorcraft: their rotors, their flight computers, and what they record.

use aerobot_components::body::Body;
use aerobot_components::inertia::InertiaShape;
use aerobot_components::rotorcraft::{FlightReference, FlightStatus, RotorCommand, Rotorcraft};
use aerobot_components::sampling::Sampling;
use aerobot_components::scene_component::FieldReport;
use aerobot_components::state::{Air, Attitude, FirstOrderState, Mass, Position, Velocity};
use aerobot_systems::docking::guidance::guide;
use aerobot_systems::environment::EnvironmentModel;
use aerobot_systems::instruments::attitude::heading_rad;
use aerobot_systems::instruments::channel_log::{BuiltInChannels, ChannelLog};
use aerobot_systems::rotorcraft::flight_computer::{FlightComputer, command_rotors, follow_course};
use aerobot_systems::rotorcraft::momentum_theory::{Inflow, shaft_power_w};
use aerobot_systems::rotorcraft::rotor_forces::rotor_forces;
use bevy_ecs::entity::Entity;
use bevy_ecs::schedule::IntoScheduleConfigs;
use bevy_ecs::system::{In, IntoSystem, Query, ResMut};
use bevy_ecs::world::World;

use super::channels::channels_due;
use crate::plugin::{Plugin, Simulator};
use crate::scene::{Scene, SetupError};
use crate::schedule::Phase;
use crate::world::{Discontinuity, SceneEntities};

const THRUST: &str = "thrust_n";
const LARGEST_THRUST: &str = "largest_thrust_n";
const POWER: &str = "power_w";

/// The channels of a rotorcraft: thrust, the largest that there is in this air, shaft power.
pub(crate) const CHANNELS: [&str; 3] = [THRUST, LARGEST_THRUST, POWER];

/// An error of thrust that matters as much as 1 m, N.
const THRUST_SCALE_N: f64 = 100.0;

/// Rotorcraft.
pub struct RotorcraftPlugin;

impl Plugin for RotorcraftPlugin {
    fn build(&self, simulator: &mut Simulator) {
        simulator
            .register_component::<Rotorcraft>()
            .add_check(check)
            .add_setup(set_up)
            .add_systems_for::<Rotorcraft, _, _>(Phase::Control, || {
                (follow_course, guide, command_rotors.pipe(note_commands)).chain()
            })
            .add_systems_for::<Rotorcraft, _, _>(Phase::Forces, || rotor_forces)
            .add_systems_for::<Rotorcraft, _, _>(Phase::Observe, || record.run_if(channels_due));
    }
}

/// Commands switch at once, so that the rates of the present are found anew.
fn note_commands(In(has_commanded): In<bool>, mut discontinuity: ResMut<Discontinuity>) {
    discontinuity.0 |= has_commanded;
}

fn check(scene: &Scene, report: &mut FieldReport) {
    for (entity, _) in scene.with::<Rotorcraft>() {
        let is_point = entity
            .get::<Body>()
            .is_some_and(|body| body.inertia == InertiaShape::Point);
        if is_point {
            report.add(
                &format!("{}.inertia", entity.path::<Body>()),
                "a rotorcraft flies by turning, and a point cannot turn",
                "give the body an `inertia`",
            );
        }
    }
}

/// Every rotorcraft starts with the thrust that carries its weight, and holds its place.
fn set_up(world: &mut World, scene: &Scene) -> Result<(), SetupError> {
    let gravity = world.resource::<EnvironmentModel>().gravity;
    for (entity, rotorcraft) in scene.with::<Rotorcraft>() {
        let Some(body) = world.resource::<SceneEntities>().get(&entity.name) else {
            continue;
        };
        let (Some(mass), Some(position), Some(attitude)) = (
            world.get::<Mass>(body).copied(),
            world.get::<Position>(body).copied(),
            world.get::<Attitude>(body).copied(),
        ) else {
            continue;
        };
        let hover_n = mass.0 * gravity.acceleration_m_s2(position.0.z);
        world.entity_mut(body).insert((
            Air::default(),
            FlightReference {
                position_m: Some(position.0),
                heading_rad: heading_rad(attitude.0),
                ..FlightReference::default()
            },
            RotorCommand {
                thrust_n: hover_n,
                attitude: attitude.0,
                is_idle: false,
            },
            FlightStatus::default(),
            FirstOrderState {
                value: hover_n,
                rate_per_s: 0.0,
                error_scale: THRUST_SCALE_N,
            },
        ));
        world.spawn((FlightComputer(body), Sampling::every(rotorcraft.period_s)));
    }
    Ok(())
}

/// Records thrust and power where they are asked for.
fn record(
    mut log: ResMut<ChannelLog>,
    bodies: Query<(
        Entity,
        &BuiltInChannels,
        (&Rotorcraft, &FlightStatus, &FirstOrderState),
        (&Velocity, &Attitude, &Air),
    )>,
) {
    for (entity, channels, (rotorcraft, status, thrust), (velocity, attitude, air)) in &bodies {
        let through_air = velocity.0 - air.velocity_m_s;
        let axis = attitude.0 * glam::DVec3::Z;
        let axial_m_s = through_air.dot(axis);
        let inflow = Inflow {
            density_kg_m3: air.density_kg_m3,
            axial_m_s,
            edgewise_m_s: (through_air - axial_m_s * axis).length_squared().sqrt(),
        };
        for (channel, value) in [
            (THRUST, thrust.value),
            (LARGEST_THRUST, status.largest_thrust_n),
            (POWER, shaft_power_w(rotorcraft, thrust.value, &inflow)),
        ] {
            if channels.has(channel) {
                log.record(entity, channel, value);
            }
        }
    }
}
