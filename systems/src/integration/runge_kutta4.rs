//! The classical Runge-Kutta method of fourth order with a fixed step (Kutta 1901):
//! y1 = y0 + h/6 (k1 + 2 k2 + 2 k3 + k4).
//!
//! Between two instants that no step may cross the step is shortened a little so that whole steps
//! fill the interval.

use super::{
    Equations, Integrator, StepFailure, Trajectory, check_state, combine, first_not_finite,
};

/// Fixed-step RK4.
#[derive(Debug)]
pub struct RungeKutta4 {
    step_s: f64,
    k: [Vec<f64>; 3],
    stage: Vec<f64>,
}

impl RungeKutta4 {
    /// With steps of at most `step_s` (s).
    #[must_use]
    pub fn new(step_s: f64) -> Self {
        Self {
            step_s,
            k: Default::default(),
            stage: Vec::new(),
        }
    }
}

impl Integrator for RungeKutta4 {
    fn step(
        &mut self,
        equations: &mut dyn Equations,
        trajectory: &mut Trajectory,
        limit_s: f64,
    ) -> Result<(), StepFailure> {
        trajectory.refresh(equations)?;
        let length = trajectory.state.len();
        self.stage.resize(length, 0.0);
        for k in &mut self.k {
            k.resize(length, 0.0);
        }
        let (start_s, remaining) = (trajectory.time_s, limit_s - trajectory.time_s);
        let count = (remaining / self.step_s - 1e-9).ceil().max(1.0);
        let h = remaining / count;
        let end_s = if count == 1.0 { limit_s } else { start_s + h };

        let [k2, k3, k4] = &mut self.k;
        let (y0, k1, stage) = (&trajectory.state, &trajectory.rates, &mut self.stage);
        combine(stage, y0, h, &[(0.5, k1)]);
        equations
            .rates(start_s + 0.5 * h, stage, k2)
            .map_err(StepFailure::Fault)?;
        combine(stage, y0, h, &[(0.5, k2)]);
        equations
            .rates(start_s + 0.5 * h, stage, k3)
            .map_err(StepFailure::Fault)?;
        combine(stage, y0, h, &[(1.0, k3)]);
        equations
            .rates(end_s, stage, k4)
            .map_err(StepFailure::Fault)?;
        let (sixth, third) = (1.0 / 6.0, 1.0 / 3.0);
        combine(
            stage,
            y0,
            h,
            &[(sixth, k1), (third, k2), (third, k3), (sixth, k4)],
        );
        check_state(stage)?;
        // A state that cannot be evaluated is not taken.
        equations
            .rates(end_s, stage, k2)
            .map_err(StepFailure::Fault)?;
        if let Some(index) = first_not_finite(k2) {
            return Err(StepFailure::NotFinite { index });
        }
        std::mem::swap(&mut trajectory.state, stage);
        std::mem::swap(&mut trajectory.rates, k2);
        trajectory.time_s = end_s;
        trajectory.cost.steps += 1;
        trajectory.cost.evaluations += 4;
        trajectory.accept(equations);
        Ok(())
    }

    fn resize(&mut self, _: &[f64]) {
        // Every step asks for the length of the state.
    }
}
