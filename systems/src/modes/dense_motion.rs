//! A linearised motion in full matrices, with first-order states.

use nalgebra::{DMatrix, DVector, Dyn, LU};

use super::shift_invert::ShiftInvert;
use super::sparse_motion::SparseMotion;

/// The matrices of the head of [`super`].
#[derive(Clone, Debug)]
pub struct DenseMotion {
    /// M.
    pub mass: DMatrix<f64>,
    /// D.
    pub damping: DMatrix<f64>,
    /// K.
    pub stiffness: DMatrix<f64>,
    /// G.
    pub by_first_order: DMatrix<f64>,
    /// X.
    pub first_order_by_displacement: DMatrix<f64>,
    /// V.
    pub first_order_by_velocity: DMatrix<f64>,
    /// W.
    pub first_order: DMatrix<f64>,
    shift: f64,
    factors: Option<LU<f64, Dyn, Dyn>>,
}

impl DenseMotion {
    /// Of so many coordinates and first-order states, all zero.
    #[must_use]
    pub fn zeros(coordinates: usize, first_order: usize) -> Self {
        let (n, m) = (coordinates, first_order);
        Self {
            mass: DMatrix::zeros(n, n),
            damping: DMatrix::zeros(n, n),
            stiffness: DMatrix::zeros(n, n),
            by_first_order: DMatrix::zeros(n, m),
            first_order_by_displacement: DMatrix::zeros(m, n),
            first_order_by_velocity: DMatrix::zeros(m, n),
            first_order: DMatrix::zeros(m, m),
            shift: 0.0,
            factors: None,
        }
    }

    /// The same motion along orthonormal directions alone, each by its parts along the coordinates.
    #[must_use]
    pub fn along(&self, directions: &[Vec<f64>]) -> Self {
        let n = self.mass.nrows();
        let z = DMatrix::from_fn(n, directions.len(), |row, column| directions[column][row]);
        let between = |m: &DMatrix<f64>| z.tr_mul(&(m * &z));
        Self {
            mass: between(&self.mass),
            damping: between(&self.damping),
            stiffness: between(&self.stiffness),
            by_first_order: z.tr_mul(&self.by_first_order),
            first_order_by_displacement: &self.first_order_by_displacement * &z,
            first_order_by_velocity: &self.first_order_by_velocity * &z,
            first_order: self.first_order.clone(),
            shift: 0.0,
            factors: None,
        }
    }

    /// The same as a motion in blocks, with so many first-order states that do nothing yet.
    #[must_use]
    pub fn of(sparse: &SparseMotion, first_order: usize) -> Self {
        let pattern = sparse.mass.pattern();
        let mut motion = Self::zeros(pattern.dimension(), first_order);
        let matrices = [
            (&sparse.mass, &mut motion.mass),
            (&sparse.damping, &mut motion.damping),
            (&sparse.stiffness, &mut motion.stiffness),
        ];
        for (from, to) in matrices {
            for i in 0..pattern.sites() {
                for &j in pattern.row(i) {
                    let (row, column) = (pattern.offset(i), pattern.offset(j));
                    let columns = pattern.dim(j);
                    for (place, value) in from.block(i, j).iter().enumerate() {
                        to[(row + place / columns, column + place % columns)] = *value;
                    }
                }
            }
        }
        motion
    }

    /// Without the first-order states that nothing depends on, such as a sum of work; and the places of
    /// those that are left.
    #[must_use]
    pub fn without_idle_first_order(mut self) -> (Self, Vec<usize>) {
        let mut left: Vec<usize> = (0..self.first_order()).collect();
        while let Some(idle) = (0..left.len()).find(|k| {
            let driven = self.by_first_order.column(*k).amax();
            driven == 0.0 && self.first_order.column(*k).amax() == 0.0
        }) {
            left.remove(idle);
            self.by_first_order = self.by_first_order.remove_column(idle);
            self.first_order = self.first_order.remove_column(idle).remove_row(idle);
            self.first_order_by_displacement = self.first_order_by_displacement.remove_row(idle);
            self.first_order_by_velocity = self.first_order_by_velocity.remove_row(idle);
        }
        (self, left)
    }
}

impl ShiftInvert for DenseMotion {
    fn coordinates(&self) -> usize {
        self.mass.nrows()
    }

    fn first_order(&self) -> usize {
        self.first_order.nrows()
    }

    fn inertia(&self) -> Vec<f64> {
        self.mass.diagonal().iter().copied().collect()
    }

    fn factorise(&mut self, shift: f64) -> bool {
        let (n, m) = (self.coordinates(), self.first_order());
        let mut matrix = DMatrix::zeros(n + m, n + m);
        let motion = &self.mass * (shift * shift) + &self.damping * shift + &self.stiffness;
        matrix.view_mut((0, 0), (n, n)).copy_from(&motion);
        matrix
            .view_mut((0, n), (n, m))
            .copy_from(&(-&self.by_first_order));
        let driven = &self.first_order_by_displacement + &self.first_order_by_velocity * shift;
        matrix.view_mut((n, 0), (m, n)).copy_from(&driven);
        let own = &self.first_order - DMatrix::identity(m, m) * shift;
        matrix.view_mut((n, n), (m, m)).copy_from(&own);
        let factors = matrix.lu();
        let is_invertible = factors.is_invertible();
        self.shift = shift;
        self.factors = Some(factors);
        is_invertible
    }

    fn apply(&mut self, r: &mut [f64]) {
        let (n, m) = (self.coordinates(), self.first_order());
        let p = DVector::from_column_slice(&r[..n]);
        let q = DVector::from_column_slice(&r[n..2 * n]);
        let u = DVector::from_column_slice(&r[2 * n..]);
        let push = &self.mass * (q + &p * self.shift) + &self.damping * &p;
        let driven = u - &self.first_order_by_velocity * &p;
        let mut unknown = DVector::zeros(n + m);
        unknown.rows_mut(0, n).copy_from(&(-push));
        unknown.rows_mut(n, m).copy_from(&driven);
        if let Some(factors) = &self.factors {
            // What could not be factorised was said to be so.
            let _ = factors.solve_mut(&mut unknown);
        }
        for k in 0..n {
            r[k] = unknown[k];
            r[n + k] = p[k] + self.shift * unknown[k];
        }
        for k in 0..m {
            r[2 * n + k] = unknown[n + k];
        }
    }
}
