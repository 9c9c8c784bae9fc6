//! Solution of sparse nonlinear equations: block-sparse matrices over a
//! graph of sites, their elimination, finite-difference Jacobians by
//! distance-2 colouring, and a damped Newton method for static equilibria.
//!
//! A *site* is a group of unknowns (3 for a tether node, 6 for a rigid body);
//! two sites are neighbours when a tether segment joins them.
pub mod block_elimination;
pub mod block_sparse;
pub mod colouring;
pub mod damped_newton;
pub mod finite_difference_jacobian;
mod small_block;

#[cfg(test)]
pub(crate) mod test_support;
