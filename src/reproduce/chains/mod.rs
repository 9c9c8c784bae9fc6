//! Several tethers between balloon and gondola, and instruments below the gondola (paper, sec. 4.3.1, figures 9 and
//! 10): both scenes in both formulations, and how the formulations meet as tethers get stiffer.

mod checks;
mod figures;
mod report;

use aerobot_components::run::Formulation;
use aerobot_components::tether::Tether;
use aerobot_engine::modes::{Mode, ModesRequest};
use aerobot_engine::plugin::Simulator;
use aerobot_engine::scene::{Scene, SceneError};

use super::check::largest;
use super::flight::{Flight, PaperScene, formulation_override, largest_difference_m};
use super::pendulums::{self, HungPair};
use super::{Case, Report, ReproduceError, Settings};

/// The names of entities of both scenes.
pub(super) const BALLOON: &str = "balloon";
pub(super) const GONDOLA: &str = "gondola";
/// An instrument of the second, on a single line.
pub(super) const MAGNETOMETER: &str = "magnetometer";
/// When the first gust begins, and when the first begins that is not along x, s.
pub(super) const GUSTS_S: (f64, f64) = (10.0, 18.0);

/// Chains with several tethers.
#[derive(Clone, Copy, Debug)]
pub struct Chains;

impl Case for Chains {
    fn name(&self) -> &'static str {
        "chains"
    }

    fn about(&self) -> &'static str {
        "several tethers, instruments below the gondola (sec. 4.3.1, figures 9, 10)"
    }

    fn run(
        &self,
        simulator: &Simulator,
        settings: &Settings,
        progress: &mut dyn FnMut(&str, f64),
    ) -> Result<Report, ReproduceError> {
        let results = study(simulator, settings, progress)?;
        Ok(report::report(&results).with_figures(figures::figures(&results)))
    }
}

/// An architecture of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Architecture {
    /// Figure 9: a gondola on three tethers.
    MultiTether,
    /// Figure 10: the same with instruments below it on a single and a double line.
    FlightChain,
}

impl Architecture {
    /// Both.
    pub const ALL: [Self; 2] = [Self::MultiTether, Self::FlightChain];

    /// The name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::MultiTether => "multi-tether",
            Self::FlightChain => "flight-chain",
        }
    }

    /// Its bodies, from above.
    #[must_use]
    pub fn bodies(self) -> &'static [&'static str] {
        match self {
            Self::MultiTether => &[BALLOON, GONDOLA],
            Self::FlightChain => &[BALLOON, GONDOLA, "camera", MAGNETOMETER],
        }
    }

    fn scene(self) -> PaperScene {
        match self {
            Self::MultiTether => PaperScene {
                name: "scenes/paper/multi_tether.ron",
                text: include_str!("../../../scenes/paper/multi_tether.ron"),
            },
            Self::FlightChain => PaperScene {
                name: "scenes/paper/flight_chain.ron",
                text: include_str!("../../../scenes/paper/flight_chain.ron"),
            },
        }
    }

    /// Its tethers: the path of the component, EA in N and c in N s/m.
    fn lines(self) -> &'static [(&'static str, f64, f64)] {
        match self {
            Self::MultiTether => &[("suspension.Tethers", 2e5, 10.0)],
            Self::FlightChain => &[
                ("suspension.Tethers", 2e5, 10.0),
                ("single-line.Tether", 1e5, 10.0),
                ("double-line.Tethers", 1e5, 10.0),
            ],
        }
    }
}

/// Factors of EA for which the formulations are compared.
pub const STIFFNESS_FACTORS: [f64; 3] = [1.0, 10.0, 100.0];
/// For so long, s: until the last gust blows.
const LIMIT_S: f64 = 55.0;

/// One architecture.
#[derive(Clone, Debug)]
pub struct ChainResult {
    /// Which.
    pub architecture: Architecture,
    /// The scene in lumped masses.
    pub lumped: Flight,
    /// The scene in rigid links.
    pub links: Flight,
    /// Balloon and gondola alone, as they hang.
    pub pair: HungPair,
    /// Frequency of the magnetometer as a point on its line, in closed form, Hz; none where there is no magnetometer.
    pub magnetometer_hz: Option<f64>,
    /// What its tethers carry at rest.
    pub loads: Vec<Load>,
    /// Modes of small motions about its rest, slowest first.
    pub modes: Vec<Mode>,
    /// EA over that of the scene, and the largest difference between lumped masses and the links that they become, m.
    pub limit: Vec<(f64, f64)>,
}

impl ChainResult {
    /// Both flights.
    #[must_use]
    pub fn flights(&self) -> [&Flight; 2] {
        [&self.lumped, &self.links]
    }
}

/// What one of some equal tethers carries at rest if they share it.
#[derive(Clone, Debug, PartialEq)]
pub struct Load {
    /// Names of the tethers.
    pub tethers: Vec<String>,
    /// Force on the attachment above, N: that below and the weight of the tether.
    pub above_n: f64,
    /// Force on the attachment below, N: the weight of all that hangs there, by the number of tethers.
    pub below_n: f64,
}

/// Flies both architectures.
///
/// # Errors
/// A scene that cannot be built.
pub fn study(
    simulator: &Simulator,
    settings: &Settings,
    progress: &mut dyn FnMut(&str, f64),
) -> Result<Vec<ChainResult>, SceneError> {
    let mut results = Vec::new();
    for (index, architecture) in Architecture::ALL.into_iter().enumerate() {
        let mut part = |what: &str, part: f64| {
            let what = format!("{}, {what}", architecture.name());
            progress(
                &what,
                (index as f64 + part) / Architecture::ALL.len() as f64,
            );
        };
        results.push(one(simulator, settings, architecture, &mut part)?);
    }
    Ok(results)
}

fn one(
    simulator: &Simulator,
    settings: &Settings,
    architecture: Architecture,
    progress: &mut dyn FnMut(&str, f64),
) -> Result<ChainResult, SceneError> {
    let count = (3 + STIFFNESS_FACTORS.len()) as f64;
    let mut done = 0.0;
    let mut fly = |what: &str, more: &[String]| {
        let scene = scene(simulator, settings, architecture, more)?;
        let mut part = |part: f64| progress(what, (done + part) / count);
        let flight = Flight::of(simulator, &scene, &mut part)?;
        done += 1.0;
        Ok::<_, SceneError>(flight)
    };
    let lumped = fly(
        "lumped masses",
        &[formulation_override(Formulation::LumpedMass)],
    )?;
    let links = fly("rigid links", &[formulation_override(Formulation::Denoc)])?;
    let until_s = settings.duration_s.unwrap_or(LIMIT_S).min(LIMIT_S);
    let until = format!("run.duration_s={until_s:?}");
    let mut rigid = stiffer(architecture, 1.0);
    rigid.extend([
        until.clone(),
        formulation_override(Formulation::Denoc),
        "run.links=PointMass".to_owned(),
        "run.integrator=Adaptive(relative_tolerance: 1e-8)".to_owned(),
    ]);
    let rigid = fly("links with their masses at the joints", &rigid)?;
    let mut limit = Vec::new();
    for factor in STIFFNESS_FACTORS {
        let accuracy_m = if factor > 10.0 { 1e-7 } else { 1e-6 };
        let mut more = stiffer(architecture, factor);
        more.extend([
            until.clone(),
            formulation_override(Formulation::LumpedMass),
            format!("run.integrator=Implicit(accuracy_m: {accuracy_m:e})"),
        ]);
        let flight = match fly(&format!("EA x {factor}"), &more) {
            Ok(flight) => flight,
            // A stiffer chain of a number of nodes that the scene has not been tried with may find no rest to start from.
            Err(_) if settings.nodes.is_some() => break,
            Err(error) => return Err(error),
        };
        let bodies = architecture.bodies().iter();
        let apart = bodies.map(|body| largest_difference_m(&flight, &rigid, body));
        limit.push((factor, largest(apart)));
    }
    let plain = scene(simulator, settings, architecture, &[])?;
    let mut simulation = simulator.build(&plain)?;
    Ok(ChainResult {
        architecture,
        lumped,
        links,
        pair: HungPair::of(&plain, &simulation, BALLOON, GONDOLA)?,
        magnetometer_hz: pendulums::hung_point_hz(&plain, &simulation, GONDOLA, MAGNETOMETER),
        loads: checks::loads(&plain, architecture),
        modes: simulation.modes(&plain, &ModesRequest::default())?.modes,
        limit,
    })
}

fn scene(
    simulator: &Simulator,
    settings: &Settings,
    architecture: Architecture,
    more: &[String],
) -> Result<Scene, SceneError> {
    let mut overrides = Vec::new();
    if let Some(nodes) = settings.nodes {
        let lines = architecture.lines().iter();
        overrides.extend(lines.map(|(line, ..)| format!("entities.{line}.nodes={nodes}")));
    }
    if let Some(duration_s) = settings.duration_s {
        overrides.push(format!("run.duration_s={duration_s:?}"));
    }
    // What comes later counts.
    for own in more {
        let field = own.split('=').next().unwrap_or_default();
        overrides.retain(|other| other.split('=').next() != Some(field));
        overrides.push(own.clone());
    }
    architecture.scene().load(simulator, &overrides)
}

/// Tethers with their masses on the nodes and EA times `factor`, with the damping that leaves the damping ratios of
/// their vibrations nearly what they were.
fn stiffer(architecture: Architecture, factor: f64) -> Vec<String> {
    let of = |(line, stiffness_n, damping_n_s_m): &(&str, f64, f64)| {
        [
            format!("entities.{line}.lumping=Interior"),
            format!(
                "entities.{line}.axial_stiffness_n={:e}",
                stiffness_n * factor
            ),
            format!(
                "entities.{line}.damping_n_s_m={:e}",
                damping_n_s_m * factor.sqrt()
            ),
        ]
    };
    architecture.lines().iter().flat_map(of).collect()
}

/// The tethers of a scene whose upper end is at `from` and whose lower end is at `to`.
fn tethers<'a>(
    scene: &'a Scene,
    from: &'a str,
    to: &'a str,
) -> impl Iterator<Item = (&'a str, &'a Tether)> {
    scene
        .with::<Tether>()
        .filter(move |(_, tether)| tether.from.0 == from && tether.to.0 == to)
        .map(|(entity, tether)| (entity.name.as_str(), tether))
}
