//! Small dense linear systems, real and complex.
//!
//! Gaussian elimination with partial pivoting (Golub and Van Loan, "Matrix Computations", 4th ed. 2013,
//! algorithm 3.4.1). A complex system of n unknowns is the real one of 2n,
//! `[[Re A, -Im A], [Im A, Re A]] (Re x, Im x) = (Re b, Im b)`.

/// A complex number as (real, imaginary).
pub type Complex = (f64, f64);

/// a b.
#[must_use]
pub fn times(a: Complex, b: Complex) -> Complex {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

/// a/b.
#[must_use]
pub fn over(a: Complex, b: Complex) -> Complex {
    let square = b.0 * b.0 + b.1 * b.1;
    (
        (a.0 * b.0 + a.1 * b.1) / square,
        (a.1 * b.0 - a.0 * b.1) / square,
    )
}

/// e^a.
#[must_use]
pub fn exponential(a: Complex) -> Complex {
    let (sin, cos) = libm::sincos(a.1);
    let size = libm::exp(a.0);
    (size * cos, size * sin)
}

/// Solves A x = b; `None` where A is singular.
#[must_use]
pub fn solve(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Option<Vec<f64>> {
    let n = b.len();
    for column in 0..n {
        let pivot =
            (column..n).max_by(|&i, &j| a[i][column].abs().total_cmp(&a[j][column].abs()))?;
        if !(a[pivot][column].abs() > 1e-300) {
            return None;
        }
        a.swap(column, pivot);
        b.swap(column, pivot);
        for row in column + 1..n {
            let factor = a[row][column] / a[column][column];
            let (upper, lower) = a.split_at_mut(row);
            for (x, y) in lower[0][column..].iter_mut().zip(&upper[column][column..]) {
                *x -= factor * y;
            }
            b[row] -= factor * b[column];
        }
    }
    for row in (0..n).rev() {
        let known: f64 = (row + 1..n).map(|k| a[row][k] * b[k]).sum();
        b[row] = (b[row] - known) / a[row][row];
    }
    b.iter().all(|x| x.is_finite()).then_some(b)
}

/// Solves A x = b of complex numbers; `None` where A is singular.
#[must_use]
pub fn solve_complex(a: &[Vec<Complex>], b: &[Complex]) -> Option<Vec<Complex>> {
    let n = b.len();
    let mut real = vec![vec![0.0; 2 * n]; 2 * n];
    for (i, row) in a.iter().enumerate() {
        for (j, &(re, im)) in row.iter().enumerate() {
            (real[i][j], real[i][n + j]) = (re, -im);
            (real[n + i][j], real[n + i][n + j]) = (im, re);
        }
    }
    let right = b.iter().map(|b| b.0).chain(b.iter().map(|b| b.1));
    let x = solve(real, right.collect())?;
    Some((0..n).map(|i| (x[i], x[n + i])).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_complex_system_is_solved() {
        let a = vec![vec![(0.0, 1.0), (2.0, -1.0)], vec![(1.0, 1.0), (0.0, 3.0)]];
        let x = [(1.0, -2.0), (0.5, 0.25)];
        let b: Vec<Complex> = a
            .iter()
            .map(|row| {
                let (p, q) = (times(row[0], x[0]), times(row[1], x[1]));
                (p.0 + q.0, p.1 + q.1)
            })
            .collect();
        for (found, expected) in solve_complex(&a, &b).unwrap().iter().zip(x) {
            assert!((found.0 - expected.0).abs() < 1e-14 && (found.1 - expected.1).abs() < 1e-14);
        }
        assert_eq!(
            solve(vec![vec![1.0, 2.0], vec![2.0, 4.0]], vec![1.0, 1.0]),
            None
        );
    }
}
