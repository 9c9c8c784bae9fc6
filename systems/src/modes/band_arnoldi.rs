//! Arnoldi's method from several start vectors at once: an orthonormal basis of what repeated
//! applications of an operator S make of them, and S in that basis.
//!
//! ```text
//! S v_j = sum_i h_ij v_i        i up to j + b
//! ```
//!
//! b start vectors, so that a system that swings alike in x and in y, whose eigenvalues come in equal
//! pairs, shows both of each (Aliaga, Boley, Freund and Hernandez, "A Lanczos-type method for multiple
//! starting vectors", Math. Comp. 69 (2000) 1577; here with full orthogonalisation, done twice). An
//! eigenpair (theta, y) of the leading square part of h gives the vector V y, whose residual is what the
//! rows below of h make of y.

use nalgebra::{Complex, DMatrix};

use super::real_eigenvectors::{Eigenpair, eigenpairs};

/// Start vectors.
const BAND: usize = 6;

/// The basis and the operator in it.
#[derive(Clone, Debug)]
pub struct BandArnoldi {
    dimension: usize,
    basis: Vec<Vec<f64>>,
    columns: Vec<Vec<f64>>,
}

/// An approximate eigenpair.
#[derive(Clone, Debug)]
pub struct RitzPair {
    /// Value and vector, of length one in the given coordinates.
    pub pair: Eigenpair,
    /// Length of `S x - theta x` over that of `theta x`.
    pub residual: f64,
}

impl BandArnoldi {
    /// From start vectors without a pattern that a mode could have, the same every time.
    #[must_use]
    pub fn new(dimension: usize) -> Self {
        let mut start = Self {
            dimension,
            basis: Vec::new(),
            columns: Vec::new(),
        };
        for number in 0..BAND.min(dimension) {
            let vector = (0..dimension)
                .map(|k| irregular(number * dimension + k))
                .collect();
            start.append(vector);
        }
        start
    }

    /// Number of applications so far.
    #[must_use]
    pub fn size(&self) -> usize {
        self.columns.len()
    }

    /// Whether the basis is that of the whole space.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.columns.len() == self.basis.len()
    }

    /// Takes one more vector into the space, by `apply`.
    pub fn extend(&mut self, apply: &mut dyn FnMut(&mut [f64])) {
        let Some(next) = self.basis.get(self.columns.len()) else {
            return;
        };
        let mut vector = next.clone();
        apply(&mut vector);
        let column = self.append(vector);
        self.columns.push(column);
    }

    /// Orthogonalises a vector and takes it into the basis, unless nothing is left of it; its parts along
    /// the basis.
    fn append(&mut self, mut vector: Vec<f64>) -> Vec<f64> {
        let mut parts = vec![0.0; self.basis.len()];
        for _ in 0..2 {
            for (part, member) in parts.iter_mut().zip(&self.basis) {
                let along = dot(member, &vector);
                *part += along;
                subtract(&mut vector, along, member);
            }
        }
        let left = dot(&vector, &vector).sqrt();
        if self.basis.len() == self.dimension || left < f64::MIN_POSITIVE.sqrt() {
            return parts;
        }
        vector.iter_mut().for_each(|value| *value /= left);
        // What is left may be round-off, and round-off is not orthogonal.
        for member in &self.basis {
            let along = dot(member, &vector);
            subtract(&mut vector, along, member);
        }
        let length = dot(&vector, &vector).sqrt();
        vector.iter_mut().for_each(|value| *value /= length);
        self.basis.push(vector);
        parts.push(left);
        parts
    }

    /// The eigenpairs of the operator as far as the basis shows them; `None` where they are not found.
    #[must_use]
    pub fn ritz_pairs(&self) -> Option<Vec<RitzPair>> {
        let size = self.columns.len();
        let part = |row: usize, column: usize| {
            let column = &self.columns[column];
            column.get(row).copied().unwrap_or(0.0)
        };
        let pairs = eigenpairs(DMatrix::from_fn(size, size, part))?;
        let ritz = pairs.into_iter().map(|small| {
            let residual = (size..self.basis.len()).map(|row| {
                let terms = small.vector.iter().enumerate();
                let sum: Complex<f64> = terms.map(|(k, y)| *y * part(row, k)).sum();
                sum.norm_sqr()
            });
            let residual = residual.sum::<f64>().sqrt();
            let mut vector = vec![Complex::new(0.0, 0.0); self.dimension];
            for (y, member) in small.vector.iter().zip(&self.basis) {
                for (sum, entry) in vector.iter_mut().zip(member) {
                    *sum += *y * *entry;
                }
            }
            RitzPair {
                residual: residual / small.value.norm_sqr().sqrt().max(f64::MIN_POSITIVE),
                pair: Eigenpair {
                    value: small.value,
                    vector,
                },
            }
        });
        Some(ritz.collect())
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn subtract(from: &mut [f64], factor: f64, what: &[f64]) {
    for (from, what) in from.iter_mut().zip(what) {
        *from -= factor * what;
    }
}

/// Numbers between -0.5 and 0.5: a counter, its bits well mixed (Steele, Lea and Flood, "Fast splittable
/// pseudorandom number generators", OOPSLA 2014: SplitMix64).
fn irregular(counter: usize) -> f64 {
    let mut z = (counter as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^= z >> 31;
    (z >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
}
