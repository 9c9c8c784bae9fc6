//! Small motions about a steady state: eigenvalues and eigenvectors of the linearised equations.
//!
//! ```text
//! M x'' + D x' + K x = G w        w' = X x + V x' + W w        x, w ~ e^(lambda t)
//! ```
//!
//! x displacements, w first-order states. Every method works on the inverse of the shifted equations,
//! `S = (A - s)^-1` with A of the state (x, x', w): the eigenvalues of S are `1 / (lambda - s)`, so that
//! slow modes, which are the largest of them, are found to full accuracy beside springs whose modes are
//! a million times faster.

pub mod band_arnoldi;
pub mod cluster;
pub mod dense_motion;
pub mod eigenmodes;
pub mod extrapolated_difference;
pub mod null_space;
pub mod real_eigenvectors;
pub mod sampled_loop;
pub mod shift_invert;
pub mod sparse_motion;

pub use nalgebra::Complex;

/// A real matrix.
pub type Matrix = nalgebra::DMatrix<f64>;

#[cfg(test)]
mod tests;
