//! One run of a study: its scene, what limits its steps, and what it costs.

use std::path::Path;

use aerobot_components::run::Formulation;
use aerobot_components::tether::Tether;
use aerobot_engine::plugin::Simulator;
use aerobot_engine::recording::frame::NullSink;
use aerobot_engine::recording::summary::{FinalState, Summary};
use aerobot_engine::run_folder::thread_cpu_time;
use aerobot_engine::scene::{Scene, SceneError};

use super::{Method, PerformanceSettings, SOLVERS, Solver, wave};

/// The scene of the studies.
const SCENE: &str = include_str!("../../../scenes/paper/comparison_900m.ron");
/// What messages call it.
const SCENE_NAME: &str = "scenes/paper/comparison_900m.ron";
/// The name of its tether.
const TETHER: &str = "tether";

/// How much of a run is flown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// All of it.
    Whole,
    /// A number of stable steps.
    StableSteps,
    /// Some seconds.
    Seconds,
}

/// A run with its cost. Everything but the CPU time is the same on every machine and every time.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Number of elements of the tether.
    pub elements: u32,
    /// Its length, m.
    pub length_m: f64,
    /// What ran it.
    pub solver: Solver,
    /// How much of it was flown; a part begins with the first gust.
    pub extent: Extent,
    /// Largest stable step of RK4 at the start, s.
    pub stable_step_s: f64,
    /// The same if nothing damped the tether, s; of lumped masses.
    pub undamped_stable_step_s: Option<f64>,
    /// Frequency of the fastest transverse vibration, rad/s; of links.
    pub transverse_rad_s: Option<f64>,
    /// Simulated time, s.
    pub simulated_s: f64,
    /// Accepted steps.
    pub steps: u64,
    /// Rejected steps.
    pub rejected_steps: u64,
    /// Evaluations of the rates.
    pub evaluations: u64,
    /// Bodies at the end.
    pub bodies: Vec<FinalState>,
    /// Largest distance of a body at the end from that of the explicit run of the same formulation, m;
    /// where both are whole.
    pub from_explicit_m: Option<f64>,
    /// Why the run stopped before its end, if it did.
    pub stopped: Option<String>,
    /// Least CPU time, s.
    pub cpu_s: f64,
    /// Of how many repeats.
    pub repeats: u32,
}

impl Measured {
    /// Accepted steps per simulated second.
    #[must_use]
    pub fn steps_per_simulated_s(&self) -> f64 {
        self.steps as f64 / self.simulated_s
    }

    /// Evaluations per simulated second.
    #[must_use]
    pub fn evaluations_per_simulated_s(&self) -> f64 {
        self.evaluations as f64 / self.simulated_s
    }

    /// CPU seconds per simulated second.
    #[must_use]
    pub fn cpu_per_simulated_s(&self) -> f64 {
        self.cpu_s / self.simulated_s
    }

    /// CPU time of an accepted step, us.
    #[must_use]
    pub fn cpu_us_per_step(&self) -> f64 {
        1e6 * self.cpu_s / self.steps as f64
    }

    /// CPU time of an evaluation with its part of all else, us.
    #[must_use]
    pub fn cpu_us_per_evaluation(&self) -> f64 {
        1e6 * self.cpu_s / self.evaluations as f64
    }
}

/// A run that can be repeated.
pub(super) struct Flight {
    scene: Scene,
    pub(super) measured: Measured,
    /// CPU time of all repeats, s.
    pub(super) cpu_s: f64,
}

impl Flight {
    /// Prepares a run with a tether of so many elements and so many metres.
    pub(super) fn new(
        simulator: &Simulator,
        settings: &PerformanceSettings,
        (elements, length_m): (u32, f64),
        solver: Solver,
        extent: Extent,
    ) -> Result<Self, SceneError> {
        let load = |duration_s: f64, more: &[&str]| {
            let mut overrides = overrides(settings, (elements, length_m), solver);
            overrides.push(format!("run.duration_s={duration_s:?}"));
            overrides.extend(more.iter().map(|text| (*text).to_owned()));
            simulator.load_text(SCENE_NAME, SCENE.to_owned(), Path::new("."), &overrides)
        };
        let whole = load(settings.duration_s, &[])?;
        let simulation = simulator.build(&whole)?;
        let stable_step_s = simulation.stable_step().step_s;
        let (mut undamped, mut transverse_rad_s) = (None, None);
        match solver.formulation {
            Formulation::LumpedMass => {
                let without = load(settings.duration_s, &[UNDAMPED])?;
                undamped = Some(simulator.build(&without)?.stable_step().step_s);
            }
            Formulation::Denoc => {
                transverse_rad_s = wave::of_tether(&simulation, TETHER, tether(&whole)?);
            }
        }
        let part_s = match extent {
            Extent::Whole => None,
            Extent::StableSteps => Some(settings.stable_steps_of_part * stable_step_s),
            Extent::Seconds => Some(settings.duration_of_part_s),
        };
        let scene = match part_s {
            None => whole,
            Some(part_s) => load(part_s.min(settings.duration_s), &[GUST_FROM_THE_START])?,
        };
        Ok(Self {
            scene,
            cpu_s: 0.0,
            measured: Measured {
                elements,
                length_m,
                solver,
                extent,
                stable_step_s,
                undamped_stable_step_s: undamped,
                transverse_rad_s,
                simulated_s: 0.0,
                steps: 0,
                rejected_steps: 0,
                evaluations: 0,
                bodies: Vec::new(),
                from_explicit_m: None,
                stopped: None,
                cpu_s: f64::INFINITY,
                repeats: 0,
            },
        })
    }

    /// What it is, for a reader.
    pub(super) fn name(&self) -> String {
        let Measured {
            elements, length_m, ..
        } = self.measured;
        let solver = self.measured.solver.name();
        format!("{solver}, {elements} elements, {length_m} m")
    }

    /// Flies it once.
    pub(super) fn fly(&mut self, simulator: &Simulator) -> Result<(), SceneError> {
        let mut simulation = simulator.build(&self.scene)?;
        let start = thread_cpu_time();
        // Whoever listens costs time, and at every step more than the step of a short line.
        let summary = simulation.run(&mut NullSink, &mut |_| {});
        let cpu_s = (thread_cpu_time() - start).as_secs_f64();
        self.cpu_s += cpu_s;
        self.measured.cpu_s = self.measured.cpu_s.min(cpu_s);
        self.measured.repeats += 1;
        self.measured.take(summary);
        Ok(())
    }
}

impl Measured {
    fn take(&mut self, summary: Summary) {
        self.simulated_s = summary.simulated_s;
        self.steps = summary.steps;
        self.rejected_steps = summary.rejected_steps;
        self.evaluations = summary.evaluations;
        self.bodies = summary.final_states;
        self.stopped = summary.stopped.map(|stop| stop.reason);
    }

    /// Largest distance between its bodies and those of another run, m.
    fn distance_m(&self, other: &Self) -> f64 {
        let pairs = self.bodies.iter().zip(&other.bodies);
        let squares = pairs.map(|(a, b)| {
            let axes = a.position_m.iter().zip(b.position_m);
            axes.map(|(a, b)| (a - b) * (a - b)).sum::<f64>()
        });
        squares.fold(0.0, f64::max).sqrt()
    }
}

/// Sets the ends of implicit runs against those of the explicit runs beside them.
pub(super) fn compare_ends(runs: &mut [Measured]) {
    for group in runs.chunks_mut(SOLVERS.len()) {
        for pair in group.chunks_mut(2) {
            if let [explicit, implicit] = pair
                && [&*explicit, &*implicit].map(|run| run.extent) == [Extent::Whole; 2]
                && explicit.stopped.is_none()
                && implicit.stopped.is_none()
                && implicit.solver.method == Method::Implicit
            {
                implicit.from_explicit_m = Some(implicit.distance_m(explicit));
            }
        }
    }
}

const UNDAMPED: &str = "entities.tether.Tether.damping_n_s_m=0";
/// A part of a run begins where the line starts to move.
const GUST_FROM_THE_START: &str = "environment.wind.0.from_s=0";

/// Nothing is recorded on the way, so that no output cuts a step.
fn overrides(
    settings: &PerformanceSettings,
    (elements, length_m): (u32, f64),
    solver: Solver,
) -> Vec<String> {
    let mut overrides = vec![
        format!("entities.{TETHER}.Tether.nodes={elements}"),
        format!("entities.{TETHER}.Tether.length_m={length_m:?}"),
        format!("run.output_every_s={:?}", settings.duration_s),
        "run.record=(bodies: Never, nodes: Never, tethers: Never, channels: None)".to_owned(),
    ];
    overrides.extend(solver.overrides(settings));
    overrides
}

fn tether(scene: &Scene) -> Result<&Tether, SceneError> {
    scene
        .entity(TETHER)
        .and_then(|entity| entity.get())
        .ok_or_else(|| SceneError::plain(format_args!("the performance case needs a `{TETHER}`")))
}
