//! The picture: a panel for each case, one legend below them.

use std::error::Error;
use std::path::Path;

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use crate::row::{Method, Row};

/// Width and height of the picture and of its legend, pixels.
const SIZE: (u32, u32) = (1260, 860);
const LEGEND_HEIGHT: u32 = 46;
/// Panels in a row.
const COLUMNS: usize = 3;
/// Half the size of a marker, pixels.
const MARKER: i32 = 3;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Panel<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
type Outcome = Result<(), Box<dyn Error>>;

/// Draws the panels, each the rows of a case, to `file`.
pub(crate) fn draw(file: &Path, panels: &[Vec<&Row>]) -> Outcome {
    let root = SVGBackend::new(file, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let (upper, legend) = root.split_vertically(SIZE.1 - LEGEND_HEIGHT);
    let rows = panels.len().div_ceil(COLUMNS);
    for (area, rows) in upper.split_evenly((rows, COLUMNS)).iter().zip(panels) {
        draw_panel(area, rows)?;
    }
    draw_legend(&legend)?;
    root.present()?;
    Ok(())
}

fn draw_panel(area: &Area<'_>, rows: &[&Row]) -> Outcome {
    let rows: Vec<&Row> = rows
        .iter()
        .copied()
        .filter(|row| row.error_bodies_m > 0.0)
        .collect();
    let (x_low, x_high) = decades(rows.iter().map(|row| row.error_bodies_m));
    let (y_low, y_high) = decades(rows.iter().map(|row| row.cpu_us_per_simulated_s));
    let mut chart = ChartBuilder::on(area)
        .margin(12)
        .margin_right(20)
        .caption(&rows[0].case, ("sans-serif", 19))
        .x_label_area_size(46)
        .y_label_area_size(66)
        .build_cartesian_2d(
            f64::from(x_low)..f64::from(x_high),
            f64::from(y_low)..f64::from(y_high),
        )?;
    let every = if x_high - x_low > 8 { 2 } else { 1 };
    let power = |x: &f64| {
        let decade = x.round();
        if (x - decade).abs() < 1e-9 {
            format!("1e{decade:.0}")
        } else {
            String::new()
        }
    };
    let labels = |low: i32, high: i32, every: i32| ((high - low) / every + 1) as usize;
    chart
        .configure_mesh()
        .max_light_lines(0)
        .bold_line_style(BLACK.mix(0.12))
        .x_labels(labels(x_low, x_high, every))
        .y_labels(labels(y_low, y_high, 1))
        .x_label_formatter(&power)
        .y_label_formatter(&power)
        .x_desc("largest error of a body [m]")
        .y_desc("CPU time per simulated s [us]")
        .label_style(("sans-serif", 14))
        .axis_desc_style(("sans-serif", 15))
        .draw()?;
    for method in Method::ALL {
        let points = rows.iter().filter(|row| row.method == method).map(|row| {
            (
                libm::log10(row.error_bodies_m),
                libm::log10(row.cpu_us_per_simulated_s),
            )
        });
        draw_method(&mut chart, method, &points.collect::<Vec<_>>())?;
    }
    Ok(())
}

/// The whole decades that hold all of `values`.
fn decades(values: impl Iterator<Item = f64>) -> (i32, i32) {
    let (low, high) = values.fold((f64::INFINITY, 0.0), |(low, high), value| {
        (f64::min(low, value), f64::max(high, value))
    });
    let (low, high) = (libm::log10(low), libm::log10(high));
    ((low - 0.05).floor() as i32, (high + 0.05).ceil() as i32)
}

/// Lightness, width and dashes (drawn, left out; pixels) of a method's line.
fn line(method: Method) -> (ShapeStyle, (i32, i32)) {
    match method {
        Method::Auto => (BLACK.stroke_width(2), (1, 0)),
        Method::Implicit => (RGBColor(200, 60, 40).stroke_width(2), (8, 4)),
        Method::DormandPrince => (RGBColor(30, 90, 190).stroke_width(2), (2, 3)),
        Method::RungeKutta4 => (RGBColor(150, 150, 150).stroke_width(2), (14, 3)),
    }
}

fn draw_method(chart: &mut Panel<'_, '_>, method: Method, points: &[(f64, f64)]) -> Outcome {
    let (style, (dash, gap)) = line(method);
    if gap == 0 {
        chart.draw_series(LineSeries::new(points.iter().copied(), style))?;
    } else {
        let series = DashedLineSeries::new(points.iter().copied(), dash, gap, style);
        chart.draw_series(series)?;
    }
    for point in points {
        let place = EmptyElement::at(*point);
        let fill = style.filled();
        match method {
            Method::Auto => chart.draw_series([place + Circle::new((0, 0), MARKER, fill)])?,
            // Open and larger, for it often lies on that of `Auto`.
            Method::Implicit => chart.draw_series([place
                + Rectangle::new(
                    [(-MARKER - 2, -MARKER - 2), (MARKER + 2, MARKER + 2)],
                    style.stroke_width(1),
                )])?,
            Method::DormandPrince => {
                chart.draw_series([place + TriangleMarker::new((0, 0), MARKER + 2, fill)])?
            }
            Method::RungeKutta4 => {
                chart.draw_series([place + Cross::new((0, 0), MARKER + 1, style)])?
            }
        };
    }
    Ok(())
}

/// One entry for each method, drawn as in the panels.
fn draw_legend(area: &Area<'_>) -> Outcome {
    const ENTRY: i32 = 230;
    const LINE: i32 = 50;
    let left = (SIZE.0 as i32 - ENTRY * Method::ALL.len() as i32) / 2;
    for (number, method) in Method::ALL.into_iter().enumerate() {
        let x = left + ENTRY * number as i32;
        let entry = area.clone().shrink((x, 8), (ENTRY, 24));
        let mut chart = ChartBuilder::on(&entry)
            .margin_right(ENTRY - LINE)
            .build_cartesian_2d(0.0..2.0, 0.0..2.0)?;
        draw_method(
            &mut chart,
            method,
            &[(0.0, 1.0), (1.0, 1.0), (2.0, 1.0)][..],
        )?;
        let text = ("sans-serif", 16).into_text_style(area);
        entry.draw(&Text::new(method.name(), (LINE + 12, 4), text))?;
    }
    Ok(())
}
