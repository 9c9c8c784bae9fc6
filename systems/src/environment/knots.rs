//! Abscissae of a table, and the lookup of the interval that holds an x in constant time.
//!
//! ```text
//! bucket(x) = floor((x - x_first) B / (x_last - x_first)),   B = ceil(span / closest pair)
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | x | abscissa | the caller's |
//! | B | number of equal buckets, at most 16384 | 1 |
//!
//! Source: elementary (a uniform grid over the knots).
//!
//! Assumptions: strictly increasing, finite abscissae, two at least.

use thiserror::Error;

/// Most buckets of the lookup table of [`Knots`].
const MOST_BUCKETS: usize = 16_384;

/// Why rows cannot be interpolated. Rows count from 1.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum InterpolationError {
    /// An interpolation needs two rows at least.
    #[error("at least 2 rows are needed, there are {rows}")]
    TooFewRows {
        /// Rows given.
        rows: usize,
    },
    /// A value is NaN or infinite.
    #[error("row {row}: {value} is not a finite number")]
    NotFinite {
        /// Row, from 1.
        row: usize,
        /// The value.
        value: f64,
    },
    /// An abscissa does not exceed the one before.
    #[error("row {row}: {value} does not exceed {previous} of the row before")]
    NotIncreasing {
        /// Row, from 1.
        row: usize,
        /// Abscissa of the row before.
        previous: f64,
        /// Abscissa of this row.
        value: f64,
    },
    /// A value that must be positive is not.
    #[error("row {row}: {value} is not positive")]
    NotPositive {
        /// Row, from 1.
        row: usize,
        /// The value.
        value: f64,
    },
    /// A column is shorter or longer than the abscissae.
    #[error("row {row}: {ordinates} values for {abscissae} knots")]
    UnequalLengths {
        /// First row without a partner, from 1.
        row: usize,
        /// Number of ordinates.
        ordinates: usize,
        /// Number of abscissae.
        abscissae: usize,
    },
    /// The difference from the row before, or a slope, exceeds the range of `f64`.
    #[error("row {row}: the step from the row before exceeds the range of numbers")]
    Overflow {
        /// Row, from 1.
        row: usize,
    },
}

impl InterpolationError {
    /// The offending row, from 1; `None` where it is the number of rows that is wrong.
    pub fn row(&self) -> Option<usize> {
        match *self {
            Self::TooFewRows { .. } => None,
            Self::NotFinite { row, .. }
            | Self::NotIncreasing { row, .. }
            | Self::NotPositive { row, .. }
            | Self::UnequalLengths { row, .. }
            | Self::Overflow { row } => Some(row),
        }
    }
}

/// An [`InterpolationError`] with the name of the column it is in.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{column}, {error}")]
pub struct ColumnError {
    /// Name of the column, with its unit.
    pub column: &'static str,
    /// What is wrong with it.
    pub error: InterpolationError,
}

impl InterpolationError {
    /// Says which column the error is in.
    pub(super) fn within(self, column: &'static str) -> ColumnError {
        ColumnError {
            column,
            error: self,
        }
    }
}

/// Strictly increasing abscissae, shared by any number of [`MonotoneCubic`](super::monotone_cubic::MonotoneCubic).
///
/// The interval of an abscissa is looked up in a table of equal buckets, no wider than the
/// closest pair of knots: constant time. (If the closest pair is closer than 1/16384 of the whole
/// span, a lookup may also walk over the knots within one bucket.)
#[derive(Debug, Clone, PartialEq)]
pub struct Knots {
    abscissae: Vec<f64>,
    lowest: f64,
    highest: f64,
    buckets_per_unit: f64,
    /// For each bucket the last interval that begins in it or before it.
    last_interval: Vec<u32>,
}

impl Knots {
    /// Knots at the given abscissae.
    ///
    /// # Errors
    /// Fewer than two, one that is not finite, one that does not exceed the one before, or a span
    /// that overflows.
    pub fn new(abscissae: &[f64]) -> Result<Self, InterpolationError> {
        check_finite(abscissae)?;
        let rows = abscissae.len();
        if rows < 2 {
            return Err(InterpolationError::TooFewRows { rows });
        }
        for (index, pair) in abscissae.windows(2).enumerate() {
            if pair[1] <= pair[0] {
                return Err(InterpolationError::NotIncreasing {
                    row: index + 2,
                    previous: pair[0],
                    value: pair[1],
                });
            }
        }
        let knots = Self::from_checked(abscissae.to_vec());
        if (knots.highest - knots.lowest).is_finite() && knots.buckets_per_unit.is_finite() {
            Ok(knots)
        } else {
            Err(InterpolationError::Overflow { row: rows })
        }
    }

    /// Knots at abscissae that are known to be at least two, finite and strictly increasing.
    pub(super) fn from_checked(abscissae: Vec<f64>) -> Self {
        let lowest = abscissae.first().copied().unwrap_or(f64::NAN);
        let highest = abscissae.last().copied().unwrap_or(f64::NAN);
        let span = highest - lowest;
        let closest = abscissae
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .fold(span, f64::min);
        let buckets = ((span / closest).ceil() as usize).clamp(1, MOST_BUCKETS);
        let mut knots = Self {
            buckets_per_unit: buckets as f64 / span,
            last_interval: vec![0; buckets],
            abscissae,
            lowest,
            highest,
        };
        knots.fill_buckets();
        knots
    }

    /// Enters into each bucket the last interval that begins in it or before it.
    ///
    /// [`Self::bucket`] never decreases with x, rounding included, so the interval of an x is at
    /// or before the entry of its bucket, and the walk back in [`Self::interval`] is exact.
    fn fill_buckets(&mut self) {
        let intervals = self.abscissae.len().saturating_sub(1);
        for interval in 0..intervals {
            let bucket = self.bucket(self.abscissae[interval]);
            self.last_interval[bucket] = interval as u32;
        }
        let mut last = 0;
        for entry in &mut self.last_interval {
            last = last.max(*entry);
            *entry = last;
        }
    }

    #[inline]
    fn bucket(&self, x: f64) -> usize {
        // A conversion to u32 is one instruction, to usize it is six.
        let bucket = ((x - self.lowest) * self.buckets_per_unit) as u32 as usize;
        bucket.min(self.last_interval.len() - 1)
    }

    /// The interval, from 0, that holds `x`: closed below and open above, the last one closed.
    /// `None` outside the knots and for NaN.
    #[inline]
    pub fn interval(&self, x: f64) -> Option<usize> {
        if !(self.lowest..=self.highest).contains(&x) {
            return None;
        }
        let mut interval = self.last_interval[self.bucket(x)] as usize;
        while x < self.abscissae[interval] {
            interval -= 1;
        }
        Some(interval)
    }

    /// The lowest abscissa.
    #[inline]
    pub fn lowest(&self) -> f64 {
        self.lowest
    }

    /// The highest abscissa.
    #[inline]
    pub fn highest(&self) -> f64 {
        self.highest
    }

    /// All abscissae.
    pub fn abscissae(&self) -> &[f64] {
        &self.abscissae
    }
}

/// Refuses the first value that is NaN or infinite.
pub(super) fn check_finite(values: &[f64]) -> Result<(), InterpolationError> {
    match values.iter().position(|value| !value.is_finite()) {
        Some(index) => Err(InterpolationError::NotFinite {
            row: index + 1,
            value: values[index],
        }),
        None => Ok(()),
    }
}

/// Refuses the first value that is not positive.
pub(super) fn check_positive(values: &[f64]) -> Result<(), InterpolationError> {
    match values.iter().position(|&value| value <= 0.0) {
        Some(index) => Err(InterpolationError::NotPositive {
            row: index + 1,
            value: values[index],
        }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The interval found by looking at every knot.
    fn searched(abscissae: &[f64], x: f64) -> usize {
        let last = abscissae.len() - 2;
        (0..=last).rev().find(|&i| abscissae[i] <= x).unwrap()
    }

    fn check_everywhere(abscissae: &[f64]) {
        let knots = Knots::new(abscissae).unwrap();
        let span = knots.highest() - knots.lowest();
        let regular = (0..=5000).map(|k| knots.lowest() + span * f64::from(k) / 5000.0);
        let at_knots = abscissae
            .iter()
            .flat_map(|&x| [x.next_down(), x, x.next_up()]);
        for x in regular.chain(at_knots) {
            let inside = x >= abscissae[0] && x <= abscissae[abscissae.len() - 1];
            let expected = inside.then(|| searched(abscissae, x));
            assert_eq!(knots.interval(x), expected, "at {x:e}");
        }
    }

    #[test]
    fn the_lookup_agrees_with_a_search_of_every_knot() {
        check_everywhere(&[0.0, 1.0]);
        check_everywhere(&[-3.0, -2.9, 0.1, 0.3, 7.7, 100.0]);
        check_everywhere(&(0..200).map(|k| 0.1 * f64::from(k)).collect::<Vec<_>>());
        check_everywhere(&(0..90).map(|k| 1.3_f64.powi(k)).collect::<Vec<_>>());
        check_everywhere(
            &(0..60)
                .map(|k| 1e5 - 0.5_f64.powi(k) * 1e5)
                .take(30)
                .collect::<Vec<_>>(),
        );
    }

    #[test]
    fn outside_and_nan_have_no_interval() {
        let knots = Knots::new(&[1.0, 2.0, 4.0]).unwrap();
        for x in [0.999, 4.001, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(knots.interval(x), None);
        }
    }

    #[test]
    fn bad_abscissae_are_refused_with_their_row() {
        let message = |x: &[f64]| Knots::new(x).unwrap_err().to_string();
        assert_eq!(message(&[]), "at least 2 rows are needed, there are 0");
        assert_eq!(message(&[1.0]), "at least 2 rows are needed, there are 1");
        assert_eq!(
            message(&[0.0, 1.0, 1.0]),
            "row 3: 1 does not exceed 1 of the row before"
        );
        assert_eq!(
            message(&[0.0, 2.0, 1.5, 3.0]),
            "row 3: 1.5 does not exceed 2 of the row before"
        );
        assert_eq!(
            message(&[0.0, f64::NAN]),
            "row 2: NaN is not a finite number"
        );
        let overflow = Knots::new(&[-1.5e308, 0.0, 1.5e308]).unwrap_err();
        assert_eq!(overflow, InterpolationError::Overflow { row: 3 });
        assert_eq!(overflow.row(), Some(3));
    }
}
