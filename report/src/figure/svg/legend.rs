//! The legend, beside the panels.

use plotters::prelude::{PathElement, Rectangle};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{BLACK, Color as _, IntoTextStyle as _, RGBColor};

use super::drawing::dashed;
use super::{Area, Outcome};
use crate::figure::tone::Tone;
use crate::figure::{Figure, Mark};

const ROW: u32 = 20;
const KEY: i32 = 34;
/// Width of a letter, pixels: what is drawn is measured by the viewer, not here.
const LETTER: u32 = 7;

/// A name with how it is drawn.
pub(super) struct Entry {
    name: String,
    tone: Tone,
    mark: Mark,
}

/// The names of a figure, each once.
pub(super) fn entries(figure: &Figure) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    for series in figure.panels.iter().flat_map(|panel| &panel.series) {
        if series.name.is_empty() || entries.iter().any(|entry| entry.name == series.name) {
            continue;
        }
        entries.push(Entry {
            name: series.name.clone(),
            tone: Tone::of(series.tone),
            mark: series.mark.clone(),
        });
    }
    entries
}

pub(super) fn width(entries: &[Entry]) -> u32 {
    let longest = entries
        .iter()
        .map(|entry| entry.name.chars().count() as u32);
    longest
        .max()
        .map_or(0, |letters| letters * LETTER + KEY as u32 + 20)
}

pub(super) fn height(entries: &[Entry]) -> u32 {
    ROW * entries.len() as u32 + 20
}

pub(super) fn draw(area: &Area<'_>, entries: &[Entry]) -> Outcome {
    let style = ("sans-serif", 13.0).into_text_style(&(1, 1)).color(&BLACK);
    let style = style.pos(Pos::new(HPos::Left, VPos::Center));
    for (index, entry) in entries.iter().enumerate() {
        let y = 14 + (ROW * index as u32) as i32;
        let [red, green, blue] = entry.tone.rgb;
        let colour = RGBColor(red, green, blue);
        let middle = (KEY / 2, y);
        match &entry.mark {
            Mark::Line => key_line(area, entry.tone, y)?,
            Mark::LineAndPoints => {
                key_line(area, entry.tone, y)?;
                area.draw(&plotters::prelude::Circle::new(middle, 3, colour.filled()))?;
            }
            Mark::Points => {
                area.draw(&plotters::prelude::Circle::new(middle, 3, colour.filled()))?;
            }
            Mark::Bars { .. } | Mark::LyingBars { .. } => {
                let corners = [(4, y - 5), (KEY - 4, y + 5)];
                area.draw(&Rectangle::new(corners, colour.mix(0.75).filled()))?;
            }
            Mark::Band { .. } => {
                let corners = [(4, y - 6), (KEY - 4, y + 6)];
                area.draw(&Rectangle::new(corners, colour.mix(0.22).filled()))?;
            }
        }
        area.draw_text(&entry.name, &style, (KEY + 4, y))?;
    }
    Ok(())
}

fn key_line(area: &Area<'_>, tone: Tone, y: i32) -> Outcome {
    let [red, green, blue] = tone.rgb;
    let style = RGBColor(red, green, blue).stroke_width(2);
    let ends = [(0.0, f64::from(y)), (f64::from(KEY - 4), f64::from(y))];
    for part in dashed(&ends, tone.dashes) {
        let points: Vec<(i32, i32)> = part.iter().map(|(x, y)| (*x as i32, *y as i32)).collect();
        area.draw(&PathElement::new(points, style))?;
    }
    Ok(())
}
