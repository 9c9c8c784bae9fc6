//! The drone that chases the gondola (sec. 5.4, figures 20 and 21), in the air that the paper's figure needs,
//! and in the two in which it cannot be had.

mod checks;
mod figures;
mod level_flight;
mod report;

use std::path::Path;

use aerobot_components::state::{Air, Velocity};
use aerobot_engine::builtin::fixed_wing::DroneTrim;
use aerobot_engine::plugin::Simulator;
use aerobot_engine::recording::frame::MemorySink;
use aerobot_engine::scene::SceneError;
use aerobot_engine::simulation::Simulation;
use aerobot_engine::world::SceneEntities;
use aerobot_systems::environment::EnvironmentModel;
use bevy_ecs::component::Component;
use glam::DVec3;

use super::{Case, Report, ReproduceError, Settings};

/// The scene of the case.
const SCENE: &str = include_str!("../../../scenes/paper/mav_chase.ron");
/// What messages call it.
const SCENE_NAME: &str = "scenes/paper/mav_chase.ron";
/// The names of its entities.
const DRONE: &str = "drone";
const GONDOLA: &str = "gondola";

/// The chase.
#[derive(Clone, Copy, Debug)]
pub struct Chase;

impl Case for Chase {
    fn name(&self) -> &'static str {
        "chase"
    }

    fn about(&self) -> &'static str {
        "a fixed-wing drone chases the gondola that a sail steers (sec. 5.4, figure 21)"
    }

    fn run(
        &self,
        simulator: &Simulator,
        settings: &Settings,
        progress: &mut dyn FnMut(&str, f64),
    ) -> Result<Report, ReproduceError> {
        let flights = fly(simulator, settings, progress)?;
        let level = level_flight::checks(simulator)?;
        Ok(report::report(&flights, level).with_figures(figures::figures(&flights)))
    }
}

/// The air that the drone flies in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DroneAir {
    /// Its own, as the scene has it: the gondola's velocity less 25 m/s.
    Own,
    /// That of the gondola.
    Gondolas,
    /// At rest in the inertial frame.
    Still,
}

impl DroneAir {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Own, Self::Gondolas, Self::Still];

    /// In words.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Own => "own wind",
            Self::Gondolas => "the gondola's wind",
            Self::Still => "still air",
        }
    }

    fn overrides(self) -> Option<String> {
        match self {
            Self::Own => None,
            Self::Gondolas => Some("Scene".to_owned()),
            Self::Still => Some("Uniform(0, 0, 0)".to_owned()),
        }
        .map(|wind| format!("entities.{DRONE}.FixedWing.wind={wind}"))
    }
}

/// One flight.
#[derive(Clone, Debug, PartialEq)]
pub struct ChaseFlight {
    /// The air that the drone flew in.
    pub air: DroneAir,
    /// Rows at every output.
    pub rows: Vec<ChaseRow>,
    /// Least and greatest airspeed of the drone's level flight, m/s.
    pub level_m_s: (f64, f64),
    /// Speed of the gondola at the start, m/s, inertial frame.
    pub gondola_m_s: f64,
    /// Its speed through the scene's wind then, m/s.
    pub gondola_through_air_m_s: f64,
    /// What was told of the drone: time in s, and what.
    pub events: Vec<(f64, String)>,
    /// Why it stopped before its end, if it did.
    pub stopped: Option<String>,
}

/// The chase at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChaseRow {
    /// Time, s.
    pub time_s: f64,
    /// Position of the drone less that of the gondola, m.
    pub error_m: DVec3,
    /// Place of the gondola across the zonal wind, m.
    pub gondola_y_m: f64,
    /// Airspeed that keeps up with it, m/s.
    pub required_m_s: f64,
    /// Speed of the drone through its air, m/s.
    pub airspeed_m_s: f64,
    /// The channel `chase_state`.
    pub state: f64,
}

impl ChaseFlight {
    /// The time in s after which the error along an axis (0, 1, 2) stays within `within_m` of its last value.
    #[must_use]
    pub fn settled_s(&self, axis: usize, within_m: f64) -> Option<f64> {
        let last_m = self.rows.last()?.error_m[axis];
        let outside = |row: &&ChaseRow| (row.error_m[axis] - last_m).abs() > within_m;
        let unsettled = self.rows.iter().rposition(|row| outside(&row));
        let first = unsettled.map_or(0, |index| index + 1);
        Some(self.rows.get(first)?.time_s)
    }
}

/// Flies the chase in all three airs.
///
/// # Errors
/// A scene that cannot be built.
pub fn fly(
    simulator: &Simulator,
    settings: &Settings,
    progress: &mut dyn FnMut(&str, f64),
) -> Result<Vec<ChaseFlight>, ReproduceError> {
    let mut flights = Vec::new();
    for (index, air) in DroneAir::ALL.into_iter().enumerate() {
        let mut part = |part: f64| progress(air.name(), (index as f64 + part) / 3.0);
        flights.push(fly_in(simulator, settings, air, &mut part)?);
    }
    Ok(flights)
}

fn fly_in(
    simulator: &Simulator,
    settings: &Settings,
    air: DroneAir,
    progress: &mut dyn FnMut(f64),
) -> Result<ChaseFlight, SceneError> {
    let mut overrides: Vec<String> = air.overrides().into_iter().collect();
    if let Some(duration_s) = settings.duration_s {
        overrides.push(format!("run.duration_s={duration_s:?}"));
    }
    if let Some(nodes) = settings.nodes {
        // Nodes of another number have no places of their own.
        overrides.push(format!("entities.tether.Tether.nodes={nodes}"));
        overrides.push("entities.tether.Tether.start=Equilibrium".to_owned());
    }
    let scene = simulator.load_text(SCENE_NAME, SCENE.to_owned(), Path::new("."), &overrides)?;
    let mut simulation = simulator.build(&scene)?;
    // The scene starts in its steady state; with other nodes that is another one.
    if settings.nodes.is_some() {
        simulation.settle_in_wind(&scene)?;
    }
    let level_m_s = of::<DroneTrim>(&simulation, DRONE)?.level_m_s;
    let velocity_m_s = of::<Velocity>(&simulation, GONDOLA)?.0;
    let wind_m_s = wind_at(&simulation, GONDOLA)?;
    let mut results = MemorySink::default();
    let duration_s = scene.run.duration_s;
    let summary = simulation.run(&mut results, &mut |time_s| progress(time_s / duration_s));
    let told = summary.events.iter().filter(|event| event.entity == DRONE);
    Ok(ChaseFlight {
        air,
        rows: rows(&results),
        level_m_s,
        gondola_m_s: velocity_m_s.length(),
        gondola_through_air_m_s: (velocity_m_s - wind_m_s).length(),
        events: told
            .map(|event| (event.time_s, event.kind.clone()))
            .collect(),
        stopped: summary.stopped.map(|stop| stop.reason),
    })
}

fn rows(results: &MemorySink) -> Vec<ChaseRow> {
    let of_drone = |channel| results.channel(DRONE, channel);
    let [x, y, z] = ["from_target_x_m", "from_target_y_m", "from_target_z_m"].map(of_drone);
    let [required, airspeed, state] = [
        "required_airspeed_m_s",
        "air_relative_speed_m_s",
        "chase_state",
    ]
    .map(of_drone);
    let gondola_y = |time_s: f64| {
        let frame = results.frames.iter().find(|frame| frame.time_s == time_s)?;
        let row = frame.states.iter().find(|row| &*row.entity == GONDOLA)?;
        Some(row.position_m.y)
    };
    let numbers = x.iter().zip(&y).zip(&z).zip(&required).zip(&airspeed);
    numbers
        .zip(&state)
        .filter_map(|(((((x, y), z), required), airspeed), state)| {
            Some(ChaseRow {
                time_s: x.0,
                error_m: DVec3::new(x.1, y.1, z.1),
                gondola_y_m: gondola_y(x.0)?,
                required_m_s: required.1,
                airspeed_m_s: airspeed.1,
                state: state.1,
            })
        })
        .collect()
}

fn missing(what: &str) -> SceneError {
    SceneError::plain(format_args!("the chase case needs {what}"))
}

fn of<'a, C: Component>(simulation: &'a Simulation, name: &str) -> Result<&'a C, SceneError> {
    let world = simulation.world();
    let entity = world.resource::<SceneEntities>().get(name);
    entity
        .and_then(|entity| world.get::<C>(entity))
        .ok_or_else(|| missing(&format!("the entity `{name}`, and it in flight")))
}

fn wind_at(simulation: &Simulation, name: &str) -> Result<DVec3, SceneError> {
    if let Ok(air) = of::<Air>(simulation, name) {
        return Ok(air.velocity_m_s);
    }
    let altitude_m = of::<aerobot_components::state::Position>(simulation, name)?
        .0
        .z;
    let wind = &simulation.world().resource::<EnvironmentModel>().wind;
    wind.velocity_m_s(altitude_m).map_err(SceneError::plain)
}
