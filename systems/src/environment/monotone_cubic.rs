//! Monotone piecewise cubic interpolation with a continuous slope (PCHIP).
//!
//! On the interval i, with t = x - `x_i`, width `h_i` and secant `s_i = (y_(i+1) - y_i) / h_i`,
//!
//! ```text
//! y(t) = y_i + d_i t + (3 s_i - 2 d_i - d_(i+1)) / h_i t^2 + (d_i + d_(i+1) - 2 s_i) / h_i^2 t^3
//!
//! inner knots  d_i = (w1 + w2) / (w1 / s_(i-1) + w2 / s_i),
//!              w1 = 2 h_i + h_(i-1),  w2 = h_i + 2 h_(i-1);
//!              0 where the secants differ in sign or one of them is 0
//! end knots    d_0 = ((2 h_0 + h_1) s_0 - h_0 s_1) / (h_0 + h_1),
//!              0 if it has not the sign of s_0; at most 3 s_0 if s_0 and s_1 differ in sign
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | `x_i`, `y_i` | knots: abscissae and ordinates | the caller's |
//! | `d_i` | slope at a knot | unit of y per unit of x |
//!
//! Sources: Fritsch and Carlson (1980), SIAM J. Numer. Anal. 17, 238-246; weighted harmonic mean
//! of Fritsch and Butland (1984), SIAM J. Sci. Stat. Comput. 5, 300-304; end slopes as in Moler
//! (2004), Numerical Computing with MATLAB, section 3.6.
//!
//! Assumptions: the curve is monotone wherever the data are, and has an extremum only at a knot.
//! The slope is continuous, the second derivative is not. No extrapolation.

use super::knots::{InterpolationError, Knots, check_finite, check_positive};

/// One interval: y = c0 + c1 t + c2 t^2 + c3 t^3 with t = x - start.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Piece {
    start: f64,
    c0: f64,
    c1: f64,
    c2: f64,
    c3: f64,
}

/// Ordinates over [`Knots`], as one cubic for each interval.
#[derive(Debug, Clone, PartialEq)]
pub struct MonotoneCubic {
    pieces: Vec<Piece>,
}

impl MonotoneCubic {
    /// The curve through `ordinates`, one for each knot.
    ///
    /// # Errors
    /// As many ordinates as knots are needed, all finite, with finite slopes between them.
    pub fn new(knots: &Knots, ordinates: &[f64]) -> Result<Self, InterpolationError> {
        check_length(knots, ordinates)?;
        check_finite(ordinates)?;
        Self::from_checked(knots, ordinates).with_finite_pieces()
    }

    /// The curve through the natural logarithms of `ordinates`, one for each knot.
    ///
    /// # Errors
    /// As [`Self::new`], and where an ordinate is not positive.
    pub fn of_logarithm(knots: &Knots, ordinates: &[f64]) -> Result<Self, InterpolationError> {
        check_length(knots, ordinates)?;
        check_finite(ordinates)?;
        check_positive(ordinates)?;
        Self::of_checked_logarithm(knots, ordinates).with_finite_pieces()
    }

    /// As [`Self::new`], for ordinates that are known to pass its checks.
    pub(super) fn from_checked(knots: &Knots, ordinates: &[f64]) -> Self {
        let rises: Vec<Rise> = knots
            .abscissae()
            .windows(2)
            .zip(ordinates.windows(2))
            .map(|(x, y)| Rise {
                width: x[1] - x[0],
                secant: (y[1] - y[0]) / (x[1] - x[0]),
            })
            .collect();
        let slopes = knot_slopes(&rises);
        let pieces = rises
            .iter()
            .zip(slopes.windows(2))
            .zip(knots.abscissae().iter().zip(ordinates))
            .map(|((rise, slope), (&start, &c0))| Piece {
                start,
                c0,
                c1: slope[0],
                c2: (3.0 * rise.secant - 2.0 * slope[0] - slope[1]) / rise.width,
                c3: (slope[0] + slope[1] - 2.0 * rise.secant) / (rise.width * rise.width),
            })
            .collect();
        Self { pieces }
    }

    /// As [`Self::of_logarithm`], for ordinates that are known to pass its checks.
    pub(super) fn of_checked_logarithm(knots: &Knots, ordinates: &[f64]) -> Self {
        let logarithms: Vec<f64> = ordinates.iter().map(|&y| libm::log(y)).collect();
        Self::from_checked(knots, &logarithms)
    }

    fn with_finite_pieces(self) -> Result<Self, InterpolationError> {
        let overflown = self.pieces.iter().position(|piece| {
            !(piece.c1.is_finite() && piece.c2.is_finite() && piece.c3.is_finite())
        });
        match overflown {
            Some(index) => Err(InterpolationError::Overflow { row: index + 2 }),
            None => Ok(self),
        }
    }

    /// The ordinate at `x`, which lies in `interval` as given by [`Knots::interval`].
    ///
    /// # Panics
    /// If there is no such interval.
    #[inline]
    pub fn value(&self, interval: usize, x: f64) -> f64 {
        let piece = &self.pieces[interval];
        let t = x - piece.start;
        piece.c0 + t * (piece.c1 + t * (piece.c2 + t * piece.c3))
    }

    /// The same curve, `factor` times as high.
    pub(super) fn scaled(&self, factor: f64) -> Self {
        let pieces = self.pieces.iter().map(|piece| Piece {
            start: piece.start,
            c0: factor * piece.c0,
            c1: factor * piece.c1,
            c2: factor * piece.c2,
            c3: factor * piece.c3,
        });
        Self {
            pieces: pieces.collect(),
        }
    }

    /// The Taylor coefficients (value, first, second / 2, third / 6) of the piece of `interval`
    /// about `x`.
    pub(super) fn taylor(&self, interval: usize, x: f64) -> [f64; 4] {
        let piece = &self.pieces[interval];
        let t = x - piece.start;
        [
            self.value(interval, x),
            self.slope(interval, x),
            piece.c2 + 3.0 * piece.c3 * t,
            piece.c3,
        ]
    }

    /// The largest of |s1|, |s2|^(1/2) and |s3|^(1/3) within `interval`, which is `width` wide:
    /// `s` as [`Self::taylor`] gives them about any of its abscissae.
    pub(super) fn fastest_rate(&self, interval: usize, width: f64) -> f64 {
        let piece = &self.pieces[interval];
        let turn = piece.start - piece.c2 / (3.0 * piece.c3);
        let inside = (piece.start..piece.start + width).contains(&turn);
        let turn = if inside { turn } else { piece.start };
        [piece.start, piece.start + width, turn]
            .into_iter()
            .map(|x| {
                let [_, s1, s2, s3] = self.taylor(interval, x);
                s1.abs().max(s2.abs().sqrt()).max(libm::cbrt(s3.abs()))
            })
            .fold(0.0, f64::max)
    }

    /// The slope dy/dx at `x`, which lies in `interval` as given by [`Knots::interval`].
    ///
    /// # Panics
    /// If there is no such interval.
    #[inline]
    pub fn slope(&self, interval: usize, x: f64) -> f64 {
        let piece = &self.pieces[interval];
        let t = x - piece.start;
        piece.c1 + t * (2.0 * piece.c2 + t * 3.0 * piece.c3)
    }
}

/// Width and secant of one interval.
#[derive(Debug, Clone, Copy)]
struct Rise {
    width: f64,
    secant: f64,
}

fn knot_slopes(rises: &[Rise]) -> Vec<f64> {
    let mut slopes = Vec::with_capacity(rises.len() + 1);
    if let (Some(&first), Some(&last)) = (rises.first(), rises.last()) {
        let second = rises.get(1).copied().unwrap_or(first);
        let last_but_one = rises.iter().rev().nth(1).copied().unwrap_or(last);
        slopes.push(end_slope(first, second));
        slopes.extend(rises.windows(2).map(|pair| inner_slope(pair[0], pair[1])));
        slopes.push(end_slope(last, last_but_one));
    }
    slopes
}

fn have_one_sign(a: f64, b: f64) -> bool {
    (a > 0.0 && b > 0.0) || (a < 0.0 && b < 0.0)
}

fn inner_slope(left: Rise, right: Rise) -> f64 {
    if !have_one_sign(left.secant, right.secant) {
        return 0.0;
    }
    let w1 = 2.0 * right.width + left.width;
    let w2 = right.width + 2.0 * left.width;
    (w1 + w2) / (w1 / left.secant + w2 / right.secant)
}

/// Slope at the outer end of `end`, whose only neighbour is `next` (`end` itself if alone).
fn end_slope(end: Rise, next: Rise) -> f64 {
    let slope = ((2.0 * end.width + next.width) * end.secant - end.width * next.secant)
        / (end.width + next.width);
    if !have_one_sign(slope, end.secant) {
        0.0
    } else if !have_one_sign(end.secant, next.secant) && slope.abs() > 3.0 * end.secant.abs() {
        3.0 * end.secant
    } else {
        slope
    }
}

fn check_length(knots: &Knots, ordinates: &[f64]) -> Result<(), InterpolationError> {
    let abscissae = knots.abscissae().len();
    if ordinates.len() == abscissae {
        return Ok(());
    }
    Err(InterpolationError::UnequalLengths {
        row: ordinates.len().min(abscissae) + 1,
        ordinates: ordinates.len(),
        abscissae,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const X: [f64; 7] = [0.0, 1.0, 1.5, 4.0, 4.2, 9.0, 10.0];
    const RISING: [f64; 7] = [1.0, 1.1, 5.0, 5.0, 6.0, 20.0, 20.5];
    const WAVY: [f64; 7] = [1.0, -2.0, 3.0, 3.5, -1.0, -1.0, 2.0];

    fn value(knots: &Knots, cubic: &MonotoneCubic, x: f64) -> f64 {
        cubic.value(knots.interval(x).unwrap(), x)
    }

    #[test]
    fn knots_are_reproduced_and_value_and_slope_are_continuous_there() {
        let knots = Knots::new(&X).unwrap();
        for y in [RISING, WAVY] {
            let cubic = MonotoneCubic::new(&knots, &y).unwrap();
            for i in 1..X.len() - 1 {
                assert_eq!(cubic.value(i, X[i]), y[i]);
                assert!((cubic.value(i - 1, X[i]) - y[i]).abs() < 1e-13);
                let (left, right) = (cubic.slope(i - 1, X[i]), cubic.slope(i, X[i]));
                assert!((left - right).abs() < 1e-12 * (1.0 + right.abs()));
            }
            assert_eq!(cubic.value(0, X[0]), y[0]);
            assert!((cubic.value(5, X[6]) - y[6]).abs() < 1e-13);
        }
    }

    #[test]
    fn monotone_data_give_a_monotone_curve_and_extrema_lie_at_knots() {
        let knots = Knots::new(&X).unwrap();
        for y in [RISING, WAVY] {
            let cubic = MonotoneCubic::new(&knots, &y).unwrap();
            for i in 0..X.len() - 1 {
                let rise = y[i + 1] - y[i];
                for k in 0..=1000 {
                    let x = X[i] + (X[i + 1] - X[i]) * f64::from(k) / 1000.0;
                    assert!(cubic.slope(i, x) * rise >= -1e-12, "interval {i}, x = {x}");
                    assert!(rise != 0.0 || cubic.value(i, x) == y[i]);
                }
            }
        }
    }

    /// h = 1, secants 1 and 3: by hand, the inner slope is 2/(1/1 + 1/3) = 1.5 and the ends
    /// (3 - 3)/2 = 0 and (9 - 1)/2 = 4.
    #[test]
    fn slopes_agree_with_a_hand_calculation() {
        let knots = Knots::new(&[0.0, 1.0, 2.0]).unwrap();
        let cubic = MonotoneCubic::new(&knots, &[0.0, 1.0, 4.0]).unwrap();
        assert_eq!(cubic.slope(0, 0.0), 0.0);
        assert!((cubic.slope(1, 1.0) - 1.5).abs() < 1e-15);
        assert!((cubic.slope(1, 2.0) - 4.0).abs() < 1e-15);
        // Widths 1 and 3, secants 2 and 1: w1 = 7, w2 = 5, d = 12/(7/2 + 5/1) = 24/17.
        let knots = Knots::new(&[0.0, 1.0, 4.0]).unwrap();
        let cubic = MonotoneCubic::new(&knots, &[0.0, 2.0, 5.0]).unwrap();
        assert!((cubic.slope(1, 1.0) - 24.0 / 17.0).abs() < 1e-15);
    }

    #[test]
    fn a_straight_line_stays_straight_and_two_knots_give_one() {
        for x in [&X[..], &X[..2]] {
            let knots = Knots::new(x).unwrap();
            let y: Vec<f64> = x.iter().map(|x| 3.0 - 0.5 * x).collect();
            let cubic = MonotoneCubic::new(&knots, &y).unwrap();
            for k in 0..=100 {
                let x = knots.highest() * f64::from(k) / 100.0;
                assert!((value(&knots, &cubic, x) - (3.0 - 0.5 * x)).abs() < 1e-14);
                assert!((cubic.slope(knots.interval(x).unwrap(), x) + 0.5).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn the_slope_is_the_derivative_of_the_value() {
        let knots = Knots::new(&X).unwrap();
        let cubic = MonotoneCubic::new(&knots, &WAVY).unwrap();
        for i in 0..X.len() - 1 {
            let x = 0.3 * X[i] + 0.7 * X[i + 1];
            let step = 1e-5;
            let secant = (cubic.value(i, x + step) - cubic.value(i, x - step)) / (2.0 * step);
            assert!((secant - cubic.slope(i, x)).abs() < 1e-6);
        }
    }

    /// Largest error over [0, 2] of the curve through `count` + 1 samples of exp, on knots that
    /// are not equally spaced.
    fn error_on_exp(count: u32) -> f64 {
        let x: Vec<f64> = (0..=count)
            .map(|k| {
                let u = f64::from(k) / f64::from(count);
                2.0 * u * (0.5 + 0.5 * u)
            })
            .collect();
        let y: Vec<f64> = x.iter().map(|&x| libm::exp(x)).collect();
        let knots = Knots::new(&x).unwrap();
        let cubic = MonotoneCubic::new(&knots, &y).unwrap();
        (0..=4000)
            .map(|k| f64::from(k) / 2000.0)
            .map(|x| (value(&knots, &cubic, x) - libm::exp(x)).abs())
            .fold(0.0, f64::max)
    }

    #[test]
    fn smooth_data_converge_at_second_order_or_better() {
        for count in [10, 20, 40, 80] {
            let order = (error_on_exp(count) / error_on_exp(2 * count)).log2();
            assert!(order > 2.0, "order {order} at {count} intervals");
        }
    }

    #[test]
    fn bad_ordinates_are_refused_with_their_row() {
        let knots = Knots::new(&[0.0, 1.0, 2.0]).unwrap();
        let message = |y: &[f64]| MonotoneCubic::new(&knots, y).unwrap_err().to_string();
        assert_eq!(message(&[1.0, 2.0]), "row 3: 2 values for 3 knots");
        assert_eq!(message(&[1.0; 5]), "row 4: 5 values for 3 knots");
        assert_eq!(
            message(&[1.0, f64::INFINITY, 2.0]),
            "row 2: inf is not a finite number"
        );
        assert_eq!(
            MonotoneCubic::new(&knots, &[1e308, -1e308, 0.0]),
            Err(InterpolationError::Overflow { row: 2 })
        );
        assert_eq!(
            MonotoneCubic::of_logarithm(&knots, &[1.0, 2.0, 0.0]).map(|_| ()),
            Err(InterpolationError::NotPositive { row: 3, value: 0.0 })
        );
    }
}
