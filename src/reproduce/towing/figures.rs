//! Figure 15 of the paper: shapes of the towline and its tension, as a continuous cable and flown.

use aerobot_report::figure::{Axis, Figure, Mark, Panel, Series};

use super::WindResult;
use super::line::LineShape;

/// Points of the continuous line, and nodes of the flown one, that are drawn.
const POINTS: usize = 200;
const NODES: usize = 20;

pub(super) fn figures(results: &[WindResult]) -> Vec<Figure> {
    vec![shapes(results), errors(results)]
}

fn line(name: String, shape: &LineShape, most: usize) -> Series {
    let every = shape.points.len().div_ceil(most).max(1);
    let last = shape.points.len().saturating_sub(1);
    let points = shape.points.iter().enumerate();
    let points = points.filter(|(index, _)| index % every == 0 || *index == last);
    Series::line(name, points.map(|(_, point)| (point.x_m, point.z_m)))
}

fn shapes(results: &[WindResult]) -> Figure {
    let mut series = Vec::new();
    for (tone, result) in results.iter().enumerate() {
        let wind = format!("{} m/s", result.wind_m_s);
        series.push(line(wind.clone(), &result.continuous, POINTS).with_tone(tone));
        let flown = line(format!("{wind}, flown"), &result.dynamic, NODES).with_tone(tone);
        series.push(flown.with_mark(Mark::Points));
    }
    Figure {
        name: "towing-shapes".to_owned(),
        title: "Shape of the towline (figure 15)".to_owned(),
        caption: "Lines: the continuous cable. Points: some nodes of the run, at its end."
            .to_owned(),
        panels: vec![Panel {
            x: Axis::new("x downwind [m]"),
            y: Axis::new("altitude [m]"),
            equal_axes: true,
            series,
            ..Panel::default()
        }],
    }
}

fn errors(results: &[WindResult]) -> Figure {
    let error = |name: &str, value: &dyn Fn(&WindResult) -> f64, tone: usize| {
        let points = results
            .iter()
            .map(|result| (result.wind_m_s, value(result)));
        Series::line(name, points)
            .with_mark(Mark::LineAndPoints)
            .with_tone(tone)
    };
    Figure {
        name: "towing-error".to_owned(),
        title: "Distance of the discrete line from the continuous one".to_owned(),
        caption: "Half the nodes are four times as far off: second order.".to_owned(),
        panels: vec![Panel {
            x: Axis::log("wind [m/s]"),
            y: Axis::log("largest distance [m]"),
            series: vec![
                error("all nodes", &WindResult::error_m, 0),
                error("half the nodes", &|result| result.half_nodes_error_m, 1),
            ],
            ..Panel::default()
        }],
    }
}
