//! The approach: distance, way in the gondola's frame, phases.

use aerobot_report::figure::{Figure, Series};

use super::super::drawing::{over_time, panel};
use super::{ApproachRow, DockingStudy};

pub(super) fn figures(found: &DockingStudy) -> Vec<Figure> {
    let lines = |value: &dyn Fn(&ApproachRow) -> f64| -> Vec<Series> {
        let approaches = found.approaches.iter().enumerate();
        approaches
            .map(|(tone, approach)| {
                let rows = approach.rows.iter().map(|row| (row.time_s, value(row)));
                Series::line(format!("seed {}", approach.seed), rows).with_tone(tone)
            })
            .collect()
    };
    vec![over_time(
        "docking-approach",
        "The approach to the port",
        "Phases: 0 search, 1 approach, 2 station-keeping, 3 contact, 4 docked.",
        vec![
            panel("distance of the ports [m]", lines(&|row| row.distance_m)),
            panel(
                "off the axis of the port [m]",
                lines(&|row| row.lateral_error_m),
            ),
            panel("shaft power [W]", lines(&|row| row.power_w)),
            panel("phase [1]", lines(&|row| row.phase)),
        ],
    )]
}
