//! A linearised motion in blocks between neighbours, as tethers make it; without first-order states.

use super::shift_invert::ShiftInvert;
use crate::nonlinear_solver::block_elimination::Elimination;
use crate::nonlinear_solver::block_sparse::{BlockMatrix, BlockPattern};

/// Mass, damping and stiffness over one pattern.
#[derive(Clone, Debug)]
pub struct SparseMotion {
    /// M.
    pub mass: BlockMatrix,
    /// D.
    pub damping: BlockMatrix,
    /// K.
    pub stiffness: BlockMatrix,
    elimination: Elimination,
    shift: f64,
    push: Vec<f64>,
    part: Vec<f64>,
}

impl SparseMotion {
    /// Over a pattern, all zero.
    #[must_use]
    pub fn zeros(pattern: &BlockPattern) -> Self {
        let zero = BlockMatrix::new(pattern.clone());
        Self {
            mass: zero.clone(),
            damping: zero.clone(),
            stiffness: zero,
            elimination: Elimination::analyse(pattern),
            shift: 0.0,
            push: vec![0.0; pattern.dimension()],
            part: vec![0.0; pattern.dimension()],
        }
    }
}

impl ShiftInvert for SparseMotion {
    fn coordinates(&self) -> usize {
        self.push.len()
    }

    fn first_order(&self) -> usize {
        0
    }

    fn inertia(&self) -> Vec<f64> {
        let pattern = self.mass.pattern();
        let diagonal = |site: usize| {
            let dim = pattern.dim(site);
            let block = self.mass.block(site, site);
            (0..dim).map(move |part| block[part * dim + part])
        };
        (0..pattern.sites()).flat_map(diagonal).collect()
    }

    fn factorise(&mut self, shift: f64) -> bool {
        self.shift = shift;
        let mut matrix = BlockMatrix::new(self.mass.pattern().clone());
        let parts = self.mass.values().iter().zip(self.damping.values());
        let parts = parts.zip(self.stiffness.values());
        for (value, ((mass, damping), stiffness)) in matrix.values_mut().iter_mut().zip(parts) {
            *value = shift * (shift * mass + damping) + stiffness;
        }
        self.elimination.factorise(&matrix).is_ok()
    }

    fn apply(&mut self, r: &mut [f64]) {
        let (p, q) = r.split_at_mut(self.push.len());
        for (q, p) in q.iter_mut().zip(p.iter()) {
            *q += self.shift * p;
        }
        self.mass.multiply(q, &mut self.push);
        self.damping.multiply(p, &mut self.part);
        for (push, part) in self.push.iter_mut().zip(&self.part) {
            *push = -(*push + part);
        }
        self.elimination.solve(&mut self.push);
        for ((p, q), x) in p.iter_mut().zip(q).zip(&self.push) {
            *q = *p + self.shift * x;
            *p = *x;
        }
    }
}
