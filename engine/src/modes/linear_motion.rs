//! A linearised motion, in full or in blocks.

use aerobot_systems::modes::dense_motion::DenseMotion;
use aerobot_systems::modes::shift_invert::ShiftInvert;
use aerobot_systems::modes::sparse_motion::SparseMotion;

/// Stiffness relative to the sum of the sizes of its terms that is round-off.
const ROUND_OFF: f64 = 1e-11;
/// Stiffness over inertia, 1/s^2, and damping over inertia, 1/s, that differences leave where there is
/// none.
const NOISE: f64 = 1e-9;

/// In full for few coordinates, in blocks for long tethers.
pub(super) enum LinearMotion {
    Dense(Box<DenseMotion>),
    Sparse(Box<SparseMotion>),
}

impl LinearMotion {
    pub(super) fn as_shift_invert(&mut self) -> &mut dyn ShiftInvert {
        match self {
            Self::Dense(motion) => &mut **motion,
            Self::Sparse(motion) => &mut **motion,
        }
    }

    /// Whether a displacement meets no force; then, whether its velocity meets none either.
    pub(super) fn is_neutral(&self, u: &[f64]) -> Option<bool> {
        let (inertia, stiffness, damping) = match self {
            Self::Dense(motion) => (
                motion.inertia(),
                dense_product(&motion.stiffness, u),
                dense_product(&motion.damping, u),
            ),
            Self::Sparse(motion) => (
                motion.inertia(),
                sparse_product(&motion.stiffness, u),
                sparse_product(&motion.damping, u),
            ),
        };
        let largest = u.iter().fold(0.0_f64, |most, part| most.max(part.abs()));
        let vanishes = |product: &(Vec<f64>, Vec<f64>)| {
            let terms = product.0.iter().zip(&product.1).zip(&inertia);
            terms.into_iter().all(|((value, size), inertia)| {
                value.abs() <= ROUND_OFF * size + NOISE * inertia * largest
            })
        };
        vanishes(&stiffness).then(|| vanishes(&damping))
    }
}

/// A u, and |A| |u|.
fn dense_product(a: &aerobot_systems::modes::Matrix, u: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let row = |i: usize| {
        let terms = u.iter().enumerate().map(|(j, u)| a[(i, j)] * u);
        terms.fold((0.0, 0.0), |(sum, size), term: f64| {
            (sum + term, size + term.abs())
        })
    };
    (0..a.nrows()).map(row).unzip()
}

/// A u, and |A| |u|.
fn sparse_product(
    a: &aerobot_systems::nonlinear_solver::block_sparse::BlockMatrix,
    u: &[f64],
) -> (Vec<f64>, Vec<f64>) {
    let mut sizes = a.clone();
    sizes.values_mut().iter_mut().for_each(|v| *v = v.abs());
    let absolute: Vec<f64> = u.iter().map(|part| part.abs()).collect();
    let mut product = (vec![0.0; u.len()], vec![0.0; u.len()]);
    a.multiply(u, &mut product.0);
    sizes.multiply(&absolute, &mut product.1);
    product
}
