//! Percentiles over all runs as time goes.

use crate::campaign::{CampaignRecord, Envelope};
use crate::figure::{Axis, Figure, Mark, Panel, Series};

use super::axis_label;

pub(in crate::campaign) fn figure(record: &CampaignRecord) -> Result<Figure, String> {
    let envelopes = record
        .envelopes
        .iter()
        .zip(&record.specification.envelopes.0);
    let panels: Vec<Panel> = envelopes
        .filter(|(envelope, _)| !envelope.times_s.is_empty())
        .map(|(envelope, (_, specification))| panel(envelope, specification.quantity().unit()))
        .collect();
    if panels.is_empty() {
        return Err("the campaign has no envelopes: give it some in `envelopes`".to_owned());
    }
    let counts = record.envelopes.iter().flat_map(|envelope| &envelope.runs);
    let fewest = counts.min().copied().unwrap_or(0);
    Ok(Figure {
        name: "envelope".to_owned(),
        title: format!("{}: percentiles as time goes", record.summary.campaign),
        caption: format!(
            "At each time the values of all runs that got to their end, {} at most and {fewest} at least: \
             percentiles 5 to 95, 25 to 75, and the median. A curve is that of no single run.",
            record.summary.runs_done
        ),
        panels,
    })
}

fn panel(envelope: &Envelope, unit: &str) -> Panel {
    let [_, p5, p25, p50, p75, p95, _] = &envelope.percentiles;
    let series = |name: &str, values: &[f64]| {
        let times = envelope.times_s.iter().copied();
        Series::line(name, times.zip(values.iter().copied()))
    };
    let band = |name: &str, low: &[f64], high: &[f64]| {
        series(name, low).with_mark(Mark::Band { to: high.to_vec() })
    };
    Panel {
        x: Axis::time(),
        y: Axis::new(axis_label(&envelope.name, unit)),
        series: vec![
            band("5 to 95 % (light)", p5, p95),
            band("25 to 75 % (dark)", p25, p75),
            series("median", p50),
        ],
        ..Panel::default()
    }
}
