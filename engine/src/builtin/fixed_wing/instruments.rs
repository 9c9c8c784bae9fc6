//! What is recorded of drones, and the event of a stall.

use aerobot_components::fixed_wing::FixedWing;
use aerobot_components::fixed_wing::aircraft::Aircraft;
use aerobot_components::fixed_wing::controls::Controls;
use aerobot_components::fixed_wing::guidance::GuidanceSpec;
use aerobot_components::state::{Air, Attitude, Position, Velocity};
use aerobot_systems::clock::Clock;
use aerobot_systems::fixed_wing::aerodynamics::incidence_rad;
use aerobot_systems::fixed_wing::chase::ChaseState;
use aerobot_systems::fixed_wing::flight_trim::beginning_stall_rad;
use aerobot_systems::fixed_wing::north_east_down::vector;
use aerobot_systems::fixed_wing::propeller::thrust;
use aerobot_systems::instruments::channel_log::ChannelLog;
use bevy_ecs::entity::Entity;
use bevy_ecs::query::With;
use bevy_ecs::system::{Local, Query, Res, ResMut};
use glam::DVec3;

use super::control::Flying;
use crate::world::{EntityName, EventLog};

/// Number of a state in the channel `chase_state`.
fn number(state: ChaseState) -> f64 {
    match state {
        ChaseState::Pursuing => 0.0,
        ChaseState::Station => 1.0,
        ChaseState::Unreachable => 2.0,
        ChaseState::EndGame => 3.0,
        ChaseState::Passed => 4.0,
    }
}

type Drone = (
    Entity,
    &'static FixedWing,
    &'static Aircraft,
    &'static Controls,
    &'static Air,
    &'static Position,
    &'static Velocity,
    &'static Attitude,
    Option<&'static Flying>,
);

/// Records flight, controls and pursuit of every drone.
pub(super) fn record(
    mut log: ResMut<ChannelLog>,
    drones: Query<Drone>,
    targets: Query<(&Position, &Velocity)>,
) {
    for (id, drone, aircraft, controls, air, position, velocity, attitude, flying) in &drones {
        let wind_m_s = drone.wind.velocity_m_s(air.velocity_m_s);
        let through_air = velocity.0 - wind_m_s;
        let (alpha, beta) = incidence_rad(vector(attitude.0.conjugate() * through_air));
        let airspeed = through_air.length();
        let propeller = thrust(
            &aircraft.propulsion,
            air.density_kg_m3,
            airspeed,
            controls.throttle,
        );
        for (channel, value) in [
            ("air_relative_speed_m_s", airspeed),
            ("course_rad", libm::atan2(through_air.y, through_air.x)),
            ("alpha_rad", alpha),
            ("beta_rad", beta),
            ("aileron_rad", controls.aileron_rad),
            ("elevator_rad", controls.elevator_rad),
            ("rudder_rad", controls.rudder_rad),
            ("throttle", controls.throttle),
            ("thrust_n", propeller.thrust_n),
        ] {
            log.record(id, channel, value);
        }
        let (GuidanceSpec::Pursue(_), Some(flying)) = (&drone.guidance, flying) else {
            continue;
        };
        let Some((target, target_velocity)) =
            flying.target.and_then(|target| targets.get(target).ok())
        else {
            continue;
        };
        let from_target: DVec3 = position.0 - target.0;
        let required = (target_velocity.0 - wind_m_s).length();
        for (channel, value) in [
            ("from_target_x_m", from_target.x),
            ("from_target_y_m", from_target.y),
            ("from_target_z_m", from_target.z),
            ("range_m", from_target.length()),
            ("required_airspeed_m_s", required),
            ("chase_state", number(flying.chase.state)),
        ] {
            log.record(id, channel, value);
        }
    }
}

/// Tells when a wing begins to stall, and when it flies again: at a tenth less than the angle where it began.
pub(super) fn tell_stalls(
    clock: Res<Clock>,
    mut events: ResMut<EventLog>,
    drones: Query<
        (
            Entity,
            &FixedWing,
            &Aircraft,
            &Air,
            &Velocity,
            &Attitude,
            &EntityName,
        ),
        With<Controls>,
    >,
    mut stalled: Local<Vec<Entity>>,
) {
    for (id, drone, aircraft, air, velocity, attitude, name) in &drones {
        let through_air = velocity.0 - drone.wind.velocity_m_s(air.velocity_m_s);
        let (alpha, _) = incidence_rad(vector(attitude.0.conjugate() * through_air));
        let begins = beginning_stall_rad(aircraft);
        let was = stalled.contains(&id);
        if !was && alpha.abs() > begins {
            stalled.push(id);
            events.add(clock.time_s, "stalled", &name.0);
        } else if was && alpha.abs() < 0.9 * begins {
            stalled.retain(|other| *other != id);
            events.add(clock.time_s, "flying again", &name.0);
        }
    }
}
