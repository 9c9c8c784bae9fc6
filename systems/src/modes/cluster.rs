//! Modes of equal eigenvalues, sorted by what moves.
//!
//! A system that swings alike in x and in y has two modes at one frequency, and any two combinations of
//! them are modes as well. Of a cluster of vectors u_k, the combinations c that extremise the share of one
//! kind of motion in all of it solve
//!
//! ```text
//! G c = mu N c        G_kl = <u_k, u_l> over the one kind, N_kl = <u_k, u_l> over all
//! ```
//!
//! both Hermitian, N positive; with N = L L' an ordinary problem (Golub and Van Loan, "Matrix
//! Computations", 4th ed. 2013, sec. 8.7.2).

use nalgebra::{Complex, DMatrix};

/// Combinations of the vectors, a column each, the largest share of the kind first; `is_kind` says which
/// parts of a vector are of it. `None` where the vectors do not span a space.
#[must_use]
pub fn separate(
    vectors: &[Vec<Complex<f64>>],
    is_kind: impl Fn(usize) -> bool,
) -> Option<DMatrix<Complex<f64>>> {
    let n = vectors.len();
    let product = |k: usize, l: usize, counts: &dyn Fn(usize) -> bool| {
        let pairs = vectors[k].iter().zip(&vectors[l]).enumerate();
        pairs
            .filter(|(place, _)| counts(*place))
            .map(|(_, (a, b))| a.conj() * b)
            .sum::<Complex<f64>>()
    };
    let of_kind = DMatrix::from_fn(n, n, |k, l| product(k, l, &is_kind));
    let of_all = DMatrix::from_fn(n, n, |k, l| product(k, l, &|_| true));
    let lower = of_all.cholesky()?.l();
    let half = lower.solve_lower_triangular(&of_kind)?;
    let ordinary = lower.solve_lower_triangular(&half.adjoint())?;
    let found = ordinary.adjoint().symmetric_eigen();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|a, b| found.eigenvalues[*b].total_cmp(&found.eigenvalues[*a]));
    let vectors = lower
        .adjoint()
        .solve_upper_triangular(&found.eigenvectors)?;
    Some(DMatrix::from_fn(n, n, |row, column| {
        vectors[(row, order[column])]
    }))
}
