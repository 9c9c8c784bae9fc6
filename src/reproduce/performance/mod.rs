//! The performance study of the paper (sec. 4.3, figures 7 and 8): what a simulated second costs as the
//! tether has more elements, and as it is longer; both formulations, explicit and implicit.

mod checks;
mod exponents;
mod flight;
mod report;
mod solver;
mod tables;
mod wave;
mod why;

use aerobot_engine::plugin::Simulator;

pub use exponents::{Exponent, Quantity, Study, power_law};
pub use flight::{Extent, Measured};
pub use solver::{Method, SOLVERS, Solver};

use super::{Case, Report, ReproduceError, Settings};
use aerobot_components::run::Formulation;
use flight::Flight;

/// Cost against the number of elements and against the length.
#[derive(Clone, Copy, Debug)]
pub struct Performance;

impl Case for Performance {
    fn name(&self) -> &'static str {
        "performance"
    }

    fn about(&self) -> &'static str {
        "cost against the number of elements and the length, both formulations (sec. 4.3, figures 7, 8)"
    }

    fn measures_time(&self) -> bool {
        true
    }

    fn run(
        &self,
        simulator: &Simulator,
        settings: &Settings,
        progress: &mut dyn FnMut(&str, f64),
    ) -> Result<Report, ReproduceError> {
        let mut own = PerformanceSettings::default();
        own.duration_s = settings.duration_s.unwrap_or(own.duration_s);
        if let Some(most) = settings.nodes {
            own.elements.retain(|elements| *elements <= most);
        }
        let costs = measure(simulator, &own, progress)?;
        Ok(report::report(&own, &costs))
    }
}

/// What is measured.
///
/// An element is a mass of the tether, as in sec. 4.2 of the paper: `nodes` of the scene. It makes one
/// segment, or link, more than there are elements.
#[derive(Clone, Debug, PartialEq)]
pub struct PerformanceSettings {
    /// Numbers of elements of the first study, ascending.
    pub elements: Vec<u32>,
    /// Length of its tether, m.
    pub length_m: f64,
    /// Lengths of the second study, m, ascending.
    pub lengths_m: Vec<f64>,
    /// Number of elements of its tether.
    pub elements_of_lengths: u32,
    /// Simulated time of a whole run, s.
    pub duration_s: f64,
    /// Relative tolerance of the explicit runs.
    pub relative_tolerance: f64,
    /// Accuracy of the implicit runs, m.
    pub accuracy_m: f64,
    /// With more elements than this an explicit run of the lumped masses is a part of the whole.
    pub most_of_whole_lumped: u32,
    /// With more elements than this an explicit run of the links is a part of the whole.
    pub most_of_whole_links: u32,
    /// Length of a part with lumped masses, in largest stable steps of RK4.
    pub stable_steps_of_part: f64,
    /// Length of a part with links, s.
    pub duration_of_part_s: f64,
    /// How often a run is repeated for the least CPU time.
    pub repeats: u32,
    /// After this much CPU time a run is not repeated, s.
    pub enough_cpu_s: f64,
}

impl Default for PerformanceSettings {
    fn default() -> Self {
        Self {
            elements: vec![1, 2, 3, 5, 7, 10, 14, 20, 40, 100, 200, 400, 1000],
            length_m: 1000.0,
            lengths_m: vec![50.0, 100.0, 200.0, 400.0, 700.0, 1000.0, 1300.0, 1550.0],
            elements_of_lengths: 5,
            duration_s: 100.0,
            relative_tolerance: 1e-6,
            accuracy_m: 1e-2,
            most_of_whole_lumped: 20,
            most_of_whole_links: 400,
            stable_steps_of_part: 1000.0,
            duration_of_part_s: 2.0,
            repeats: 4,
            enough_cpu_s: 0.5,
        }
    }
}

impl PerformanceSettings {
    /// How much of a run is flown.
    fn extent(&self, elements: u32, solver: Solver) -> Extent {
        match (solver.method, solver.formulation) {
            (Method::Explicit, Formulation::LumpedMass) if elements > self.most_of_whole_lumped => {
                Extent::StableSteps
            }
            (Method::Explicit, Formulation::Denoc) if elements > self.most_of_whole_links => {
                Extent::Seconds
            }
            _ => Extent::Whole,
        }
    }
}

/// What the two studies have measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Costs {
    /// Against the number of elements, four for each number.
    pub by_elements: Vec<Measured>,
    /// Against the length, four for each length.
    pub by_length: Vec<Measured>,
}

impl Costs {
    /// The runs of a study.
    #[must_use]
    pub fn of(&self, study: Study) -> &[Measured] {
        match study {
            Study::Elements => &self.by_elements,
            Study::Length => &self.by_length,
        }
    }
}

/// Runs both studies.
///
/// # Errors
/// Fewer than two numbers of elements, or a scene that cannot be built.
pub fn measure(
    simulator: &Simulator,
    settings: &PerformanceSettings,
    progress: &mut dyn FnMut(&str, f64),
) -> Result<Costs, ReproduceError> {
    if settings.elements.len() < 2 {
        return Err(ReproduceError::Setting(format!(
            "the performance case needs two numbers of elements or more to tell how the cost grows: \
             `--nodes` must be at least {}",
            PerformanceSettings::default().elements.get(1).unwrap_or(&2)
        )));
    }
    let by_elements = settings
        .elements
        .iter()
        .map(|elements| (*elements, settings.length_m));
    let by_length = settings
        .lengths_m
        .iter()
        .map(|length_m| (settings.elements_of_lengths, *length_m));
    let mut flights = Vec::new();
    for (elements, length_m) in by_elements.chain(by_length) {
        for solver in SOLVERS {
            progress(&format!("{elements} elements, {length_m} m"), 0.0);
            let extent = settings.extent(elements, solver);
            let flight = Flight::new(simulator, settings, (elements, length_m), solver, extent)?;
            flights.push(flight);
        }
    }
    repeat(simulator, settings, &mut flights, progress)?;
    let mut by_elements: Vec<Measured> =
        flights.into_iter().map(|flight| flight.measured).collect();
    let by_length = by_elements.split_off(settings.elements.len() * SOLVERS.len());
    let mut costs = Costs {
        by_elements,
        by_length,
    };
    flight::compare_ends(&mut costs.by_elements);
    flight::compare_ends(&mut costs.by_length);
    Ok(costs)
}

/// Flies every run, and then all of them again, so that what else the machine does falls on all alike.
fn repeat(
    simulator: &Simulator,
    settings: &PerformanceSettings,
    flights: &mut [Flight],
    progress: &mut dyn FnMut(&str, f64),
) -> Result<(), ReproduceError> {
    let count = f64::from(settings.repeats) * flights.len() as f64;
    let mut done = 0.0;
    for _ in 0..settings.repeats {
        for flight in &mut *flights {
            progress(&flight.name(), done / count);
            if flight.cpu_s < settings.enough_cpu_s {
                flight.fly(simulator)?;
            }
            done += 1.0;
        }
    }
    progress("done", 1.0);
    Ok(())
}
