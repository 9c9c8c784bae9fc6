//! The comparison of the two formulations (paper, sec. 4.2, figures 5 and 6): one flight in lumped masses and in
//! rigid links, the difference as the tether gets stiffer, and both against separate programs.

mod reference;
mod report;

use aerobot_components::body::Body;
use aerobot_components::run::Formulation;
use aerobot_components::tether::Tether;
use aerobot_engine::plugin::Simulator;
use aerobot_engine::scene::{Scene, SceneError};

pub use reference::{AT_100_S, Reference};

use super::flight::{Flight, PaperScene, formulation_override, largest_difference_m};
use super::{Case, Report, ReproduceError, Settings};

/// The scene of the case.
const SCENE: PaperScene = PaperScene {
    name: "scenes/paper/comparison_900m.ron",
    text: include_str!("../../../scenes/paper/comparison_900m.ron"),
};
/// The names of its entities.
pub(super) const BALLOON: &str = "balloon";
pub(super) const GONDOLA: &str = "gondola";
pub(super) const TETHER: &str = "tether";
/// When its first gust begins, s.
pub(super) const FIRST_GUST_S: f64 = 10.0;

/// Two formulations of one flight.
#[derive(Clone, Copy, Debug)]
pub struct FormulationComparison;

impl Case for FormulationComparison {
    fn name(&self) -> &'static str {
        "comparison"
    }

    fn about(&self) -> &'static str {
        "balloon and gondola on 900 m in three gusts, both formulations (sec. 4.2, figures 5, 6)"
    }

    fn run(
        &self,
        simulator: &Simulator,
        settings: &Settings,
        progress: &mut dyn FnMut(&str, f64),
    ) -> Result<Report, ReproduceError> {
        Ok(report::report(&study(simulator, settings, progress)?))
    }
}

/// Factors of EA for which the formulations are compared.
pub const STIFFNESS_FACTORS: [f64; 4] = [1.0, 10.0, 100.0, 1000.0];

/// All of the case.
#[derive(Clone, Debug)]
pub struct ComparisonStudy {
    /// The scene in lumped masses.
    pub lumped: Flight,
    /// The scene in rigid links.
    pub links: Flight,
    /// What hangs.
    pub hanging: Hanging,
    /// EA over that of the scene, and the largest difference between lumped masses and the links that they become,
    /// m.
    pub limit: Vec<(f64, f64)>,
    /// What separate programs have computed, with the same flown here; none if the settings make another flight.
    pub references: Vec<(Reference, Flight)>,
}

/// A gondola on an elastic tether at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hanging {
    /// Mass of the gondola, kg.
    pub gondola_kg: f64,
    /// Mass of the tether, kg.
    pub tether_kg: f64,
    /// Its length, m.
    pub length_m: f64,
    /// Its stiffness EA, N.
    pub axial_stiffness_n: f64,
    /// Acceleration of gravity, m/s^2.
    pub gravity_m_s2: f64,
}

impl Hanging {
    /// What the tether stretches: g L (m_p + m_t/2)/EA, m.
    #[must_use]
    pub fn stretch_m(&self) -> f64 {
        let hangs_kg = self.gondola_kg + 0.5 * self.tether_kg;
        self.gravity_m_s2 * self.length_m * hangs_kg / self.axial_stiffness_n
    }

    /// Force on the balloon: g (m_p + m_t), N.
    #[must_use]
    pub fn top_n(&self) -> f64 {
        self.gravity_m_s2 * (self.gondola_kg + self.tether_kg)
    }

    /// Force on the gondola: g m_p, N.
    #[must_use]
    pub fn bottom_n(&self) -> f64 {
        self.gravity_m_s2 * self.gondola_kg
    }
}

/// Flies everything.
///
/// # Errors
/// A scene that cannot be built.
pub fn study(
    simulator: &Simulator,
    settings: &Settings,
    progress: &mut dyn FnMut(&str, f64),
) -> Result<ComparisonStudy, SceneError> {
    let references = if *settings == Settings::default() {
        AT_100_S.to_vec()
    } else {
        Vec::new()
    };
    let count = (3 + STIFFNESS_FACTORS.len() + references.len()) as f64;
    let mut done = 0.0;
    let mut fly = |what: &str, more: &[String]| {
        let scene = scene(simulator, settings, more)?;
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
    let hanging = hanging(&scene(simulator, settings, &[])?)?;
    let rigid = fly("links with their masses at the joints", &point_masses())?;
    let mut limit = Vec::new();
    for factor in STIFFNESS_FACTORS {
        let flight = fly(&format!("EA x {factor}"), &stiffer(factor, &hanging))?;
        let largest_m = [BALLOON, GONDOLA]
            .map(|body| largest_difference_m(&flight, &rigid, body))
            .into_iter();
        limit.push((factor, super::check::largest(largest_m)));
    }
    let flown = references.into_iter().map(|reference| {
        let flight = fly(reference.name, &reference.overrides())?;
        Ok((reference, flight))
    });
    let references = flown.collect::<Result<_, SceneError>>()?;
    Ok(ComparisonStudy {
        lumped,
        links,
        hanging,
        limit,
        references,
    })
}

fn scene(simulator: &Simulator, settings: &Settings, more: &[String]) -> Result<Scene, SceneError> {
    let mut overrides = Vec::new();
    if let Some(nodes) = settings.nodes {
        overrides.push(format!("entities.{TETHER}.Tether.nodes={nodes}"));
    }
    if let Some(duration_s) = settings.duration_s {
        overrides.push(format!("run.duration_s={duration_s:?}"));
    }
    overrides.extend_from_slice(more);
    SCENE.load(simulator, &overrides)
}

/// The tether's mass on its nodes, so that lumped masses and links move the same masses.
fn on_the_nodes() -> String {
    format!("entities.{TETHER}.Tether.lumping=Interior")
}

/// Links with their masses at the joints: what lumped masses become as EA grows without end.
fn point_masses() -> Vec<String> {
    vec![
        formulation_override(Formulation::Denoc),
        on_the_nodes(),
        "run.links=PointMass".to_owned(),
        "run.integrator=Adaptive(relative_tolerance: 1e-9)".to_owned(),
    ]
}

/// Lumped masses with EA times `factor`, and with the damping that leaves the damping ratios what they were.
fn stiffer(factor: f64, hanging: &Hanging) -> Vec<String> {
    let stiffness_n = factor * hanging.axial_stiffness_n;
    let damping_n_s_m = 10.0 * factor.sqrt();
    vec![
        formulation_override(Formulation::LumpedMass),
        on_the_nodes(),
        format!("entities.{TETHER}.Tether.axial_stiffness_n={stiffness_n:?}"),
        format!("entities.{TETHER}.Tether.damping_n_s_m={damping_n_s_m:?}"),
        "run.integrator=Implicit(accuracy_m: 1e-6)".to_owned(),
    ]
}

fn missing(what: &str) -> SceneError {
    SceneError::plain(format_args!("the comparison case needs {what}"))
}

fn hanging(scene: &Scene) -> Result<Hanging, SceneError> {
    let tether: &Tether = scene
        .entity(TETHER)
        .and_then(|entity| entity.get())
        .ok_or_else(|| missing("a `Tether`"))?;
    let gondola: &Body = scene
        .entity(GONDOLA)
        .and_then(|entity| entity.get())
        .ok_or_else(|| missing("a gondola"))?;
    Ok(Hanging {
        gondola_kg: gondola.mass_kg,
        tether_kg: tether.mass_kg(),
        length_m: tether.length_m,
        axial_stiffness_n: tether.axial_stiffness_n,
        gravity_m_s2: scene.environment.gravity.acceleration_m_s2(0.0),
    })
}
