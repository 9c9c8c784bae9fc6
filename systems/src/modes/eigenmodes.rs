//! The slowest modes of a linearised motion.
//!
//! States are counted in parts of about equal kinetic energy, velocities times sqrt(inertia) and
//! displacements times sqrt(inertia) and a slow frequency, so that a metre and a radian can be compared.

use nalgebra::{Complex, DMatrix};

use super::band_arnoldi::BandArnoldi;
use super::real_eigenvectors::{Eigenpair, eigenpairs};
use super::shift_invert::ShiftInvert;

/// Relative residual of an eigenvalue that counts.
const TOLERANCE: f64 = 1e-11;
/// Shifts that are tried, each so much larger than the one before.
const SHIFT_RATIOS: [f64; 4] = [1.0, 1.37, 1.93, 2.71];

/// How modes are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// All of them at once: time grows with the cube of their number.
    #[default]
    Complete,
    /// The slowest by Arnoldi's method.
    Slowest,
}

/// A solution `x e^(lambda t)`.
#[derive(Clone, Debug, PartialEq)]
pub struct Eigenmode {
    /// lambda, 1/s.
    pub eigenvalue: Complex<f64>,
    /// Displacements x, of any size.
    pub displacement: Vec<Complex<f64>>,
    /// First-order states, on the same scale.
    pub first_order: Vec<Complex<f64>>,
}

/// Why modes are not found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotFound {
    /// No shift would do.
    #[error("the equations of small motion are singular")]
    Singular,
    /// The QR algorithm did not converge.
    #[error("the eigenvalues of small motion do not converge")]
    NotConverged,
}

/// The `count` modes whose |lambda| is smallest, slowest first, of a complex pair that with the positive
/// frequency; all there are if they are fewer. `slow_per_s` is a guess of how slow they are, 1/s.
///
/// # Errors
/// As [`NotFound`] says.
pub fn slowest(
    motion: &mut dyn ShiftInvert,
    count: usize,
    slow_per_s: f64,
    method: Method,
) -> Result<Vec<Eigenmode>, NotFound> {
    if motion.is_empty() {
        return Ok(Vec::new());
    }
    let tried = SHIFT_RATIOS.map(|ratio| 0.1 * ratio * slow_per_s);
    let shift = tried.into_iter().find(|shift| motion.factorise(*shift));
    let shift = shift.ok_or(NotFound::Singular)?;
    let scales = scales(motion, slow_per_s);
    let mut apply = |vector: &mut [f64]| {
        for (value, scale) in vector.iter_mut().zip(&scales) {
            *value /= scale;
        }
        motion.apply(vector);
        for (value, scale) in vector.iter_mut().zip(&scales) {
            *value *= scale;
        }
    };
    let pairs = match method {
        Method::Complete => complete(scales.len(), &mut apply),
        Method::Slowest => converged(scales.len(), count, &mut apply),
    };
    let mut modes: Vec<Eigenmode> = pairs
        .ok_or(NotFound::NotConverged)?
        .into_iter()
        .filter(|pair| pair.value.im <= 0.0 && pair.value.norm_sqr() > 0.0)
        .map(|pair| unscaled(&pair, shift, &scales, motion))
        .collect();
    let size = |mode: &Eigenmode| mode.eigenvalue.norm_sqr();
    modes.sort_by(|a, b| size(a).total_cmp(&size(b)));
    modes.truncate(count);
    Ok(modes)
}

/// What every part of the state is multiplied by.
fn scales(motion: &dyn ShiftInvert, slow_per_s: f64) -> Vec<f64> {
    let inertia = motion.inertia();
    let root = |inertia: &f64| inertia.max(f64::MIN_POSITIVE).sqrt();
    let velocities = inertia.iter().map(root);
    let displacements = velocities.clone().map(|scale| scale * 10.0 * slow_per_s);
    let first_order = std::iter::repeat_n(1.0, motion.first_order());
    displacements.chain(velocities).chain(first_order).collect()
}

/// All eigenpairs, column by column.
fn complete(dimension: usize, apply: &mut dyn FnMut(&mut [f64])) -> Option<Vec<Eigenpair>> {
    let mut matrix = DMatrix::zeros(dimension, dimension);
    for k in 0..dimension {
        let mut column = vec![0.0; dimension];
        column[k] = 1.0;
        apply(&mut column);
        matrix.column_mut(k).copy_from_slice(&column);
    }
    eigenpairs(matrix)
}

/// The largest eigenpairs, as many as it takes for `count` modes.
fn converged(
    dimension: usize,
    count: usize,
    apply: &mut dyn FnMut(&mut [f64]),
) -> Option<Vec<Eigenpair>> {
    let mut krylov = BandArnoldi::new(dimension);
    // Two of each pair, and those beside the last that may be larger than it seems.
    let wanted = 2 * count + 4;
    let mut next = 2 * wanted + 24;
    loop {
        while krylov.size() < next && !krylov.is_complete() {
            krylov.extend(apply);
        }
        let mut found = krylov.ritz_pairs()?;
        found.sort_by(|a, b| {
            let size = |value: Complex<f64>| value.norm_sqr();
            size(b.pair.value).total_cmp(&size(a.pair.value))
        });
        let enough = wanted.min(found.len());
        let are_found = found[..enough].iter().all(|ritz| ritz.residual < TOLERANCE);
        if are_found || krylov.is_complete() {
            let good = found.into_iter().take(enough);
            return Some(good.map(|ritz| ritz.pair).collect());
        }
        next += next / 3;
    }
}

/// The mode of an eigenpair of the scaled inverse.
fn unscaled(pair: &Eigenpair, shift: f64, scales: &[f64], motion: &dyn ShiftInvert) -> Eigenmode {
    let n = motion.coordinates();
    let parts = pair.vector.iter().zip(scales);
    let state: Vec<Complex<f64>> = parts.map(|(part, scale)| part / *scale).collect();
    Eigenmode {
        // A real eigenvalue stays real: its sign of zero is not to be a matter of taste.
        eigenvalue: Complex::from(shift) + pair.value.inv(),
        displacement: state[..n].to_vec(),
        first_order: state[2 * n..].to_vec(),
    }
}
