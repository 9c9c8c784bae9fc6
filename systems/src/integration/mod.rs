//! Integrators, written against [`Equations`]: a state goes in, rates come out; an implicit method also
//! asks them to solve for its stages.

pub mod automatic;
mod controlled_step;
pub mod dormand_prince;
mod ros34pw2;
pub mod rosenbrock;
pub mod runge_kutta4;
pub mod runge_kutta43;
pub mod stability;
pub mod stable_step;
pub mod step_control;
pub mod torsional_modes;

use crate::fault::Fault;

/// How an accepted state was corrected to meet constraints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Correction {
    /// Not at all.
    None,
    /// By so little that its rates hold for the next step; what else its evaluation has found is to be found anew
    /// before it is looked at.
    Slight,
    /// So that it has to be evaluated anew.
    Large,
}

/// Ordinary differential equations y' = f(t, y) of a state as
/// [`StateVector`](crate::dynamics::state_vector) lays it out.
pub trait Equations {
    /// Writes the rates of `state` at `time_s`.
    ///
    /// # Errors
    /// The fault that makes the state meaningless.
    fn rates(&mut self, time_s: f64, state: &[f64], rates: &mut [f64]) -> Result<(), Fault>;

    /// Called once for every accepted state, whose evaluation was the last one: attitudes are taken
    /// as the new centres of their charts, in `state` and in `rates`, and the state is made to meet
    /// constraints.
    fn accept(&mut self, state: &mut [f64], rates: &mut [f64]) -> Correction;

    /// Linearises the motion about the accepted state, whose evaluation was the last one.
    fn linearise(&mut self);

    /// Prepares solutions for a step of `step_s` (s) of a method with this `gamma`.
    ///
    /// # Errors
    /// The place in the state where the step is too long to be solved for.
    fn factorise(&mut self, step_s: f64, gamma: f64) -> Result<(), usize>;

    /// Solves `(I/g - A) u = r`, g = gamma x step, A the linearised motion: `r` becomes `u`.
    fn solve(&mut self, r: &mut [f64]);

    /// How large the error `error` of a state is: 1 is an error of `tolerance_m` (m) in a position, or
    /// what weighs as much in a first-order state. With the place in the state where it is largest.
    fn position_error(&mut self, error: &[f64], tolerance_m: f64) -> (f64, usize);

    /// The same for the strain of tethers, for a step by `increment` from where the motion was linearised
    /// last.
    fn strain_error(&mut self, error: &[f64], increment: &[f64]) -> (f64, usize);

    /// Whether a tether was slack where the motion was linearised last.
    fn has_slack(&self) -> bool;

    /// The mechanical energy of the state that was evaluated last.
    fn energy(&mut self) -> MechanicalEnergy;
}

/// The mechanical energy of a state, and what changes it from outside.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MechanicalEnergy {
    /// Kinetic and potential energy, J.
    pub energy_j: f64,
    /// Kinetic energy alone, J.
    pub kinetic_j: f64,
    /// Power of the forces that are not in the energy, W; without that of the tethers' dampers, which
    /// can only take.
    pub power_w: f64,
}

/// A state on its way through time.
#[derive(Clone, Debug, Default)]
pub struct Trajectory {
    /// Time, s.
    pub time_s: f64,
    /// The state.
    pub state: Vec<f64>,
    /// Its rates, valid while `rates_are_current`.
    pub rates: Vec<f64>,
    /// Whether `rates` belong to `state`; something that switches at `time_s` makes them stale.
    pub rates_are_current: bool,
    /// Whether the last evaluation was of `state` itself, before any correction.
    pub is_seen_as_it_is: bool,
    /// Whether something has switched at `time_s`, so that the next step must not trust the last; the
    /// integrator clears it.
    pub has_switched: bool,
    /// What the run has cost so far.
    pub cost: Cost,
}

/// What an integration has cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Accepted steps.
    pub steps: u64,
    /// Those of them that were implicit.
    pub implicit_steps: u64,
    /// Rejected steps.
    pub rejected: u64,
    /// Evaluations of the rates.
    pub evaluations: u64,
}

impl Trajectory {
    /// A trajectory that starts from `state` at `time_s`.
    #[must_use]
    pub fn new(time_s: f64, state: Vec<f64>) -> Self {
        let rates = vec![0.0; state.len()];
        Self {
            time_s,
            state,
            rates,
            rates_are_current: false,
            is_seen_as_it_is: false,
            has_switched: true,
            cost: Cost::default(),
        }
    }

    /// Notes that something has switched at the present.
    pub fn switch(&mut self) {
        self.rates_are_current = false;
        self.has_switched = true;
    }

    /// Tells the equations that the state, whose evaluation was the last one, is accepted.
    fn accept(&mut self, equations: &mut dyn Equations) {
        let correction = equations.accept(&mut self.state, &mut self.rates);
        self.rates_are_current &= correction != Correction::Large;
        self.is_seen_as_it_is = correction == Correction::None;
    }

    /// Evaluates the current state unless it was, so that everything that was found belongs to it.
    ///
    /// # Errors
    /// As [`Equations::rates`].
    pub fn look(&mut self, equations: &mut dyn Equations) -> Result<(), StepFailure> {
        self.rates_are_current &= self.is_seen_as_it_is;
        self.refresh(equations)
    }

    /// Evaluates the rates of the current state unless they are known.
    ///
    /// # Errors
    /// As [`Equations::rates`].
    pub fn refresh(&mut self, equations: &mut dyn Equations) -> Result<(), StepFailure> {
        if !self.rates_are_current {
            self.cost.evaluations += 1;
            equations
                .rates(self.time_s, &self.state, &mut self.rates)
                .map_err(StepFailure::Fault)?;
            if let Some(index) = first_not_finite(&self.rates) {
                return Err(StepFailure::NotFinite { index });
            }
            self.rates_are_current = true;
            self.is_seen_as_it_is = true;
        }
        Ok(())
    }
}

/// A method that advances a trajectory step by step.
pub trait Integrator: Send {
    /// Takes one accepted step that ends at or before `limit_s`; on success the last evaluation was
    /// that of the accepted state.
    ///
    /// # Errors
    /// Why no step could be taken; the trajectory still holds the last accepted state.
    fn step(
        &mut self,
        equations: &mut dyn Equations,
        trajectory: &mut Trajectory,
        limit_s: f64,
    ) -> Result<(), StepFailure>;

    /// Goes on with a state of other parts, of which these are the scales of errors; what is known of step
    /// sizes is kept.
    fn resize(&mut self, scales: &[f64]);
}

/// Why a step could not be taken.
#[derive(Clone, Debug, PartialEq)]
pub enum StepFailure {
    /// The state, or one it led to, could not be evaluated.
    Fault(Fault),
    /// A number of the state or of its rates is not finite.
    NotFinite {
        /// Its place in the state.
        index: usize,
    },
    /// The motion has left all bounds.
    Runaway {
        /// Its place in the state.
        index: usize,
        /// Its value, m, rad, m/s or rad/s.
        value: f64,
    },
    /// What an implicit step asks for cannot be solved.
    NotSolvable {
        /// Its place in the state.
        index: usize,
    },
    /// The error asks for a step below round-off.
    StepTooSmall {
        /// The step, s.
        step_s: f64,
        /// Place in the state of the largest error.
        index: usize,
    },
}

/// Under an accuracy in metres the first step after something has switched is at most this, s.
const FIRST_STEP_S: f64 = 0.01;

/// The tolerance of a step is this part of the accuracy that is wanted in the end: errors add up.
const PART_OF_ACCURACY: f64 = 0.25;

/// No displacement in m and no speed in m/s of a balloon flight comes near this.
pub const RUNAWAY: f64 = 1e8;

/// Index of the first value that is not finite.
#[must_use]
pub fn first_not_finite(values: &[f64]) -> Option<usize> {
    // The sum is finite if all are; it costs far less than asking each.
    if values.iter().map(|value| value * 0.0).sum::<f64>() == 0.0 {
        return None;
    }
    values.iter().position(|value| !value.is_finite())
}

/// Checks an accepted state.
fn check_state(state: &[f64]) -> Result<(), StepFailure> {
    if let Some(index) = first_not_finite(state) {
        return Err(StepFailure::NotFinite { index });
    }
    match state.iter().position(|value| value.abs() > RUNAWAY) {
        Some(index) => Err(StepFailure::Runaway {
            index,
            value: state[index],
        }),
        None => Ok(()),
    }
}

/// `a + h * sum(c_i k_i)`, element by element, into `out`.
fn combine(out: &mut [f64], start: &[f64], step: f64, terms: &[(f64, &[f64])]) {
    match terms {
        [(c, k)] => {
            let c = step * c;
            for ((out, a), k) in out.iter_mut().zip(start).zip(*k) {
                *out = a + c * k;
            }
        }
        _ => {
            out.copy_from_slice(start);
            for (c, k) in terms {
                let c = step * c;
                for (out, k) in out.iter_mut().zip(*k) {
                    *out += c * k;
                }
            }
        }
    }
}
