//! The environment of a scene as a resource, and the air at everything that asks for it.

use aerobot_components::aerodynamics::{AddedMass, Buoyancy, Drag, RadiusRule, Sphere};
use aerobot_components::body::{Fixed, Moving, Pose};
use aerobot_components::environment::{AtmosphereSpec, Environment, WindSpec};
use aerobot_components::scene_component::FieldReport;
use aerobot_systems::environment::EnvironmentModel;
use aerobot_systems::environment::air_at::air_at_entities;
use aerobot_systems::environment::atmosphere::Atmosphere;
use aerobot_systems::environment::gusts_at::advance_gusts;
use aerobot_systems::environment::wind::{Wind, WindSource};
use aerobot_systems::environment::wind_profile::WindProfile;
use bevy_ecs::world::World;

use super::gusts;
use crate::plugin::{Plugin, Simulator};
use crate::scene::tables::{Tables, gas_of};
use crate::scene::{Scene, SceneEntity, SetupError};
use crate::schedule::Phase;
use crate::world::Edges;

/// Gravity, air and wind.
pub struct EnvironmentPlugin;

impl Plugin for EnvironmentPlugin {
    fn build(&self, simulator: &mut Simulator) {
        simulator
            .add_check(check_temperature)
            .add_check(check_altitudes)
            .add_check(gusts::check)
            .add_setup(set_up)
            .add_systems_if(Phase::Environment, gusts::has_gusts, || advance_gusts)
            .add_systems(Phase::Environment, || air_at_entities);
    }
}

fn set_up(world: &mut World, scene: &Scene) -> Result<(), SetupError> {
    let model = environment_model(scene)?;
    world.resource_mut::<Edges>().add(model.wind.edges_s());
    // The start of the run is an edge too: the first interval begins there.
    world.resource_mut::<Edges>().add([0.0]);
    world.insert_resource(model);
    Ok(())
}

/// The model that a scene's environment describes, under the seed of its run.
///
/// # Errors
/// A gust that cannot be; the checks of the scene refuse it before.
pub fn environment_model(scene: &Scene) -> Result<EnvironmentModel, SetupError> {
    let environment = &scene.environment;
    let sources = environment
        .wind
        .iter()
        .enumerate()
        .filter_map(|(index, wind)| wind_source(wind, index, &scene.tables))
        .collect();
    Ok(EnvironmentModel {
        gravity: environment.gravity,
        atmosphere: atmosphere(environment, &scene.tables),
        wind: Wind::new(sources).with_gusts(gusts::draw(scene)?),
    })
}

/// The air that a scene describes.
#[must_use]
pub fn atmosphere(environment: &Environment, tables: &Tables) -> Atmosphere {
    match &environment.atmosphere {
        AtmosphereSpec::Vira => Atmosphere::vira(),
        AtmosphereSpec::Vacuum => Atmosphere::Vacuum,
        AtmosphereSpec::StandardAtmosphere1976 => Atmosphere::StandardAtmosphere1976,
        AtmosphereSpec::Uniform {
            density_kg_m3,
            temperature_k,
            gas,
        } => Atmosphere::Uniform {
            density_kg_m3: *density_kg_m3,
            temperature_k: *temperature_k,
            gas: gas_of(*gas),
        },
        AtmosphereSpec::Exponential {
            density_kg_m3,
            altitude_m,
            scale_height_m,
            temperature_k,
            gas,
        } => Atmosphere::Exponential {
            density_kg_m3: *density_kg_m3,
            altitude_m: *altitude_m,
            scale_height_m: *scale_height_m,
            temperature_k: *temperature_k,
            gas: gas_of(*gas),
        },
        AtmosphereSpec::Table { .. } => tables
            .atmosphere
            .clone()
            .map_or(Atmosphere::Vacuum, Atmosphere::Table),
    }
}

fn wind_source(wind: &WindSpec, index: usize, tables: &Tables) -> Option<WindSource> {
    Some(match wind {
        WindSpec::Uniform { velocity_m_s } => WindSource::Uniform {
            velocity_m_s: *velocity_m_s,
        },
        WindSpec::Shear {
            altitude_m,
            gradient_per_s,
            direction,
        } => WindSource::Shear {
            altitude_m: *altitude_m,
            gradient_per_s: *gradient_per_s,
            direction: *direction,
        },
        WindSpec::Step {
            velocity_m_s,
            from_s,
            until_s,
        } => WindSource::Step {
            velocity_m_s: *velocity_m_s,
            from_s: *from_s,
            until_s: *until_s,
        },
        WindSpec::VenusZonal => WindSource::Profile(WindProfile::venus_zonal()),
        WindSpec::Profile { .. } => WindSource::Profile(tables.winds.get(&index)?.clone()),
        WindSpec::Gust(_) => return None,
    })
}

/// A Reynolds number needs a viscosity, and a viscosity a temperature.
fn check_temperature(scene: &Scene, report: &mut FieldReport) {
    let unknown = match &scene.environment.atmosphere {
        AtmosphereSpec::Uniform { temperature_k, .. }
        | AtmosphereSpec::Exponential { temperature_k, .. } => temperature_k.is_none(),
        AtmosphereSpec::Table { .. } => match &scene.tables.atmosphere {
            Some(table) => matches!(table.temperature_k(table.lowest_m()), Some(None)),
            None => false,
        },
        AtmosphereSpec::Vira | AtmosphereSpec::Vacuum | AtmosphereSpec::StandardAtmosphere1976 => {
            false
        }
    };
    for (entity, drag) in scene.with::<Drag>() {
        if unknown && matches!(drag, Drag::Morrison) {
            report.add(
                &entity.path::<Drag>(),
                "`Morrison` needs the temperature of the air, and this atmosphere has none",
                "give the atmosphere a `temperature_k`",
            );
        }
    }
}

/// What is in the air must start where the atmosphere is known.
fn check_altitudes(scene: &Scene, report: &mut FieldReport) {
    let (lowest_m, highest_m) = atmosphere(&scene.environment, &scene.tables).bounds_m();
    for entity in &scene.entities {
        let Some((field, altitude_m)) = given_altitude(entity) else {
            continue;
        };
        if altitude_m < lowest_m || altitude_m > highest_m {
            report.add(
                &format!("entities.{}.{field}", entity.name),
                format!("an altitude of {altitude_m} m is outside the atmosphere"),
                format!("it is known from {lowest_m} m to {highest_m} m; z is the altitude"),
            );
        }
    }
}

/// Where an entity that meets the air is put by the scene: the field, and the altitude in m.
pub(super) fn given_altitude(entity: &SceneEntity) -> Option<(&'static str, f64)> {
    if let Some(RadiusRule::Equilibrium { altitude_m }) =
        entity.get::<Sphere>().and_then(|sphere| sphere.radius)
    {
        return Some(("Sphere.radius.altitude_m", altitude_m));
    }
    if !(entity.has::<Drag>() || entity.has::<Buoyancy>() || entity.has::<AddedMass>()) {
        return None;
    }
    let fixed = entity.get::<Fixed>();
    let moving = entity.get::<Moving>();
    let pose = entity.get::<Pose>();
    fixed
        .and_then(|fixed| Some(("Fixed.position_m", fixed.position_m?.z)))
        .or_else(|| moving.map(|moving| ("Moving.position_m", moving.position_m.z)))
        .or_else(|| pose.map(|pose| ("Pose.position_m", pose.position_m.z)))
}
