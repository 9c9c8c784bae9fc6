//! Figure 21 of the paper: the drone's place from the gondola.

use aerobot_report::figure::{Figure, Series};

use super::super::drawing::{over_time, panel};
use super::{ChaseFlight, DroneAir};

pub(super) fn figures(flights: &[ChaseFlight]) -> Vec<Figure> {
    let (own, other): (Vec<_>, Vec<_>) = flights
        .iter()
        .partition(|flight| flight.air == DroneAir::Own);
    vec![
        errors(
            "chase-error",
            "Place of the drone from the gondola (figure 21)",
            &own,
        ),
        errors("chase-other-air", "The same in other air", &other),
    ]
}

fn errors(name: &str, title: &str, flights: &[&ChaseFlight]) -> Figure {
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
    over_time(name, title, "Drone less gondola.", panels.collect())
}
