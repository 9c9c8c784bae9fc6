//! The four ways to solve: two formulations, explicit and implicit.

use aerobot_components::run::Formulation;

use super::PerformanceSettings;

/// Whether a step asks for the solution of linear equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Dormand-Prince 5(4): the paper names no integrator, and this pair (`ode45`, `RK45`) is what
    /// programs have where nothing else is asked for.
    Explicit,
    /// ROS34PW2.
    Implicit,
}

impl Method {
    /// The name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Explicit => "explicit",
            Self::Implicit => "implicit",
        }
    }
}

/// A formulation and how it is integrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Solver {
    /// The equations.
    pub formulation: Formulation,
    /// Their integration.
    pub method: Method,
}

/// All four, lumped masses first.
pub const SOLVERS: [Solver; 4] = [
    Solver::new(Formulation::LumpedMass, Method::Explicit),
    Solver::new(Formulation::LumpedMass, Method::Implicit),
    Solver::new(Formulation::Denoc, Method::Explicit),
    Solver::new(Formulation::Denoc, Method::Implicit),
];

impl Solver {
    const fn new(formulation: Formulation, method: Method) -> Self {
        Self {
            formulation,
            method,
        }
    }

    /// The name in texts.
    #[must_use]
    pub fn name(self) -> String {
        let formulation = match self.formulation {
            Formulation::LumpedMass => "lumped",
            Formulation::Denoc => "DeNOC",
        };
        format!("{formulation} {}", self.method.name())
    }

    /// What the paper says of the formulation: cost against elements, and against length.
    pub(super) fn claim(self) -> (&'static str, &'static str) {
        match self.formulation {
            Formulation::LumpedMass => ("O(n^3)", "strongly dependent"),
            Formulation::Denoc => ("O(n)", "independent"),
        }
    }

    /// As overrides of a scene.
    pub(super) fn overrides(self, settings: &PerformanceSettings) -> [String; 2] {
        let formulation = match self.formulation {
            Formulation::LumpedMass => "LumpedMass",
            Formulation::Denoc => "Denoc",
        };
        let integrator = match self.method {
            Method::Explicit => {
                let tolerance = settings.relative_tolerance;
                format!("Adaptive(relative_tolerance: {tolerance:?})")
            }
            Method::Implicit => format!("Implicit(accuracy_m: {:?})", settings.accuracy_m),
        };
        [
            format!("run.formulation={formulation}"),
            format!("run.integrator={integrator}"),
        ]
    }
}
