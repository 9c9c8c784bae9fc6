//! What an implicit step asks of a linearised motion, whatever its coordinates are.

use super::derivatives::Derivatives;

/// A matrix that cannot be factorised: the step is too long for what pushes there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotSolvable {
    /// Place in the state.
    pub index: usize,
}

/// Solves the linear systems of one step.
pub trait StageSolver: Send + Sync {
    /// Factorises the matrix of a step of `step_s` with g = `gamma` x `step_s`.
    ///
    /// # Errors
    /// [`NotSolvable`], with the place in the state.
    fn factorise(
        &mut self,
        derivatives: &Derivatives,
        step_s: f64,
        gamma: f64,
    ) -> Result<(), NotSolvable>;

    /// Solves for the increments of one stage: `r` holds r_x, r_v and r_s and becomes X, V and S.
    fn solve(&mut self, derivatives: &Derivatives, r: &mut [f64]);

    /// Finds by how much bodies and nodes move where the state changes by `change`, and keeps it.
    fn displace(&mut self, derivatives: &Derivatives, change: &[f64], of: Change);

    /// What [`StageSolver::displace`] has kept, in the coordinates of the topology, which are absolute; of
    /// the same `change`.
    fn displaced<'a>(&'a self, change: &'a [f64], of: Change) -> &'a [f64];

    /// The place in the state of what moves a coordinate of the topology.
    fn place(&self, coordinate: usize) -> usize;
}

/// A change of the state during a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Its estimated error.
    Error,
    /// The step itself.
    Increment,
}
