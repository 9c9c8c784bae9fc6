//! Statistics of many numbers: percentiles, intervals of confidence, rank correlation.

use super::random_stream::{Purpose, RandomStream};

/// Mean and standard deviation (over n - 1) of numbers; `None` of fewer than two.
#[must_use]
pub fn mean_and_deviation(values: &[f64]) -> Option<(f64, f64)> {
    if values.len() < 2 {
        return None;
    }
    let count = values.len() as f64;
    let mean = values.iter().map(|value| value / count).sum::<f64>();
    let squares = values.iter().map(|value| (value - mean) * (value - mean));
    Some((mean, libm::sqrt(squares.sum::<f64>() / (count - 1.0))))
}

/// Width of the 95 % interval of the mean by the normal law, 2 x 1.96 s / sqrt(n), in the values' unit;
/// `None` of fewer than two values.
#[must_use]
pub fn mean_interval_width(values: &[f64]) -> Option<f64> {
    let (_, deviation) = mean_and_deviation(values)?;
    Some(2.0 * 1.959_963_984_540_054 * deviation / libm::sqrt(values.len() as f64))
}

/// A percentile of sorted numbers, straight between neighbours (definition 7 of Hyndman and Fan, The
/// American Statistician 50, 361 (1996)); `None` of no number.
#[must_use]
pub fn percentile(sorted: &[f64], percent: f64) -> Option<f64> {
    let last = sorted.len().checked_sub(1)?;
    let place = (percent / 100.0).clamp(0.0, 1.0) * last as f64;
    let below = place as usize;
    let (low, high) = (sorted[below], sorted[(below + 1).min(last)]);
    let part = place - below as f64;
    Some(if part == 0.0 {
        low
    } else {
        low * (1.0 - part) + high * part
    })
}

/// 95 % intervals by the bootstrap.
#[derive(Clone, Debug, PartialEq)]
pub struct Bootstrap {
    /// Of the mean.
    pub mean: [f64; 2],
    /// Of each percentile that was asked for.
    pub percentiles: Vec<[f64; 2]>,
    /// Number of resamples.
    pub resamples: u32,
}

/// Draws of a bootstrap over all resamples; a million values get 200 resamples.
const MOST_DRAWS: usize = 200_000_000;

/// The percentile bootstrap (Efron, The Annals of Statistics 7, 1 (1979)): 1000 resamples, fewer of more
/// than 200 000 values, and the 2.5th and 97.5th percentile of what they give. `None` of fewer than two values.
#[must_use]
pub fn bootstrap(sorted: &[f64], percents: &[f64], seed: u64, stream: u64) -> Option<Bootstrap> {
    if sorted.len() < 2 {
        return None;
    }
    let resamples = (MOST_DRAWS / sorted.len()).clamp(200, 1000);
    let mut random = RandomStream::new(seed, Purpose::Bootstrap, stream);
    let mut found = vec![Vec::with_capacity(resamples); percents.len() + 1];
    let mut counts = vec![0_u32; sorted.len()];
    let mut resample = Vec::with_capacity(sorted.len());
    for _ in 0..resamples {
        counts.fill(0);
        for _ in 0..sorted.len() {
            counts[random.below(sorted.len() as u64) as usize] += 1;
        }
        resample.clear();
        for (value, count) in sorted.iter().zip(&counts) {
            resample.extend(std::iter::repeat_n(*value, *count as usize));
        }
        let mean = resample
            .iter()
            .map(|value| value / sorted.len() as f64)
            .sum();
        found[0].push(mean);
        for (values, percent) in found[1..].iter_mut().zip(percents) {
            values.extend(percentile(&resample, *percent));
        }
    }
    let mut intervals = found.into_iter().map(|mut values| {
        values.sort_by(f64::total_cmp);
        Some([percentile(&values, 2.5)?, percentile(&values, 97.5)?])
    });
    Some(Bootstrap {
        mean: intervals.next()??,
        percentiles: intervals.collect::<Option<_>>()?,
        resamples: resamples as u32,
    })
}

/// Spearman's rank correlation of pairs, equal values sharing their mean rank; `None` if there are fewer than
/// three pairs, or all of one side are equal.
#[must_use]
pub fn rank_correlation(pairs: &[(f64, f64)]) -> Option<f64> {
    if pairs.len() < 3 {
        return None;
    }
    let first = ranks(&pairs.iter().map(|pair| pair.0).collect::<Vec<_>>());
    let second = ranks(&pairs.iter().map(|pair| pair.1).collect::<Vec<_>>());
    let middle = (pairs.len() as f64 + 1.0) / 2.0;
    let product = |a: &[f64], b: &[f64]| -> f64 {
        a.iter()
            .zip(b)
            .map(|(a, b)| (a - middle) * (b - middle))
            .sum()
    };
    let spread = libm::sqrt(product(&first, &first) * product(&second, &second));
    (spread > 0.0).then(|| (product(&first, &second) / spread).clamp(-1.0, 1.0))
}

/// Ranks from 1; equal values have the mean of theirs.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]).then(a.cmp(b)));
    let mut found = vec![0.0; values.len()];
    let mut before = 0.0;
    for group in order.chunk_by(|a, b| values[*a] == values[*b]) {
        let count = group.len() as f64;
        for place in group {
            found[*place] = before + (count + 1.0) / 2.0;
        }
        before += count;
    }
    found
}

#[cfg(test)]
mod tests {
    use aerobot_systems::stochastic::normal_distribution::quantile;

    use super::*;

    #[test]
    fn percentiles_of_few_numbers() {
        let values = [1.0, 2.0, 4.0, 8.0];
        assert_eq!(percentile(&values, 0.0), Some(1.0));
        assert_eq!(percentile(&values, 50.0), Some(3.0));
        assert_eq!(percentile(&values, 100.0), Some(8.0));
        assert_eq!(percentile(&[], 50.0), None);
    }

    /// Ranks 1 2 3 4 5 against 2 1 4 3 5: 1 - 6 * 4 / (5 * 24) = 0.8. With ties, Pearson's of mean ranks.
    #[test]
    fn rank_correlations_by_hand() {
        let pairs = [
            (1.0, 20.0),
            (2.0, 10.0),
            (3.0, 40.0),
            (4.0, 30.0),
            (5.0, 1e9),
        ];
        assert!((rank_correlation(&pairs).unwrap() - 0.8).abs() < 1e-15);
        let falling: Vec<_> = (0..9)
            .map(|k| (f64::from(k), libm::exp(-f64::from(k))))
            .collect();
        assert_eq!(rank_correlation(&falling), Some(-1.0));
        // Ranks 1.5 1.5 3 against 1 2 3: 1.5 / sqrt(1.5 * 2).
        let tied = rank_correlation(&[(0.0, 1.0), (0.0, 2.0), (7.0, 3.0)]).unwrap();
        assert!((tied - 1.5 / libm::sqrt(3.0)).abs() < 1e-15);
        assert_eq!(
            rank_correlation(&[(1.0, 1.0), (1.0, 2.0), (1.0, 3.0)]),
            None
        );
    }

    /// Of 100 samples of 40 normal numbers, the intervals of the mean, and of the median, hold the truth in
    /// 86 or more: the percentile bootstrap of 40 covers about 94 %, and 86 is four standard errors less.
    #[test]
    fn bootstrap_intervals_cover_the_truth() {
        let (mut means, mut medians) = (0, 0);
        for sample in 0..100 {
            let mut random = RandomStream::new(sample, Purpose::Inputs, 0);
            let mut values: Vec<f64> = (0..40).map(|_| quantile(random.unit())).collect();
            values.sort_by(f64::total_cmp);
            let found = bootstrap(&values, &[50.0], 1, sample).unwrap();
            let holds = |interval: [f64; 2]| i32::from(interval[0] < 0.0 && 0.0 < interval[1]);
            means += holds(found.mean);
            medians += holds(found.percentiles[0]);
        }
        assert!(means >= 86 && medians >= 86, "{means}, {medians}");
        assert!(means < 100 || medians < 100);
    }

    #[test]
    fn the_interval_of_a_mean_by_hand() {
        // Variance of 1, 2, 3 is 1.
        let width = mean_interval_width(&[1.0, 2.0, 3.0]).unwrap();
        assert!((width - 2.0 * 1.959963984540054 / libm::sqrt(3.0)).abs() < 1e-14);
        assert_eq!(mean_interval_width(&[1.0]), None);
    }
}
