//! How drones start: in trim, with an autopilot whose gains follow from it.

use aerobot_components::fixed_wing::FixedWing;
use aerobot_components::fixed_wing::guidance::GuidanceSpec;
use aerobot_components::sampling::Sampling;
use aerobot_components::state::{
    Air, AngularVelocity, Attitude, ChartAttitude, Inertia, Mass, Position, Velocity,
};
use aerobot_systems::environment::EnvironmentModel;
use aerobot_systems::fixed_wing::autopilot::{Autopilot, Memory};
use aerobot_systems::fixed_wing::chase::Chase;
use aerobot_systems::fixed_wing::flight_trim::{Flier, SteadyFlight, TrimmedFlight};
use aerobot_systems::fixed_wing::gains::design;
use aerobot_systems::fixed_wing::linear_model::LinearModel;
use aerobot_systems::fixed_wing::north_east_down::{attitude, from_roll_pitch_yaw, tensor, vector};
use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;
use glam::DVec3;

use super::control::{AutopilotOf, Flying, LEAST_MARGIN};
use crate::scene::{Scene, SceneEntity, SetupError};
use crate::world::{EntityName, SceneEntities};

/// The trim in which a drone starts, and the airspeeds of level flight.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct DroneTrim {
    /// Angles and controls; north-east-down.
    pub flight: TrimmedFlight,
    /// Least and greatest airspeed of level straight flight with its mass and in its air at the start, m/s.
    pub level_m_s: (f64, f64),
    /// Density of that air, kg/m^3.
    pub density_kg_m3: f64,
    /// Gravity, m/s^2.
    pub gravity_m_s2: f64,
}

/// Puts every drone into trim, where the scene has it.
pub(super) fn set_up(world: &mut World, scene: &Scene) -> Result<(), SetupError> {
    for (entity, drone) in scene.with::<FixedWing>() {
        let Some(id) = world.resource::<SceneEntities>().get(&entity.name) else {
            continue;
        };
        start(world, (entity, id), drone)?;
    }
    Ok(())
}

/// Density (kg/m^3) and wind (m/s) where a drone starts, as they are at that time.
fn air_at_start(world: &World, position_m: DVec3) -> Result<Air, String> {
    let environment = world.resource::<EnvironmentModel>();
    let mut wind = environment.wind.clone();
    wind.begin_interval(0.0);
    wind.advance_gusts(0.0);
    Ok(Air {
        density_kg_m3: environment
            .atmosphere
            .density_kg_m3(position_m.z)
            .map_err(|outside| outside.to_string())?,
        velocity_m_s: wind
            .velocity_m_s(position_m.z)
            .map_err(|outside| outside.to_string())?,
    })
}

fn start(
    world: &mut World,
    (entity, id): (&SceneEntity, Entity),
    drone: &FixedWing,
) -> Result<(), SetupError> {
    let refuse = |field: &str, message: String, help: &str| {
        let path = format!("{}.{field}", entity.path::<FixedWing>());
        SetupError::new(path, message, help)
    };
    let (Some(mass), Some(inertia), Some(position)) = (
        world.get::<Mass>(id).copied(),
        world.get::<Inertia>(id).copied(),
        world.get::<Position>(id).copied(),
    ) else {
        return Ok(());
    };
    let air = air_at_start(world, position.0).map_err(|message| refuse("start", message, ""))?;
    let flier = Flier {
        aircraft: drone.aircraft(),
        mass_kg: mass.0,
        inertia_kg_m2: tensor(inertia.0),
        density_kg_m3: air.density_kg_m3,
        gravity_m_s2: world
            .resource::<EnvironmentModel>()
            .gravity
            .acceleration_m_s2(position.0.z),
    };
    let (course_rad, climb_rad, turn_rad_s) = drone.start.path_rad();
    let airspeed_m_s = drone.start.airspeed_m_s();
    // Outside, courses and turns count from x towards y; inside, from north to the east.
    let asked = SteadyFlight {
        airspeed_m_s,
        climb_rad,
        turn_rad_s: -turn_rad_s,
    };
    let no_trim = |error| {
        refuse(
            "start",
            format!("the drone cannot fly so: {error}"),
            "another airspeed, a lighter body or denser air may do",
        )
    };
    let flight = flier.trim(asked).map_err(no_trim)?;
    let level = flier
        .trim(SteadyFlight {
            airspeed_m_s,
            ..SteadyFlight::default()
        })
        .map_err(no_trim)?;
    let level_m_s = flier.level_airspeeds_m_s(airspeed_m_s).map_err(no_trim)?;
    let wind_m_s = drone.wind.velocity_m_s(air.velocity_m_s);
    set_state(world, id, &flight, (course_rad, wind_m_s));
    let trim = DroneTrim {
        flight,
        level_m_s,
        density_kg_m3: air.density_kg_m3,
        gravity_m_s2: flier.gravity_m_s2,
    };
    world
        .entity_mut(id)
        .insert((flier.aircraft, flight.controls, air, trim));
    if drone.guidance == GuidanceSpec::None {
        return Ok(());
    }
    let gains = design(&LinearModel::about(&flier, &level), &drone.autopilot).map_err(|error| {
        refuse(
            &format!("autopilot.{}", error.name),
            error.to_string(),
            "the bandwidths that are there without being given suit the Aerosonde",
        )
    })?;
    let target = drone
        .guidance
        .names()
        .and_then(|(_, name)| world.resource::<SceneEntities>().get(name));
    let flying = Flying {
        autopilot: Autopilot {
            spec: drone.autopilot,
            gains,
            trim: level,
            limits: flier.aircraft.limits,
            safe_airspeed_m_s: LEAST_MARGIN * level_m_s.0,
        },
        memory: Memory::starting_in(vector(wind_m_s)),
        chase: Chase::default(),
        target,
        last: None,
        end_game_pitch_rad: None,
    };
    world.entity_mut(id).insert(flying);
    world.spawn((AutopilotOf(id), Sampling::every(drone.autopilot.period_s)));
    Ok(())
}

/// Attitude and motion of a trimmed flight, on a course and in a wind of the scene's frame.
fn set_state(
    world: &mut World,
    id: Entity,
    flight: &TrimmedFlight,
    (course_rad, wind_m_s): (f64, DVec3),
) {
    // The heading that makes the course: without yaw the path may point to a side, when the wing hangs.
    let straight = from_roll_pitch_yaw(DVec3::new(flight.roll_rad, flight.pitch_rad, 0.0));
    let path = straight * flight.velocity_m_s();
    let yaw = -course_rad - libm::atan2(path.y, path.x);
    let turned = from_roll_pitch_yaw(DVec3::new(flight.roll_rad, flight.pitch_rad, yaw));
    let velocity_m_s = wind_m_s + vector(turned * flight.velocity_m_s());
    let attitude = attitude(turned).normalize();
    world.entity_mut(id).insert((
        Attitude(attitude),
        ChartAttitude(attitude),
        Velocity(velocity_m_s),
        AngularVelocity(vector(flight.rate_rad_s)),
    ));
}

/// The trim of every drone, as lines for a person.
#[must_use]
pub fn describe(world: &World) -> Vec<String> {
    let mut lines = Vec::new();
    for id in world.resource::<SceneEntities>().in_order() {
        let (Some(trim), Some(name)) = (world.get::<DroneTrim>(*id), world.get::<EntityName>(*id))
        else {
            continue;
        };
        let (flight, controls) = (&trim.flight, &trim.flight.controls);
        lines.push(format!(
            "trim of `{}`: {} m/s at {:.4} kg/m^3: angle of attack {:.5} deg, roll {:.4} deg, elevator \
             {:.5} deg, aileron {:.4} deg, rudder {:.4} deg, throttle {:.6}, thrust {:.5} N; level flight \
             from {:.2} to {:.2} m/s",
            name.0,
            flight.flight.airspeed_m_s,
            trim.density_kg_m3,
            flight.alpha_rad.to_degrees(),
            flight.roll_rad.to_degrees(),
            controls.elevator_rad.to_degrees(),
            controls.aileron_rad.to_degrees(),
            controls.rudder_rad.to_degrees(),
            controls.throttle,
            flight.thrust_n,
            trim.level_m_s.0,
            trim.level_m_s.1
        ));
        if let Some(flying) = world.get::<Flying>(*id) {
            let gains = &flying.autopilot.gains;
            let pair = |name, of: aerobot_systems::fixed_wing::gains::LoopGains| {
                format!("{name} {:.5} and {:.5}", of.proportional, of.second)
            };
            lines.push(format!(
                "gains of `{}`: {}",
                name.0,
                [
                    pair("roll", gains.roll),
                    pair("course", gains.course),
                    pair("pitch", gains.pitch),
                    pair("altitude", gains.altitude),
                    pair("airspeed", gains.airspeed),
                ]
                .join(", ")
            ));
        }
    }
    lines
}
