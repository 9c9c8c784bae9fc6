//! How the mean of each metric settles as runs come in.

use crate::campaign::CampaignRecord;
use crate::figure::{Axis, Figure, Mark, Panel, Series};

use super::axis_label;

/// The most points of a curve.
const MOST_POINTS: f64 = 400.0;
/// The 97.5th percentile of the normal distribution.
const NORMAL_97_5: f64 = 1.959_963_984_540_054;

pub(in crate::campaign) fn figure(record: &CampaignRecord) -> Result<Figure, String> {
    let metrics = record.specification.metrics.0.iter().enumerate();
    let panels: Vec<Panel> = metrics
        .filter_map(|(place, (name, metric))| {
            panel(&record.values(place), axis_label(name, &metric.unit()))
        })
        .collect();
    if panels.is_empty() {
        return Err("no metric has values of two runs".to_owned());
    }
    Ok(Figure {
        name: "convergence".to_owned(),
        title: format!("{}: means as runs come in", record.summary.campaign),
        caption: "The mean of the first so many runs that have the metric, in the order of their indices, and \
                  its 95 % interval by the normal law, mean +- 1.96 s / sqrt(n), which takes runs as independent."
            .to_owned(),
        panels,
    })
}

fn panel(values: &[f64], label: String) -> Option<Panel> {
    let means = running_means(values);
    let first = means.first()?.0;
    let curve = |pick: fn(&(f64, f64, f64)) -> f64| means.iter().map(move |row| (row.0, pick(row)));
    let high = means.iter().map(|(_, mean, half)| mean + half).collect();
    Some(Panel {
        title: String::new(),
        x: Axis {
            range: Some((first, values.len() as f64)),
            ..Axis::log("runs [1]")
        },
        y: Axis::new(format!("mean of {label}")),
        series: vec![
            Series::line("95 % interval", curve(|row| row.1 - row.2))
                .with_mark(Mark::Band { to: high }),
            Series::line("mean", curve(|row| row.1)),
        ],
        ..Panel::default()
    })
}

/// Number of values, their mean and half the width of its interval, at numbers that grow evenly in their
/// logarithms; sums by Welford (Technometrics 4, 419 (1962)). The first fiftieth of the values is not shown.
fn running_means(values: &[f64]) -> Vec<(f64, f64, f64)> {
    let total = values.len() as f64;
    let first = (total / 50.0).max(2.0);
    let growth = libm::pow((total / first).max(1.0), 1.0 / MOST_POINTS);
    let mut next = first;
    let mut found = Vec::new();
    let (mut mean, mut squares) = (0.0, 0.0);
    for (index, value) in values.iter().enumerate() {
        let count = index as f64 + 1.0;
        let apart = value - mean;
        mean += apart / count;
        squares += apart * (value - mean);
        if count >= next || (count == total && count >= 2.0) {
            let deviation = libm::sqrt(squares / (count - 1.0));
            found.push((count, mean, NORMAL_97_5 * deviation / libm::sqrt(count)));
            while next <= count {
                next = (next * growth).max(next + 1e-9);
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of 1, 2, .. n the mean is (n + 1) / 2 and the variance n (n + 1) / 12.
    #[test]
    fn means_and_intervals_of_whole_numbers() {
        let values: Vec<f64> = (1..=10_000).map(f64::from).collect();
        let means = running_means(&values);
        assert!((300..=401).contains(&means.len()), "{}", means.len());
        assert_eq!(means.first().map(|row| row.0), Some(200.0));
        assert_eq!(means.last().map(|row| row.0), Some(10_000.0));
        for (n, mean, half) in means {
            let half_there = NORMAL_97_5 * libm::sqrt((n + 1.0) / 12.0);
            assert!((mean - (n + 1.0) / 2.0).abs() < 1e-9 * mean);
            assert!(
                (half - half_there).abs() < 1e-9 * half,
                "{n}: {half} {half_there}"
            );
        }
        assert!(running_means(&[1.0]).is_empty());
        assert_eq!(running_means(&[1.0, 2.0, 3.0]).len(), 2);
    }
}
