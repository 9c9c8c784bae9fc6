//! The sail of the paper (sec. 5.2, figures 17 to 19): how it trims and whether it is stable with either sign of
//! the downwash and on either side, the wind that drives it, and its response to the proportional law.

mod checks;
mod figures;
mod report;
mod separate_program;

use std::path::Path;

use aerobot_components::control::{Controller, Law};
use aerobot_components::sail::{Sail, SailShape};
use aerobot_engine::plugin::Simulator;
use aerobot_engine::recording::frame::MemorySink;
use aerobot_engine::scene::{Scene, SceneError};
use aerobot_systems::forces::sail::{least_rudder_area_m2, yaw_stiffness_m3_rad};

use super::{Case, Report, ReproduceError, Settings};
pub use separate_program::{RUDDER_STEP, SeparateProgram};

/// The scene of the case.
const SCENE: &str = include_str!("../../../scenes/paper/sail_trajectory.ron");
/// What messages call it.
const SCENE_NAME: &str = "scenes/paper/sail_trajectory.ron";
/// The names of its entities.
const BALLOON: &str = "balloon";
const SAIL: &str = "sail";
/// A balloon this close to where it should be has arrived, m.
pub const BAND_M: f64 = 1.0;

/// The sail and its proportional law.
#[derive(Clone, Copy, Debug)]
pub struct SailCase;

impl Case for SailCase {
    fn name(&self) -> &'static str {
        "sail"
    }

    fn about(&self) -> &'static str {
        "the sail that steers the balloon by a proportional law (sec. 5.2, figures 17 to 19)"
    }

    fn run(
        &self,
        simulator: &Simulator,
        settings: &Settings,
        progress: &mut dyn FnMut(&str, f64),
    ) -> Result<Report, ReproduceError> {
        let found = study(simulator, settings, progress)?;
        Ok(report::report(&found).with_figures(figures::figures(&found)))
    }
}

/// What a variant changes in the scene: its words, and overrides.
const VARIANTS: [(&str, &[&str]); 5] = [
    ("y of the balloon fed back", &[]),
    (
        "y of the sail fed back",
        &["entities.helm.Controller.law.measured=Y(\"sail\")"],
    ),
    (
        "balloon, the wing ahead, downwash as printed",
        &[
            "entities.sail.Sail.wing.side=Ahead",
            "entities.sail.Sail.downwash=AsPrinted",
        ],
    ),
    (
        "balloon, a line without drag",
        &["entities.tether.Tether.drag=(normal: 0, tangential: 0)"],
    ),
    (
        "balloon, no drag, slope of the finite span",
        &[
            "entities.tether.Tether.drag=(normal: 0, tangential: 0)",
            "entities.sail.Sail.lift_slope=FiniteSpan",
        ],
    ),
];

/// All of the case.
#[derive(Clone, Debug, PartialEq)]
pub struct SailStudy {
    /// Sails of every kind, with what makes them so.
    pub trims: Vec<(String, Trim)>,
    /// The commanded y, m.
    pub target_m: f64,
    /// The flights, with what is varied.
    pub flights: Vec<(&'static str, Response)>,
    /// Flights that a separate program has computed too.
    pub separate: SeparateProgram,
}

/// How a sail answers to its rudder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trim {
    /// Incidence of the wing over the deflection where nothing turns the sail.
    pub incidence_per_deflection: f64,
    /// Side force there over dynamic pressure and deflection, m^2/rad.
    pub force_m2_rad: f64,
    /// Yaw stiffness over the dynamic pressure, m^3/rad; negative if unstable.
    pub stiffness_m3_rad: f64,
    /// The area of the rudder from which on it is stable, m^2.
    pub least_rudder_m2: Option<f64>,
}

/// The balloon's way to the commanded y.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Response {
    /// Time (s), y of the balloon, y of the sail (m), deflection of the rudder (rad).
    pub rows: Vec<(f64, f64, f64, f64)>,
    /// Largest y of the balloon over the target, less one.
    pub overshoot: f64,
    /// Time from which on the balloon stays within [`BAND_M`], s, if it does.
    pub arrived_s: Option<f64>,
    /// Mean time between upward passages of the target, s.
    pub period_s: Option<f64>,
    /// Why the run stopped before its end.
    pub stopped: Option<String>,
}

/// Trims and flies everything.
///
/// # Errors
/// A scene that cannot be built.
pub fn study(
    simulator: &Simulator,
    settings: &Settings,
    progress: &mut dyn FnMut(&str, f64),
) -> Result<SailStudy, SceneError> {
    let plain = scene(simulator, settings, &[])?;
    let mut found = SailStudy {
        trims: trims(&plain)?,
        target_m: target_m(&plain)?,
        flights: Vec::new(),
        separate: SeparateProgram::fly(simulator)?,
    };
    let count = VARIANTS.len() as f64;
    for (index, (words, overrides)) in VARIANTS.into_iter().enumerate() {
        let scene = scene(simulator, settings, overrides)?;
        let mut part = |part: f64| progress(words, (index as f64 + part) / count);
        let response = fly(simulator, &scene, found.target_m, &mut part)?;
        found.flights.push((words, response));
    }
    Ok(found)
}

fn scene(simulator: &Simulator, settings: &Settings, more: &[&str]) -> Result<Scene, SceneError> {
    let mut overrides: Vec<String> = more.iter().map(|text| (*text).to_owned()).collect();
    if let Some(nodes) = settings.nodes {
        overrides.push(format!("entities.tether.Tether.nodes={nodes}"));
    }
    if let Some(duration_s) = settings.duration_s {
        overrides.push(format!("run.duration_s={duration_s:?}"));
    }
    simulator.load_text(SCENE_NAME, SCENE.to_owned(), Path::new("."), &overrides)
}

fn missing(what: &str) -> SceneError {
    SceneError::plain(format_args!("the sail case needs {what}"))
}

fn target_m(scene: &Scene) -> Result<f64, SceneError> {
    let law = scene.with::<Controller>().next().map(|(_, own)| &own.law);
    match law {
        Some(Law::Proportional { target, .. }) => Ok(*target),
        _ => Err(missing("a `Controller` with a `Proportional` law")),
    }
}

/// The scene's sail on either side, with either sign and either slope.
fn trims(scene: &Scene) -> Result<Vec<(String, Trim)>, SceneError> {
    use aerobot_components::sail::{Downwash, LiftSlope, Side};
    let (_, given) = scene
        .with::<Sail>()
        .next()
        .ok_or_else(|| missing("a `Sail`"))?;
    let mut found = Vec::new();
    for (slope, slope_words) in [
        (LiftSlope::ThinAerofoil, "2 pi"),
        (LiftSlope::FiniteSpan, "2 pi/(1 + 2/AR)"),
    ] {
        for (side, side_words) in [(Side::Ahead, "ahead"), (Side::Aft, "aft")] {
            for (downwash, sign_words) in [
                (Downwash::Right, "right"),
                (Downwash::AsPrinted, "as printed"),
            ] {
                let mut sail = given.clone();
                (sail.lift_slope, sail.wing.side, sail.downwash) = (slope, side, downwash);
                // By lift alone, as the closed form of the paper's equations has it.
                sail.wing.zero_lift_drag = 0.0;
                let words = format!("{slope_words:<16} {side_words:<6} {sign_words:<11}");
                found.push((words, trim(&sail.shape())));
            }
        }
    }
    Ok(found)
}

/// Small deflections.
fn trim(shape: &SailShape) -> Trim {
    let (wing, rudder) = (&shape.wing, &shape.rudder);
    let stiffness = yaw_stiffness_m3_rad(shape);
    let rudder_slope = rudder.area_m2 * rudder.lift_slope_per_rad;
    let incidence = -rudder.centre_m.x * rudder_slope / stiffness;
    let straightened = 1.0 + shape.downwash_rad * wing.lift_slope_per_rad;
    let wing_lift = wing.area_m2 * wing.lift_slope_per_rad * incidence;
    let rudder_lift = rudder_slope * (straightened * incidence - 1.0);
    Trim {
        incidence_per_deflection: incidence,
        force_m2_rad: -(wing_lift + rudder_lift),
        stiffness_m3_rad: stiffness,
        least_rudder_m2: least_rudder_area_m2(shape).filter(|area| *area > 0.0),
    }
}

fn fly(
    simulator: &Simulator,
    scene: &Scene,
    target_m: f64,
    progress: &mut dyn FnMut(f64),
) -> Result<Response, SceneError> {
    let mut simulation = simulator.build(scene)?;
    let mut results = MemorySink::default();
    let duration_s = scene.run.duration_s;
    let summary = simulation.run(&mut results, &mut |time_s| progress(time_s / duration_s));
    let balloon = results.positions(BALLOON);
    let sail = results.positions(SAIL);
    let rudder = results.channel(SAIL, "rudder_rad");
    let rows: Vec<(f64, f64, f64, f64)> = balloon
        .iter()
        .zip(&sail)
        .zip(&rudder)
        .map(|(((time_s, balloon), (_, sail)), (_, rudder))| (*time_s, balloon.y, sail.y, *rudder))
        .collect();
    Ok(Response {
        stopped: summary.stopped.map(|stop| stop.reason),
        ..told(rows, target_m)
    })
}

/// What is told of the way to a target.
fn told(rows: Vec<(f64, f64, f64, f64)>, target_m: f64) -> Response {
    let most = rows
        .iter()
        .map(|row| row.1)
        .fold(f64::NEG_INFINITY, f64::max);
    let balloon: Vec<(f64, f64)> = rows.iter().map(|row| (row.0, row.1)).collect();
    let upward: Vec<f64> = rows
        .windows(2)
        .filter(|pair| pair[0].1 < target_m && pair[1].1 >= target_m)
        .map(|pair| {
            let part = (target_m - pair[0].1) / (pair[1].1 - pair[0].1);
            pair[0].0 + part * (pair[1].0 - pair[0].0)
        })
        .collect();
    // Of an oscillation that has nearly died out the passages say little.
    let period_s = match upward.as_slice() {
        [first, second, ..] => Some(second - first),
        _ => None,
    };
    Response {
        overshoot: most / target_m - 1.0,
        arrived_s: arrival_s(&balloon, target_m),
        period_s,
        rows,
        stopped: None,
    }
}

/// Time (s) from which on y of the balloon, at times, stays within [`BAND_M`] of the target, if it does.
fn arrival_s(balloon: &[(f64, f64)], target_m: f64) -> Option<f64> {
    let outside = balloon
        .iter()
        .rposition(|(_, y_m)| (y_m - target_m).abs() > BAND_M);
    match outside {
        Some(last) => balloon.get(last + 1).map(|row| row.0),
        None => Some(0.0),
    }
}
