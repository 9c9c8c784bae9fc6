//! Block-sparse square matrices over a graph of sites.
//!
//! Site `i` has `d_i` unknowns, numbered from `offset_i = d_0 + … + d_{i-1}`.
//! The matrix is `A = (A_ij)`, with a stored block `A_ij` of `d_i × d_j`
//! values (row-major) for `i = j` and for each pair of neighbours; the pattern
//! is symmetric, the values need not be. The product is
//! `y_i = Σ_j A_ij x_j`. Layout: block compressed rows (George and Liu,
//! "Computer Solution of Large Sparse Positive Definite Systems", 1981).

use super::small_block;

#[cfg(test)]
mod tests;

/// Which blocks of a square matrix over the sites are stored.
///
/// Symmetric, with every diagonal block present.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BlockPattern {
    /// First unknown of each site, and the number of unknowns at the end.
    offsets: Vec<usize>,
    /// First block of each block row, and the number of blocks at the end.
    row_starts: Vec<usize>,
    /// Column site of each block, ascending in each row.
    columns: Vec<usize>,
    /// First value of each block, and the number of values at the end.
    block_starts: Vec<usize>,
}

impl BlockPattern {
    /// The pattern of a graph: `dims[i]` unknowns at site `i`, and both blocks
    /// `(i, j)` and `(j, i)` for each edge. Duplicate edges and edges of a
    /// site with itself are merged.
    ///
    /// # Panics
    /// If an edge names a site that is not below `dims.len()`.
    #[must_use]
    pub fn new(dims: &[usize], edges: &[(usize, usize)]) -> Self {
        let mut rows: Vec<Vec<usize>> = (0..dims.len()).map(|site| vec![site]).collect();
        for &(i, j) in edges {
            rows[i].push(j);
            rows[j].push(i);
        }
        let mut offsets = vec![0];
        let mut row_starts = vec![0];
        let mut columns = Vec::with_capacity(dims.len() + 2 * edges.len());
        let mut block_starts = vec![0];
        let (mut unknowns, mut values) = (0, 0);
        for (row, &dim) in rows.iter_mut().zip(dims) {
            row.sort_unstable();
            row.dedup();
            for &column in row.iter() {
                values += dim * dims[column];
                columns.push(column);
                block_starts.push(values);
            }
            unknowns += dim;
            offsets.push(unknowns);
            row_starts.push(columns.len());
        }
        Self {
            offsets,
            row_starts,
            columns,
            block_starts,
        }
    }

    /// Number of sites.
    #[must_use]
    pub fn sites(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Number of unknowns of all sites together.
    #[must_use]
    pub fn dimension(&self) -> usize {
        self.offsets[self.sites()]
    }

    /// Number of unknowns of a site.
    #[must_use]
    pub fn dim(&self, site: usize) -> usize {
        self.offsets[site + 1] - self.offsets[site]
    }

    /// Number of the first unknown of a site.
    #[must_use]
    pub fn offset(&self, site: usize) -> usize {
        self.offsets[site]
    }

    /// Sites with a block in the row of `site`: itself and its neighbours,
    /// ascending.
    #[must_use]
    pub fn row(&self, site: usize) -> &[usize] {
        &self.columns[self.row_starts[site]..self.row_starts[site + 1]]
    }

    /// Number of stored blocks.
    #[must_use]
    pub fn blocks(&self) -> usize {
        self.columns.len()
    }

    /// Number of stored values.
    #[must_use]
    pub fn values(&self) -> usize {
        self.block_starts[self.blocks()]
    }

    /// Number of block `(i, j)` in storage order, row after row; `None` when
    /// it is not stored.
    #[must_use]
    pub fn block_index(&self, i: usize, j: usize) -> Option<usize> {
        let place = self.row(i).binary_search(&j).ok()?;
        Some(self.row_starts[i] + place)
    }

    /// Where the values of the block with this number lie in
    /// [`BlockMatrix::values`].
    #[must_use]
    pub fn value_range(&self, block: usize) -> std::ops::Range<usize> {
        self.block_starts[block]..self.block_starts[block + 1]
    }
}

/// A square matrix over a [`BlockPattern`]; its values need not be symmetric.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockMatrix {
    pattern: BlockPattern,
    values: Vec<f64>,
}

impl BlockMatrix {
    /// The zero matrix over a pattern.
    #[must_use]
    pub fn new(pattern: BlockPattern) -> Self {
        let values = vec![0.0; pattern.values()];
        Self { pattern, values }
    }

    /// The pattern of the matrix.
    #[must_use]
    pub fn pattern(&self) -> &BlockPattern {
        &self.pattern
    }

    /// All stored values, block after block.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// All stored values to change, block after block.
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Sets all values to zero.
    pub fn clear(&mut self) {
        self.values.fill(0.0);
    }

    /// Adds `v` to the entry at row `r`, column `c` of block `(i, j)`.
    ///
    /// # Panics
    /// If the block is not stored, or if `r` or `c` lies outside it.
    pub fn add(&mut self, i: usize, j: usize, r: usize, c: usize, v: f64) {
        let columns = self.pattern.dim(j);
        let row = &mut self.block_mut(i, j)[r * columns..(r + 1) * columns];
        row[c] += v;
    }

    /// Values of block `(i, j)`, row-major, `dim(i) × dim(j)`; empty when the
    /// block is not stored.
    #[must_use]
    pub fn block(&self, i: usize, j: usize) -> &[f64] {
        match self.pattern.block_index(i, j) {
            Some(block) => &self.values[self.pattern.value_range(block)],
            None => &[],
        }
    }

    /// Values of block `(i, j)` to change, row-major, `dim(i) × dim(j)`; empty
    /// when the block is not stored.
    pub fn block_mut(&mut self, i: usize, j: usize) -> &mut [f64] {
        match self.pattern.block_index(i, j) {
            Some(block) => &mut self.values[self.pattern.value_range(block)],
            None => &mut [],
        }
    }

    /// Sets all values to those of a matrix over the same pattern, times
    /// `factor`.
    pub fn set_multiple(&mut self, factor: f64, other: &BlockMatrix) {
        for (value, other) in self.values.iter_mut().zip(&other.values) {
            *value = factor * other;
        }
    }

    /// `y = A x`.
    ///
    /// # Panics
    /// If `x` or `y` is shorter than the dimension.
    pub fn multiply(&self, x: &[f64], y: &mut [f64]) {
        let pattern = &self.pattern;
        for i in 0..pattern.sites() {
            let (start, dim) = (pattern.offset(i), pattern.dim(i));
            let y_i = &mut y[start..start + dim];
            y_i.fill(0.0);
            let first = pattern.row_starts[i];
            for (place, &j) in pattern.row(i).iter().enumerate() {
                let block = &self.values[pattern.value_range(first + place)];
                let x_j = &x[pattern.offset(j)..pattern.offset(j + 1)];
                small_block::add_product(dim, x_j.len(), block, x_j, y_i);
            }
        }
    }
}
