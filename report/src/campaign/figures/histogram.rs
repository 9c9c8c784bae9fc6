//! How often each metric has which values.

use aerobot_engine::campaign::statistics::percentile;

use crate::campaign::CampaignRecord;
use crate::figure::{Axis, Figure, Mark, Panel, Series};

use super::axis_label;

/// The fewest and the most bars.
const BARS: (f64, f64) = (5.0, 60.0);

pub(in crate::campaign) fn figure(record: &CampaignRecord) -> Result<Figure, String> {
    let metrics = record.specification.metrics.0.iter().enumerate();
    let panels: Vec<Panel> = metrics
        .filter_map(|(place, (name, metric))| {
            panel(&record.values(place), axis_label(name, &metric.unit()))
        })
        .collect();
    if panels.is_empty() {
        return Err("no run of the campaign has a metric".to_owned());
    }
    Ok(Figure {
        name: "histogram".to_owned(),
        title: format!("{}: metrics over all runs", record.summary.campaign),
        caption: "Runs that have the metric, with its mean and its percentiles 5, 50 and 95."
            .to_owned(),
        panels,
    })
}

fn panel(values: &[f64], label: String) -> Option<Panel> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (bars, width) = bars(&sorted)?;
    let top = bars.iter().map(|bar| bar.1).fold(0.0, f64::max);
    let count = sorted.len() as f64;
    let mean = sorted.iter().map(|value| value / count).sum::<f64>();
    let upright = |name: &str, x: f64| Series::line(name, [(x, 0.0), (x, top)]);
    let mut series = vec![Series::line("runs", bars).with_mark(Mark::Bars { width })];
    series.push(upright("mean", mean).with_tone(1));
    for percent in [5.0, 50.0, 95.0] {
        let name = "5, 50, 95 %";
        series.push(upright(name, percentile(&sorted, percent)?).with_tone(2));
    }
    Some(Panel {
        title: String::new(),
        x: Axis::new(label),
        y: Axis::new("runs [1]"),
        series,
        ..Panel::default()
    })
}

/// Middles and heights of bars, and their width, 2 IQR / cbrt(n) (Freedman and Diaconis, Zeitschrift fuer
/// Wahrscheinlichkeitstheorie 57, 453 (1981)) within limits; nothing of no number.
fn bars(sorted: &[f64]) -> Option<(Vec<(f64, f64)>, f64)> {
    let (least, most) = (*sorted.first()?, *sorted.last()?);
    if least == most {
        let width = if least == 0.0 { 1.0 } else { 0.1 * least.abs() };
        return Some((vec![(least, sorted.len() as f64)], width));
    }
    let quartiles = percentile(sorted, 75.0)? - percentile(sorted, 25.0)?;
    let wanted = 2.0 * quartiles / libm::cbrt(sorted.len() as f64);
    let number = if wanted > 0.0 {
        (most - least) / wanted
    } else {
        BARS.1
    };
    let number = libm::ceil(number).clamp(BARS.0, BARS.1);
    let width = (most - least) / number;
    let mut heights = vec![0.0; number as usize];
    for value in sorted {
        // The largest belongs to the last bar.
        let place = (((value - least) / width) as usize).min(heights.len() - 1);
        heights[place] += 1.0;
    }
    let bars = heights.into_iter().enumerate();
    let middle = |place: usize| least + (place as f64 + 0.5) * width;
    Some((
        bars.map(|(place, height)| (middle(place), height))
            .collect(),
        width,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_is_in_one_bar() {
        let values: Vec<f64> = (0..=1000).map(f64::from).collect();
        let (bars, width) = bars(&values).unwrap_or_default();
        // 2 x 500 / cbrt(1001) is 99.97, so that ten bars are not quite enough.
        assert_eq!(bars.len(), 11);
        assert!((width - 1000.0 / 11.0).abs() < 1e-12);
        assert_eq!(bars.iter().map(|bar| bar.1).sum::<f64>(), 1001.0);
        assert!(bars.iter().all(|bar| (90.0..=92.0).contains(&bar.1)));
        assert_eq!(
            super::bars(&[3.0, 3.0]).map(|bars| bars.0),
            Some(vec![(3.0, 2.0)])
        );
        assert_eq!(super::bars(&[]), None);
    }
}
