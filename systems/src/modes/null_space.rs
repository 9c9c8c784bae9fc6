//! Directions that linear constraints leave free.

use nalgebra::DMatrix;

/// Eigenvalues below this part of the largest count as zero.
const DEPENDENT: f64 = 1e-12;

/// An orthonormal basis of the vectors of `length` to which all `rows` are orthogonal, by the eigenvectors of
/// the rows' Gram matrix.
#[must_use]
pub fn null_space(rows: &[Vec<f64>], length: usize) -> Vec<Vec<f64>> {
    let mut gram = DMatrix::<f64>::zeros(length, length);
    for row in rows {
        for (i, a) in row.iter().enumerate() {
            for (j, b) in row.iter().enumerate() {
                gram[(i, j)] += a * b;
            }
        }
    }
    let decomposed = gram.symmetric_eigen();
    let largest = decomposed.eigenvalues.amax();
    let values = decomposed.eigenvalues.iter();
    values
        .zip(decomposed.eigenvectors.column_iter())
        .filter(|(value, _)| value.abs() <= DEPENDENT * largest)
        .map(|(_, vector)| vector.iter().copied().collect())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dot(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a * b).sum()
    }

    #[test]
    fn what_is_left_free_is_orthonormal_and_orthogonal_to_the_rows() {
        // The third row is the sum of the others, as of a redundant loop.
        let rows = vec![
            vec![1.0, 0.0, -1.0, 0.0, 2.0],
            vec![0.0, 3.0, 0.5, -1.0, 0.0],
            vec![1.0, 3.0, -0.5, -1.0, 2.0],
        ];
        let free = null_space(&rows, 5);
        assert_eq!(free.len(), 3);
        for (k, vector) in free.iter().enumerate() {
            for row in &rows {
                assert!(dot(row, vector).abs() < 1e-12);
            }
            for (other, expected) in free.iter().enumerate().map(|(j, v)| (v, f64::from(j == k))) {
                assert!((dot(vector, other) - expected).abs() < 1e-12);
            }
        }
        assert_eq!(null_space(&[], 4).len(), 4);
    }
}
