//! Classical Runge-Kutta of fourth order with an error estimate and step control.
//!
//! The evaluation k5 of the new state, which the next step and the record want anyway, gives an
//! embedded solution of third order with the weights 1/6, 1/3, 1/3, 1/15, 1/10; the difference is
//! `h/10 (k4 - k5)`. It checks itself like the implicit method, in metres.

use super::controlled_step::{Verdict, controlled_step};
use super::step_control::StepControl;
use super::{
    Equations, FIRST_STEP_S, Integrator, PART_OF_ACCURACY, StepFailure, Trajectory, check_state,
    combine, first_not_finite,
};

/// Order of the embedded solution, plus one.
const ERROR_ORDER: u32 = 4;

/// The method with its scratch.
#[derive(Debug)]
pub struct RungeKutta43 {
    tolerance_m: f64,
    control: StepControl,
    k: [Vec<f64>; 4],
    stage: Vec<f64>,
    trial: Vec<f64>,
}

impl RungeKutta43 {
    /// With steps chosen for positions that are right to `accuracy_m` (m) in the end, and not longer
    /// than `longest_step_s` (s); for states of `length` numbers.
    #[must_use]
    pub fn new(accuracy_m: f64, length: usize, longest_step_s: f64) -> Self {
        Self {
            tolerance_m: PART_OF_ACCURACY * accuracy_m,
            control: StepControl::new(ERROR_ORDER, FIRST_STEP_S, longest_step_s),
            k: std::array::from_fn(|_| vec![0.0; length]),
            stage: vec![0.0; length],
            trial: vec![0.0; length],
        }
    }

    /// Starts again with a step of at most `step_s` (s).
    pub fn restart(&mut self, step_s: f64) {
        self.control.begin(step_s);
    }

    /// One step to `end_s`: the new state in `trial`, its rates in the last of `k`, and its scaled error
    /// with the place in the state where that is largest.
    fn attempt(
        &mut self,
        equations: &mut dyn Equations,
        trajectory: &mut Trajectory,
        end_s: f64,
    ) -> Result<(f64, usize), StepFailure> {
        let (start_s, h) = (trajectory.time_s, end_s - trajectory.time_s);
        let [k2, k3, k4, k5] = &mut self.k;
        let (y0, k1, stage) = (&trajectory.state, &trajectory.rates, &mut self.stage);
        let evaluations = &mut trajectory.cost.evaluations;
        let mut rates = |time_s: f64, state: &[f64], k: &mut Vec<f64>| {
            *evaluations += 1;
            equations
                .rates(time_s, state, k)
                .map_err(StepFailure::Fault)
        };
        combine(stage, y0, h, &[(0.5, k1)]);
        rates(start_s + 0.5 * h, stage, k2)?;
        combine(stage, y0, h, &[(0.5, k2)]);
        rates(start_s + 0.5 * h, stage, k3)?;
        combine(stage, y0, h, &[(1.0, k3)]);
        rates(end_s, stage, k4)?;
        let (sixth, third) = (1.0 / 6.0, 1.0 / 3.0);
        let terms = [(sixth, &k1[..]), (third, k2), (third, k3), (sixth, k4)];
        combine(&mut self.trial, y0, h, &terms);
        check_state(&self.trial)?;
        rates(end_s, &self.trial, k5)?;
        if let Some(index) = first_not_finite(k5) {
            return Err(StepFailure::NotFinite { index });
        }
        for ((error, k4), k5) in stage.iter_mut().zip(k4).zip(k5) {
            *error = 0.1 * h * (*k4 - *k5);
        }
        Ok(equations.position_error(stage, self.tolerance_m))
    }
}

impl Integrator for RungeKutta43 {
    fn step(
        &mut self,
        equations: &mut dyn Equations,
        trajectory: &mut Trajectory,
        limit_s: f64,
    ) -> Result<(), StepFailure> {
        if std::mem::take(&mut trajectory.has_switched) {
            self.control.restart(FIRST_STEP_S);
        }
        trajectory.refresh(equations)?;
        let mut control = self.control;
        let outcome = controlled_step(&mut control, trajectory, limit_s, |trajectory, end_s| {
            let (error, index) = self.attempt(equations, trajectory, end_s)?;
            Ok(Verdict::Error(error, index))
        });
        self.control = control;
        trajectory.time_s = outcome?;
        trajectory.cost.steps += 1;
        std::mem::swap(&mut trajectory.state, &mut self.trial);
        std::mem::swap(&mut trajectory.rates, &mut self.k[3]);
        trajectory.accept(equations);
        Ok(())
    }

    fn resize(&mut self, scales: &[f64]) {
        for part in self.k.iter_mut().chain([&mut self.stage, &mut self.trial]) {
            part.resize(scales.len(), 0.0);
        }
    }
}
