//! Step control by a proportional-integral rule (Gustafsson 1991; Hairer and Wanner 1996, IV.2):
//! h' = h s err^(-0.7/q) err_previous^(0.4/q), with the safety s = 0.93 (in steady motion the
//! error then stays at half the tolerance), the factor within 0.2 and 4, and no growth after a rejection;
//! q is the order of the error estimate plus one.

const SAFETY: f64 = 0.93;
const SMALLEST_FACTOR: f64 = 0.2;
const LARGEST_FACTOR: f64 = 4.0;
/// A step may be longer than was asked for by this part of itself, if then a whole number reaches a limit.
const STRETCH: f64 = 0.1;
/// An error below this says no more of the next than this does: growth after a small step is not held up.
const LEAST_PREVIOUS_ERROR: f64 = 0.1;
/// A limit within this many steps is reached in equal ones.
const FEW_STEPS: f64 = 4.0;
/// Steps are not cut below this part of the time (or of a second).
const ROUND_OFF: f64 = 1e-14;

/// Proposes steps and judges their errors.
#[derive(Clone, Copy, Debug)]
pub struct StepControl {
    order: f64,
    step_s: f64,
    longest_s: f64,
    previous_error: f64,
    after_rejection: bool,
}

impl StepControl {
    /// For a pair whose lower order plus one is `order`, with a first and a longest step in s.
    #[must_use]
    pub fn new(order: u32, first_step_s: f64, longest_s: f64) -> Self {
        Self {
            order: f64::from(order),
            step_s: first_step_s.min(longest_s),
            longest_s,
            previous_error: 1.0,
            after_rejection: false,
        }
    }

    /// The next step from `time_s`, s, and whether it ends on `limit_s`.
    ///
    /// A limit within a few steps is reached in equal ones, so that no sliver remains and none is longer
    /// than need be.
    #[must_use]
    pub fn propose(&self, time_s: f64, limit_s: f64) -> (f64, bool) {
        let remaining = limit_s - time_s;
        let stretch = if self.after_rejection { 1e-9 } else { STRETCH };
        // The longest step is a bound, and is not stretched.
        let fewest = (remaining / self.longest_s - 1e-9).ceil();
        let count = (remaining / self.step_s - stretch).ceil().max(fewest);
        if count <= 1.0 {
            (remaining, true)
        } else if count <= FEW_STEPS {
            (remaining / count, false)
        } else {
            (self.step_s, false)
        }
    }

    /// Judges a step of `h` with the scaled error `error` (1 is the tolerance) and sets the next;
    /// `cut` says that a limit, not the error, chose the step.
    pub fn accepts(&mut self, h: f64, error: f64, cut: bool) -> bool {
        // A perfect step must not make the next proposal infinite, and what is not a number is not good.
        let error = if error.is_nan() {
            f64::INFINITY
        } else {
            error.max(1e-10)
        };
        if error > 1.0 {
            let factor = SAFETY * libm::pow(error, -1.0 / self.order);
            self.step_s = h * factor.max(SMALLEST_FACTOR);
            self.after_rejection = true;
            return false;
        }
        let factor = SAFETY
            * libm::pow(error, -0.7 / self.order)
            * libm::pow(self.previous_error, 0.4 / self.order);
        let most = if self.after_rejection {
            1.0
        } else {
            LARGEST_FACTOR
        };
        let next = (h * factor.clamp(SMALLEST_FACTOR, most)).min(self.longest_s);
        // A step that a limit has cut says little of how long the next may be.
        let shortened = cut || h < 0.999 * self.step_s;
        self.step_s = if shortened {
            next.max(self.step_s)
        } else {
            next
        };
        // Nor is its error one to compare the next with.
        if !shortened {
            self.previous_error = error.max(LEAST_PREVIOUS_ERROR);
        }
        self.after_rejection = false;
        true
    }

    /// Shortens the step after one that could not be evaluated.
    pub fn failed(&mut self, h: f64) {
        self.step_s = h * SMALLEST_FACTOR;
        self.after_rejection = true;
    }

    /// Shortens the step to `factor` of one that was rejected for another reason than its error.
    pub fn shorten(&mut self, h: f64, factor: f64) {
        self.step_s = h * factor;
        self.after_rejection = true;
    }

    /// Starts again, after something has switched, with a step of at most `step_s` (s).
    pub fn restart(&mut self, step_s: f64) {
        self.step_s = self.step_s.min(step_s);
        self.previous_error = 1.0;
    }

    /// Starts with a step of `step_s` (s), whatever was before.
    pub fn begin(&mut self, step_s: f64) {
        self.step_s = step_s.min(self.longest_s);
        self.previous_error = 1.0;
        self.after_rejection = false;
    }

    /// Whether the step has shrunk to round-off of the time `time_s`.
    #[must_use]
    pub fn is_exhausted(&self, time_s: f64) -> bool {
        self.step_s < ROUND_OFF * time_s.abs().max(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step may be stretched to reach a limit, but not beyond the longest that was allowed, and not
    /// right after a rejection, where it would be the same step again.
    #[test]
    fn a_stretched_step_keeps_to_the_longest() {
        let mut control = StepControl::new(3, 1.0, 1.0);
        assert_eq!(control.propose(0.0, 1.05), (0.525, false));
        control = StepControl::new(3, 1.0, 10.0);
        assert_eq!(control.propose(0.0, 1.05), (1.05, true));
        assert!(!control.accepts(1.05, 1.1, true));
        let (h, reaches_limit) = control.propose(0.0, 1.05);
        assert!(h < 1.0 && !reaches_limit, "{h}");
    }

    /// Equal steps to a limit that is near, none to one that is far.
    #[test]
    fn a_near_limit_is_reached_in_equal_steps() {
        let control = StepControl::new(3, 0.3, f64::INFINITY);
        assert_eq!(control.propose(0.0, 1.0), (0.25, false));
        assert_eq!(control.propose(0.0, 100.0), (0.3, false));
    }
}
