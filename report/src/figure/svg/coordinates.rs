//! From data to the plane of a panel: logarithms of what has decades, and the ranges that hold everything.

use std::ops::Range;

use crate::figure::{Axis, Mark, Panel, Scale};

/// The ranges of a panel, in logarithms where the axis has decades.
pub(super) struct Coordinates {
    pub(super) x: Range<f64>,
    pub(super) y: Range<f64>,
    scales: (Scale, Scale),
}

impl Coordinates {
    pub(super) fn of(panel: &Panel) -> Self {
        let mut x = Extent::default();
        let mut y = Extent::default();
        for series in &panel.series {
            // What is a gap in one is not seen in the other.
            for (a, b) in series.x.iter().zip(&series.y) {
                if a.is_finite() && b.is_finite() {
                    x.take(&panel.x, *a);
                    y.take(&panel.y, *b);
                }
            }
            match &series.mark {
                Mark::Bars { width } => {
                    y.take(&panel.y, 0.0);
                    let ends = series
                        .x
                        .iter()
                        .flat_map(|a| [a - 0.5 * width, a + 0.5 * width]);
                    ends.for_each(|a| x.take(&panel.x, a));
                }
                Mark::LyingBars { from, .. } => from.iter().for_each(|a| x.take(&panel.x, *a)),
                Mark::Band { to } => to.iter().for_each(|b| y.take(&panel.y, *b)),
                Mark::Line | Mark::Points | Mark::LineAndPoints => {}
            }
        }
        let mut coordinates = Self {
            x: x.range(&panel.x, panel.x.is_time),
            y: y.range(&panel.y, false),
            scales: (panel.x.scale, panel.y.scale),
        };
        if panel.equal_axes {
            // A line straight down has a width all the same.
            let (width, height) = coordinates.spans();
            widen(&mut coordinates.x, 0.3 * height - width);
            widen(&mut coordinates.y, 0.3 * width - height);
        }
        coordinates
    }

    /// Width and height.
    pub(super) fn spans(&self) -> (f64, f64) {
        (self.x.end - self.x.start, self.y.end - self.y.start)
    }

    /// A point of the data; nothing where it cannot be drawn.
    pub(super) fn point(&self, x: f64, y: f64) -> Option<(f64, f64)> {
        let (x, y) = (place(self.scales.0, x), place(self.scales.1, y));
        (x.is_finite() && y.is_finite()).then_some((x, y))
    }

    /// Where bars begin.
    pub(super) fn floor(&self) -> f64 {
        match self.scales.1 {
            Scale::Linear => 0.0,
            Scale::Log => self.y.start,
        }
    }

    /// Widens one axis so that a unit is as long along both, on so many pixels.
    pub(super) fn equalised(&self, pixels: (f64, f64)) -> Self {
        let (width, height) = self.spans();
        let unit = (width / pixels.0).max(height / pixels.1);
        let (mut x, mut y) = (self.x.clone(), self.y.clone());
        widen(&mut x, unit * pixels.0 - width);
        widen(&mut y, unit * pixels.1 - height);
        Self { x, y, ..*self }
    }
}

fn widen(range: &mut Range<f64>, by: f64) {
    if by > 0.0 {
        range.start -= 0.5 * by;
        range.end += 0.5 * by;
    }
}

fn place(scale: Scale, value: f64) -> f64 {
    match scale {
        Scale::Linear => value,
        Scale::Log if value > 0.0 => libm::log10(value),
        Scale::Log => f64::NAN,
    }
}

#[derive(Default)]
struct Extent(Option<(f64, f64)>);

impl Extent {
    fn take(&mut self, axis: &Axis, value: f64) {
        let value = place(axis.scale, value);
        if value.is_finite() {
            let (low, high) = self.0.unwrap_or((value, value));
            self.0 = Some((low.min(value), high.max(value)));
        }
    }

    /// With room at both ends, unless the axis says its own or begins and ends with the data.
    fn range(&self, axis: &Axis, is_tight: bool) -> Range<f64> {
        if !axis.names.is_empty() {
            return -0.6..axis.names.len() as f64 - 0.4;
        }
        if let Some((low, high)) = axis.range {
            return place(axis.scale, low)..place(axis.scale, high);
        }
        let (low, high) = self.0.unwrap_or((0.0, 1.0));
        match axis.scale {
            Scale::Log if high - low >= 2.0 => {
                let room = 0.03 * (high - low);
                low - room..high + room
            }
            // Two ticks at least.
            Scale::Log => (low - 0.02).floor()..(high + 0.02).ceil(),
            Scale::Linear if high - low <= 1e-12 * low.abs().max(high.abs()) => {
                let room = if low == 0.0 { 1.0 } else { 1e-3 * low.abs() };
                low - room..high + room
            }
            Scale::Linear if is_tight => low..high,
            Scale::Linear => {
                let room = 0.05 * (high - low);
                low - room..high + room
            }
        }
    }
}

/// The text at a tick of an axis; empty where there is to be none.
pub(super) fn tick_text(axis: &Axis, span: f64, value: f64) -> String {
    let whole = value.round();
    let is_whole = (value - whole).abs() < 1e-6;
    if !axis.names.is_empty() {
        let name = (is_whole && whole >= 0.0).then(|| axis.names.get(whole as usize));
        return name.flatten().cloned().unwrap_or_default();
    }
    match axis.scale {
        Scale::Log if !is_whole => String::new(),
        Scale::Log if (-3.0..=4.0).contains(&whole) => format!("{}", libm::pow(10.0, whole)),
        Scale::Log => format!("1e{whole:.0}"),
        Scale::Linear => linear_text(span, value),
    }
}

fn linear_text(span: f64, value: f64) -> String {
    let largest = value.abs().max(span);
    if value.abs() < 1e-9 * span {
        return "0".to_owned();
    }
    if largest >= 1e6 || span < 1e-4 {
        return format!("{value:.3e}").replace(".000e", "e");
    }
    // Ticks are at least a thirtieth of the span apart.
    let decimals = (2.0 - libm::log10(span).floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_as_long_as_they_need_to_be() {
        assert_eq!(linear_text(100.0, 20.0), "20");
        assert_eq!(linear_text(1.0, 0.25), "0.25");
        assert_eq!(linear_text(0.01, 56_000.005), "56000.005");
        assert_eq!(linear_text(1e7, 2e6), "2e6");
        let log = Axis::log("");
        assert_eq!(tick_text(&log, 3.0, 2.0), "100");
        assert_eq!(tick_text(&log, 3.0, -6.0), "1e-6");
        assert_eq!(tick_text(&log, 3.0, 0.5), "");
    }
}
