//! Figures 13 and 14 of the paper: the heading over time, with the record that its table was read from.

use aerobot_report::figure::{Figure, Series};

use super::super::drawing::{degrees, over_time, panel};
use super::LengthResult;

pub(super) fn figures(results: &[LengthResult]) -> Vec<Figure> {
    let panels = results.iter().map(|result| {
        let flights = [&result.lumped, &result.links].into_iter().enumerate();
        let series = flights.map(|(tone, flight)| {
            Series::line(flight.formulation.name(), degrees(&flight.headings)).with_tone(tone)
        });
        let label = format!("heading, {} m [deg]", result.pendulum.length_m);
        panel(&label, series.collect())
    });
    vec![over_time(
        "yaw-heading",
        "Heading of the body on its ring of tethers (figures 13, 14)",
        "The paper's frequencies are bins of the first 15 s.",
        panels.collect(),
    )]
}
