//! A sensor of pressure and temperature: an instrument that is not part of aerobot.
//!
//! It uses nothing but what every crate can use, and what the built-in instruments use too. Five
//! pieces make an instrument:
//!
//! 1. a component, [`AtmosphereSensor`]: what a scene may write under an entity;
//! 2. a check, [`needs_pressure_and_temperature`]: what must hold between it and the rest of a scene;
//! 3. a setup, [`mount`]: what the running world needs beside the component, derived from it once;
//! 4. a system, [`sample`]: what the instrument does, over and over;
//! 5. a plugin, [`AtmosphereSensorPlugin`], that registers the four.

use aerobot::components::sampling::Sampling;
use aerobot::components::scene_component::{FieldReport, SceneComponent};
use aerobot::components::state::Position;
use aerobot::engine::builtin::environment::atmosphere;
use aerobot::engine::plugin::{Plugin, Simulator};
use aerobot::engine::scene::{Scene, SetupError};
use aerobot::engine::schedule::Phase;
use aerobot::engine::world::SceneEntities;
use aerobot::systems::clock::Clock;
use aerobot::systems::environment::EnvironmentModel;
use aerobot::systems::instruments::channel_log::ChannelLog;
use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use bevy_ecs::system::{Query, Res, ResMut};
use bevy_ecs::world::World;
use serde::Deserialize;

/// Name of the channel of pressure. A channel's name ends in its unit: there is no other place for it
/// in `channels.csv`.
pub(crate) const PRESSURE: &str = "pressure_pa";
/// Name of the channel of temperature.
pub(crate) const TEMPERATURE: &str = "temperature_k";

/// The sensor as a scene writes it: `AtmosphereSensor: (period_s: 0.5, pressure_bias_pa: 25)`.
///
/// A component is plain data in SI. `deny_unknown_fields` makes a misspelt field an error that shows
/// its line and the nearest right name; without it the field would be dropped in silence.
#[derive(Component, Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub(crate) struct AtmosphereSensor {
    /// Time between samples, s.
    pub(crate) period_s: f64,
    /// What the sensor reads above the true pressure, Pa; none unless given.
    #[serde(default)]
    pub(crate) pressure_bias_pa: f64,
}

impl SceneComponent for AtmosphereSensor {
    const NAME: &'static str = "AtmosphereSensor";
    // It sits on something that has a position: a body, or an anchor.
    const REQUIRES: &'static [&'static [&'static str]] = &[&["Body", "Fixed", "Moving"]];

    fn check(&self, report: &mut FieldReport) {
        report.positive("period_s", self.period_s);
        report.finite("pressure_bias_pa", self.pressure_bias_pa);
    }
}

/// Marks the sampler of a sensor, and says which body carries the sensor.
///
/// The sampler is an entity of its own: a body that carries several instruments has one `Sampling`
/// for each of them, and an entity can have only one.
#[derive(Component, Clone, Copy, Debug)]
struct CarriedBy(Entity);

/// The family: this is what `aerobot::cli::main` and `Simulator::add_plugin` take.
pub(crate) struct AtmosphereSensorPlugin;

impl Plugin for AtmosphereSensorPlugin {
    fn build(&self, simulator: &mut Simulator) {
        simulator
            .register_component::<AtmosphereSensor>()
            .add_check(needs_pressure_and_temperature)
            .add_setup(mount)
            // Observe: once per accepted step, when every quantity belongs to the accepted state.
            // A force would go to Phase::Forces instead and run once per stage of the integrator.
            // `_for` leaves the system out of scenes without a sensor.
            .add_systems_for::<AtmosphereSensor, _, _>(Phase::Observe, || sample);
    }
}

/// Some atmospheres are a density and nothing else. Better to refuse such a scene when it is read than
/// to stop the run; what a check reports is shown at its line, together with all else that is wrong.
fn needs_pressure_and_temperature(scene: &Scene, report: &mut FieldReport) {
    let air = atmosphere(&scene.environment, &scene.tables);
    let (lowest_m, _) = air.bounds_m();
    let altitude_m = if lowest_m.is_finite() { lowest_m } else { 0.0 };
    let knows_both = matches!(air.pressure_pa(altitude_m), Ok(Some(_)))
        && matches!(air.temperature_k(altitude_m), Ok(Some(_)));
    if knows_both {
        return;
    }
    for (entity, _) in scene.with::<AtmosphereSensor>() {
        report.add(
            &entity.path::<AtmosphereSensor>(),
            "`AtmosphereSensor` needs an atmosphere with pressure and temperature",
            "use `atmosphere: Vira`, or a `Table` with both columns",
        );
    }
}

/// Runs once, when every entity of the scene stands in the world with its components.
///
/// The run looks at every `Sampling` and ends a step exactly at its next time, so that no sample is
/// interpolated, whatever the integrator and whatever the output times.
fn mount(world: &mut World, scene: &Scene) -> Result<(), SetupError> {
    for (entity, sensor) in scene.with::<AtmosphereSensor>() {
        if let Some(body) = world.resource::<SceneEntities>().get(&entity.name) {
            world.spawn((CarriedBy(body), Sampling::every(sensor.period_s)));
        }
    }
    Ok(())
}

/// Runs after every accepted step, and reads the air where the sensor is if a sample is due.
///
/// The arguments say what the system touches: `Res` reads a resource, `ResMut` changes one, a `Query`
/// finds entities by their components. It does not ask for the wind, the forces or the integrator.
fn sample(
    clock: Res<Clock>,
    environment: Res<EnvironmentModel>,
    mut log: ResMut<ChannelLog>,
    mut samplers: Query<(&CarriedBy, &mut Sampling)>,
    carriers: Query<(&AtmosphereSensor, &Position)>,
) {
    for (body, mut sampling) in &mut samplers {
        if !sampling.is_due(clock.time_s) {
            continue;
        }
        sampling.done(clock.time_s);
        let Ok((sensor, position)) = carriers.get(body.0) else {
            continue;
        };
        let altitude_m = position.0.z;
        let pressure_pa = environment.atmosphere.pressure_pa(altitude_m);
        let temperature_k = environment.atmosphere.temperature_k(altitude_m);
        // Above or below the atmosphere there is no reading. A value that is not finite stops the run
        // and names the channel, which is what a user wants to hear.
        let pressure_pa = pressure_pa.ok().flatten().unwrap_or(f64::NAN);
        let temperature_k = temperature_k.ok().flatten().unwrap_or(f64::NAN);
        log.record(body.0, PRESSURE, pressure_pa + sensor.pressure_bias_pa);
        log.record(body.0, TEMPERATURE, temperature_k);
    }
}
