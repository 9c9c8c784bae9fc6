//! Powers in which costs grow, by least squares of logarithms.

use super::{Costs, Measured, SOLVERS, Solver};

/// From so many elements on there are many.
const MANY: f64 = 40.0;

/// One of the two studies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Study {
    /// Against the number of elements.
    Elements,
    /// Against the length.
    Length,
}

impl Study {
    /// The name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Elements => "elements",
            Self::Length => "length_m",
        }
    }

    /// What varies in it.
    fn argument(self, run: &Measured) -> f64 {
        match self {
            Self::Elements => f64::from(run.elements),
            Self::Length => run.length_m,
        }
    }

    /// Ranges of the argument over which powers are fitted. The first of `Elements` is in what the paper
    /// shows, without the shortest chains; the second is where the arithmetic of the elements outweighs
    /// what every evaluation costs.
    fn ranges(self) -> &'static [(f64, f64)] {
        match self {
            Self::Elements => &[(5.0, 20.0), (MANY, f64::INFINITY)],
            Self::Length => &[(0.0, f64::INFINITY)],
        }
    }
}

/// Something that grows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Accepted steps per simulated second.
    Steps,
    /// Evaluations per simulated second.
    Evaluations,
    /// Largest stable step of RK4.
    StableStep,
    /// The same without damping of the tether.
    UndampedStableStep,
    /// Frequency of the fastest transverse vibration.
    Transverse,
    /// CPU time per simulated second.
    Cpu,
    /// CPU time of an evaluation with its part of all else.
    CpuPerEvaluation,
}

const QUANTITIES: [Quantity; 7] = [
    Quantity::Steps,
    Quantity::Evaluations,
    Quantity::StableStep,
    Quantity::UndampedStableStep,
    Quantity::Transverse,
    Quantity::Cpu,
    Quantity::CpuPerEvaluation,
];

impl Quantity {
    /// The name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Steps => "steps_per_simulated_s",
            Self::Evaluations => "evaluations_per_simulated_s",
            Self::StableStep => "stable_step_s",
            Self::UndampedStableStep => "undamped_stable_step_s",
            Self::Transverse => "transverse_rad_s",
            Self::Cpu => "cpu_s_per_simulated_s",
            Self::CpuPerEvaluation => "cpu_us_per_evaluation",
        }
    }

    /// Whether a clock comes in, so that it differs from one time to the next.
    #[must_use]
    pub fn is_timed(self) -> bool {
        matches!(self, Self::Cpu | Self::CpuPerEvaluation)
    }

    fn of(self, run: &Measured) -> Option<f64> {
        match self {
            Self::Steps => Some(run.steps_per_simulated_s()),
            Self::Evaluations => Some(run.evaluations_per_simulated_s()),
            Self::StableStep => Some(run.stable_step_s),
            Self::UndampedStableStep => run.undamped_stable_step_s,
            Self::Transverse => run.transverse_rad_s,
            Self::Cpu => Some(run.cpu_per_simulated_s()),
            Self::CpuPerEvaluation => Some(run.cpu_us_per_evaluation()),
        }
    }
}

/// A power law that was fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exponent {
    /// Against what.
    pub study: Study,
    /// What ran it.
    pub solver: Solver,
    /// What grows.
    pub quantity: Quantity,
    /// Smallest and largest argument that came in: elements, or m.
    pub range: (f64, f64),
    /// The power of the argument in which it grows.
    pub exponent: f64,
}

impl Exponent {
    /// Whether it is of a study, and there of few elements or of many.
    pub(super) fn is_of(&self, study: Study, many: bool) -> bool {
        let has_many = study == Study::Elements && self.range.0 >= MANY;
        self.study == study && has_many == many
    }
}

/// All power laws for which there are two runs or more that came to their ends.
pub(super) fn all(costs: &Costs) -> Vec<Exponent> {
    let mut found = Vec::new();
    for study in [Study::Elements, Study::Length] {
        for range in study.ranges() {
            for solver in SOLVERS {
                for quantity in QUANTITIES {
                    let points = points(costs.of(study), study, solver, quantity, *range);
                    if let Some(exponent) = power_law(&points) {
                        let ends = points.iter().map(|point| point.0);
                        found.push(Exponent {
                            study,
                            solver,
                            quantity,
                            range: (
                                ends.clone().fold(f64::INFINITY, f64::min),
                                ends.fold(0.0, f64::max),
                            ),
                            exponent,
                        });
                    }
                }
            }
        }
    }
    found
}

fn points(
    runs: &[Measured],
    study: Study,
    solver: Solver,
    quantity: Quantity,
    (least, most): (f64, f64),
) -> Vec<(f64, f64)> {
    runs.iter()
        .filter(|run| run.solver == solver && run.stopped.is_none())
        .filter_map(|run| Some((study.argument(run), quantity.of(run)?)))
        .filter(|(argument, value)| (least..=most).contains(argument) && *value > 0.0)
        .collect()
}

/// The exponent p of y = a x^p by least squares of logarithms; nothing unless there are two different x.
#[must_use]
pub fn power_law(points: &[(f64, f64)]) -> Option<f64> {
    let logarithms: Vec<(f64, f64)> = points
        .iter()
        .map(|(x, y)| (libm::log(*x), libm::log(*y)))
        .collect();
    let count = logarithms.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| logarithms.iter().map(of).sum::<f64>() / count;
    let (mean_x, mean_y) = (mean(|point| point.0), mean(|point| point.1));
    let (mut above, mut below) = (0.0, 0.0);
    for (x, y) in &logarithms {
        above += (x - mean_x) * (y - mean_y);
        below += (x - mean_x) * (x - mean_x);
    }
    (below > 0.0 && above.is_finite()).then(|| above / below)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_is_found_again() {
        let points = [1.0, 3.0, 10.0, 40.0].map(|x: f64| (x, 7.0 * x.powf(1.7)));
        let found = power_law(&points).unwrap();
        assert!((found - 1.7).abs() < 1e-12, "{found}");
    }

    #[test]
    fn one_place_has_no_power() {
        assert_eq!(power_law(&[]), None);
        assert_eq!(power_law(&[(2.0, 3.0), (2.0, 4.0)]), None);
        assert_eq!(power_law(&[(1.0, 0.0), (2.0, 4.0)]), None);
    }
}
