//! A panel: frame, ticks, series, named places.

use plotters::coord::types::RangedCoordf64;
use plotters::prelude::{
    Cartesian2d, ChartBuilder, ChartContext, Circle, EmptyElement, PathElement, Polygon, Rectangle,
    SVGBackend, Text,
};
use plotters::style::{BLACK, Color as _, FontTransform, RGBColor};

use super::coordinates::{Coordinates, tick_text};
use super::{Area, BELOW, LINE, MARGIN, Outcome, centred, left};
use crate::figure::tone::Tone;
use crate::figure::{Axis, Mark, Panel, Scale, Series};

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

pub(super) fn draw(area: &Area<'_>, panel: &Panel, coordinates: &Coordinates) -> Outcome {
    let (width, height) = area.dim_in_pixel();
    let title_height = if panel.title.is_empty() { 0 } else { 20 };
    let pixels = (
        f64::from(width.saturating_sub(left(panel) + 2 * MARGIN).max(1)),
        f64::from(
            height
                .saturating_sub(BELOW + 2 * MARGIN + title_height)
                .max(1),
        ),
    );
    let equalised;
    let coordinates = if panel.equal_axes {
        equalised = coordinates.equalised(pixels);
        &equalised
    } else {
        coordinates
    };
    let mut builder = ChartBuilder::on(area);
    builder
        .margin(MARGIN)
        .x_label_area_size(BELOW)
        .y_label_area_size(left(panel));
    if !panel.title.is_empty() {
        builder.caption(&panel.title, ("sans-serif", 15.0));
    }
    let mut chart = builder.build_cartesian_2d(coordinates.x.clone(), coordinates.y.clone())?;
    draw_mesh(&mut chart, panel, coordinates, pixels)?;
    name_ordinate(
        area,
        panel,
        f64::from(MARGIN + title_height) + 0.5 * pixels.1,
    )?;
    for series in &panel.series {
        draw_series(&mut chart, series, coordinates, pixels)?;
    }
    for label in &panel.labels {
        let Some(place) = coordinates.point(label.x, label.y) else {
            continue;
        };
        let text = Text::new(label.text.clone(), (5, -16), ("sans-serif", 12.0));
        chart.draw_series([EmptyElement::at(place) + text])?;
    }
    Ok(())
}

fn draw_mesh(
    chart: &mut Chart<'_, '_>,
    panel: &Panel,
    coordinates: &Coordinates,
    pixels: (f64, f64),
) -> Outcome {
    let (width, height) = coordinates.spans();
    let x_text = |value: &f64| tick_text(&panel.x, width, *value);
    let y_text = |value: &f64| tick_text(&panel.y, height, *value);
    chart
        .configure_mesh()
        .max_light_lines(0)
        .bold_line_style(BLACK.mix(0.10))
        .x_labels(labels(&panel.x, width, pixels.0, 90.0))
        .y_labels(labels(&panel.y, height, pixels.1, 40.0))
        .x_label_formatter(&x_text)
        .y_label_formatter(&y_text)
        .x_desc(&panel.x.label)
        .label_style(("sans-serif", 13.0))
        .axis_desc_style(("sans-serif", 14.0))
        .draw()?;
    Ok(())
}

/// The name of the vertical axis, in one line or two, about a height in pixels.
fn name_ordinate(area: &Area<'_>, panel: &Panel, middle: f64) -> Outcome {
    let style = centred(("sans-serif", 14)).transform(FontTransform::Rotate270);
    for (index, line) in panel.y.lines().into_iter().enumerate() {
        let x = MARGIN + LINE / 2 + LINE * index as u32;
        area.draw_text(line, &style, (x as i32, middle as i32))?;
    }
    Ok(())
}

/// How many ticks an axis has at most.
fn labels(axis: &Axis, span: f64, pixels: f64, apart: f64) -> usize {
    let fitting = (pixels / apart).max(2.0) as usize;
    if !axis.names.is_empty() {
        return 2 * axis.names.len() + 1;
    }
    match axis.scale {
        Scale::Linear => fitting,
        Scale::Log => {
            let decades = span.round() as usize;
            let every = decades.div_ceil(fitting).max(1);
            decades / every + 1
        }
    }
}

fn draw_series(
    chart: &mut Chart<'_, '_>,
    series: &Series,
    coordinates: &Coordinates,
    pixels: (f64, f64),
) -> Outcome {
    let tone = Tone::of(series.tone);
    let [red, green, blue] = tone.rgb;
    let colour = RGBColor(red, green, blue);
    let (width, height) = coordinates.spans();
    let scale = (pixels.0 / width, pixels.1 / height);
    if matches!(series.mark, Mark::Line | Mark::LineAndPoints) {
        for run in runs(series, coordinates) {
            // Dashes are as long as pixels say, not as data do.
            let on_paper: Vec<(f64, f64)> =
                run.iter().map(|p| (p.0 * scale.0, p.1 * scale.1)).collect();
            for part in dashed(&on_paper, tone.dashes) {
                let points: Vec<(f64, f64)> = part
                    .iter()
                    .map(|p| (p.0 / scale.0, p.1 / scale.1))
                    .collect();
                chart.draw_series([PathElement::new(points, colour.stroke_width(2))])?;
            }
        }
    }
    if matches!(series.mark, Mark::Points | Mark::LineAndPoints) {
        let points = runs(series, coordinates).into_iter().flatten();
        chart.draw_series(points.map(|point| Circle::new(point, 3, colour.filled())))?;
    }
    match &series.mark {
        Mark::Bars { width } => {
            let bars = series.x.iter().zip(&series.y).filter_map(|(x, y)| {
                let (left, top) = coordinates.point(x - 0.5 * width, *y)?;
                let (right, _) = coordinates.point(x + 0.5 * width, *y)?;
                let corners = [(left, coordinates.floor()), (right, top)];
                Some(Rectangle::new(corners, colour.mix(0.75).filled()))
            });
            chart.draw_series(bars)?;
        }
        Mark::LyingBars { from, width } => {
            let rows = series.x.iter().zip(&series.y).zip(from);
            let bars = rows.filter_map(|((x, y), from)| {
                let low = coordinates.point(*from, y - 0.5 * width)?;
                let high = coordinates.point(*x, y + 0.5 * width)?;
                Some(Rectangle::new([low, high], colour.mix(0.75).filled()))
            });
            chart.draw_series(bars)?;
        }
        Mark::Band { to } => {
            let there = series.x.iter().zip(&series.y);
            let back = series.x.iter().zip(to).rev();
            let outline: Vec<(f64, f64)> = there
                .chain(back)
                .filter_map(|(x, y)| coordinates.point(*x, *y))
                .collect();
            chart.draw_series([Polygon::new(outline, colour.mix(0.22).filled())])?;
        }
        Mark::Line | Mark::Points | Mark::LineAndPoints => {}
    }
    Ok(())
}

/// The points between gaps.
fn runs(series: &Series, coordinates: &Coordinates) -> Vec<Vec<(f64, f64)>> {
    let mut runs = vec![Vec::new()];
    for (x, y) in series.x.iter().zip(&series.y) {
        match coordinates.point(*x, *y) {
            Some(point) => {
                if let Some(run) = runs.last_mut() {
                    run.push(point);
                }
            }
            None => runs.push(Vec::new()),
        }
    }
    runs.retain(|run| !run.is_empty());
    runs
}

/// The drawn parts of a line, in pixels; all of it without dashes.
pub(super) fn dashed(line: &[(f64, f64)], dashes: &[u32]) -> Vec<Vec<(f64, f64)>> {
    let Some(first) = line.first() else {
        return Vec::new();
    };
    if dashes.is_empty() {
        return vec![line.to_vec()];
    }
    let mut parts = Vec::new();
    let mut part = vec![*first];
    let mut place = 0;
    let mut left = f64::from(dashes[0]);
    for pair in line.windows(2) {
        let (mut from, to) = (pair[0], pair[1]);
        loop {
            let length = libm::hypot(to.0 - from.0, to.1 - from.1);
            let is_drawn = place % 2 == 0;
            if length < left {
                left -= length;
                if is_drawn {
                    part.push(to);
                }
                break;
            }
            let along = left / length;
            from = (
                from.0 + along * (to.0 - from.0),
                from.1 + along * (to.1 - from.1),
            );
            part.push(from);
            if is_drawn {
                parts.push(std::mem::take(&mut part));
            }
            part = vec![from];
            place = (place + 1) % dashes.len();
            left = f64::from(dashes[place]);
        }
    }
    if place % 2 == 0 && part.len() > 1 {
        parts.push(part);
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_go_round_corners() {
        let line = [(0.0, 0.0), (6.0, 0.0), (6.0, 6.0)];
        let parts = dashed(&line, &[8, 2]);
        assert_eq!(parts[0], vec![(0.0, 0.0), (6.0, 0.0), (6.0, 2.0)]);
        assert_eq!(parts[1], vec![(6.0, 4.0), (6.0, 6.0)]);
        assert_eq!(parts.len(), 2);
    }
}
