//! Figures 9 and 10 of the paper: how the chains move, how they turn, how their tethers pull.

use aerobot_report::figure::{Figure, Panel, Series};

use super::super::drawing::{component, degrees, over_time, panel};
use super::ChainResult;

pub(super) fn figures(results: &[ChainResult]) -> Vec<Figure> {
    results
        .iter()
        .flat_map(|result| [displacements(result), angles(result)])
        .collect()
}

fn paper_figure(result: &ChainResult) -> &'static str {
    match result.architecture {
        super::Architecture::MultiTether => "several tethers (figure 9)",
        super::Architecture::FlightChain => "flight chain (figure 10)",
    }
}

fn displacements(result: &ChainResult) -> Figure {
    let panels = ["x", "y", "z"].iter().enumerate().map(|(axis, name)| {
        let mut series = Vec::new();
        for body in result.architecture.bodies() {
            for flight in result.flights() {
                let rows = component(&flight.displacements(body), axis);
                let name = format!("{body}, {}", flight.formulation.name());
                let tone = series.len();
                series.push(Series::line(name, rows).with_tone(tone));
            }
        }
        panel(&format!("{name} displacement [m]"), series)
    });
    over_time(
        &format!("chains-displacement-{}", result.architecture.name()),
        &format!("Displacement, {}", paper_figure(result)),
        "",
        panels.collect(),
    )
}

fn angles(result: &ChainResult) -> Figure {
    let angle = |channel: &str, label: &str| -> Panel {
        let mut series = Vec::new();
        for body in result.architecture.bodies() {
            for flight in result.flights() {
                let rows = degrees(&flight.results.channel(body, channel));
                if rows.is_empty() {
                    continue;
                }
                let name = format!("{body}, {}", flight.formulation.name());
                let tone = series.len();
                series.push(Series::line(name, rows).with_tone(tone));
            }
        }
        panel(label, series)
    };
    over_time(
        &format!("chains-angles-{}", result.architecture.name()),
        &format!("Swing and heading, {}", paper_figure(result)),
        "",
        vec![
            angle("tilt_rad", "tilt [deg]"),
            angle("heading_rad", "heading [deg]"),
        ],
    )
}
