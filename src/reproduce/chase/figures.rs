//! Figure 21 of the paper: the drone's place from the gondola.

use aerobot_report::figure::{Figure, Series};

use super::super::drawing::{over_time, panel};
use super::ChaseFlight;

pub(super) fn figures(flights: &[ChaseFlight]) -> Vec<Figure> {
    let panels = ["x", "y", "z"].iter().enumerate().map(|(axis, name)| {
        let series = flights.iter().enumerate().map(|(tone, flight)| {
            let rows = flight
                .rows
                .iter()
                .map(|row| (row.time_s, row.error_m[axis]));
            Series::line(flight.air.name(), rows).with_tone(tone)
        });
        panel(&format!("{name} error [m]"), series.collect())
    });
    vec![over_time(
        "chase-error",
        "Place of the drone from the gondola (figure 21)",
        "In a wind of its own, as the paper's figure needs; in the gondola's; in still air.",
        panels.collect(),
    )]
}
