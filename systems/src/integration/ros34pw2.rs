//! The tableau of ROS34PW2 (Rang and Angermann 2005, BIT 45, 761-787): four stages, order 3, L-stable and
//! stiffly accurate, of order 3 with any matrix A; the embedded solution has order 2.

/// Number of stages.
pub(super) const STAGES: usize = 4;
/// gamma.
pub(super) const GAMMA: f64 = 4.358_665_215_084_59e-1;
const ALPHA: [[f64; STAGES]; STAGES] = [
    [0.0; STAGES],
    [8.717_330_430_169_18e-1, 0.0, 0.0, 0.0],
    [
        8.445_706_001_536_942e-1,
        -1.129_906_423_648_418_5e-1,
        0.0,
        0.0,
    ],
    [0.0, 0.0, 1.0, 0.0],
];
const COUPLING: [[f64; STAGES]; STAGES] = [
    [GAMMA, 0.0, 0.0, 0.0],
    [-8.717_330_430_169_18e-1, GAMMA, 0.0, 0.0],
    [
        -9.033_805_701_304_408e-1,
        5.418_067_238_809_533e-2,
        GAMMA,
        0.0,
    ],
    [
        2.421_238_070_609_534_6e-1,
        -1.223_250_583_904_514_7,
        5.452_602_553_351_021e-1,
        GAMMA,
    ],
];
const B: [f64; STAGES] = [
    2.421_238_070_609_534_6e-1,
    -1.223_250_583_904_514_7,
    1.545_260_255_335_102,
    GAMMA,
];
const B_EMBEDDED: [f64; STAGES] = [
    3.781_090_314_581_937e-1,
    -9.604_229_221_242_318e-2,
    0.5,
    2.179_332_607_542_295e-1,
];

/// The tableau in the form that needs no product with A.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tableau {
    /// a_ij.
    pub(super) a: [[f64; STAGES]; STAGES],
    /// c_ij.
    pub(super) c: [[f64; STAGES]; STAGES],
    /// m_i.
    pub(super) m: [f64; STAGES],
    /// m_i - m^_i.
    pub(super) e: [f64; STAGES],
    /// alpha_i: where in the step the stages stand.
    pub(super) alpha: [f64; STAGES],
}

impl Tableau {
    pub(super) fn new() -> Self {
        let inverse = invert_lower(&COUPLING);
        let product = |row: &[f64; STAGES]| -> [f64; STAGES] {
            std::array::from_fn(|j| (0..STAGES).map(|k| row[k] * inverse[k][j]).sum())
        };
        let m = product(&B);
        let m_embedded = product(&B_EMBEDDED);
        Self {
            a: ALPHA.map(|row| product(&row)),
            c: std::array::from_fn(|i| {
                std::array::from_fn(|j| if i == j { 0.0 } else { -inverse[i][j] })
            }),
            m,
            e: std::array::from_fn(|i| m[i] - m_embedded[i]),
            alpha: ALPHA.map(|row| row.iter().sum()),
        }
    }
}

fn invert_lower(matrix: &[[f64; STAGES]; STAGES]) -> [[f64; STAGES]; STAGES] {
    let mut inverse = [[0.0; STAGES]; STAGES];
    for (row, factors) in matrix.iter().enumerate() {
        inverse[row] = std::array::from_fn(|column| {
            let one = if row == column { 1.0 } else { 0.0 };
            let sum: f64 = (0..row).map(|k| factors[k] * inverse[k][column]).sum();
            (one - sum) / factors[row]
        });
    }
    inverse
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dot(a: &[f64; STAGES], b: &[f64; STAGES]) -> f64 {
        a.iter().zip(b).map(|(a, b)| a * b).sum()
    }

    fn times(matrix: &[[f64; STAGES]; STAGES], vector: &[f64; STAGES]) -> [f64; STAGES] {
        matrix.map(|row| dot(&row, vector))
    }

    /// The conditions for order 3 with any matrix A (Hairer and Wanner 1996, IV.7, W-methods), and those
    /// for order 2 of the embedded solution.
    #[test]
    fn the_tableau_has_order_three_with_any_jacobian() {
        let one = [1.0; STAGES];
        let (alpha, gamma) = (times(&ALPHA, &one), times(&COUPLING, &one));
        let square = alpha.map(|a| a * a);
        let conditions = [
            (one, 1.0),
            (alpha, 0.5),
            (gamma, 0.0),
            (square, 1.0 / 3.0),
            (times(&ALPHA, &alpha), 1.0 / 6.0),
            (times(&ALPHA, &gamma), 0.0),
            (times(&COUPLING, &alpha), 0.0),
            (times(&COUPLING, &gamma), 0.0),
        ];
        for (number, (vector, value)) in conditions.iter().enumerate() {
            let error = (dot(&B, vector) - value).abs();
            assert!(error < 1e-14, "condition {number}: {error:e}");
        }
        for (vector, value) in &conditions[..3] {
            assert!((dot(&B_EMBEDDED, vector) - value).abs() < 1e-14);
        }
    }

    /// Stiffly accurate: the solution is the last stage, so that R at infinity is 0.
    #[test]
    fn the_tableau_is_stiffly_accurate() {
        for ((b, alpha), coupling) in B.iter().zip(&ALPHA[3]).zip(&COUPLING[3]) {
            assert!((b - alpha - coupling).abs() < 1e-15);
        }
        let tableau = Tableau::new();
        for (a, m) in tableau.a[3].iter().zip(&tableau.m) {
            assert!((a - m).abs() < 1e-14 || *m == tableau.m[3]);
        }
        assert!((tableau.m[3] - 1.0).abs() < 1e-14);
    }
}
