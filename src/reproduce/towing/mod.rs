//! The towing case (paper, sec. 5.1, figure 15): a continuous cable in equilibrium, the discrete line
//! in equilibrium, and the discrete line flown from straight down until it rests.

mod checks;
mod line;
mod report;

use std::path::Path;

use aerobot_components::tether::Tether;
use aerobot_engine::plugin::Simulator;
use aerobot_engine::recording::frame::NullSink;
use aerobot_engine::scene::{Scene, SceneError};

pub use line::{LinePoint, LineShape};

use super::{Case, Report, ReproduceError, Settings};

/// The scene of the case.
const SCENE: &str = include_str!("../../../scenes/paper/towing_9700m.ron");
/// What messages call it.
const SCENE_NAME: &str = "scenes/paper/towing_9700m.ron";
/// The names of its entities.
const TOWLINE: &str = "towline";
const PROBE: &str = "probe";

/// A towed probe: static against dynamic.
#[derive(Clone, Copy, Debug)]
pub struct Towing;

impl Case for Towing {
    fn name(&self) -> &'static str {
        "towing"
    }

    fn about(&self) -> &'static str {
        "a probe on 9.7 km of line in shear, continuous, discrete and flown (sec. 5.1, figure 15)"
    }

    fn run(
        &self,
        simulator: &Simulator,
        settings: &Settings,
        progress: &mut dyn FnMut(&str, f64),
    ) -> Result<Report, ReproduceError> {
        let mut own = TowingSettings::default();
        own.nodes = settings.nodes.unwrap_or(own.nodes);
        own.duration_s = settings.duration_s.unwrap_or(own.duration_s);
        let results = compare(simulator, &own, progress)?;
        Ok(report::report(&own, &results))
    }
}

/// What is compared.
#[derive(Clone, Debug, PartialEq)]
pub struct TowingSettings {
    /// Relative winds at the depth of the straight line, m/s; in proportion to depth above.
    pub winds_m_s: Vec<f64>,
    /// Nodes of the discrete line; two or more.
    pub nodes: u32,
    /// Simulated time of the flight from straight down, s.
    pub duration_s: f64,
}

impl Default for TowingSettings {
    fn default() -> Self {
        Self {
            winds_m_s: vec![1.0, 2.0, 5.0, 10.0, 20.0, 40.0],
            nodes: 100,
            duration_s: 20_000.0,
        }
    }
}

/// The line in one wind.
#[derive(Clone, Debug, PartialEq)]
pub struct WindResult {
    /// The relative wind at the depth of the straight line, m/s.
    pub wind_m_s: f64,
    /// The continuous cable in equilibrium.
    pub continuous: LineShape,
    /// The discrete line in equilibrium.
    pub discrete: LineShape,
    /// The discrete line at the end of its flight.
    pub dynamic: LineShape,
    /// When that was, s.
    pub flown_s: f64,
    /// Why the flight stopped before its end, if it did.
    pub stopped: Option<String>,
    /// Nodes of a line with half as many, to tell the order of convergence.
    pub half_nodes: u32,
    /// Largest distance between that line and the continuous cable, m.
    pub half_nodes_error_m: f64,
}

impl WindResult {
    /// Largest distance between discrete line and continuous cable, m.
    #[must_use]
    pub fn error_m(&self) -> f64 {
        self.discrete.largest_distance_m(&self.continuous)
    }

    /// Order of convergence between half the nodes and all: the power of the segment length in which
    /// the error falls.
    #[must_use]
    pub fn order(&self) -> f64 {
        let segments = |nodes: usize| (nodes + 1) as f64;
        let nodes = self.discrete.segment_tensions_n.len() - 1;
        libm::log(self.half_nodes_error_m / self.error_m())
            / libm::log(segments(nodes) / segments(self.half_nodes as usize))
    }

    /// Largest distance between the end of the flight and the discrete equilibrium, m.
    #[must_use]
    pub fn unsettled_m(&self) -> f64 {
        self.dynamic.largest_distance_m(&self.discrete)
    }
}

/// Computes all three for every wind: first what rests, which is quick, then the flights.
///
/// # Errors
/// Too few nodes, or a scene that cannot be built or finds no rest.
pub fn compare(
    simulator: &Simulator,
    settings: &TowingSettings,
    progress: &mut dyn FnMut(&str, f64),
) -> Result<Vec<WindResult>, ReproduceError> {
    if settings.nodes < 2 {
        return Err(ReproduceError::Setting(format!(
            "the towing case needs 2 nodes or more to tell an order of convergence, not {}",
            settings.nodes
        )));
    }
    let mut results = Vec::new();
    for wind_m_s in &settings.winds_m_s {
        progress(&format!("{wind_m_s} m/s at rest"), 0.0);
        results.push(at_rest(simulator, settings, *wind_m_s)?);
    }
    let count = results.len() as f64;
    for (index, result) in results.iter_mut().enumerate() {
        let what = format!("{} m/s in flight", result.wind_m_s);
        let mut part = |time_s: f64| {
            progress(&what, (index as f64 + time_s / settings.duration_s) / count);
        };
        fly(simulator, settings, result, &mut part)?;
    }
    Ok(results)
}

/// The scene with a wind and a number of nodes.
fn scene(
    simulator: &Simulator,
    settings: &TowingSettings,
    wind_m_s: f64,
    nodes: u32,
) -> Result<Scene, SceneError> {
    let load = |overrides: &[String]| {
        simulator.load_text(SCENE_NAME, SCENE.to_owned(), Path::new("."), overrides)
    };
    let gradient_per_s = -wind_m_s / towline(&load(&[])?)?.length_m;
    load(&[
        format!("environment.wind.0.gradient_per_s={gradient_per_s:?}"),
        format!("entities.{TOWLINE}.Tether.nodes={nodes}"),
        format!("run.duration_s={:?}", settings.duration_s),
    ])
}

/// The towline of the scene.
fn towline(scene: &Scene) -> Result<&Tether, SceneError> {
    scene
        .entity(TOWLINE)
        .and_then(|entity| entity.get())
        .ok_or_else(|| line::missing("a `Tether`", TOWLINE))
}

/// Continuous and discrete line in equilibrium; the flight is left where it starts.
fn at_rest(
    simulator: &Simulator,
    settings: &TowingSettings,
    wind_m_s: f64,
) -> Result<WindResult, ReproduceError> {
    let half_nodes = settings.nodes / 2;
    let (continuous, discrete) = equilibria(simulator, settings, wind_m_s, settings.nodes)?;
    let (exact, coarse) = equilibria(simulator, settings, wind_m_s, half_nodes)?;
    Ok(WindResult {
        wind_m_s,
        dynamic: discrete.clone(),
        continuous,
        discrete,
        flown_s: 0.0,
        stopped: None,
        half_nodes,
        half_nodes_error_m: coarse.largest_distance_m(&exact),
    })
}

/// The continuous cable at the places of `nodes` nodes, and the discrete line of them, at rest.
fn equilibria(
    simulator: &Simulator,
    settings: &TowingSettings,
    wind_m_s: f64,
    nodes: u32,
) -> Result<(LineShape, LineShape), ReproduceError> {
    let scene = scene(simulator, settings, wind_m_s, nodes)?;
    let mut simulation = simulator.build(&scene)?;
    let continuous = line::continuous(&scene, &simulation, towline(&scene)?)?;
    simulation.settle_in_wind(&scene)?;
    let discrete = line::discrete(&simulation, towline(&scene)?)?;
    Ok((continuous, discrete))
}

/// Flies the discrete line from straight down to the end.
fn fly(
    simulator: &Simulator,
    settings: &TowingSettings,
    result: &mut WindResult,
    progress: &mut dyn FnMut(f64),
) -> Result<(), ReproduceError> {
    let scene = scene(simulator, settings, result.wind_m_s, settings.nodes)?;
    let mut simulation = simulator.build(&scene)?;
    let summary = simulation.run(&mut NullSink, progress);
    result.dynamic = line::discrete(&simulation, towline(&scene)?)?;
    result.flown_s = summary.simulated_s;
    result.stopped = summary.stopped.map(|stop| stop.reason);
    Ok(())
}
