//! The embedded Runge-Kutta pair of Dormand and Prince, order 5(4), with step control.
//!
//! Seven stages, the last of which is the evaluation of the accepted state (first same as last);
//! tableau from Dormand and Prince (1980), J. Comput. Appl. Math. 6, 19-26; Hairer, Norsett and
//! Wanner (1993), table II.5.2. The error of a step is the largest over the state of
//! |e_i| / (tolerance max(s_i, |y_i|)): s_i = 1 m, 1 m/s, 1 rad or 1 rad/s, and y_i counts
//! displacement from the start, never the altitude.

use super::controlled_step::{Verdict, controlled_step};
use super::step_control::StepControl;
use super::{
    Equations, Integrator, StepFailure, Trajectory, check_state, combine, first_not_finite,
};

const C: [f64; 5] = [1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0];
const A2: [f64; 1] = [1.0 / 5.0];
const A3: [f64; 2] = [3.0 / 40.0, 9.0 / 40.0];
const A4: [f64; 3] = [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0];
const A5: [f64; 4] = [
    19372.0 / 6561.0,
    -25360.0 / 2187.0,
    64448.0 / 6561.0,
    -212.0 / 729.0,
];
const A6: [f64; 5] = [
    9017.0 / 3168.0,
    -355.0 / 33.0,
    46732.0 / 5247.0,
    49.0 / 176.0,
    -5103.0 / 18656.0,
];
/// Weights of the solution of order 5; that of the second stage is zero.
const B: [f64; 6] = [
    35.0 / 384.0,
    0.0,
    500.0 / 1113.0,
    125.0 / 192.0,
    -2187.0 / 6784.0,
    11.0 / 84.0,
];
/// Weights of the difference from the solution of order 4.
const E: [f64; 7] = [
    71.0 / 57600.0,
    0.0,
    -71.0 / 16695.0,
    71.0 / 1920.0,
    -17253.0 / 339200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];

/// Adaptive Dormand-Prince 5(4).
#[derive(Debug)]
pub struct DormandPrince {
    tolerance: f64,
    scales: Vec<f64>,
    control: StepControl,
    k: [Vec<f64>; 6],
    stage: Vec<f64>,
    trial: Vec<f64>,
}

impl DormandPrince {
    /// With a tolerance relative to `scales` (one for each part of the state), a first step and a
    /// longest step in s.
    #[must_use]
    pub fn new(tolerance: f64, scales: Vec<f64>, first_step_s: f64, longest_step_s: f64) -> Self {
        let length = scales.len();
        Self {
            tolerance,
            scales,
            control: StepControl::new(5, first_step_s, longest_step_s),
            k: std::array::from_fn(|_| vec![0.0; length]),
            stage: vec![0.0; length],
            trial: vec![0.0; length],
        }
    }

    /// Tries a step to `end_s` and leaves the result in `trial`, its rates in the last of `k`; returns
    /// the scaled error and the place of its largest part.
    fn attempt(
        &mut self,
        equations: &mut dyn Equations,
        trajectory: &mut Trajectory,
        end_s: f64,
    ) -> Result<(f64, usize), StepFailure> {
        let (t, h) = (trajectory.time_s, end_s - trajectory.time_s);
        let (y0, k1) = (&trajectory.state, &trajectory.rates);
        let [k2, k3, k4, k5, k6, k7] = &mut self.k;
        let stage = &mut self.stage;
        let mut evaluations = 0;
        let mut evaluate = |c: f64, stage: &[f64], k: &mut Vec<f64>| {
            evaluations += 1;
            let time = if c == 1.0 { end_s } else { t + c * h };
            equations.rates(time, stage, k).map_err(StepFailure::Fault)
        };
        let mut stages = || -> Result<(), StepFailure> {
            combine(stage, y0, h, &[(A2[0], k1)]);
            evaluate(C[0], stage, k2)?;
            combine(stage, y0, h, &[(A3[0], k1), (A3[1], k2)]);
            evaluate(C[1], stage, k3)?;
            combine(stage, y0, h, &[(A4[0], k1), (A4[1], k2), (A4[2], k3)]);
            evaluate(C[2], stage, k4)?;
            combine(
                stage,
                y0,
                h,
                &[(A5[0], k1), (A5[1], k2), (A5[2], k3), (A5[3], k4)],
            );
            evaluate(C[3], stage, k5)?;
            let terms = [
                (A6[0], &k1[..]),
                (A6[1], k2),
                (A6[2], k3),
                (A6[3], k4),
                (A6[4], k5),
            ];
            combine(stage, y0, h, &terms);
            evaluate(C[4], stage, k6)?;
            let terms = [
                (B[0], &k1[..]),
                (B[2], k3),
                (B[3], k4),
                (B[4], k5),
                (B[5], k6),
            ];
            combine(&mut self.trial, y0, h, &terms);
            evaluate(1.0, &self.trial, k7)
        };
        let outcome = stages();
        trajectory.cost.evaluations += evaluations;
        outcome?;
        check_state(&self.trial)?;
        if let Some(index) = first_not_finite(k7) {
            return Err(StepFailure::NotFinite { index });
        }
        let mut largest = (0.0, 0);
        for i in 0..y0.len() {
            let error = E[0] * k1[i]
                + E[2] * k3[i]
                + E[3] * k4[i]
                + E[4] * k5[i]
                + E[5] * k6[i]
                + E[6] * k7[i];
            let scale = self.scales[i].max(y0[i].abs()).max(self.trial[i].abs());
            let scaled = (h * error).abs() / (self.tolerance * scale);
            if scaled > largest.0 {
                largest = (scaled, i);
            }
        }
        Ok(largest)
    }
}

impl Integrator for DormandPrince {
    fn step(
        &mut self,
        equations: &mut dyn Equations,
        trajectory: &mut Trajectory,
        limit_s: f64,
    ) -> Result<(), StepFailure> {
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
        std::mem::swap(&mut trajectory.rates, &mut self.k[5]);
        trajectory.accept(equations);
        Ok(())
    }

    fn resize(&mut self, scales: &[f64]) {
        self.scales = scales.to_vec();
        for part in self.k.iter_mut().chain([&mut self.stage, &mut self.trial]) {
            part.resize(scales.len(), 0.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The order conditions of the tableau up to order 5 that involve quadrature: sum b c^(q-1) = 1/q.
    #[test]
    fn the_tableau_integrates_powers() {
        let c = [0.0, C[0], C[1], C[2], C[3], C[4]];
        for q in 1..=5 {
            let sum: f64 = B.iter().zip(c).map(|(b, c)| b * c.powi(q - 1)).sum();
            assert!((sum - 1.0 / f64::from(q)).abs() < 1e-14, "{q}: {sum}");
        }
        for (row, c) in [&A2[..], &A3, &A4, &A5, &A6].into_iter().zip(C) {
            assert!((row.iter().sum::<f64>() - c).abs() < 1e-14);
        }
        assert!(E.iter().sum::<f64>().abs() < 1e-16);
    }
}
