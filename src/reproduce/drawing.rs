//! What the figures of several cases are made of.

use aerobot_report::figure::{Axis, Figure, Panel, Series};
use glam::DVec3;

/// A figure of panels over the time of the runs.
pub(super) fn over_time(name: &str, title: &str, caption: &str, panels: Vec<Panel>) -> Figure {
    Figure {
        name: name.to_owned(),
        title: title.to_owned(),
        caption: caption.to_owned(),
        panels: panels
            .into_iter()
            .map(|panel| Panel {
                x: Axis::time(),
                ..panel
            })
            .collect(),
    }
}

/// A panel with its ordinate.
pub(super) fn panel(y: &str, series: Vec<Series>) -> Panel {
    Panel {
        y: Axis::new(y),
        series,
        ..Panel::default()
    }
}

/// A component of vectors over time.
pub(super) fn component(rows: &[(f64, DVec3)], axis: usize) -> Vec<(f64, f64)> {
    rows.iter()
        .map(|(time_s, vector)| (*time_s, vector[axis]))
        .collect()
}

/// Angles over time, in degrees.
pub(super) fn degrees(rows: &[(f64, f64)]) -> Vec<(f64, f64)> {
    rows.iter()
        .map(|(time_s, angle)| (*time_s, angle.to_degrees()))
        .collect()
}
