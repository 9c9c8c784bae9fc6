//! Docking of a drone with the gondola, which the paper promises (contribution 4) and leaves out (sec. 5.4): a
//! rotorcraft in one wind field with the gondola, some seeds of gusts and of errors of navigation.

mod figures;
mod impact;
mod report;

use aerobot_components::body::Body;
use aerobot_components::docking::{DockingPhase, DockingPort, Latch};
use aerobot_components::rotorcraft::Rotorcraft;
use aerobot_components::state::Position;
use aerobot_engine::plugin::Simulator;
use aerobot_engine::recording::frame::{Frame, StateRow};
use aerobot_engine::scene::{Scene, SceneError};
use aerobot_engine::world::SceneEntities;
use aerobot_systems::environment::EnvironmentModel;
use glam::DVec3;

pub use impact::Impact;

use super::flight::{Flight, PaperScene};
use super::{Case, Report, ReproduceError, Settings};

/// The scene of the case.
const SCENE: PaperScene = PaperScene {
    name: "scenes/mav_dock.ron",
    text: include_str!("../../../scenes/mav_dock.ron"),
};
/// The names of its entities.
pub(super) const DRONE: &str = "drone";
pub(super) const GONDOLA: &str = "gondola";

/// A drone docks.
#[derive(Clone, Copy, Debug)]
pub struct DockingCase;

impl Case for DockingCase {
    fn name(&self) -> &'static str {
        "docking"
    }

    fn about(&self) -> &'static str {
        "a rotorcraft docks with the gondola (contribution 4 of the paper, without a figure)"
    }

    fn run(
        &self,
        simulator: &Simulator,
        settings: &Settings,
        progress: &mut dyn FnMut(&str, f64),
    ) -> Result<Report, ReproduceError> {
        let mut own = DockingSettings::default();
        own.nodes = settings.nodes.or(own.nodes);
        own.duration_s = settings.duration_s.unwrap_or(own.duration_s);
        let found = study(simulator, &own, progress)?;
        Ok(report::report(&found).with_figures(figures::figures(&found)))
    }
}

/// What is flown.
#[derive(Clone, Debug, PartialEq)]
pub struct DockingSettings {
    /// Seeds of gusts and of errors of navigation.
    pub seeds: Vec<u64>,
    /// Nodes of the tether, if not those of the scene.
    pub nodes: Option<u32>,
    /// Simulated time, s.
    pub duration_s: f64,
    /// Time between outputs, s: as far as momentum at the impact is told by a straight line.
    pub output_every_s: f64,
}

impl Default for DockingSettings {
    fn default() -> Self {
        Self {
            seeds: vec![1, 2, 3, 4],
            nodes: None,
            duration_s: 120.0,
            output_every_s: 0.02,
        }
    }
}

/// All of the case.
#[derive(Clone, Debug)]
pub struct DockingStudy {
    /// Drone, gondola and latch.
    pub craft: Craft,
    /// The approaches, in the order of the seeds.
    pub approaches: Vec<Approach>,
}

/// What docks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Craft {
    /// Mass of the drone, kg.
    pub drone_kg: f64,
    /// Mass of the gondola, kg.
    pub gondola_kg: f64,
    /// Place of the drone's port from its centre of mass, body frame, m.
    pub drone_port_m: DVec3,
    /// Place of the gondola's port from its centre of mass, body frame, m.
    pub gondola_port_m: DVec3,
    /// Area of all discs of the rotors, m^2.
    pub disc_area_m2: f64,
    /// Part of the shaft power that momentum theory would ask for.
    pub figure_of_merit: f64,
    /// Largest speed at which the latch closes, m/s.
    pub latch_m_s: f64,
    /// Density of the air where the gondola is at the start, kg/m^3.
    pub density_kg_m3: f64,
    /// Acceleration of gravity, m/s^2.
    pub gravity_m_s2: f64,
}

impl Craft {
    /// Shaft power in W that a thrust (N) takes at an airspeed across the discs (m/s), by momentum theory (Glauert 1926):
    /// the induced velocity w has w^2 (V^2 + w^2) = (T/(2 rho A))^2, hence P = T w/FM.
    #[must_use]
    pub fn level_power_w(&self, thrust_n: f64, airspeed_m_s: f64) -> f64 {
        let hover_m2_s2 = thrust_n / (2.0 * self.density_kg_m3 * self.disc_area_m2);
        let half = 0.5 * airspeed_m_s * airspeed_m_s;
        let induced_m_s = ((half * half + hover_m2_s2 * hover_m2_s2).sqrt() - half).sqrt();
        thrust_n * induced_m_s / self.figure_of_merit
    }

    /// Shaft power in hover, W.
    #[must_use]
    pub fn hover_power_w(&self) -> f64 {
        self.level_power_w(self.drone_kg * self.gravity_m_s2, 0.0)
    }
}

/// One approach.
#[derive(Clone, Debug)]
pub struct Approach {
    /// The seed.
    pub seed: u64,
    /// The flight.
    pub flight: Flight,
    /// The drone at every output.
    pub rows: Vec<ApproachRow>,
    /// Phases of the drone and when they began, s.
    pub phases: Vec<(f64, String)>,
    /// The moment when the latch closed, if it did.
    pub impact: Option<Impact>,
}

/// The drone at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ApproachRow {
    /// Time, s.
    pub time_s: f64,
    /// The drone's port from that of the gondola, in the gondola's body frame, m.
    pub path_m: DVec3,
    /// Distance of the ports, m.
    pub distance_m: f64,
    /// Distance of the drone's port from the axis of the other, m.
    pub lateral_error_m: f64,
    /// The channel `docking_phase`.
    pub phase: f64,
    /// Airspeed of the drone, m/s.
    pub airspeed_m_s: f64,
    /// Thrust of its rotors, N.
    pub thrust_n: f64,
    /// Shaft power, W.
    pub power_w: f64,
}

impl Approach {
    /// When the latch closed, s.
    #[must_use]
    pub fn docked_s(&self) -> Option<f64> {
        let docked = DockingPhase::Docked.name();
        let mut own = self.phases.iter().filter(|(_, kind)| kind == docked);
        own.next().map(|(time_s, _)| *time_s)
    }

    /// Means over the way along the port's axis: thrust (N), airspeed (m/s) and shaft power (W).
    #[must_use]
    pub fn closing_means(&self) -> Option<[f64; 3]> {
        let closing = DockingPhase::Contact as u8;
        let rows: Vec<&ApproachRow> = self
            .rows
            .iter()
            .filter(|row| row.phase == f64::from(closing))
            .collect();
        let mean = |of: fn(&ApproachRow) -> f64| {
            rows.iter().map(|row| of(row)).sum::<f64>() / rows.len() as f64
        };
        (!rows.is_empty()).then(|| {
            [
                mean(|r| r.thrust_n),
                mean(|r| r.airspeed_m_s),
                mean(|r| r.power_w),
            ]
        })
    }
}

/// Flies an approach for each seed.
///
/// # Errors
/// A scene that cannot be built.
pub fn study(
    simulator: &Simulator,
    settings: &DockingSettings,
    progress: &mut dyn FnMut(&str, f64),
) -> Result<DockingStudy, SceneError> {
    let craft = craft(simulator, &scene(simulator, settings, 1)?)?;
    let mut approaches = Vec::new();
    let count = settings.seeds.len() as f64;
    for (index, seed) in settings.seeds.iter().enumerate() {
        let scene = scene(simulator, settings, *seed)?;
        let mut part = |part: f64| progress(&format!("seed {seed}"), (index as f64 + part) / count);
        let flight = Flight::of(simulator, &scene, &mut part)?;
        let events = flight
            .events
            .iter()
            .filter(|(_, entity, _)| entity == DRONE);
        let mut approach = Approach {
            seed: *seed,
            rows: rows(&flight, &craft),
            phases: events
                .map(|(time_s, _, kind)| (*time_s, kind.clone()))
                .collect(),
            impact: None,
            flight,
        };
        let docked_s = approach.docked_s();
        approach.impact = docked_s.and_then(|at_s| Impact::of(&approach.flight, &craft, at_s));
        approaches.push(approach);
    }
    Ok(DockingStudy { craft, approaches })
}

fn scene(
    simulator: &Simulator,
    settings: &DockingSettings,
    seed: u64,
) -> Result<Scene, SceneError> {
    let mut overrides = vec![
        format!("run.seed={seed}"),
        format!("run.duration_s={:?}", settings.duration_s),
        format!("run.output_every_s={:?}", settings.output_every_s),
    ];
    if let Some(nodes) = settings.nodes {
        // Nodes of another number have no places of their own.
        overrides.push(format!("entities.tether.Tether.nodes={nodes}"));
        overrides.push("entities.tether.Tether.start=Equilibrium".to_owned());
    }
    SCENE.load(simulator, &overrides)
}

fn craft(simulator: &Simulator, scene: &Scene) -> Result<Craft, SceneError> {
    let missing = |what: &str| SceneError::plain(format_args!("the docking case needs {what}"));
    let (drone, gondola) = match (scene.entity(DRONE), scene.entity(GONDOLA)) {
        (Some(drone), Some(gondola)) => (drone, gondola),
        _ => return Err(missing("a drone and a gondola")),
    };
    let bodies = [drone, gondola].map(|entity| entity.get::<Body>());
    let ports = [drone, gondola].map(|entity| entity.get::<DockingPort>());
    let ([Some(drone_body), Some(gondola_body)], [Some(drone_port), Some(gondola_port)]) =
        (bodies, ports)
    else {
        return Err(missing("bodies with ports"));
    };
    let (Some(rotorcraft), Some(latch)) = (drone.get::<Rotorcraft>(), drone.get::<Latch>()) else {
        return Err(missing("a `Rotorcraft` with a `Latch`"));
    };
    let simulation = simulator.build(scene)?;
    let world = simulation.world();
    let entity = world.resource::<SceneEntities>().get(GONDOLA);
    let position = entity.and_then(|entity| world.get::<Position>(entity));
    let altitude_m = position.ok_or_else(|| missing("a gondola in flight"))?.0.z;
    let air = &world.resource::<EnvironmentModel>().atmosphere;
    let density_kg_m3 = air.density_kg_m3(altitude_m).map_err(SceneError::plain)?;
    let radius_m = 0.5 * rotorcraft.rotor_diameter_m;
    Ok(Craft {
        drone_kg: drone_body.mass_kg,
        gondola_kg: gondola_body.mass_kg,
        drone_port_m: drone_port.at_m,
        gondola_port_m: gondola_port.at_m,
        disc_area_m2: f64::from(rotorcraft.rotors) * std::f64::consts::PI * radius_m * radius_m,
        figure_of_merit: rotorcraft.figure_of_merit,
        latch_m_s: latch.speed_m_s,
        density_kg_m3,
        gravity_m_s2: scene.environment.gravity.acceleration_m_s2(0.0),
    })
}

/// The row of a body in a frame.
fn state<'a>(frame: &'a Frame, entity: &str) -> Option<&'a StateRow> {
    frame.states.iter().find(|row| &*row.entity == entity)
}

fn rows(flight: &Flight, craft: &Craft) -> Vec<ApproachRow> {
    let row = |frame: &Frame| {
        let (drone, gondola) = (state(frame, DRONE)?, state(frame, GONDOLA)?);
        let place = |row: &StateRow, port_m: DVec3| Some(row.position_m + row.rotation?.0 * port_m);
        let apart = place(drone, craft.drone_port_m)? - place(gondola, craft.gondola_port_m)?;
        let channel = |name: &str| {
            let mut own = frame.channels.iter().filter(|row| &*row.entity == DRONE);
            Some(own.find(|row| row.channel == name)?.value)
        };
        Some(ApproachRow {
            time_s: frame.time_s,
            path_m: gondola.rotation?.0.inverse() * apart,
            distance_m: channel("distance_m")?,
            lateral_error_m: channel("lateral_error_m")?,
            phase: channel("docking_phase")?,
            airspeed_m_s: channel("airspeed_m_s")?,
            thrust_n: channel("thrust_n")?,
            power_w: channel("power_w")?,
        })
    };
    flight.results.frames.iter().filter_map(row).collect()
}
