//! One step under control: attempts that shorten until one is good.

use super::step_control::StepControl;
use super::{StepFailure, Trajectory};

/// What an attempt is worth.
pub(super) enum Verdict {
    /// Its scaled error, of which 1 is the tolerance, and the place in the state where that is largest.
    Error(f64, usize),
    /// It is to be shortened to this part for another reason than its error, seen at this place.
    TooLong(f64, usize),
}

/// Attempts steps from the trajectory to a time (s) at or before `limit_s` until one is good; that time.
///
/// # Errors
/// Why no step is short enough.
pub(super) fn controlled_step(
    control: &mut StepControl,
    trajectory: &mut Trajectory,
    limit_s: f64,
    mut attempt: impl FnMut(&mut Trajectory, f64) -> Result<Verdict, StepFailure>,
) -> Result<f64, StepFailure> {
    loop {
        let (h, reaches_limit) = control.propose(trajectory.time_s, limit_s);
        let end_s = if reaches_limit {
            limit_s
        } else {
            trajectory.time_s + h
        };
        let failure = match attempt(trajectory, end_s) {
            Ok(Verdict::Error(error, index)) => {
                if control.accepts(h, error, reaches_limit) {
                    return Ok(end_s);
                }
                StepFailure::StepTooSmall { step_s: h, index }
            }
            Ok(Verdict::TooLong(factor, index)) => {
                control.shorten(h, factor);
                StepFailure::StepTooSmall { step_s: h, index }
            }
            // A trial step that goes astray is too long, unless it is already as short as can be.
            Err(failure) => {
                control.failed(h);
                failure
            }
        };
        trajectory.cost.rejected += 1;
        if control.is_exhausted(trajectory.time_s) {
            return Err(failure);
        }
    }
}
