//! Figures 17 to 19 of the paper: the way to the commanded place across the wind, and the rudder.

use aerobot_report::figure::{Figure, Series};

use super::super::drawing::{over_time, panel};
use super::SailStudy;

pub(super) fn figures(found: &SailStudy) -> Vec<Figure> {
    let lines = |value: &dyn Fn(&(f64, f64, f64, f64)) -> f64| -> Vec<Series> {
        let flights = found.flights.iter().enumerate();
        flights
            .map(|(tone, (name, response))| {
                let rows = response.rows.iter().map(|row| (row.0, value(row)));
                Series::line(*name, rows).with_tone(tone)
            })
            .collect()
    };
    let mut balloon = lines(&|row| row.1);
    let end_s = balloon
        .iter()
        .flat_map(|series| &series.x)
        .copied()
        .fold(0.0, f64::max);
    let target = [(0.0, found.target_m), (end_s, found.target_m)];
    balloon.push(Series::line("target", target).with_tone(7));
    let response = over_time(
        "sail-response",
        "Way to the commanded place across the wind (figures 17 to 19)",
        "",
        vec![
            panel("y of the balloon [m]", balloon),
            panel("y of the sail [m]", lines(&|row| row.2)),
            panel("rudder [deg]", lines(&|row| row.3.to_degrees())),
        ],
    );
    vec![response, found.separate.figure()]
}
