//! The tether length study of the paper (sec. 4.4.1, figures 13 and 14, table 1): the yaw of a body on a ring
//! of tethers, elastic and inextensible, beside the multifilar pendulum and beside what a transform of 15 s
//! can tell.

mod checks;
mod frequency;
mod inertia;
mod pendulum;
mod report;

use std::path::Path;

use aerobot_components::body::{Body, Motion};
use aerobot_components::run::Formulation;
use aerobot_components::tether::{AttachmentPoint, Tether};
use aerobot_engine::plugin::Simulator;
use aerobot_engine::recording::frame::MemorySink;
use aerobot_engine::scene::{Scene, SceneError};

pub use frequency::{CrossingFrequency, by_crossings, largest_bin};
pub use pendulum::MultifilarPendulum;

use super::{Case, Report, ReproduceError, Settings};

/// The scene of the case.
const SCENE: &str = include_str!("../../../scenes/paper/multi_tether_yaw.ron");
/// What messages call it.
const SCENE_NAME: &str = "scenes/paper/multi_tether_yaw.ron";
/// The names of its entities.
const BODY: &str = "body";
const RING: &str = "suspension";
/// Its channel.
const HEADING: &str = "heading_rad";

/// Length of the paper's records, which its frequencies show: they are multiples of 1/15 Hz.
pub const PAPER_RECORD_S: f64 = 15.0;

/// Yaw of a body on a ring of tethers.
#[derive(Clone, Copy, Debug)]
pub struct Yaw;

impl Case for Yaw {
    fn name(&self) -> &'static str {
        "yaw"
    }

    fn about(&self) -> &'static str {
        "the yaw of a body on three tethers of 10, 20 and 50 m (sec. 4.4.1, figures 13, 14, table 1)"
    }

    fn run(
        &self,
        simulator: &Simulator,
        settings: &Settings,
        progress: &mut dyn FnMut(&str, f64),
    ) -> Result<Report, ReproduceError> {
        let mut own = YawSettings::default();
        own.nodes = settings.nodes.or(own.nodes);
        own.duration_s = settings.duration_s.or(own.duration_s);
        let results = study(simulator, &own, progress)?;
        Ok(report::report(&results))
    }
}

/// What is studied.
#[derive(Clone, Debug, PartialEq)]
pub struct YawSettings {
    /// Lengths of the tethers, m, each with the frequency that table 1 of the paper has for it, Hz.
    pub lengths: Vec<(f64, f64)>,
    /// Nodes of each tether, if not those of the scene.
    pub nodes: Option<u32>,
    /// Simulated time, s, if not that of the scene.
    pub duration_s: Option<f64>,
}

impl Default for YawSettings {
    fn default() -> Self {
        Self {
            lengths: vec![(10.0, 0.133), (20.0, 0.066), (50.0, 0.066)],
            nodes: None,
            duration_s: None,
        }
    }
}

/// The yaw with one length of tethers.
#[derive(Clone, Debug, PartialEq)]
pub struct LengthResult {
    /// The same body on inextensible massless tethers.
    pub pendulum: MultifilarPendulum,
    /// What the paper's table has, Hz.
    pub paper_hz: f64,
    /// Number of tethers.
    pub tethers: usize,
    /// Nodes of each.
    pub nodes: u32,
    /// Time that a transverse wave takes from end to end of a tether, s.
    pub wave_s: f64,
    /// Lumped masses on elastic tethers.
    pub lumped: YawFlight,
    /// Rigid links.
    pub links: YawFlight,
}

/// One run.
#[derive(Clone, Debug, PartialEq)]
pub struct YawFlight {
    /// The formulation.
    pub formulation: Formulation,
    /// The integrator with its settings.
    pub integrator: String,
    /// Time in s and heading in rad at every output.
    pub headings: Vec<(f64, f64)>,
    /// Why it stopped before its end, if it did.
    pub stopped: Option<String>,
}

impl YawFlight {
    /// Frequency by zero crossings; nothing if the run has no whole period.
    #[must_use]
    pub fn frequency(&self) -> Option<CrossingFrequency> {
        by_crossings(&self.headings)
    }

    /// Largest heading to either side, rad.
    #[must_use]
    pub fn amplitude_rad(&self) -> f64 {
        let headings = self.headings.iter();
        headings.fold(0.0, |most, (_, heading)| most.max(heading.abs()))
    }

    /// The largest bin of the transform of the first 15 s; nothing if the run is shorter.
    #[must_use]
    pub fn paper_bin(&self) -> Option<usize> {
        let (last_s, _) = self.headings.last()?;
        if *last_s < PAPER_RECORD_S {
            return None;
        }
        // A record of T seconds ends one interval before T.
        let values: Vec<f64> = self
            .headings
            .iter()
            .take_while(|(time_s, _)| *time_s < PAPER_RECORD_S - 1e-9)
            .map(|(_, heading)| *heading)
            .collect();
        largest_bin(&values)
    }
}

/// Flies every length in both formulations.
///
/// # Errors
/// A scene that cannot be built.
pub fn study(
    simulator: &Simulator,
    settings: &YawSettings,
    progress: &mut dyn FnMut(&str, f64),
) -> Result<Vec<LengthResult>, ReproduceError> {
    let count = settings.lengths.len() as f64;
    let mut results = Vec::new();
    for (index, (length_m, paper_hz)) in settings.lengths.iter().enumerate() {
        let mut fly = |formulation: Formulation, before: f64| {
            let scene = scene(simulator, settings, *length_m, formulation)?;
            let what = format!("{length_m} m, {}", formulation.name());
            let mut part = |part: f64| {
                progress(&what, (index as f64 + 0.5 * (before + part)) / count);
            };
            Ok::<_, SceneError>((fly(simulator, &scene, formulation, &mut part)?, scene))
        };
        let (lumped, scene) = fly(Formulation::LumpedMass, 0.0)?;
        let (links, _) = fly(Formulation::Denoc, 1.0)?;
        let pendulum = pendulum(&scene)?;
        let tether = first_tether(&scene)?;
        let tethers = scene.with::<Tether>().count();
        let tension_n = pendulum.mass_kg * pendulum.gravity_m_s2 / tethers as f64;
        let mass_per_length_kg_m = tether.mass_kg() / tether.length_m;
        results.push(LengthResult {
            paper_hz: *paper_hz,
            tethers,
            nodes: tether.nodes,
            wave_s: tether.length_m * (mass_per_length_kg_m / tension_n).sqrt(),
            pendulum,
            lumped,
            links,
        });
    }
    Ok(results)
}

fn scene(
    simulator: &Simulator,
    settings: &YawSettings,
    length_m: f64,
    formulation: Formulation,
) -> Result<Scene, SceneError> {
    let formulation = match formulation {
        Formulation::LumpedMass => "LumpedMass",
        Formulation::Denoc => "Denoc",
    };
    let mut overrides = vec![
        format!("entities.{RING}.Tethers.length_m={length_m:?}"),
        format!("run.formulation={formulation}"),
    ];
    if let Some(nodes) = settings.nodes {
        overrides.push(format!("entities.{RING}.Tethers.nodes={nodes}"));
    }
    if let Some(duration_s) = settings.duration_s {
        overrides.push(format!("run.duration_s={duration_s:?}"));
    }
    simulator.load_text(SCENE_NAME, SCENE.to_owned(), Path::new("."), &overrides)
}

fn fly(
    simulator: &Simulator,
    scene: &Scene,
    formulation: Formulation,
    progress: &mut dyn FnMut(f64),
) -> Result<YawFlight, SceneError> {
    let mut simulation = simulator.build(scene)?;
    let mut results = MemorySink::default();
    let duration_s = scene.run.duration_s;
    let summary = simulation.run(&mut results, &mut |time_s| progress(time_s / duration_s));
    Ok(YawFlight {
        formulation,
        integrator: summary.integrator,
        headings: results.channel(BODY, HEADING),
        stopped: summary.stopped.map(|stop| stop.reason),
    })
}

/// What is said if the scene lacks what the case is about.
fn missing(what: &str) -> SceneError {
    SceneError::plain(format_args!("the yaw case needs {what}"))
}

fn first_tether(scene: &Scene) -> Result<&Tether, SceneError> {
    let first = scene.with::<Tether>().next();
    first
        .map(|(_, tether)| tether)
        .ok_or_else(|| missing("tethers"))
}

/// The multifilar pendulum of the scene.
fn pendulum(scene: &Scene) -> Result<MultifilarPendulum, SceneError> {
    let entity = scene
        .entity(BODY)
        .ok_or_else(|| missing("the entity `body`"))?;
    let body: &Body = entity.get().ok_or_else(|| missing("a `Body` of `body`"))?;
    let tensor = body.inertia.tensor(body.mass_kg, 0.0);
    let tether = first_tether(scene)?;
    let radius_m = |point: AttachmentPoint| match point {
        AttachmentPoint::Named(_) => 0.0,
        AttachmentPoint::Offset(x, y, _) => libm::hypot(x, y),
        AttachmentPoint::Displaced(_, offset_m) => offset_m.truncate().length(),
    };
    Ok(MultifilarPendulum {
        mass_kg: body.mass_kg,
        moment_kg_m2: tensor.map_or(0.0, |tensor| tensor.z_axis.z),
        upper_radius_m: radius_m(tether.from.1),
        lower_radius_m: radius_m(tether.to.1),
        length_m: tether.length_m,
        gravity_m_s2: scene.environment.gravity.acceleration_m_s2(0.0),
        rate_rad_s: entity
            .get::<Motion>()
            .map_or(0.0, |motion| motion.rate_rad_s.z),
    })
}
