//! Dense operations on the small row-major blocks of one or two sites.
//!
//! `P A = L U` with partial pivoting (Golub and Van Loan, "Matrix
//! Computations", 4th ed. 2013, algorithm 3.4.1), `L` with unit diagonal; in
//! place of the diagonal of `U` its reciprocals are stored. Every operation is
//! written once for any size and compiled for the sizes of nodes and bodies
//! (3 and 6), where the compiler unrolls the loops.

/// Calls an always-inlined kernel with constant sizes where these are common.
macro_rules! with_constant_dim {
    ($kernel:ident, $dim:expr, $($rest:expr),*) => {
        match $dim {
            3 => $kernel(3, $($rest),*),
            6 => $kernel(6, $($rest),*),
            dim => $kernel(dim, $($rest),*),
        }
    };
}

/// Largest absolute value of a block (0 when it is empty).
pub(super) fn norm(block: &[f64]) -> f64 {
    block.iter().fold(0.0, |most, v| v.abs().max(most))
}

/// Factorises the `dim × dim` block in place; `false` when a pivot is not
/// above `threshold` (also when it is not a number).
#[must_use]
pub(super) fn factorise(dim: usize, a: &mut [f64], pivots: &mut [usize], threshold: f64) -> bool {
    with_constant_dim!(factorise_kernel, dim, a, pivots, threshold)
}

/// `b := A⁻¹ b` for the `dim × columns` block `b`, with `A` factorised.
pub(super) fn solve(dim: usize, columns: usize, lu: &[f64], pivots: &[usize], b: &mut [f64]) {
    match (dim, columns) {
        (3, 3) => solve_kernel(3, 3, lu, pivots, b),
        (3, 1) => solve_kernel(3, 1, lu, pivots, b),
        (6, 6) => solve_kernel(6, 6, lu, pivots, b),
        (6, 1) => solve_kernel(6, 1, lu, pivots, b),
        _ => solve_kernel(dim, columns, lu, pivots, b),
    }
}

/// `c := c - a b` with `a` of `m × k`, `b` of `k × n` and `c` of `m × n`.
pub(super) fn subtract_product(
    (m, k, n): (usize, usize, usize),
    a: &[f64],
    b: &[f64],
    c: &mut [f64],
) {
    match (m, k, n) {
        (3, 3, 3) => subtract_kernel((3, 3, 3), a, b, c),
        (6, 3, 3) => subtract_kernel((6, 3, 3), a, b, c),
        (3, 3, 6) => subtract_kernel((3, 3, 6), a, b, c),
        (6, 3, 6) => subtract_kernel((6, 3, 6), a, b, c),
        (3, 3, 1) => subtract_kernel((3, 3, 1), a, b, c),
        (6, 6, 6) => subtract_kernel((6, 6, 6), a, b, c),
        (6, 6, 1) => subtract_kernel((6, 6, 1), a, b, c),
        _ => subtract_kernel((m, k, n), a, b, c),
    }
}

/// `y := y + a x` with `a` of `m × k`.
pub(super) fn add_product(m: usize, k: usize, a: &[f64], x: &[f64], y: &mut [f64]) {
    with_constant_dim!(add_kernel, m, k, a, x, y);
}

#[inline(always)]
fn factorise_kernel(dim: usize, a: &mut [f64], pivots: &mut [usize], threshold: f64) -> bool {
    let a = &mut a[..dim * dim];
    let pivots = &mut pivots[..dim];
    for c in 0..dim {
        let mut p = c;
        for r in c + 1..dim {
            if a[r * dim + c].abs() > a[p * dim + c].abs() {
                p = r;
            }
        }
        let pivot = a[p * dim + c];
        let usable = pivot.abs() > threshold && pivot.is_finite();
        if !usable {
            return false;
        }
        pivots[c] = p;
        if p != c {
            for j in 0..dim {
                a.swap(p * dim + j, c * dim + j);
            }
        }
        let reciprocal = 1.0 / pivot;
        a[c * dim + c] = reciprocal;
        for r in c + 1..dim {
            let factor = a[r * dim + c] * reciprocal;
            a[r * dim + c] = factor;
            for j in c + 1..dim {
                a[r * dim + j] -= factor * a[c * dim + j];
            }
        }
    }
    true
}

#[inline(always)]
fn solve_kernel(dim: usize, columns: usize, lu: &[f64], pivots: &[usize], b: &mut [f64]) {
    let lu = &lu[..dim * dim];
    let pivots = &pivots[..dim];
    let b = &mut b[..dim * columns];
    for (r, &p) in pivots.iter().enumerate() {
        if p != r {
            for j in 0..columns {
                b.swap(p * columns + j, r * columns + j);
            }
        }
    }
    for r in 1..dim {
        for c in 0..r {
            let factor = lu[r * dim + c];
            for j in 0..columns {
                b[r * columns + j] -= factor * b[c * columns + j];
            }
        }
    }
    for r in (0..dim).rev() {
        for c in r + 1..dim {
            let factor = lu[r * dim + c];
            for j in 0..columns {
                b[r * columns + j] -= factor * b[c * columns + j];
            }
        }
        let reciprocal = lu[r * dim + r];
        for j in 0..columns {
            b[r * columns + j] *= reciprocal;
        }
    }
}

#[inline(always)]
fn subtract_kernel((m, k, n): (usize, usize, usize), a: &[f64], b: &[f64], c: &mut [f64]) {
    let a = &a[..m * k];
    let b = &b[..k * n];
    let c = &mut c[..m * n];
    for i in 0..m {
        for l in 0..k {
            let factor = a[i * k + l];
            for j in 0..n {
                c[i * n + j] -= factor * b[l * n + j];
            }
        }
    }
}

#[inline(always)]
fn add_kernel(m: usize, k: usize, a: &[f64], x: &[f64], y: &mut [f64]) {
    let a = &a[..m * k];
    let x = &x[..k];
    let y = &mut y[..m];
    for i in 0..m {
        for j in 0..k {
            y[i] += a[i * k + j] * x[j];
        }
    }
}
