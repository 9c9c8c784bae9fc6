//! `summary.json`: what was run and how it ended. `timing.json`: what it took, apart, because every
//! other file has the same bytes for the same scene, seed and version.

use std::borrow::Cow;
use std::fmt;

use serde::{Deserialize, Serialize};

use crate::world::Event;

/// Version of the program that stands in every summary.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The summary of a run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Summary {
    /// Version of the program.
    pub version: Cow<'static, str>,
    /// Name of the scene.
    pub scene: String,
    /// Seed of the random draws.
    pub seed: u64,
    /// The formulation.
    pub formulation: Cow<'static, str>,
    /// The integrator with its settings.
    pub integrator: String,
    /// Largest step that fixed-step RK4 could take at the start, s; absent without tethers.
    pub stable_step_s: Option<f64>,
    /// The segment that sets it.
    pub stiffest_segment: Option<String>,
    /// Accepted steps.
    pub steps: u64,
    /// Those of them that were implicit.
    pub implicit_steps: u64,
    /// Rejected steps.
    pub rejected_steps: u64,
    /// Evaluations of the rates.
    pub evaluations: u64,
    /// Simulated time, s.
    pub simulated_s: f64,
    /// `done` or `stopped`.
    pub outcome: Cow<'static, str>,
    /// Why it stopped before its end.
    pub stopped: Option<Stop>,
    /// The largest tension and where it was.
    pub largest_tension: Option<LargestTension>,
    /// Events in the order of time.
    pub events: Vec<EventRow>,
    /// How many events more than are listed there were.
    pub events_dropped: u64,
    /// State of each body at the end.
    pub final_states: Vec<FinalState>,
    /// What is worth knowing, as sentences.
    pub warnings: Vec<String>,
}

impl Summary {
    /// Marks the run as stopped at its present end, for `reason`.
    pub fn stop(&mut self, reason: String) {
        self.outcome = "stopped".into();
        self.stopped = Some(Stop {
            time_s: self.simulated_s,
            entity: None,
            reason,
        });
    }
}

/// Why a run stopped before its end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stop {
    /// Time of the last accepted state, s.
    pub time_s: f64,
    /// The entity where it shows.
    pub entity: Option<String>,
    /// What happened and the likely cause.
    pub reason: String,
}

impl fmt::Display for Stop {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "stopped at {} s:", self.time_s)?;
        if let Some(entity) = &self.entity {
            write!(formatter, " `{entity}`:")?;
        }
        write!(formatter, " {}", self.reason)
    }
}

/// The largest tension of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LargestTension {
    /// The tension, N.
    pub tension_n: f64,
    /// When, s.
    pub time_s: f64,
    /// In which tether.
    pub tether: String,
    /// In which segment of it.
    pub segment: u32,
}

/// An event.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EventRow {
    /// When, s.
    pub time_s: f64,
    /// What.
    pub kind: String,
    /// To which entity.
    pub entity: String,
}

impl From<&Event> for EventRow {
    fn from(event: &Event) -> Self {
        Self {
            time_s: event.time_s,
            kind: event.kind.clone(),
            entity: event.entity.clone(),
        }
    }
}

/// State of a body at the end of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FinalState {
    /// Its name.
    pub entity: String,
    /// Position, inertial frame, m.
    pub position_m: [f64; 3],
    /// Velocity, inertial frame, m/s.
    pub velocity_m_s: [f64; 3],
    /// Attitude (x, y, z, w), body to inertial.
    pub attitude: [f64; 4],
    /// Angular velocity, body frame, rad/s.
    pub rate_rad_s: [f64; 3],
}

/// What a run took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// Wall time, s.
    pub wall_s: f64,
    /// CPU time of the stepping thread, s.
    pub cpu_s: f64,
    /// Simulated seconds per second of CPU time.
    pub simulated_s_per_cpu_s: f64,
}
