//! The choice between an implicit and an explicit method, made anew as the motion asks for it.
//!
//! The implicit method ([`Rosenbrock`]) takes steps as long as the motion allows; the explicit one
//! ([`RungeKutta43`]) cannot pass its stable step and costs a fraction per step. The implicit one runs
//! as long as it advances further for its price. Where its steps shrink, in a burst of snaps or where
//! nothing is stiff, the explicit one takes over for a number of steps, then the implicit one is tried
//! again; what each has advanced for its price decides, counted in steps and never in time on a clock,
//! so that a run repeats itself bit by bit.

use super::rosenbrock::Rosenbrock;
use super::runge_kutta43::RungeKutta43;
use super::{Equations, Integrator, StepFailure, Trajectory};

/// What an implicit step costs in explicit ones.
const IMPLICIT_PRICE: f64 = 2.0;
/// Explicit steps as a part of the largest stable one.
const PART_OF_STABLE_STEP: f64 = 0.9;
/// Attempts over which the advance of the implicit method is judged.
const WINDOW: u64 = 8;
/// Explicit steps in a burst: at first, and at most, when bursts follow on one another.
const FIRST_BURST: u64 = 50;
const LONGEST_BURST: u64 = 1600;
/// The implicit method tries itself again with this many explicit steps in one.
const TRIAL: f64 = 4.0;

#[derive(Clone, Copy, Debug)]
enum Mode {
    /// Implicit, with the attempts and the time (s) at which the window began.
    Implicit { attempts: u64, since_s: f64 },
    /// Explicit, with the steps left in the burst, those taken in it, and the time (s) it began.
    Explicit {
        left: u64,
        attempts: u64,
        since_s: f64,
    },
}

/// The two methods and the choice between them.
#[derive(Debug)]
pub struct Automatic {
    implicit: Rosenbrock,
    explicit: RungeKutta43,
    mode: Option<Mode>,
    /// Time per attempt that the explicit method has advanced in its last burst, s.
    explicit_advance_s: f64,
    burst: u64,
}

impl Automatic {
    /// For positions that are right to `accuracy_m` (m) in the end, with no step longer than
    /// `longest_step_s` (s); for states of `length` numbers whose explicit steps are stable to
    /// `stable_step_s` (s), infinite where no tether is: then it begins explicitly.
    #[must_use]
    pub fn new(accuracy_m: f64, length: usize, longest_step_s: f64, stable_step_s: f64) -> Self {
        let explicit_step_s = longest_step_s.min(PART_OF_STABLE_STEP * stable_step_s);
        Self {
            implicit: Rosenbrock::controlled(accuracy_m, length, longest_step_s),
            explicit: RungeKutta43::new(accuracy_m, length, explicit_step_s),
            mode: None,
            explicit_advance_s: explicit_step_s,
            burst: FIRST_BURST,
        }
    }

    /// Chooses the method of the next step.
    fn choose(&mut self, trajectory: &Trajectory) -> Mode {
        let (time_s, done) = (
            trajectory.time_s,
            trajectory.cost.steps + trajectory.cost.rejected,
        );
        let implicit = Mode::Implicit {
            attempts: done,
            since_s: time_s,
        };
        match self.mode {
            // Without a tether the first burst shows what the explicit method is worth.
            None if self.explicit_advance_s.is_infinite() => Mode::Explicit {
                left: FIRST_BURST,
                attempts: done,
                since_s: time_s,
            },
            None => implicit,
            Some(Mode::Implicit { attempts, since_s }) if done - attempts >= WINDOW => {
                let advance_s = (time_s - since_s) / (done - attempts) as f64;
                if advance_s > IMPLICIT_PRICE * self.explicit_advance_s {
                    self.burst = FIRST_BURST;
                    return implicit;
                }
                self.explicit.restart(self.explicit_advance_s);
                let left = self.burst;
                self.burst = (2 * self.burst).min(LONGEST_BURST);
                Mode::Explicit {
                    left,
                    attempts: done,
                    since_s: time_s,
                }
            }
            Some(Mode::Explicit {
                left: 0,
                attempts,
                since_s,
            }) => {
                self.explicit_advance_s = (time_s - since_s) / (done - attempts).max(1) as f64;
                self.implicit.restart(TRIAL * self.explicit_advance_s);
                implicit
            }
            Some(mode) => mode,
        }
    }
}

impl Integrator for Automatic {
    fn step(
        &mut self,
        equations: &mut dyn Equations,
        trajectory: &mut Trajectory,
        limit_s: f64,
    ) -> Result<(), StepFailure> {
        let mode = self.choose(trajectory);
        match mode {
            Mode::Implicit { .. } => {
                self.mode = Some(mode);
                self.implicit.step(equations, trajectory, limit_s)
            }
            Mode::Explicit {
                left,
                attempts,
                since_s,
            } => {
                self.mode = Some(Mode::Explicit {
                    left: left - 1,
                    attempts,
                    since_s,
                });
                self.explicit.step(equations, trajectory, limit_s)
            }
        }
    }

    fn resize(&mut self, scales: &[f64]) {
        self.implicit.resize(scales);
        self.explicit.resize(scales);
    }
}
