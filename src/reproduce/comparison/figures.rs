//! Figures 5 and 6 of the paper, and how the two formulations become one.

use aerobot_report::figure::{Axis, Figure, Mark, Panel, Series};

use super::super::drawing::{component, over_time, panel};
use super::{BALLOON, ComparisonStudy, GONDOLA, TETHER};

pub(super) fn figures(found: &ComparisonStudy) -> Vec<Figure> {
    vec![
        displacements(found),
        differences(found),
        tensions(found),
        limit(found),
    ]
}

fn displacements(found: &ComparisonStudy) -> Figure {
    let panels = ["x", "y", "z"].iter().enumerate().map(|(axis, name)| {
        let mut series = Vec::new();
        for body in [BALLOON, GONDOLA] {
            for flight in [&found.lumped, &found.links] {
                let rows = component(&flight.displacements(body), axis);
                let name = format!("{body}, {}", flight.formulation.name());
                let tone = series.len();
                series.push(Series::line(name, rows).with_tone(tone));
            }
        }
        panel(&format!("{name} displacement [m]"), series)
    });
    over_time(
        "comparison-displacement",
        "Displacement of balloon and gondola (figure 5)",
        "",
        panels.collect(),
    )
}

fn differences(found: &ComparisonStudy) -> Figure {
    let panels = [BALLOON, GONDOLA].iter().map(|body| {
        let pairs = [&found.lumped, &found.links].map(|flight| flight.displacements(body));
        let apart: Vec<_> = pairs[0]
            .iter()
            .zip(&pairs[1])
            .map(|((time_s, a), (_, b))| (*time_s, *b - *a))
            .collect();
        let series = ["x", "y", "z"].iter().enumerate();
        let series =
            series.map(|(axis, name)| Series::line(*name, component(&apart, axis)).with_tone(axis));
        panel(&format!("difference, {body} [m]"), series.collect())
    });
    over_time(
        "comparison-difference",
        "Rigid links less lumped masses",
        "The tether of the lumped masses stretches; that of the links does not.",
        panels.collect(),
    )
}

fn tensions(found: &ComparisonStudy) -> Figure {
    let panels = ["tension_from_n", "tension_to_n"]
        .iter()
        .zip(["top", "bottom"]);
    let panels = panels.map(|(channel, name)| {
        let series = [&found.lumped, &found.links].into_iter().enumerate();
        let series = series.map(|(tone, flight)| {
            let rows = flight.results.channel(TETHER, channel);
            Series::line(flight.formulation.name(), rows).with_tone(tone)
        });
        panel(&format!("tension, {name} [N]"), series.collect())
    });
    over_time(
        "comparison-tension",
        "Tension at the ends of the tether (figure 6)",
        "",
        panels.collect(),
    )
}

fn limit(found: &ComparisonStudy) -> Figure {
    let ours = Series::line("lumped masses less links", found.limit.clone());
    let mut series = vec![ours.with_mark(Mark::LineAndPoints)];
    if let Some((factor, largest_m)) = found.limit.first() {
        let line = found
            .limit
            .iter()
            .map(|(other, _)| (*other, largest_m * factor / other));
        series.push(Series::line("as 1/EA", line).with_tone(1));
    }
    Figure {
        name: "comparison-stiffness".to_owned(),
        title: "Difference of the formulations as the tether gets stiffer".to_owned(),
        caption: "Masses on the nodes in both: what is left is the stretch.".to_owned(),
        panels: vec![Panel {
            x: Axis::log("axial stiffness over that of the scene [1]"),
            y: Axis::log("largest difference of a displacement [m]"),
            series,
            ..Panel::default()
        }],
    }
}
