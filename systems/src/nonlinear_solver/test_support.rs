//! Random numbers, graphs and dense algebra for the tests.

use super::block_sparse::{BlockMatrix, BlockPattern};

/// Edges between sites.
pub(crate) type Edges = Vec<(usize, usize)>;

/// Pseudo-random numbers (xorshift64*, Vigna 2016).
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    /// Uniform in [-1, 1).
    pub(crate) fn signed(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// Uniform in 0..limit.
    pub(crate) fn below(&mut self, limit: usize) -> usize {
        (self.next() >> 16) as usize % limit
    }
}

pub(crate) fn chain(sites: usize) -> Edges {
    (1..sites).map(|i| (i - 1, i)).collect()
}

/// Graphs of `sites` sites of all kinds that occur, by name.
pub(crate) fn graphs(sites: usize, random: &mut Random) -> Vec<(&'static str, Edges)> {
    let tree = (1..sites).map(|i| (random.below(i), i)).collect();
    let mut ring = chain(sites);
    ring.push((sites - 1, 0));
    // Chains of random length between three bodies, the last three sites.
    let bodies = |random: &mut Random| sites.saturating_sub(1 + random.below(3));
    let mut rings = Vec::new();
    for i in 0..sites {
        let body = bodies(random);
        match random.below(4) {
            0 => rings.extend([(i, body), (i, bodies(random))]),
            1 => rings.push((i, body)),
            _ => rings.push((i, (i + 1) % sites)),
        }
    }
    let pieces = chain(sites).into_iter().filter(|_| random.below(3) > 0);
    let pieces = pieces.collect();
    let any = (0..2 * sites)
        .map(|_| (random.below(sites), random.below(sites)))
        .collect();
    let mut shuffled: Vec<usize> = (0..sites).collect();
    for i in (1..sites).rev() {
        shuffled.swap(i, random.below(i + 1));
    }
    let renumbered = chain(sites)
        .iter()
        .map(|&(i, j)| (shuffled[i], shuffled[j]))
        .collect();
    vec![
        ("chain", chain(sites)),
        ("renumbered chain", renumbered),
        ("tree", tree),
        ("ring", ring),
        ("rings sharing bodies", rings),
        ("disconnected chains", pieces),
        ("any graph", any),
    ]
}

/// Three chains of `length` nodes between two bodies (the last two sites).
pub(crate) fn suspension(length: usize) -> (Vec<usize>, Edges) {
    let (top, bottom) = (3 * length, 3 * length + 1);
    let mut dims = vec![3; 3 * length];
    dims.extend([6, 6]);
    let mut edges = Vec::new();
    for first in [0, length, 2 * length] {
        edges.push((top, first));
        edges.extend((first + 1..first + length).map(|i| (i - 1, i)));
        edges.push((first + length - 1, bottom));
    }
    (dims, edges)
}

pub(crate) fn random_dims(sites: usize, random: &mut Random) -> Vec<usize> {
    (0..sites).map(|_| [3, 6][random.below(2)]).collect()
}

/// Random values, with a diagonal larger than the sum of its row, rows then
/// exchanged in pairs inside the blocks when `exchange` is set.
pub(crate) fn dominant(pattern: &BlockPattern, exchange: bool, random: &mut Random) -> BlockMatrix {
    let mut matrix = BlockMatrix::new(pattern.clone());
    for i in 0..pattern.sites() {
        for r in 0..pattern.dim(i) {
            let row = if exchange {
                (r + 1) % pattern.dim(i)
            } else {
                r
            };
            let mut sum = 0.5;
            for &j in pattern.row(i) {
                for c in 0..pattern.dim(j) {
                    let v = random.signed();
                    sum += v.abs();
                    matrix.add(i, j, row, c, v);
                }
            }
            matrix.add(i, i, row, r, sum * random.signed().signum());
        }
    }
    matrix
}

pub(crate) fn dense(matrix: &BlockMatrix) -> Vec<Vec<f64>> {
    let pattern = matrix.pattern();
    let mut full = vec![vec![0.0; pattern.dimension()]; pattern.dimension()];
    for i in 0..pattern.sites() {
        for &j in pattern.row(i) {
            let columns = pattern.dim(j);
            for (number, v) in matrix.block(i, j).iter().enumerate() {
                let (r, c) = (number / columns, number % columns);
                full[pattern.offset(i) + r][pattern.offset(j) + c] = *v;
            }
        }
    }
    full
}

/// Solution of `a x = b` by dense elimination with partial pivoting.
pub(crate) fn dense_solve(mut a: Vec<Vec<f64>>, b: &[f64]) -> Vec<f64> {
    let n = b.len();
    let mut x = b.to_vec();
    for c in 0..n {
        let p = (c..n)
            .max_by(|&p, &q| a[p][c].abs().total_cmp(&a[q][c].abs()))
            .unwrap();
        a.swap(c, p);
        x.swap(c, p);
        let pivot_row = a[c].clone();
        for r in c + 1..n {
            let factor = a[r][c] / pivot_row[c];
            for (entry, pivot) in a[r].iter_mut().zip(&pivot_row).skip(c) {
                *entry -= factor * pivot;
            }
            x[r] -= factor * x[c];
        }
    }
    for r in (0..n).rev() {
        let known: f64 = (r + 1..n).map(|c| a[r][c] * x[c]).sum();
        x[r] = (x[r] - known) / a[r][r];
    }
    x
}

/// Largest absolute difference.
pub(crate) fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).fold(0.0, |most, (a, b)| {
        let difference = (a - b).abs();
        if difference.is_nan() {
            f64::INFINITY
        } else {
            difference.max(most)
        }
    })
}
