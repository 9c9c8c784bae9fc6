//! Block Jacobians by central differences.
//!
//! Column `q` of the Jacobian `J = ∂r/∂x` (Curtis, Powell and Reid, J. Inst.
//! Maths Applics 13 (1974) 117, with central differences):
//!
//! ```text
//! J_pq = (r_p(x ⊕ h_q e_q) - r_p(x ⊖ h_q e_q)) / (2 h_q) + O(h_q²)
//! ```
//!
//! The sites of one colour are perturbed together, so a Jacobian takes
//! `2 Σ_colours (largest dimension of a site of the colour)` residuals,
//! whatever the number of sites. `⊕` is [`Residual::apply`], so on a manifold
//! the columns belong to the same increments that the Newton method makes.
//! Steps are rounded down to powers of two: then `x + h` and `x - h` are
//! almost always exact, and no round-off of `x` enters the quotient.

use super::block_sparse::{BlockMatrix, BlockPattern};
use super::colouring::colour;

#[cfg(test)]
mod tests;

/// A system of as many equations `r(x) = 0` as unknowns, coupled only between
/// neighbouring sites.
pub trait Residual {
    /// Why an evaluation can fail.
    type Error;

    /// Number of unknowns and of residuals.
    fn dimension(&self) -> usize;

    /// Writes the residual at `x` to `r`; both have [`Residual::dimension`]
    /// elements, and `r` may hold anything before.
    ///
    /// # Errors
    /// When the residual cannot be evaluated at `x`.
    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), Self::Error>;

    /// Moves `x` by the increment `dx`, by default `x := x + dx`.
    ///
    /// For unknowns on a manifold, e.g. rotation vectors composed as
    /// rotations. Sites whose part of `dx` is zero must keep their values
    /// exactly; the increment of a site must change that site only.
    fn apply(&mut self, x: &mut [f64], dx: &[f64]) {
        for (x, dx) in x.iter_mut().zip(dx) {
            *x += dx;
        }
    }
}

/// Work space and colouring for the Jacobians over one pattern.
#[derive(Debug, Clone)]
pub struct FiniteDifference {
    /// Sites of each colour.
    groups: Vec<Vec<usize>>,
    increment: Vec<f64>,
    moved: Vec<f64>,
    forward: Vec<f64>,
    backward: Vec<f64>,
}

impl FiniteDifference {
    /// Colours the sites of a pattern.
    #[must_use]
    pub fn new(pattern: &BlockPattern) -> Self {
        let mut groups = Vec::new();
        for (site, colour) in colour(pattern).into_iter().enumerate() {
            if groups.len() <= colour {
                groups.resize(colour + 1, Vec::new());
            }
            groups[colour].push(site);
        }
        let zeros = vec![0.0; pattern.dimension()];
        Self {
            groups,
            increment: zeros.clone(),
            moved: zeros.clone(),
            forward: zeros.clone(),
            backward: zeros,
        }
    }

    /// Writes `∂r/∂x` at `x` to `jacobian`, which must be over the pattern
    /// given to [`FiniteDifference::new`]. Does not allocate.
    ///
    /// `steps` holds a positive step for each unknown, in its unit.
    ///
    /// # Errors
    /// The first error of an evaluation; `jacobian` is then unusable.
    ///
    /// # Panics
    /// If a length does not fit the pattern.
    pub fn evaluate<E>(
        &mut self,
        system: &mut dyn Residual<Error = E>,
        x: &[f64],
        steps: &[f64],
        jacobian: &mut BlockMatrix,
    ) -> Result<(), E> {
        for colour in 0..self.groups.len() {
            let dims = self.groups[colour]
                .iter()
                .map(|&i| jacobian.pattern().dim(i));
            for component in 0..dims.max().unwrap_or(0) {
                self.set_increment(colour, component, steps, jacobian.pattern());
                self.difference(system, x)?;
                self.store(colour, component, steps, jacobian);
            }
        }
        Ok(())
    }

    /// Perturbs one unknown of each site of a colour.
    fn set_increment(
        &mut self,
        colour: usize,
        component: usize,
        steps: &[f64],
        pattern: &BlockPattern,
    ) {
        self.increment.fill(0.0);
        for &site in &self.groups[colour] {
            if component < pattern.dim(site) {
                let unknown = pattern.offset(site) + component;
                self.increment[unknown] = power_of_two(steps[unknown]);
            }
        }
    }

    /// Residuals at both ends of the increment.
    fn difference<E>(&mut self, system: &mut dyn Residual<Error = E>, x: &[f64]) -> Result<(), E> {
        self.moved.copy_from_slice(x);
        system.apply(&mut self.moved, &self.increment);
        system.residual(&self.moved, &mut self.forward)?;
        for increment in &mut self.increment {
            *increment = -*increment;
        }
        self.moved.copy_from_slice(x);
        system.apply(&mut self.moved, &self.increment);
        system.residual(&self.moved, &mut self.backward)
    }

    /// Takes one column of each site of a colour from the residuals.
    fn store(&self, colour: usize, component: usize, steps: &[f64], jacobian: &mut BlockMatrix) {
        for &site in &self.groups[colour] {
            let columns = jacobian.pattern().dim(site);
            if component >= columns {
                continue;
            }
            let unknown = jacobian.pattern().offset(site) + component;
            let scale = 0.5 / power_of_two(steps[unknown]);
            for neighbour in 0..jacobian.pattern().row(site).len() {
                let row = jacobian.pattern().row(site)[neighbour];
                let start = jacobian.pattern().offset(row);
                let block = jacobian.block_mut(row, site).iter_mut();
                let column = block.skip(component).step_by(columns);
                let ends = self.forward[start..].iter().zip(&self.backward[start..]);
                for (entry, (forward, backward)) in column.zip(ends) {
                    *entry = (forward - backward) * scale;
                }
            }
        }
    }
}

/// The largest power of two that is not above a positive normal number.
fn power_of_two(step: f64) -> f64 {
    f64::from_bits(step.to_bits() & 0x7ff0_0000_0000_0000)
}
