//! Direct solution for one or two bodies, which most scenes have: one small matrix of known size.
//!
//! `A = L U` (Golub and Van Loan 2013, algorithm 3.2.1) without row exchanges: what is eliminated is a
//! mass matrix with the stiffness and damping of a stable motion, whose symmetric part is positive
//! definite, and there the pivots on the diagonal are safe (sec. 4.3.2). Where one is not positive, the
//! caller has [`Elimination`](crate::nonlinear_solver::block_elimination), which exchanges rows.

use glam::DMat3;

use super::body_block::BodyBlock;
use super::topology::BodySite;

/// A pivot below this part of the diagonal element before the elimination is not trusted.
const LEAST_PIVOT: f64 = 1e-12;

/// Factors of the matrix of one or two bodies: two points, a point and a body, and so on.
#[derive(Clone, Debug)]
#[allow(
    clippy::large_enum_variant,
    reason = "there are a few of them in a simulation, and a box is one more step to the values"
)]
pub enum FewBodies {
    /// One point.
    Three(Factors<3>),
    /// One body, or two points.
    Six(Factors<6>),
    /// A body and a point.
    Nine(Factors<9>),
    /// Two bodies.
    Twelve(Factors<12>),
}

/// Calls a method of the factors, whatever their size.
macro_rules! with_factors {
    ($few:expr, $factors:ident => $call:expr) => {
        match $few {
            FewBodies::Three($factors) => $call,
            FewBodies::Six($factors) => $call,
            FewBodies::Nine($factors) => $call,
            FewBodies::Twelve($factors) => $call,
        }
    };
}

impl FewBodies {
    /// For these bodies; `None` if there are none, or too many.
    #[must_use]
    pub fn new(bodies: &[BodySite]) -> Option<Self> {
        match bodies.iter().map(BodySite::unknowns).sum() {
            _ if bodies.len() > 2 => None,
            3 => Some(Self::Three(Factors::ZERO)),
            6 => Some(Self::Six(Factors::ZERO)),
            9 => Some(Self::Nine(Factors::ZERO)),
            12 => Some(Self::Twelve(Factors::ZERO)),
            _ => None,
        }
    }

    /// Begins a new matrix.
    pub fn clear(&mut self) {
        with_factors!(self, factors => *factors = Factors::ZERO);
    }

    /// Adds a block whose first row and column are given; points (`turns` false, of rows and of
    /// columns) take the linear part only.
    pub fn add(&mut self, at: (usize, usize), turns: (bool, bool), block: &BodyBlock) {
        with_factors!(self, factors => factors.add_block(at, turns, block));
    }

    /// Factorises what has been added; false if that takes row exchanges.
    #[must_use]
    pub fn factorise(&mut self) -> bool {
        with_factors!(self, factors => factors.factorise())
    }

    /// Solves with the factors; the right-hand side becomes the solution.
    pub fn solve(&self, rhs: &mut [f64]) {
        with_factors!(self, factors => factors.solve(rhs));
    }
}

/// L without its diagonal of ones and U with the reciprocals of its diagonal, by rows.
#[derive(Clone, Debug)]
pub struct Factors<const N: usize>([[f64; N]; N]);

impl<const N: usize> Factors<N> {
    const ZERO: Self = Self([[0.0; N]; N]);

    #[inline]
    fn add_block(
        &mut self,
        (row, column): (usize, usize),
        (rows_turn, columns_turn): (bool, bool),
        block: &BodyBlock,
    ) {
        self.add_part(row, column, &block.linear);
        if columns_turn {
            self.add_part(row, column + 3, &block.linear_by_turn);
        }
        if rows_turn {
            self.add_part(row + 3, column, &block.turn_by_linear);
        }
        if rows_turn && columns_turn {
            self.add_part(row + 3, column + 3, &block.turn);
        }
    }

    #[inline]
    fn add_part(&mut self, row: usize, column: usize, part: &DMat3) {
        for (r, values) in self.0[row..row + 3].iter_mut().enumerate() {
            let values = &mut values[column..column + 3];
            values[0] += part.x_axis[r];
            values[1] += part.y_axis[r];
            values[2] += part.z_axis[r];
        }
    }

    fn factorise(&mut self) -> bool {
        let a = &mut self.0;
        let mut least = [0.0; N];
        for (k, least) in least.iter_mut().enumerate() {
            *least = LEAST_PIVOT * a[k][k].abs();
        }
        for k in 0..N {
            let pivot = a[k][k];
            // Also false where the pivot is not a number.
            let usable = pivot > least[k] && pivot.is_finite();
            if !usable {
                return false;
            }
            let reciprocal = 1.0 / pivot;
            // Zero up to the diagonal, so that whole rows of known length can be subtracted.
            let mut rest = a[k];
            rest[..=k].fill(0.0);
            for row in &mut a[k + 1..] {
                let factor = row[k] * reciprocal;
                for (value, rest) in row.iter_mut().zip(&rest) {
                    *value -= factor * rest;
                }
                row[k] = factor;
            }
            a[k][k] = reciprocal;
        }
        true
    }

    fn solve(&self, rhs: &mut [f64]) {
        let a = &self.0;
        let mut x = [0.0; N];
        x.copy_from_slice(&rhs[..N]);
        for r in 1..N {
            let mut sum = x[r];
            for c in 0..r {
                sum -= a[r][c] * x[c];
            }
            x[r] = sum;
        }
        for r in (0..N).rev() {
            let mut sum = x[r];
            for c in (r + 1..N).rev() {
                sum -= a[r][c] * x[c];
            }
            x[r] = sum * a[r][r];
        }
        rhs[..N].copy_from_slice(&x);
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::nonlinear_solver::test_support::{Random, dense_solve};

    fn matrix(random: &mut Random) -> DMat3 {
        let mut column = || DVec3::new(random.signed(), random.signed(), random.signed());
        DMat3::from_cols(column(), column(), column())
    }

    fn block(random: &mut Random, diagonal: f64) -> BodyBlock {
        let own = DMat3::from_diagonal(DVec3::splat(diagonal));
        BodyBlock {
            linear: matrix(random) + own,
            linear_by_turn: matrix(random),
            turn_by_linear: matrix(random),
            turn: matrix(random) + own,
        }
    }

    fn site(turns: bool) -> BodySite {
        BodySite {
            first_state: 0,
            turns,
            arm_m: 1.0,
        }
    }

    /// The same matrix, written out element by element, in a dense solution with row exchanges.
    #[test]
    fn few_bodies_answer_as_the_dense_system_does() {
        let mut random = Random::new(11);
        for turns in [
            vec![false],
            vec![true],
            vec![false, false],
            vec![false, true],
            vec![true, false],
            vec![true, true],
        ] {
            let sites: Vec<BodySite> = turns.iter().map(|turns| site(*turns)).collect();
            let mut few = FewBodies::new(&sites).unwrap();
            few.clear();
            let unknowns: usize = sites.iter().map(BodySite::unknowns).sum();
            let mut dense = vec![vec![0.0; unknowns]; unknowns];
            let mut row = 0;
            for (i, of_row) in sites.iter().enumerate() {
                let mut column = 0;
                for (j, of_column) in sites.iter().enumerate() {
                    // Dominated by the diagonal, and not symmetric.
                    let block = block(&mut random, if i == j { 20.0 } else { 0.0 });
                    few.add((row, column), (of_row.turns, of_column.turns), &block);
                    let parts = [
                        [block.linear, block.linear_by_turn],
                        [block.turn_by_linear, block.turn],
                    ];
                    for r in 0..of_row.unknowns() {
                        for c in 0..of_column.unknowns() {
                            let part = parts[r / 3][c / 3];
                            dense[row + r][column + c] = part.col(c % 3)[r % 3];
                        }
                    }
                    column += of_column.unknowns();
                }
                row += of_row.unknowns();
            }
            let load: Vec<f64> = (0..unknowns).map(|_| random.signed()).collect();
            assert!(few.factorise());
            let mut found = load.clone();
            few.solve(&mut found);
            let expected = dense_solve(dense, &load);
            for (found, expected) in found.iter().zip(&expected) {
                assert!((found - expected).abs() < 1e-14, "{turns:?}");
            }
        }
    }

    #[test]
    fn what_takes_row_exchanges_is_left_to_others() {
        let mut few = FewBodies::new(&[site(true)]).unwrap();
        let mut block = BodyBlock::ZERO;
        block.linear_by_turn = DMat3::IDENTITY;
        block.turn_by_linear = DMat3::IDENTITY;
        few.add((0, 0), (true, true), &block);
        assert!(!few.factorise());
        few.clear();
        few.add((0, 0), (true, true), &BodyBlock::ZERO);
        assert!(!few.factorise());
        few.clear();
        block.linear = f64::NAN * DMat3::IDENTITY;
        few.add((0, 0), (true, true), &block);
        assert!(!few.factorise());
    }

    #[test]
    fn many_bodies_are_not_few() {
        assert!(FewBodies::new(&[]).is_none());
        assert!(FewBodies::new(&[site(false); 3]).is_none());
    }
}
