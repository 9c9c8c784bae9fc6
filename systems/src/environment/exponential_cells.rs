//! The exponential of a piecewise cubic, without a call of exp.
//!
//! ```text
//! y(x) = exp(f(x)) = y_c exp(s1 t + s2 t^2 + s3 t^3) = a0 + a1 t + ... + a5 t^5,   t = x - x_c
//! ```
//!
//! Every piece of the cubic f is cut into equal cells so small that |s1 t|, |s2|^(1/2) t and
//! |s3|^(1/3) t stay below 0.003 about the centre x_c of a cell; there the Taylor series ends below
//! round-off: what it leaves out is at most about 2 x 0.003^6 = 1.5e-15 where the cubic bends most,
//! and 0.003^6/720 = 1e-18 where it is nearly straight, as the logarithm of a density is. Even and
//! odd terms are summed apart, so that no operation waits for more than three others. The density of
//! the air at every segment of a tether is the most frequent look-up of a run, and a call of exp would
//! take most of it.

use super::knots::Knots;
use super::monotone_cubic::MonotoneCubic;

/// The largest value of |s1 t|, |s2|^(1/2) t and |s3|^(1/3) t.
const REACH: f64 = 0.003;

/// One cell: its centre, and the coefficients in the head of this file.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cell {
    centre: f64,
    a: [f64; 6],
}

impl Cell {
    /// The cell about `centre` with the Taylor coefficients `s` of the exponent there.
    fn new(centre: f64, [s0, s1, s2, s3]: [f64; 4]) -> Self {
        let square = s1 * s1;
        let series = [
            1.0,
            s1,
            s2 + square / 2.0,
            s3 + s1 * s2 + square * s1 / 6.0,
            s1 * s3 + s2 * s2 / 2.0 + square * s2 / 2.0 + square * square / 24.0,
            s2 * s3
                + square * s3 / 2.0
                + s1 * s2 * s2 / 2.0
                + square * s1 * s2 / 6.0
                + square * square * s1 / 120.0,
        ];
        let value = libm::exp(s0);
        Self {
            centre,
            a: series.map(|a| value * a),
        }
    }
}

/// exp of a monotone cubic.
#[derive(Debug, Clone, PartialEq)]
pub struct ExponentialCells {
    bounds: Knots,
    cells: Vec<Cell>,
}

impl ExponentialCells {
    /// exp of `logarithm`, whose pieces lie between `knots`.
    pub fn new(knots: &Knots, logarithm: &MonotoneCubic) -> Self {
        let mut bounds = Vec::new();
        let mut cells = Vec::new();
        for (interval, pair) in knots.abscissae().windows(2).enumerate() {
            let width = pair[1] - pair[0];
            let rate = logarithm.fastest_rate(interval, width);
            let count = ((rate * width / (2.0 * REACH)).ceil() as usize).max(1);
            for index in 0..count {
                let start = pair[0] + width * (index as f64 / count as f64);
                let end = if index + 1 == count {
                    pair[1]
                } else {
                    pair[0] + width * ((index + 1) as f64 / count as f64)
                };
                // Neighbouring abscissae can be too close for a cell between them.
                if end <= start {
                    continue;
                }
                let centre = 0.5 * (start + end);
                bounds.push(start);
                cells.push(Cell::new(centre, logarithm.taylor(interval, centre)));
            }
        }
        bounds.push(knots.highest());
        Self {
            bounds: Knots::from_checked(bounds),
            cells,
        }
    }

    /// The value at `x`; `None` outside the knots and for NaN.
    #[inline(always)]
    pub fn value(&self, x: f64) -> Option<f64> {
        let cell = &self.cells[self.bounds.interval(x)?];
        let [a0, a1, a2, a3, a4, a5] = cell.a;
        let t = x - cell.centre;
        let square = t * t;
        Some((a0 + a1 * t) + square * ((a2 + a3 * t) + square * (a4 + a5 * t)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_exponential_of_the_cubic_to_round_off() {
        let x = [0.0, 1.0, 1.5, 4.0, 4.001, 9.0];
        let y = [0.9, 0.8, -0.4, -0.5, -0.9, -1.6];
        let knots = Knots::new(&x).unwrap();
        let cubic = MonotoneCubic::new(&knots, &y).unwrap();
        let cells = ExponentialCells::new(&knots, &cubic);
        let mut largest = 0.0_f64;
        for k in 0..=90_000 {
            let x = f64::from(k) * 1e-4;
            let expected = libm::exp(cubic.value(knots.interval(x).unwrap(), x));
            largest = largest.max((cells.value(x).unwrap() / expected - 1.0).abs());
        }
        // The series leaves out 1.5e-15 at most, and exp magnifies the round-off of its exponent.
        assert!(largest < 1.5e-15 + 8.0 * f64::EPSILON, "{largest}");
        assert_eq!(cells.value(-1e-9), None);
        assert_eq!(cells.value(9.1), None);
        assert_eq!(cells.value(f64::NAN), None);
    }
}
