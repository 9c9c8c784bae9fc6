//! Static equilibrium of a mechanical system by a regularised, damped Newton
//! method.
//!
//! Wanted is `r(x) = 0`, with `r` the generalised forces. Near a stable
//! equilibrium the stiffness `-J = -∂r/∂x` is symmetric and positive
//! semi-definite; its null space are the free motions (translations, yaw),
//! along which no force acts. Each iteration solves
//!
//! ```text
//! (-J + μ D) δ = r
//! D_q = max(|J_qq|, 10⁻³ max|J_ss|, residual_scale_q / largest_step_q)   q at site s
//! x  := x ⊕ t δ
//! ```
//!
//! (Levenberg, Quart. Appl. Math. 2 (1944) 164; Marquardt 1963 for the scaling
//! by the diagonal). `μ` is tiny, so that steps are Newton steps in all stiff
//! directions and vanish in the null space, where `r` has no part. The step is
//! first shortened so that no unknown moves by more than `largest_step_q`, then
//! halved until it is acceptable: the forces do work along it, `r(0)·δ > 0`,
//! and either the norm `φ² = Σ (r_q / residual_scale_q)²` decreases,
//!
//! ```text
//! φ(t) ≤ (1 - 10⁻⁴ t) φ(0)        (Armijo 1966)
//! r(t)·δ ≥ -½ r(0)·δ              or the energy does
//! ```
//!
//! (Nocedal and Wright, "Numerical Optimization", 2nd ed. 2006, sections 3.1
//! and 11.2). In the second case the work `t (r(0) + r(t))·δ / 2` done by the
//! forces is positive, i.e. the potential energy falls; without it long chains
//! stall far from equilibrium, where a sideways step always stretches stiff
//! segments a little and so increases `φ`. When no
//! halving is acceptable or the matrix is singular, `μ` is increased a
//! hundredfold, which turns the step towards the forces (relaxation), and
//! after a success decreased again. The first condition keeps the method away
//! from unstable equilibria.

use super::block_elimination::{Elimination, Singular};
use super::block_sparse::{BlockMatrix, BlockPattern};
use super::finite_difference_jacobian::{FiniteDifference, Residual};
use super::small_block;

#[cfg(test)]
mod tests;

/// Damping `μ` at which the method gives up.
const LARGEST_DAMPING: f64 = 1e5;
/// Change of `μ` after a failed step (up) or a successful one (down).
const DAMPING_FACTOR: f64 = 100.0;
/// Least `μ` after a failed step.
const LEAST_INCREASED_DAMPING: f64 = 1e-12;
/// Halvings of a step before it counts as failed.
const HALVINGS: usize = 8;
/// Least decrease of the norm, relative to the one of a linear system.
const LEAST_DECREASE: f64 = 1e-4;
/// Work of the forces at the end of a step against it, relative to the work
/// at its beginning, up to which it is sure to have lowered the energy.
const LARGEST_OVERSHOOT: f64 = 0.5;
/// Decrease of the largest residual in one step that counts as progress
/// below the round-off floor.
const PROGRESS: f64 = 0.5;
/// Least scale `D` of an unknown relative to the norm of the diagonal block.
const LEAST_SCALE: f64 = 1e-3;

/// Scales and limits of [`DampedNewton::solve`]. Slices hold one positive
/// number for each unknown.
#[derive(Debug, Clone, Copy)]
pub struct NewtonSettings<'a> {
    /// Step of the finite differences, in the unit of the unknown.
    pub difference_step: &'a [f64],
    /// Largest change of the unknown in one iteration, in its unit.
    pub largest_step: &'a [f64],
    /// Residuals are divided by this, in the unit of the residual.
    pub residual_scale: &'a [f64],
    /// Largest scaled residual of a solution (1).
    pub tolerance: f64,
    /// Largest scaled residual that round-off can explain (1): accepted when
    /// the residual cannot be decreased any further.
    pub floor: f64,
    /// Smallest `μ`, tried first (1). About `1e-10`; the error along a mode
    /// of stiffness `λ` then decreases by `μ D / λ` in an iteration at best.
    pub smallest_damping: f64,
    /// Largest number of steps.
    pub largest_iterations: usize,
}

/// How a solution was reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NewtonReport {
    /// Number of steps made.
    pub iterations: usize,
    /// Largest absolute scaled residual left (1).
    pub largest_residual: f64,
    /// Number of the unknown with this residual (0 for an empty system).
    pub largest_unknown_index: usize,
}

/// Why no solution was found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NewtonError<E> {
    /// The regularised stiffness is singular with any damping.
    #[error("the stiffness is singular at site {site}, whatever the damping")]
    Singular {
        /// Site with the singular diagonal block.
        site: usize,
    },
    /// No acceptable step, or too many iterations.
    #[error(
        "not converged after {iterations} iterations: \
         scaled residual {largest_residual:e} at unknown {worst_unknown}"
    )]
    NotConverged {
        /// Number of steps made.
        iterations: usize,
        /// Largest absolute scaled residual left (1; infinite when a residual
        /// is not a number).
        largest_residual: f64,
        /// Number of the unknown with this residual.
        worst_unknown: usize,
    },
    /// The residual could not be evaluated.
    #[error("the residual could not be evaluated")]
    Evaluation(#[source] E),
}

/// Norms of a scaled residual.
#[derive(Debug, Clone, Copy)]
struct Size {
    /// Euclidean norm.
    norm: f64,
    largest: f64,
    worst: usize,
}

/// What the search along one or more steps gave.
enum Search<E> {
    Accepted(Size),
    /// No decrease; the last error of an evaluation on the way, if any.
    Failed(Option<E>),
}

/// Work space of the method for systems over one pattern.
#[derive(Debug, Clone)]
pub struct DampedNewton {
    difference: FiniteDifference,
    jacobian: BlockMatrix,
    stiffness: BlockMatrix,
    elimination: Elimination,
    /// The scale `D`.
    scale: Vec<f64>,
    residual: Vec<f64>,
    step: Vec<f64>,
    part: Vec<f64>,
    trial: Vec<f64>,
    trial_residual: Vec<f64>,
}

impl DampedNewton {
    /// Prepares for systems whose Jacobian has the given pattern.
    #[must_use]
    pub fn new(pattern: &BlockPattern) -> Self {
        let zeros = vec![0.0; pattern.dimension()];
        Self {
            difference: FiniteDifference::new(pattern),
            jacobian: BlockMatrix::new(pattern.clone()),
            stiffness: BlockMatrix::new(pattern.clone()),
            elimination: Elimination::analyse(pattern),
            scale: zeros.clone(),
            residual: zeros.clone(),
            step: zeros.clone(),
            part: zeros.clone(),
            trial: zeros.clone(),
            trial_residual: zeros,
        }
    }

    /// Solves `r(x) = 0` from the guess `x`, which becomes the solution (on
    /// failure the last point reached). `r` must be the forces, such that
    /// `-∂r/∂x` is positive semi-definite at the solution. Does not allocate.
    ///
    /// An error of the residual at a trial point only shortens the step.
    ///
    /// # Errors
    /// See [`NewtonError`]; the number of iterations is limited in any case.
    ///
    /// # Panics
    /// If `x`, the system or a slice of the settings has another length than
    /// the dimension of the pattern.
    pub fn solve<E>(
        &mut self,
        system: &mut dyn Residual<Error = E>,
        x: &mut [f64],
        settings: &NewtonSettings<'_>,
    ) -> Result<NewtonReport, NewtonError<E>> {
        debug_assert_eq!(system.dimension(), self.residual.len());
        system
            .residual(x, &mut self.residual)
            .map_err(NewtonError::Evaluation)?;
        let mut size = measure(&self.residual, settings.residual_scale);
        let mut damping = settings.smallest_damping;
        let mut stalled = false;
        for iterations in 0..=settings.largest_iterations {
            if size.largest <= settings.tolerance || (stalled && size.largest <= settings.floor) {
                return Ok(size.report(iterations));
            }
            if iterations == settings.largest_iterations || !size.norm.is_finite() {
                return Err(size.not_converged(iterations));
            }
            self.difference
                .evaluate(system, x, settings.difference_step, &mut self.jacobian)
                .map_err(NewtonError::Evaluation)?;
            self.set_scale(settings);
            match self.advance(system, x, settings, &size, &mut damping)? {
                Search::Accepted(now) => {
                    stalled = now.largest > PROGRESS * size.largest;
                    size = now;
                }
                Search::Failed(_) if size.largest <= settings.floor => {
                    return Ok(size.report(iterations));
                }
                Search::Failed(Some(error)) => return Err(NewtonError::Evaluation(error)),
                Search::Failed(None) => return Err(size.not_converged(iterations)),
            }
        }
        Err(size.not_converged(settings.largest_iterations))
    }

    /// Makes one step, with as much damping as it takes.
    fn advance<E>(
        &mut self,
        system: &mut dyn Residual<Error = E>,
        x: &mut [f64],
        settings: &NewtonSettings<'_>,
        size: &Size,
        damping: &mut f64,
    ) -> Result<Search<E>, NewtonError<E>> {
        let mut failure: Result<Option<E>, Singular> = Ok(None);
        while *damping <= LARGEST_DAMPING {
            match self.find_step(settings, *damping) {
                Err(singular) => failure = Err(singular),
                Ok(()) => match self.search(system, x, settings, size) {
                    Search::Failed(error) => failure = Ok(error),
                    Search::Accepted(now) => {
                        *damping = (*damping / DAMPING_FACTOR).max(settings.smallest_damping);
                        return Ok(Search::Accepted(now));
                    }
                },
            }
            *damping = (*damping * DAMPING_FACTOR).max(LEAST_INCREASED_DAMPING);
        }
        match failure {
            Ok(error) => Ok(Search::Failed(error)),
            Err(Singular { site }) => Err(NewtonError::Singular { site }),
        }
    }

    /// Solves for the step `δ` and shortens it to the largest allowed.
    fn find_step(&mut self, settings: &NewtonSettings<'_>, damping: f64) -> Result<(), Singular> {
        self.stiffness.set_multiple(-1.0, &self.jacobian);
        let mut unknown = 0;
        for site in 0..self.stiffness.pattern().sites() {
            let dim = self.stiffness.pattern().dim(site);
            let diagonal = self.stiffness.block_mut(site, site);
            for entry in diagonal.iter_mut().step_by(dim + 1) {
                *entry += damping * self.scale[unknown];
                unknown += 1;
            }
        }
        self.elimination.factorise(&self.stiffness)?;
        self.step.copy_from_slice(&self.residual);
        self.elimination.solve(&mut self.step);
        let limits = self.step.iter().zip(settings.largest_step);
        let excess = limits.fold(1.0, |most: f64, (step, limit)| most.max(step.abs() / limit));
        for step in &mut self.step {
            *step /= excess;
        }
        Ok(())
    }

    /// Halves the step until the residual or the energy decreases; then moves
    /// `x`.
    fn search<E>(
        &mut self,
        system: &mut dyn Residual<Error = E>,
        x: &mut [f64],
        settings: &NewtonSettings<'_>,
        size: &Size,
    ) -> Search<E> {
        let mut fraction = 1.0;
        let mut last_error = None;
        let work = dot(&self.residual, &self.step);
        for _ in 0..=HALVINGS {
            for (part, step) in self.part.iter_mut().zip(&self.step) {
                *part = fraction * step;
            }
            self.trial.copy_from_slice(x);
            system.apply(&mut self.trial, &self.part);
            match system.residual(&self.trial, &mut self.trial_residual) {
                Err(error) => last_error = Some(error),
                Ok(()) => {
                    let now = measure(&self.trial_residual, settings.residual_scale);
                    let decreases = now.norm < (1.0 - LEAST_DECREASE * fraction) * size.norm;
                    let work_left = dot(&self.trial_residual, &self.step);
                    let falls = now.norm.is_finite() && work_left >= -LARGEST_OVERSHOOT * work;
                    if work > 0.0 && (decreases || falls) {
                        x.copy_from_slice(&self.trial);
                        std::mem::swap(&mut self.residual, &mut self.trial_residual);
                        return Search::Accepted(now);
                    }
                }
            }
            fraction *= 0.5;
        }
        Search::Failed(last_error)
    }

    /// Sets the scale `D` from the Jacobian.
    fn set_scale(&mut self, settings: &NewtonSettings<'_>) {
        let mut unknown = 0;
        for site in 0..self.jacobian.pattern().sites() {
            let dim = self.jacobian.pattern().dim(site);
            let diagonal = self.jacobian.block(site, site);
            let least = LEAST_SCALE * small_block::norm(diagonal);
            for entry in diagonal.iter().step_by(dim + 1) {
                let slack = settings.residual_scale[unknown] / settings.largest_step[unknown];
                self.scale[unknown] = entry.abs().max(least).max(slack);
                unknown += 1;
            }
        }
    }
}

impl Size {
    fn report(&self, iterations: usize) -> NewtonReport {
        NewtonReport {
            iterations,
            largest_residual: self.largest,
            largest_unknown_index: self.worst,
        }
    }

    fn not_converged<E>(&self, iterations: usize) -> NewtonError<E> {
        NewtonError::NotConverged {
            iterations,
            largest_residual: self.largest,
            worst_unknown: self.worst,
        }
    }
}

/// Sum of the products: the work of forces along a step.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Norms of a residual divided by its scale.
fn measure(residual: &[f64], scale: &[f64]) -> Size {
    let mut size = Size {
        norm: 0.0,
        largest: 0.0,
        worst: 0,
    };
    for (unknown, (residual, scale)) in residual.iter().zip(scale).enumerate() {
        let scaled = (residual / scale).abs();
        let scaled = if scaled.is_nan() {
            f64::INFINITY
        } else {
            scaled
        };
        size.norm += scaled * scaled;
        if scaled > size.largest {
            size.largest = scaled;
            size.worst = unknown;
        }
    }
    size.norm = size.norm.sqrt();
    size
}
