//! Sobol indices: which part of a metric's variance a field makes by itself (first order), and which part goes
//! where the field is held and everything else varies as before (total).
//!
//! Of a plan laid out for it, S = mean(f_B (f_ABi - f_A)) / V (Saltelli et al., Computer Physics Communications
//! 181, 259 (2010)) and T = mean((f_A - f_ABi)^2) / (2 V) (Jansen, Computer Physics Communications 117, 35
//! (1999)); A and B are independent samples, ABi is A with field i of B, V the variance over A and B.
//!
//! Of runs that are drawn independently, S = sum(y_j y_j') / sum(y_j^2), y less its mean and y_j' that of the
//! next larger value of the field, the largest followed by the smallest (Gamboa, Gremaud, Klein and Lagnoux,
//! Bernoulli 28, 2345 (2022)).

use serde::{Deserialize, Serialize};

use super::random_stream::{Purpose, RandomStream};
use super::statistics::percentile;

/// A part of a variance. Estimates may be somewhat below 0 or above 1.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct Estimate {
    /// The estimate.
    pub value: f64,
    /// 95 % interval.
    pub interval_95: [f64; 2],
}

/// First-order and total index of a field.
pub type Pair = (Estimate, Estimate);

/// Values that are drawn for a bootstrap over all resamples.
const MOST_DRAWS: usize = 200_000_000;
/// The fewest base samples of which intervals mean something.
pub const FEWEST_BASE_SAMPLES: usize = 8;
/// The fewest runs of which the indices of given runs are told: those of a field without influence scatter by
/// 1 / sqrt(n).
pub const FEWEST_RUNS: usize = 100;

/// First-order and total index of each field; `columns` are the values of a metric in A, in B, and in AB1 and so
/// on. Intervals are of the percentile bootstrap over base samples. `None` of fewer than
/// [`FEWEST_BASE_SAMPLES`], or if nothing varies.
#[must_use]
pub fn saltelli_indices(columns: &[Vec<f64>], seed: u64, stream: u64) -> Option<Vec<Pair>> {
    let count = columns.first()?.len();
    if count < FEWEST_BASE_SAMPLES || columns.len() < 3 {
        return None;
    }
    let mut counts = vec![1; count];
    let values = weighted_indices(columns, &counts)?;
    let resamples = (MOST_DRAWS / (count * columns.len())).clamp(200, 1000);
    let mut random = RandomStream::new(seed, Purpose::IndexBootstrap, stream);
    let mut found = vec![Vec::with_capacity(resamples); 2 * values.len()];
    for _ in 0..resamples {
        counts.fill(0);
        for _ in 0..count {
            counts[random.below(count as u64) as usize] += 1;
        }
        // A resample of one value alone has no variance.
        let resampled = weighted_indices(columns, &counts).unwrap_or_default();
        for (place, (first, total)) in resampled.into_iter().enumerate() {
            found[2 * place].push(first);
            found[2 * place + 1].push(total);
        }
    }
    let mut intervals = found.into_iter().map(|mut values| {
        values.sort_unstable_by(f64::total_cmp);
        Some([percentile(&values, 2.5)?, percentile(&values, 97.5)?])
    });
    let mut estimate = |value| {
        Some(Estimate {
            value,
            interval_95: intervals.next()??,
        })
    };
    let pairs = values.into_iter();
    pairs
        .map(|(first, total)| Some((estimate(first)?, estimate(total)?)))
        .collect()
}

/// The indices with each base sample taken so many times.
fn weighted_indices(columns: &[Vec<f64>], counts: &[u32]) -> Option<Vec<(f64, f64)>> {
    let (a, b) = (columns.first()?, columns.get(1)?);
    let total: f64 = counts.iter().map(|count| f64::from(*count)).sum();
    let sum = |term: &dyn Fn(usize) -> f64| -> f64 {
        let terms = counts.iter().enumerate().filter(|(_, count)| **count > 0);
        terms
            .map(|(row, count)| f64::from(*count) * term(row))
            .sum()
    };
    let mean = sum(&|row| 0.5 * a[row] + 0.5 * b[row]) / total;
    let square = |value: f64| (value - mean) * (value - mean);
    let variance = sum(&|row| 0.5 * square(a[row]) + 0.5 * square(b[row])) / total;
    // Round-off of equal values is no variance.
    if variance <= (1e-14 * mean) * (1e-14 * mean) {
        return None;
    }
    let of_field = |mixed: &Vec<f64>| {
        let first = sum(&|row| (b[row] - mean) * (mixed[row] - a[row]));
        let differences = sum(&|row| (a[row] - mixed[row]) * (a[row] - mixed[row]));
        (
            first / total / variance,
            0.5 * differences / total / variance,
        )
    };
    Some(columns[2..].iter().map(of_field).collect())
}

/// The first-order index of a field from independent runs; `pairs` are values of field and metric. Equal values of
/// the field stand in an order that is drawn. `None` of fewer than [`FEWEST_RUNS`], or if nothing varies.
///
/// The interval is the normal one of the estimator's central limit theorem. With psi_j = (y_j y_j' - S y_j^2) / V
/// in the order of the field, whose terms are dependent on their neighbours alone once the field is given, n times
/// the variance is c_0 + 2 (c_1 - c_2), c_k the mean of psi_j psi_(j + k): what neighbours share beyond the field's
/// own share is the difference of c_1 and c_2.
#[must_use]
pub fn ranked_index(pairs: &[(f64, f64)], seed: u64, stream: u64) -> Option<Estimate> {
    let count = pairs.len();
    if count < FEWEST_RUNS {
        return None;
    }
    let mut random = RandomStream::new(seed, Purpose::Ties, stream);
    let mut order: Vec<u32> = (0..count as u32).collect();
    for last in (1..count).rev() {
        order.swap(last, random.below(last as u64 + 1) as usize);
    }
    order.sort_by(|a, b| pairs[*a as usize].0.total_cmp(&pairs[*b as usize].0));
    let size = count as f64;
    let mean = pairs.iter().map(|pair| pair.1 / size).sum::<f64>();
    let values: Vec<f64> = order
        .iter()
        .map(|place| pairs[*place as usize].1 - mean)
        .collect();
    let variance = values.iter().map(|y| y * y).sum::<f64>() / size;
    if variance <= (1e-14 * mean) * (1e-14 * mean) {
        return None;
    }
    let next = |place: usize| values[(place + 1) % count];
    let product: f64 = (0..count).map(|place| values[place] * next(place)).sum();
    let value = product / size / variance;
    let psi: Vec<f64> = (0..count)
        .map(|place| values[place] * (next(place) - value * values[place]) / variance)
        .collect();
    let shared = |lag: usize| -> f64 {
        let terms = (0..count).map(|place| psi[place] * psi[(place + lag) % count]);
        terms.sum::<f64>() / size
    };
    let spread = (shared(0) + 2.0 * (shared(1) - shared(2))).max(0.0);
    let half = 1.959_963_984_540_054 * libm::sqrt(spread / size);
    Some(Estimate {
        value,
        interval_95: [value - half, value + half],
    })
}

#[cfg(test)]
mod tests;
