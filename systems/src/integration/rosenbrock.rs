//! ROS34PW2, a linearly implicit method for stiff motion: four stages, order 3, embedded order 2,
//! L-stable and stiffly accurate; the order holds with an inexact Jacobian (a W-method), so that
//! whatever is not stiff need not supply derivatives (Rang and Angermann 2005, BIT 45, 761-787).
//!
//! For y' = f(t, y), with a matrix A near df/dy and g = gamma h (Hairer and Wanner 1996, IV.7):
//!
//! ```text
//! (I/g - A) u_i = f(t + alpha_i h, y + sum_j a_ij u_j) + sum_j c_ij u_j / h
//! y_1 = y + sum m_i u_i      error = sum (m_i - m^_i) u_i
//! a = alpha Gamma^-1         c = I/gamma - Gamma^-1         m = b Gamma^-1
//! ```
//!
//! The equations of motion solve this for velocities alone ([`crate::linearised_motion`]).
//!
//! A step is accepted when its error is (in metres and in the strain of tethers), and, where a tether is
//! slack, when the mechanical energy has not risen by more than the work done and a thousandth of the
//! kinetic energy: no method is stable in energy from slack to taut by itself.

use super::controlled_step::{Verdict, controlled_step};
use super::ros34pw2::{GAMMA, STAGES, Tableau};
use super::step_control::StepControl;
use super::{
    Equations, FIRST_STEP_S, Integrator, MechanicalEnergy, PART_OF_ACCURACY, StepFailure,
    Trajectory, check_state, first_not_finite,
};

/// Order of the embedded solution, plus one.
const ERROR_ORDER: u32 = 3;
/// In steps up to this, s, the error of each counts, for in fast motion errors of either sign cancel; in
/// longer ones, of a motion that creeps, they add up, and the error per this time counts.
const PER_STEP_UP_TO_S: f64 = 0.5;
/// From this accuracy on, m, all of the strain error that keeps a line sound is allowed.
const WHOLE_STRAIN_FROM_M: f64 = 0.01;
/// Part of the kinetic energy that may come from nowhere in one step.
const ENERGY_GAIN: f64 = 1e-3;
/// After a step that gained energy, the next is this part of it.
const AFTER_GAIN: f64 = 0.5;

/// How the step is chosen.
#[derive(Clone, Copy, Debug)]
enum Steps {
    /// By the error: the tolerance, m, and the control.
    Controlled(f64, StepControl),
    /// Whole steps of at most this, s.
    Fixed(f64),
}

/// The method with its scratch.
#[derive(Debug)]
pub struct Rosenbrock {
    tableau: Tableau,
    steps: Steps,
    u: [Vec<f64>; STAGES],
    stage: Vec<f64>,
    error: Vec<f64>,
    increment: Vec<f64>,
    trial: Vec<f64>,
    rates: Vec<f64>,
}

impl Rosenbrock {
    /// With steps chosen for positions that are right to `accuracy_m` (m) in the end, and not longer
    /// than `longest_step_s` (s); for states of `length` numbers.
    #[must_use]
    pub fn controlled(accuracy_m: f64, length: usize, longest_step_s: f64) -> Self {
        let control = StepControl::new(ERROR_ORDER, FIRST_STEP_S, longest_step_s);
        Self::new(
            Steps::Controlled(PART_OF_ACCURACY * accuracy_m, control),
            length,
        )
    }

    /// With steps of `step_s` (s), whatever their error.
    #[must_use]
    pub fn fixed(step_s: f64, length: usize) -> Self {
        Self::new(Steps::Fixed(step_s), length)
    }

    fn new(steps: Steps, length: usize) -> Self {
        Self {
            tableau: Tableau::new(),
            steps,
            u: std::array::from_fn(|_| vec![0.0; length]),
            stage: vec![0.0; length],
            error: vec![0.0; length],
            increment: vec![0.0; length],
            trial: vec![0.0; length],
            rates: vec![0.0; length],
        }
    }

    /// Starts again with a step of `step_s` (s).
    pub fn restart(&mut self, step_s: f64) {
        if let Steps::Controlled(_, control) = &mut self.steps {
            control.begin(step_s);
        }
    }

    /// One step from the trajectory to `end_s`: the stages, the new state in `trial`, its estimated
    /// error in `error`.
    fn attempt(
        &mut self,
        equations: &mut dyn Equations,
        trajectory: &mut Trajectory,
        end_s: f64,
    ) -> Result<(), StepFailure> {
        let h = end_s - trajectory.time_s;
        equations
            .factorise(h, GAMMA)
            .map_err(|index| StepFailure::NotSolvable { index })?;
        let Tableau { a, c, alpha, .. } = &self.tableau;
        for i in 0..STAGES {
            let (done, rest) = self.u.split_at_mut(i);
            let u = &mut rest[0];
            if i == 0 {
                u.copy_from_slice(&trajectory.rates);
            } else {
                add_all(&mut self.stage, &trajectory.state, &a[i], done);
                let time_s = if alpha[i] == 1.0 {
                    end_s
                } else {
                    trajectory.time_s + alpha[i] * h
                };
                trajectory.cost.evaluations += 1;
                equations
                    .rates(time_s, &self.stage, &mut self.rates)
                    .map_err(StepFailure::Fault)?;
                let over_step = c[i].map(|c| c / h);
                add_all(u, &self.rates, &over_step, done);
            }
            equations.solve(u);
        }
        self.finish(&trajectory.state);
        check_state(&self.trial)
    }

    /// The new state and its error from the stages.
    fn finish(&mut self, start: &[f64]) {
        let Tableau { m, e, .. } = &self.tableau;
        let [u1, u2, u3, u4] = &self.u;
        let stages = u1.iter().zip(u2).zip(u3.iter().zip(u4));
        let out = self.trial.iter_mut().zip(&mut self.increment);
        let out = out.zip(&mut self.error).zip(start);
        for ((((trial, increment), error), start), ((u1, u2), (u3, u4))) in out.zip(stages) {
            *increment = m[0] * u1 + m[1] * u2 + m[2] * u3 + m[3] * u4;
            *trial = start + *increment;
            *error = e[0] * u1 + e[1] * u2 + e[2] * u3 + e[3] * u4;
        }
    }

    /// Evaluates the new state, which the next step and the record want.
    fn evaluate_trial(
        &mut self,
        equations: &mut dyn Equations,
        trajectory: &mut Trajectory,
        end_s: f64,
    ) -> Result<(), StepFailure> {
        trajectory.cost.evaluations += 1;
        equations
            .rates(end_s, &self.trial, &mut self.rates)
            .map_err(StepFailure::Fault)?;
        match first_not_finite(&self.rates) {
            Some(index) => Err(StepFailure::NotFinite { index }),
            None => Ok(()),
        }
    }

    /// Says whether the step that was tried may be taken, with its state evaluated if so; `start` is the
    /// energy before it, where that must not grow.
    fn judge(
        &mut self,
        equations: &mut dyn Equations,
        trajectory: &mut Trajectory,
        tolerance_m: f64,
        start: Option<MechanicalEnergy>,
        end_s: f64,
    ) -> Result<Verdict, StepFailure> {
        let h = end_s - trajectory.time_s;
        let per_time_m = tolerance_m * (PER_STEP_UP_TO_S / h).min(1.0);
        let mut largest = equations.position_error(&self.error, per_time_m);
        let strain = equations.strain_error(&self.error, &self.increment);
        let strain = (strain.0 / strain_allowance(tolerance_m), strain.1);
        if strain.0 > largest.0 {
            largest = strain;
        }
        let (error, index) = largest;
        // What is not accurate is not worth an evaluation.
        if error.is_nan() || error > 1.0 {
            return Ok(Verdict::Error(error, index));
        }
        self.evaluate_trial(equations, trajectory, end_s)?;
        if start.is_some_and(|start| start.gains(&equations.energy(), h)) {
            return Ok(Verdict::TooLong(AFTER_GAIN, index));
        }
        Ok(Verdict::Error(error, index))
    }

    fn take(&mut self, equations: &mut dyn Equations, trajectory: &mut Trajectory, end_s: f64) {
        std::mem::swap(&mut trajectory.state, &mut self.trial);
        std::mem::swap(&mut trajectory.rates, &mut self.rates);
        trajectory.time_s = end_s;
        trajectory.cost.steps += 1;
        trajectory.cost.implicit_steps += 1;
        trajectory.accept(equations);
    }

    fn step_fixed(
        &mut self,
        equations: &mut dyn Equations,
        trajectory: &mut Trajectory,
        step_s: f64,
        limit_s: f64,
    ) -> Result<(), StepFailure> {
        let remaining = limit_s - trajectory.time_s;
        let count = (remaining / step_s - 1e-9).ceil().max(1.0);
        let end_s = if count == 1.0 {
            limit_s
        } else {
            trajectory.time_s + remaining / count
        };
        self.attempt(equations, trajectory, end_s)?;
        self.evaluate_trial(equations, trajectory, end_s)?;
        self.take(equations, trajectory, end_s);
        Ok(())
    }

    fn step_controlled(
        &mut self,
        equations: &mut dyn Equations,
        trajectory: &mut Trajectory,
        tolerance_m: f64,
        control: &mut StepControl,
        limit_s: f64,
    ) -> Result<(), StepFailure> {
        let start = equations.has_slack().then(|| equations.energy());
        let outcome = controlled_step(control, trajectory, limit_s, |trajectory, end_s| {
            self.attempt(equations, trajectory, end_s)?;
            self.judge(equations, trajectory, tolerance_m, start, end_s)
        });
        self.take(equations, trajectory, outcome?);
        Ok(())
    }
}

/// Part of the allowed strain error at this tolerance of positions (m): all of it from an accuracy of 1 cm
/// on, less below, so that a tighter accuracy is had of the stiffest line too.
fn strain_allowance(tolerance_m: f64) -> f64 {
    let ratio = tolerance_m / (PART_OF_ACCURACY * WHOLE_STRAIN_FROM_M);
    libm::cbrt(ratio * ratio).min(1.0)
}

impl MechanicalEnergy {
    /// Whether `end`, a step of `h` (s) later, has more energy than what was done in work allows.
    fn gains(&self, end: &Self, h: f64) -> bool {
        let work = 0.5 * h * (self.power_w + end.power_w);
        let round_off = 1e-12 * self.energy_j.abs().max(end.energy_j.abs());
        let kinetic = self.kinetic_j.max(end.kinetic_j);
        end.energy_j - self.energy_j > work + ENERGY_GAIN * kinetic + round_off
    }
}

impl Integrator for Rosenbrock {
    fn step(
        &mut self,
        equations: &mut dyn Equations,
        trajectory: &mut Trajectory,
        limit_s: f64,
    ) -> Result<(), StepFailure> {
        let switched = std::mem::take(&mut trajectory.has_switched);
        trajectory.refresh(equations)?;
        equations.linearise();
        match self.steps {
            Steps::Fixed(step_s) => self.step_fixed(equations, trajectory, step_s, limit_s),
            Steps::Controlled(tolerance_m, mut control) => {
                if switched {
                    control.restart(FIRST_STEP_S);
                }
                let outcome =
                    self.step_controlled(equations, trajectory, tolerance_m, &mut control, limit_s);
                self.steps = Steps::Controlled(tolerance_m, control);
                outcome
            }
        }
    }

    fn resize(&mut self, scales: &[f64]) {
        let scratch = [
            &mut self.stage,
            &mut self.error,
            &mut self.increment,
            &mut self.trial,
            &mut self.rates,
        ];
        for part in self.u.iter_mut().chain(scratch) {
            part.resize(scales.len(), 0.0);
        }
    }
}

/// `start + sum_j factors_j u_j`, element by element, into `out`.
fn add_all(out: &mut [f64], start: &[f64], factors: &[f64; STAGES], u: &[Vec<f64>]) {
    let out = out.iter_mut().zip(start);
    match u {
        [u1] => {
            for ((out, start), u1) in out.zip(u1) {
                *out = start + factors[0] * u1;
            }
        }
        [u1, u2] => {
            for ((out, start), (u1, u2)) in out.zip(u1.iter().zip(u2)) {
                *out = start + (factors[0] * u1 + factors[1] * u2);
            }
        }
        [u1, u2, u3] => {
            for ((out, start), ((u1, u2), u3)) in out.zip(u1.iter().zip(u2).zip(u3)) {
                *out = start + (factors[0] * u1 + factors[1] * u2 + factors[2] * u3);
            }
        }
        _ => {}
    }
}
