//! Fewer points that look the same: of each stretch of a series its least and its greatest ordinate.

use super::{Figure, Mark, Series};

/// More points than this of a line are not seen apart, pixels of a wide screen being fewer.
pub const MOST_POINTS: usize = 4000;

impl Figure {
    /// The figure with lines of at most about `most` points each; peaks stay, and so do gaps.
    #[must_use]
    pub fn thinned(mut self, most: usize) -> Self {
        for series in self.panels.iter_mut().flat_map(|panel| &mut panel.series) {
            thin(series, most);
        }
        self
    }
}

fn thin(series: &mut Series, most: usize) {
    let is_line = matches!(series.mark, Mark::Line | Mark::LineAndPoints);
    let is_run_on = series.x.windows(2).all(|pair| pair[0] <= pair[1]);
    if series.x.len() <= most || !is_line {
        return;
    }
    let kept = if is_run_on {
        extremes(&series.y, most)
    } else {
        // A path: its points are not a function of one axis.
        evenly(series.x.len(), most)
    };
    series.x = kept.iter().map(|index| series.x[*index]).collect();
    series.y = kept.iter().map(|index| series.y[*index]).collect();
}

fn evenly(count: usize, most: usize) -> Vec<usize> {
    (0..most)
        .map(|place| place * (count - 1) / (most - 1))
        .collect()
}

/// First, last, least and greatest of each of `most / 4` stretches, in order; a gap stays a gap.
fn extremes(y: &[f64], most: usize) -> Vec<usize> {
    let stretches = (most / 4).max(1);
    let mut kept = Vec::with_capacity(most + 1);
    for stretch in 0..stretches {
        let from = stretch * y.len() / stretches;
        let to = (stretch + 1) * y.len() / stretches;
        let numbers = || (from..to).filter(|index| y[*index].is_finite());
        let least = numbers().min_by(|a, b| y[*a].total_cmp(&y[*b]));
        let most = numbers().max_by(|a, b| y[*a].total_cmp(&y[*b]));
        let gap = (from..to).find(|index| !y[*index].is_finite());
        let mut chosen: Vec<usize> = [Some(from), least, most, gap, Some(to - 1)]
            .into_iter()
            .flatten()
            .collect();
        chosen.sort_unstable();
        chosen.dedup();
        kept.extend(chosen);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Panel;

    fn figure(points: impl Iterator<Item = (f64, f64)>) -> Figure {
        Figure {
            panels: vec![Panel {
                series: vec![Series::line("a", points)],
                ..Panel::default()
            }],
            ..Figure::default()
        }
    }

    #[test]
    fn peaks_of_one_sample_stay() {
        let count = 100_000;
        let value = |index: usize| match index {
            31_234 => 7.0,
            77_777 => -9.0,
            _ => libm::sin(index as f64 * 1e-3),
        };
        let all = figure((0..count).map(|index| (index as f64, value(index))));
        let thinned = all.thinned(MOST_POINTS);
        let series = &thinned.panels[0].series[0];
        assert!(series.x.len() <= MOST_POINTS);
        assert!(series.x.len() > MOST_POINTS / 4);
        let at = |x: f64| {
            series
                .x
                .iter()
                .position(|other| *other == x)
                .map(|i| series.y[i])
        };
        assert_eq!(at(31_234.0), Some(7.0));
        assert_eq!(at(77_777.0), Some(-9.0));
        assert_eq!((series.x[0], *series.x.last().unwrap()), (0.0, 99_999.0));
        assert!(series.x.windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn every_stretch_keeps_its_range() {
        // Whatever the thinning, the least and greatest of any tenth are those of all points.
        let wave = |index: usize| libm::sin(index as f64 * 1.7) * libm::cos(index as f64 * 3e-4);
        let count = 50_000;
        let thinned = figure((0..count).map(|i| (i as f64, wave(i)))).thinned(2000);
        let series = &thinned.panels[0].series[0];
        for tenth in 0..10 {
            let span = (tenth * count / 10) as f64..((tenth + 1) * count / 10) as f64;
            let range = |pairs: &mut dyn Iterator<Item = (f64, f64)>| {
                pairs
                    .filter(|(x, _)| span.contains(x))
                    .fold((f64::MAX, f64::MIN), |(low, high), (_, y)| {
                        (low.min(y), high.max(y))
                    })
            };
            let all = range(&mut (0..count).map(|i| (i as f64, wave(i))));
            let kept = range(&mut series.x.iter().copied().zip(series.y.iter().copied()));
            assert_eq!(all, kept);
        }
    }

    #[test]
    fn gaps_stay() {
        let value = |i: usize| {
            if (4000..4003).contains(&i) {
                f64::NAN
            } else {
                1.0
            }
        };
        let thinned = figure((0..10_000).map(|i| (i as f64, value(i)))).thinned(400);
        assert!(thinned.panels[0].series[0].y.iter().any(|y| y.is_nan()));
    }
}
