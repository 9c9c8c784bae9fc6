//! All eigenvalues and eigenvectors of a real matrix: its real Schur form A = Q T Q', and the
//! eigenvectors of the quasi-triangular T by back-substitution (Golub and Van Loan, "Matrix
//! Computations", 4th ed. 2013, sec. 7.6.4).

use nalgebra::{Complex, DMatrix, Schur};

/// Sweeps of the QR algorithm for each eigenvalue at most; two or three are usual.
const SWEEPS: usize = 100;

/// Elements this many round-offs beside their neighbours count as zero: the least that converges.
const ROUND_OFFS: [f64; 4] = [1.0, 16.0, 256.0, 4096.0];

/// An eigenvalue and its vector.
#[derive(Clone, Debug, PartialEq)]
pub struct Eigenpair {
    /// The eigenvalue.
    pub value: Complex<f64>,
    /// Its vector, of length one.
    pub vector: Vec<Complex<f64>>,
}

/// All eigenpairs, those of complex pairs beside each other; `None` where the QR algorithm does not
/// converge.
#[must_use]
pub fn eigenpairs(matrix: DMatrix<f64>) -> Option<Vec<Eigenpair>> {
    let n = matrix.nrows();
    if n == 0 {
        return Some(Vec::new());
    }
    let schur = ROUND_OFFS.iter().find_map(|part| {
        let smallest = part * f64::EPSILON;
        Schur::try_new(matrix.clone(), smallest, SWEEPS * n.max(10))
    })?;
    let (q, t) = schur.unpack();
    let smallest = f64::EPSILON * t.amax().max(f64::MIN_POSITIVE);
    let mut pairs = Vec::with_capacity(n);
    for (first, size) in blocks(&t) {
        for value in values(&t, first, size) {
            let within = back_substitute(&t, (first, size), value, smallest);
            let mut vector = vec![Complex::new(0.0, 0.0); n];
            for (k, part) in within.iter().enumerate() {
                for (sum, entry) in vector.iter_mut().zip(q.column(k).iter()) {
                    *sum += part * *entry;
                }
            }
            let size = vector.iter().map(Complex::norm_sqr).sum::<f64>().sqrt();
            vector.iter_mut().for_each(|part| *part /= size);
            pairs.push(Eigenpair { value, vector });
        }
    }
    Some(pairs)
}

/// First rows and sizes of the diagonal blocks.
fn blocks(t: &DMatrix<f64>) -> Vec<(usize, usize)> {
    let mut blocks = Vec::new();
    let mut row = 0;
    while row < t.nrows() {
        let size = if row + 1 < t.nrows() && t[(row + 1, row)] != 0.0 {
            2
        } else {
            1
        };
        blocks.push((row, size));
        row += size;
    }
    blocks
}

/// The eigenvalues of a diagonal block.
fn values(t: &DMatrix<f64>, k: usize, size: usize) -> Vec<Complex<f64>> {
    if size == 1 {
        return vec![Complex::new(t[(k, k)], 0.0)];
    }
    let (a, b, c, d) = (t[(k, k)], t[(k, k + 1)], t[(k + 1, k)], t[(k + 1, k + 1)]);
    let (mean, half) = (0.5 * (a + d), 0.5 * (a - d));
    let discriminant = half * half + b * c;
    if discriminant < 0.0 {
        let beside = (-discriminant).sqrt();
        vec![Complex::new(mean, beside), Complex::new(mean, -beside)]
    } else {
        let larger = mean + discriminant.sqrt().copysign(mean);
        let product = a * d - b * c;
        let other = if larger == 0.0 { 0.0 } else { product / larger };
        vec![Complex::new(larger, 0.0), Complex::new(other, 0.0)]
    }
}

/// The eigenvector of T for an eigenvalue of the block at `own`; its parts up to the end of the block.
fn back_substitute(
    t: &DMatrix<f64>,
    own: (usize, usize),
    value: Complex<f64>,
    smallest: f64,
) -> Vec<Complex<f64>> {
    let (first, size) = own;
    let mut y = vec![Complex::new(0.0, 0.0); first + size];
    if size == 1 {
        y[first] = Complex::new(1.0, 0.0);
    } else {
        let above = (
            Complex::from(t[(first, first + 1)]),
            value - t[(first, first)],
        );
        let below = (
            value - t[(first + 1, first + 1)],
            Complex::from(t[(first + 1, first)]),
        );
        let size = |pair: &(Complex<f64>, Complex<f64>)| pair.0.norm_sqr() + pair.1.norm_sqr();
        let chosen = if size(&above) > size(&below) {
            above
        } else {
            below
        };
        (y[first], y[first + 1]) = chosen;
    }
    for (row, size) in blocks(t).into_iter().rev() {
        if row >= first {
            continue;
        }
        let sum_of = |y: &[Complex<f64>], part: usize| -> Complex<f64> {
            (row + size..y.len())
                .map(|k| y[k] * t[(row + part, k)])
                .sum()
        };
        if size == 1 {
            y[row] =
                -sum_of(&y, 0) / away_from_zero(Complex::from(t[(row, row)]) - value, smallest);
        } else {
            let sums = [sum_of(&y, 0), sum_of(&y, 1)];
            let (a, d) = (
                Complex::from(t[(row, row)]) - value,
                Complex::from(t[(row + 1, row + 1)]) - value,
            );
            let (b, c) = (t[(row, row + 1)], t[(row + 1, row)]);
            let determinant = away_from_zero(a * d - b * c, smallest * smallest);
            y[row] = (sums[1] * b - sums[0] * d) / determinant;
            y[row + 1] = (sums[0] * c - sums[1] * a) / determinant;
        }
    }
    y
}

/// Equal eigenvalues divide by zero: by next to it, the vector is one of their common space.
fn away_from_zero(value: Complex<f64>, smallest: f64) -> Complex<f64> {
    if value.norm_sqr() < smallest * smallest {
        Complex::from(smallest)
    } else {
        value
    }
}
