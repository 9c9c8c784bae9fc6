//! What eigensolvers ask of a linearised motion: to apply the inverse of its shifted equations.
//!
//! With v = x' the equations `(A - s) y = r` of the parts y = (x, v, w), r = (p, q, u) become
//!
//! ```text
//! v = p + s x
//! (s^2 M + s D + K) x - G w = -(M q + D p + s M p)
//! (X + s V) x + (W - s) w   = u - V p
//! ```
//!
//! (Tisseur and Meerbergen, "The quadratic eigenvalue problem", SIAM Review 43 (2001) 235, sec. 5.2).

/// A linearised motion whose shifted equations can be solved.
pub trait ShiftInvert {
    /// Number of displacements, and of velocities.
    fn coordinates(&self) -> usize;

    /// Number of first-order states.
    fn first_order(&self) -> usize;

    /// The inertia of every coordinate by itself.
    fn inertia(&self) -> Vec<f64>;

    /// Factorises the equations shifted by `shift`, 1/s; false where that is not possible.
    #[must_use]
    fn factorise(&mut self, shift: f64) -> bool;

    /// `r := (A - s)^-1 r` with the shift of the last factorisation.
    fn apply(&mut self, r: &mut [f64]);

    /// Length of the state (x, x', w).
    fn len(&self) -> usize {
        2 * self.coordinates() + self.first_order()
    }

    /// Whether nothing moves.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
