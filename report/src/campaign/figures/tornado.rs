//! Which field drives which metric: Sobol indices where the campaign has them, else rank correlations.

use aerobot_engine::campaign::sensitivity::SobolIndex;
use aerobot_engine::campaign::sobol_indices::Estimate;
use aerobot_engine::campaign::summary::RankCorrelation;

use crate::campaign::CampaignRecord;
use crate::figure::{Axis, Figure, Mark, Panel, Series};

/// The 97.5th percentile of the normal distribution.
const NORMAL_97_5: f64 = 1.959_963_984_540_054;

/// Fields with bars of one name, a value and its interval for each.
struct Bars {
    name: &'static str,
    values: Vec<Estimate>,
}

pub(in crate::campaign) fn figure(record: &CampaignRecord) -> Result<Figure, String> {
    let metrics = || record.specification.metrics.0.iter();
    let panels: Vec<Panel> = metrics()
        .filter_map(|(name, _)| of_indices(record, name))
        .collect();
    if !panels.is_empty() {
        return Ok(Figure {
            name: "tornado".to_owned(),
            title: format!("{}: what drives what", record.summary.campaign),
            caption: "Sobol indices with their 95 % intervals: the part of a metric's variance that a field makes \
                      by itself (first order), and with everything that it does together with others (total). \
                      `run.seed` stands for chance."
                .to_owned(),
            panels,
        });
    }
    let panels: Vec<Panel> = metrics()
        .filter_map(|(name, _)| of_correlations(record, name))
        .collect();
    if panels.is_empty() {
        return Err("no field of the campaign varies by itself".to_owned());
    }
    Ok(Figure {
        name: "tornado".to_owned(),
        title: format!("{}: what goes with what", record.summary.campaign),
        caption: "Spearman's rank correlation of fields and metrics; 95 % intervals by Fisher's z with the \
                  variance of Bonett and Wright, Psychometrika 65, 23 (2000)."
            .to_owned(),
        panels,
    })
}

fn of_indices(record: &CampaignRecord, metric: &str) -> Option<Panel> {
    let indices = record.summary.sobol_indices.iter();
    let mut rows: Vec<&SobolIndex> = indices
        .filter(|index| index.metric == metric && index.first_order.is_some())
        .collect();
    let size = |row: &SobolIndex| row.total.or(row.first_order).map_or(0.0, |of| of.value);
    rows.sort_by(|a, b| size(a).total_cmp(&size(b)).then(b.field.cmp(&a.field)));
    let fields = rows.iter().map(|row| row.field.as_str()).collect();
    let first = rows.iter().filter_map(|row| row.first_order).collect();
    let total: Vec<Estimate> = rows.iter().filter_map(|row| row.total).collect();
    let mut bars = vec![Bars {
        name: "first order",
        values: first,
    }];
    if total.len() == rows.len() {
        bars.push(Bars {
            name: "total",
            values: total,
        });
    }
    panel(metric, "Sobol index", fields, &bars)
}

fn of_correlations(record: &CampaignRecord, metric: &str) -> Option<Panel> {
    let correlations = record.summary.rank_correlations.iter();
    let mut rows: Vec<(&RankCorrelation, f64)> = correlations
        .filter(|row| row.metric == metric)
        .filter_map(|row| Some((row, row.spearman?)))
        .collect();
    let order = |a: &(_, f64), b: &(_, f64)| a.1.abs().total_cmp(&b.1.abs());
    rows.sort_by(|a, b| order(a, b).then(b.0.field.cmp(&a.0.field)));
    let fields = rows.iter().map(|(row, _)| row.field.as_str()).collect();
    let values = rows
        .iter()
        .map(|(row, value)| correlation(*value, row.runs));
    let bars = Bars {
        name: "rank correlation",
        values: values.collect(),
    };
    panel(metric, "rank correlation", fields, &[bars])
}

/// A rank correlation with its interval: z = atanh(r) has about the variance (1 + r^2 / 2) / (n - 3).
fn correlation(value: f64, runs: u64) -> Estimate {
    let interval_95 = if runs > 3 && value.abs() < 1.0 {
        let z = libm::atanh(value);
        let spread = libm::sqrt((1.0 + 0.5 * value * value) / (runs as f64 - 3.0));
        [z - NORMAL_97_5 * spread, z + NORMAL_97_5 * spread].map(libm::tanh)
    } else {
        [value; 2]
    };
    Estimate { value, interval_95 }
}

/// Lying bars, the first field at the bottom, bars of several names side by side.
fn panel(metric: &str, what: &str, fields: Vec<&str>, bars: &[Bars]) -> Option<Panel> {
    if fields.is_empty() {
        return None;
    }
    let width = 0.8 / bars.len() as f64;
    let mut series = Vec::new();
    for (tone, of_name) in bars.iter().enumerate() {
        let shift = 0.4 - (tone as f64 + 0.5) * width;
        let place = |field: usize| field as f64 + shift;
        let rows = of_name.values.iter().enumerate();
        let bar = rows.clone().map(|(field, of)| (of.value, place(field)));
        let from = vec![0.0; of_name.values.len()];
        let intervals = rows.flat_map(|(field, of)| {
            let [low, high] = of.interval_95;
            let at = place(field);
            [(low, at), (high, at), (high, f64::NAN)]
        });
        let mark = Mark::LyingBars {
            from,
            width: 0.9 * width,
        };
        series.push(
            Series::line(of_name.name, bar)
                .with_mark(mark)
                .with_tone(tone),
        );
        series.push(
            Series::line("95 % interval", intervals)
                .with_mark(Mark::LineAndPoints)
                .with_tone(bars.len()),
        );
    }
    Some(Panel {
        title: metric.to_owned(),
        x: Axis::new(what),
        y: Axis {
            names: fields.into_iter().map(short).collect(),
            ..Axis::default()
        },
        series,
        ..Panel::default()
    })
}

/// A path without what all of them begin with.
fn short(path: &str) -> String {
    let rest = path.strip_prefix("entities.");
    rest.unwrap_or(path).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// atanh(0.5) is ln(3) / 2; of n = 3 + 1.125 / 0.25^2 = 21 runs the spread of z is a quarter.
    #[test]
    fn the_interval_of_a_correlation_by_hand() {
        let found = correlation(0.5, 21);
        let z = 0.5 * libm::log(3.0);
        let [low, high] = found.interval_95;
        assert!((libm::atanh(low) - (z - 0.489_990_996)).abs() < 1e-9);
        assert!((libm::atanh(high) - (z + 0.489_990_996)).abs() < 1e-9);
        assert_eq!(correlation(1.0, 21).interval_95, [1.0, 1.0]);
    }
}
