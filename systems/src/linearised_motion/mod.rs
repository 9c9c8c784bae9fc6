//! The motion of a world linearised about a state, and the direct solution of what an implicit step
//! asks of it: tethers eliminate first, in linear time, bodies last; two bodies on one tether from end
//! to end.
//!
//! With M the masses, D = dF/dv and K = dF/dx, a stage of a Rosenbrock method with g = gamma h solves
//!
//! ```text
//! (M - g D - g^2 K) V = g M r_v + g^2 K r_x        X = g (V + r_x)
//! ```
//!
//! for the increments X of positions and V of velocities. First-order states have no derivative here:
//! S = g r_s.

pub mod body_block;
pub mod chain;
#[cfg(test)]
pub(crate) mod dense_motion;
pub mod derivatives;
pub mod error_norm;
pub mod few_bodies;
pub mod joined_pair;
pub mod probed_motion;
pub mod shifted_system;
pub mod stage_solver;
pub mod symmetric3;
pub mod topology;
