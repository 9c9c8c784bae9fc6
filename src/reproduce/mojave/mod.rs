//! The test in the Mojave desert (paper, sec. 4.3.1, figure 11): pendulum and torsion of a gondola on a ring of tethers,
//! coupled by a centre of mass beside the axis; as modes, as a flight, and as the flight's spectrum.

mod figures;
mod report;

use aerobot_components::run::Formulation;
use aerobot_engine::modes::{Mode, ModesRequest, Motion};
use aerobot_engine::plugin::Simulator;
use aerobot_engine::scene::{Scene, SceneError};
use aerobot_report::spectrum::{Spectrum, amplitude_spectrum};

use super::check::largest;
use super::flight::{Flight, PaperScene, formulation_override};
use super::pendulums::HungPair;
use super::{Case, Report, ReproduceError, Settings};

/// The scene of the case.
const SCENE: PaperScene = PaperScene {
    name: "scenes/paper/mojave_test.ron",
    text: include_str!("../../../scenes/paper/mojave_test.ron"),
};
/// The names of its entities.
pub(super) const BALLOON: &str = "balloon";
pub(super) const GONDOLA: &str = "gondola";
/// Spectra begin here, s: the gust has passed.
pub const CALM_S: f64 = 12.0;
/// Spectra end here, Hz.
const HIGHEST_HZ: f64 = 1.0;
/// Points of a spectrum for each bin of the record.
const POINTS_OF_BIN: usize = 4;

/// Pendulum and torsion coupled.
#[derive(Clone, Copy, Debug)]
pub struct Mojave;

impl Case for Mojave {
    fn name(&self) -> &'static str {
        "mojave"
    }

    fn about(&self) -> &'static str {
        "a gondola off the axis of its ring: pendulum and torsion coupled (sec. 4.3.1, figure 11)"
    }

    fn run(
        &self,
        simulator: &Simulator,
        settings: &Settings,
        progress: &mut dyn FnMut(&str, f64),
    ) -> Result<Report, ReproduceError> {
        let mut own = MojaveSettings::default();
        own.nodes = settings.nodes.or(own.nodes);
        own.duration_s = settings.duration_s.unwrap_or(own.duration_s);
        let found = study(simulator, &own, progress)?;
        Ok(report::report(&own, &found).with_figures(figures::figures(&found)))
    }
}

/// What is studied.
#[derive(Clone, Debug, PartialEq)]
pub struct MojaveSettings {
    /// Offsets of the ring's centre from the gondola's centre of mass, along y, m.
    pub offsets_m: Vec<f64>,
    /// The offset of the flights in rigid links, m.
    pub offset_of_links_m: f64,
    /// Nodes of each tether, if not those of the scene.
    pub nodes: Option<u32>,
    /// Simulated time, s: as long as frequencies 0.008 Hz apart are to be told apart.
    pub duration_s: f64,
}

impl Default for MojaveSettings {
    fn default() -> Self {
        Self {
            offsets_m: vec![0.0, 0.05, 0.1, -0.1],
            offset_of_links_m: 0.1,
            nodes: None,
            duration_s: 300.0,
        }
    }
}

/// All of the case.
#[derive(Clone, Debug)]
pub struct MojaveStudy {
    /// Lumped masses, for each offset.
    pub offsets: Vec<OffsetResult>,
    /// Rigid links, for one.
    pub links: OffsetFlight,
    /// EA over that of the scene, and the largest difference in the turn between lumped masses and the links that they
    /// become, rad, with the largest turn of the links, rad; with the offset of `links`, until 60 s.
    pub limit: Vec<(f64, f64, f64)>,
}

/// One offset of the ring from the centre of mass.
#[derive(Clone, Debug)]
pub struct OffsetResult {
    /// The flight.
    pub flown: OffsetFlight,
    /// Balloon and gondola as they hang, for closed forms.
    pub pair: HungPair,
    /// Modes of small motions about the rest, slowest first.
    pub modes: Vec<Mode>,
    /// Spectrum of the swing along x, rad.
    pub swing: Spectrum,
    /// Spectrum of the turn of the gondola against the balloon, rad.
    pub turn: Spectrum,
}

impl OffsetResult {
    /// Frequency of the oscillating mode with the largest share of a motion of the gondola, Hz.
    #[must_use]
    pub fn mode_hz(&self, motion: Motion) -> Option<f64> {
        let own = self.modes.iter().filter(|mode| mode.oscillates());
        let share = |mode: &Mode| mode.share(GONDOLA, motion);
        let most = own.max_by(|a, b| share(a).total_cmp(&share(b)))?;
        Some(most.frequency_hz())
    }
}

/// A flight with an offset.
#[derive(Clone, Debug)]
pub struct OffsetFlight {
    /// The offset along y, m.
    pub offset_m: f64,
    /// The flight.
    pub flight: Flight,
}

impl OffsetFlight {
    /// Time (s) and swing of the gondola below the balloon along x, rad.
    #[must_use]
    pub fn swing(&self) -> Vec<(f64, f64)> {
        self.flight.results.channel(GONDOLA, "swing_x_rad")
    }

    /// Time (s) and heading of the gondola less that of the balloon, rad.
    #[must_use]
    pub fn turn(&self) -> Vec<(f64, f64)> {
        let of = |body| self.flight.results.channel(body, "heading_rad");
        let pairs = of(GONDOLA).into_iter().zip(of(BALLOON));
        pairs
            .map(|((time_s, gondola), (_, balloon))| (time_s, gondola - balloon))
            .collect()
    }
}

/// Flies the scene with every offset.
///
/// # Errors
/// A scene that cannot be built.
pub fn study(
    simulator: &Simulator,
    settings: &MojaveSettings,
    progress: &mut dyn FnMut(&str, f64),
) -> Result<MojaveStudy, SceneError> {
    let count = (settings.offsets_m.len() + 2 + STIFFNESS_FACTORS.len()) as f64;
    let mut done = 0.0;
    let mut fly = |offset_m: f64, formulation: Formulation, more: &[String]| {
        let scene = scene(simulator, settings, offset_m, formulation, more)?;
        let what = format!("{offset_m} m, {}", formulation.name());
        let mut part = |part: f64| progress(&what, (done + part) / count);
        let flight = Flight::of(simulator, &scene, &mut part)?;
        done += 1.0;
        Ok::<_, SceneError>((OffsetFlight { offset_m, flight }, scene))
    };
    let mut offsets = Vec::new();
    for offset_m in &settings.offsets_m {
        let (flown, scene) = fly(*offset_m, Formulation::LumpedMass, &[])?;
        let mut simulation = simulator.build(&scene)?;
        offsets.push(OffsetResult {
            pair: HungPair::of(&scene, &simulation, BALLOON, GONDOLA)?,
            modes: simulation.modes(&scene, &ModesRequest::default())?.modes,
            swing: calm(&flown.swing()),
            turn: calm(&flown.turn()),
            flown,
        });
    }
    let offset_m = settings.offset_of_links_m;
    let (links, _) = fly(offset_m, Formulation::Denoc, &[])?;
    let until_s = settings.duration_s.min(LIMIT_S);
    let (rigid, _) = fly(offset_m, Formulation::Denoc, &point_masses(until_s))?;
    let rigid = rigid.turn();
    let mut limit = Vec::new();
    for factor in STIFFNESS_FACTORS {
        let (elastic, _) = fly(offset_m, Formulation::LumpedMass, &stiffer(until_s, factor))?;
        let pairs = elastic.turn().into_iter().zip(&rigid);
        let apart_rad = largest(pairs.map(|((_, a), (_, b))| (a - b).abs()));
        let most_rad = largest(rigid.iter().map(|(_, turn)| turn.abs()));
        limit.push((factor, apart_rad, most_rad));
    }
    Ok(MojaveStudy {
        offsets,
        links,
        limit,
    })
}

/// Factors of EA for which the formulations are compared.
const STIFFNESS_FACTORS: [f64; 2] = [1.0, 10.0];
/// For so long, s.
const LIMIT_S: f64 = 60.0;

/// Links with their masses at the joints: what lumped masses become as EA grows without end.
fn point_masses(until_s: f64) -> Vec<String> {
    vec![
        format!("run.duration_s={until_s:?}"),
        "entities.suspension.Tethers.lumping=Interior".to_owned(),
        "run.links=PointMass".to_owned(),
        "run.integrator=Adaptive(relative_tolerance: 1e-8)".to_owned(),
    ]
}

/// Lumped masses with EA times `factor`, and with the damping that leaves the damping ratios what they were.
fn stiffer(until_s: f64, factor: f64) -> Vec<String> {
    let (stiffness_n, damping_n_s_m) = (5e4 * factor, 5.0 * factor.sqrt());
    vec![
        format!("run.duration_s={until_s:?}"),
        "entities.suspension.Tethers.lumping=Interior".to_owned(),
        format!("entities.suspension.Tethers.axial_stiffness_n={stiffness_n:?}"),
        format!("entities.suspension.Tethers.damping_n_s_m={damping_n_s_m:?}"),
        "run.integrator=Implicit(accuracy_m: 1e-6)".to_owned(),
    ]
}

/// The spectrum of what is recorded after the gust.
fn calm(record: &[(f64, f64)]) -> Spectrum {
    let calm = record.iter().filter(|(time_s, _)| *time_s >= CALM_S);
    let (times_s, values): (Vec<f64>, Vec<f64>) = calm.copied().unzip();
    amplitude_spectrum(&times_s, &values, POINTS_OF_BIN)
        .unwrap_or_default()
        .up_to(HIGHEST_HZ)
}

fn scene(
    simulator: &Simulator,
    settings: &MojaveSettings,
    offset_m: f64,
    formulation: Formulation,
    more: &[String],
) -> Result<Scene, SceneError> {
    let mut overrides = vec![
        formulation_override(formulation),
        format!("entities.suspension.Tethers.to=(\"{GONDOLA}\", (0, {offset_m:?}, 0.2))"),
    ];
    overrides.extend_from_slice(more);
    if more.is_empty() {
        overrides.push(format!("run.duration_s={:?}", settings.duration_s));
    }
    if let Some(nodes) = settings.nodes {
        overrides.push(format!("entities.suspension.Tethers.nodes={nodes}"));
    }
    SCENE.load(simulator, &overrides)
}
