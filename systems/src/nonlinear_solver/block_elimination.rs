//! Direct solution of `A x = b` for a block-sparse `A` with a symmetric
//! pattern, by block elimination.
//!
//! The sites are eliminated in a minimum-degree order (Tinney and Walker,
//! Proc. IEEE 55 (1967) 1801; Rose 1972): always a site with the fewest
//! neighbours left, the lowest number among equals. Eliminating site `k` with
//! the neighbours `N(k)` left joins these with each other. With the diagonal
//! block `D_k = A_kk` as it is at that moment (Golub and Van Loan, "Matrix
//! Computations", 4th ed. 2013, section 3.2.11, block LU):
//!
//! ```text
//! W_kj  = D_k⁻¹ A_kj              j in N(k)
//! A_ij := A_ij - A_ik W_kj        i, j in N(k)
//! forward    y_k = D_k⁻¹ b_k,  b_i := b_i - A_ik y_k      i in N(k)
//! backward   x_k = y_k - Σ_j W_kj x_j                     j in N(k), reverse order
//! ```
//!
//! Rows are exchanged inside the diagonal blocks only. On chains `N(k)` has
//! one or two members, so time and storage are linear in the chain length.

use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

use super::block_sparse::{BlockMatrix, BlockPattern};
use super::small_block;

#[cfg(test)]
mod tests;

/// Pivots below this fraction of the block norm count as zero.
const SMALLEST_PIVOT: f64 = 1e-14;

/// A diagonal block that cannot be inverted.
///
/// A pivot of the block was below `1e-14` of the largest absolute value of the
/// block (of the given matrix, or as it was after the elimination of the
/// previous sites, whichever is larger), or was not a finite number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the matrix is singular at site {site}")]
pub struct Singular {
    /// Site of the diagonal block.
    pub site: usize,
}

/// Elimination of one site. Its values lie together in the order: diagonal
/// block, blocks `W_kj` of all neighbours, blocks `A_ik` of all neighbours.
#[derive(Debug, Clone, Copy)]
struct Step {
    site: usize,
    dim: usize,
    /// First unknown of the site.
    offset: usize,
    /// First value of the step, and the first one behind it.
    values: (usize, usize),
    /// Unknowns of all neighbours together.
    width: usize,
    /// Range in `Elimination::neighbours`.
    neighbours: (usize, usize),
    /// First of the squared number of neighbours in `Elimination::targets`.
    targets: usize,
}

/// A neighbour left at the elimination of a site.
#[derive(Debug, Clone, Copy)]
struct Neighbour {
    site: usize,
    dim: usize,
    /// First unknown of the neighbour.
    offset: usize,
    /// First value of its block among the `W_kj`, equally among the `A_ik`.
    place: usize,
}

/// Elimination order, storage and factors of matrices over one pattern.
#[derive(Debug, Clone)]
pub struct Elimination {
    /// In elimination order.
    steps: Vec<Step>,
    neighbours: Vec<Neighbour>,
    /// First value of the block `(i, j)` changed by a step, for each pair of
    /// its neighbours.
    targets: Vec<usize>,
    /// First value of each block of the pattern.
    sources: Vec<usize>,
    values: Vec<f64>,
    /// Row exchanges, as many as unknowns.
    pivots: Vec<usize>,
}

impl Elimination {
    /// Chooses the elimination order of a pattern and lays out the storage.
    ///
    /// Takes `O(N log N)` time for chains of `N` sites. The factors are zero
    /// until [`Elimination::factorise`] is called.
    #[must_use]
    pub fn analyse(pattern: &BlockPattern) -> Self {
        let mut result = Self {
            steps: Vec::with_capacity(pattern.sites()),
            neighbours: Vec::new(),
            targets: Vec::new(),
            sources: Vec::with_capacity(pattern.blocks()),
            values: Vec::new(),
            pivots: vec![0; pattern.dimension()],
        };
        let mut step_of_site = vec![0; pattern.sites()];
        for (site, left) in minimum_degree_order(pattern) {
            step_of_site[site] = result.steps.len();
            result.push_step(pattern, site, &left);
        }
        let values = result.steps.last().map_or(0, |step| step.values.1);
        result.values = vec![0.0; values];
        result.find_targets(&step_of_site);
        for i in 0..pattern.sites() {
            for &j in pattern.row(i) {
                result.sources.push(result.locate(&step_of_site, i, j));
            }
        }
        result
    }

    /// Number of blocks stored for the factors, fill included.
    #[must_use]
    pub fn stored_blocks(&self) -> usize {
        self.steps.len() + 2 * self.neighbours.len()
    }

    /// Sites in the order of their elimination.
    pub fn order(&self) -> impl Iterator<Item = usize> + '_ {
        self.steps.iter().map(|step| step.site)
    }

    /// Factorises a matrix over the pattern that was analysed. Does not
    /// allocate.
    ///
    /// # Errors
    /// [`Singular`] when a diagonal block cannot be inverted; the factors are
    /// then unusable until the next successful call.
    ///
    /// # Panics
    /// If the matrix has fewer blocks or values than the analysed pattern.
    pub fn factorise(&mut self, matrix: &BlockMatrix) -> Result<(), Singular> {
        self.load(matrix);
        for k in 0..self.steps.len() {
            let step = self.steps[k];
            let given = matrix.block(step.site, step.site);
            self.eliminate(&step, small_block::norm(given))?;
        }
        Ok(())
    }

    /// Solves `A x = rhs` with the factors; `rhs` becomes `x`. Does not
    /// allocate.
    ///
    /// # Panics
    /// If `rhs` is shorter than the dimension of the matrix.
    pub fn solve(&self, rhs: &mut [f64]) {
        for step in &self.steps {
            self.forward(step, rhs);
        }
        for step in self.steps.iter().rev() {
            self.backward(step, rhs);
        }
    }

    /// Appends the elimination of `site`, with the neighbours `left`.
    fn push_step(&mut self, pattern: &BlockPattern, site: usize, left: &BTreeSet<usize>) {
        let dim = pattern.dim(site);
        let first = self.neighbours.len();
        let mut width = 0;
        for &site in left {
            self.neighbours.push(Neighbour {
                site,
                dim: pattern.dim(site),
                offset: pattern.offset(site),
                place: width * dim,
            });
            width += pattern.dim(site);
        }
        let begin = self.steps.last().map_or(0, |step| step.values.1);
        self.steps.push(Step {
            site,
            dim,
            offset: pattern.offset(site),
            values: (begin, begin + dim * (dim + 2 * width)),
            width,
            neighbours: (first, self.neighbours.len()),
            targets: 0,
        });
    }

    /// Looks up the blocks that each step changes.
    fn find_targets(&mut self, step_of_site: &[usize]) {
        for k in 0..self.steps.len() {
            self.steps[k].targets = self.targets.len();
            let (first, last) = self.steps[k].neighbours;
            for i in first..last {
                for j in first..last {
                    let (row, column) = (self.neighbours[i].site, self.neighbours[j].site);
                    let target = self.locate(step_of_site, row, column);
                    self.targets.push(target);
                }
            }
        }
    }

    /// First value of the block `(i, j)`, which must be stored.
    fn locate(&self, step_of_site: &[usize], i: usize, j: usize) -> usize {
        let upper = step_of_site[i] < step_of_site[j];
        let (early, late) = if upper { (i, j) } else { (j, i) };
        let step = &self.steps[step_of_site[early]];
        if i == j {
            return step.values.0;
        }
        let neighbours = &self.neighbours[step.neighbours.0..step.neighbours.1];
        let number = neighbours.partition_point(|neighbour| neighbour.site < late);
        let lower = if upper { 0 } else { step.dim * step.width };
        step.values.0 + step.dim * step.dim + lower + neighbours[number].place
    }

    /// Copies the blocks of the matrix to their places, fill set to zero.
    fn load(&mut self, matrix: &BlockMatrix) {
        self.values.fill(0.0);
        let pattern = matrix.pattern();
        for (block, &start) in self.sources.iter().enumerate() {
            let source = &matrix.values()[pattern.value_range(block)];
            let target = &mut self.values[start..start + source.len()];
            for (target, source) in target.iter_mut().zip(source) {
                *target = *source;
            }
        }
    }

    /// Eliminates one site; `given_norm` is the norm of its diagonal block in
    /// the given matrix.
    fn eliminate(&mut self, step: &Step, given_norm: f64) -> Result<(), Singular> {
        let dim = step.dim;
        let (begin, end) = step.values;
        let (own, later) = self.values.split_at_mut(end);
        let (diagonal, sides) = own[begin..].split_at_mut(dim * dim);
        let (upper, lower) = sides.split_at_mut(dim * step.width);
        let neighbours = &self.neighbours[step.neighbours.0..step.neighbours.1];
        let pivots = &mut self.pivots[step.offset..step.offset + dim];

        let threshold = SMALLEST_PIVOT * small_block::norm(diagonal).max(given_norm);
        if !small_block::factorise(dim, diagonal, pivots, threshold) {
            return Err(Singular { site: step.site });
        }
        let mut targets = self.targets[step.targets..].iter();
        for column in neighbours {
            let w = &mut upper[column.place..];
            small_block::solve(dim, column.dim, diagonal, pivots, w);
        }
        for row in neighbours {
            for (column, target) in neighbours.iter().zip(&mut targets) {
                small_block::subtract_product(
                    (row.dim, dim, column.dim),
                    &lower[row.place..],
                    &upper[column.place..],
                    &mut later[target - end..],
                );
            }
        }
        Ok(())
    }

    /// Diagonal block, the `W_kj` and the `A_ik` of a step.
    fn blocks_of(&self, step: &Step) -> (&[f64], &[f64], &[f64]) {
        let own = &self.values[step.values.0..step.values.1];
        let (diagonal, sides) = own.split_at(step.dim * step.dim);
        let (upper, lower) = sides.split_at(step.dim * step.width);
        (diagonal, upper, lower)
    }

    /// `y_k = D_k⁻¹ b_k`, `b_i := b_i - A_ik y_k`.
    fn forward(&self, step: &Step, rhs: &mut [f64]) {
        let dim = step.dim;
        let (diagonal, _, lower) = self.blocks_of(step);
        let pivots = &self.pivots[step.offset..step.offset + dim];
        small_block::solve(dim, 1, diagonal, pivots, &mut rhs[step.offset..]);
        for row in &self.neighbours[step.neighbours.0..step.neighbours.1] {
            let (own, other) = both(rhs, step.offset, row.offset);
            small_block::subtract_product((row.dim, dim, 1), &lower[row.place..], own, other);
        }
    }

    /// `x_k = y_k - Σ_j W_kj x_j`.
    fn backward(&self, step: &Step, rhs: &mut [f64]) {
        let dim = step.dim;
        let (_, upper, _) = self.blocks_of(step);
        for column in &self.neighbours[step.neighbours.0..step.neighbours.1] {
            let (own, other) = both(rhs, step.offset, column.offset);
            small_block::subtract_product((dim, column.dim, 1), &upper[column.place..], other, own);
        }
    }
}

/// The parts of `x` from two different places on, the lower one ending before
/// the higher one.
fn both(x: &mut [f64], first: usize, second: usize) -> (&mut [f64], &mut [f64]) {
    if first < second {
        let (head, tail) = x.split_at_mut(second);
        (&mut head[first..], tail)
    } else {
        let (head, tail) = x.split_at_mut(first);
        (tail, &mut head[second..])
    }
}

/// Sites in elimination order, each with its neighbours left at that moment.
fn minimum_degree_order(pattern: &BlockPattern) -> Vec<(usize, BTreeSet<usize>)> {
    let mut graph: Vec<BTreeSet<usize>> = (0..pattern.sites())
        .map(|i| pattern.row(i).iter().copied().filter(|&j| j != i).collect())
        .collect();
    let mut queue: BinaryHeap<Reverse<(usize, usize)>> = graph
        .iter()
        .enumerate()
        .map(|(site, left)| Reverse((left.len(), site)))
        .collect();
    let mut eliminated = vec![false; graph.len()];
    let mut order = Vec::with_capacity(graph.len());
    while let Some(Reverse((degree, site))) = queue.pop() {
        if eliminated[site] || graph[site].len() != degree {
            continue; // an outdated entry
        }
        eliminated[site] = true;
        let left = std::mem::take(&mut graph[site]);
        for &i in &left {
            graph[i].remove(&site);
            graph[i].extend(left.iter().filter(|&&j| j != i));
            queue.push(Reverse((graph[i].len(), i)));
        }
        order.push((site, left));
    }
    order
}
