//! A figure as SVG, for papers: vector lines, dashes that are told apart in grey, the legend beside the data.

mod coordinates;
mod drawing;
mod legend;

use std::error::Error;

use plotters::coord::Shift;
use plotters::prelude::{DrawingArea, IntoDrawingArea, SVGBackend, TextStyle, WHITE};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{BLACK, IntoTextStyle as _};

use super::{Figure, Panel};
use coordinates::Coordinates;

/// Width of the panels, pixels; the legend is added to it.
const WIDTH: u32 = 760;
/// Height of a panel, pixels.
const HEIGHT: u32 = 250;
/// Height for a title.
const TITLE: u32 = 34;
/// Height for each name of an axis of names.
const NAME: u32 = 24;
/// Room for the numbers of the axes, pixels; for names as many more as the longest has letters.
const LEFT: u32 = 84;
const LETTER: u32 = 7;
/// From line to line of the name of an axis, pixels.
const LINE: u32 = 17;
const BELOW: u32 = 52;
const MARGIN: u32 = 14;
/// Height of panels whose axes are equally long, pixels, between which it follows the data.
const SQUARE: (f64, f64) = (280.0, 900.0);

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Outcome = Result<(), Box<dyn Error>>;

impl Figure {
    /// The figure as the text of an SVG file.
    ///
    /// # Errors
    /// What the drawing library could not draw, as a sentence.
    pub fn svg(&self) -> Result<String, String> {
        let mut text = String::new();
        self.draw(&mut text)
            .map_err(|error| format!("the figure `{}` cannot be drawn: {error}", self.name))?;
        Ok(text)
    }

    fn draw(&self, text: &mut String) -> Outcome {
        let panels: Vec<(&Panel, Coordinates)> = self
            .panels
            .iter()
            .map(|panel| (panel, Coordinates::of(panel)))
            .collect();
        let heights: Vec<u32> = panels
            .iter()
            .map(|(panel, place)| height(panel, place))
            .collect();
        let entries = legend::entries(self);
        let beside = legend::width(&entries);
        let total = TITLE + heights.iter().sum::<u32>() + MARGIN;
        let size = (WIDTH + beside, total.max(legend::height(&entries) + TITLE));
        let root = SVGBackend::with_string(text, size).into_drawing_area();
        root.fill(&WHITE)?;
        let style = centred(("sans-serif", 19));
        root.draw_text(
            &self.title,
            &style,
            (WIDTH as i32 / 2, TITLE as i32 / 2 + 2),
        )?;
        let (_, below) = root.split_vertically(TITLE);
        let (mut rest, side) = below.split_horizontally(WIDTH);
        for ((panel, coordinates), height) in panels.iter().zip(&heights) {
            let (area, more) = rest.split_vertically(*height);
            drawing::draw(&area, panel, coordinates)?;
            rest = more;
        }
        legend::draw(&side, &entries)?;
        root.present()?;
        Ok(())
    }
}

fn centred(font: (&str, u32)) -> TextStyle<'_> {
    let font = (font.0, f64::from(font.1));
    let style = font.into_text_style(&(1, 1)).color(&BLACK);
    style.pos(Pos::new(HPos::Center, VPos::Center))
}

/// Room on the left of a panel, pixels.
fn left(panel: &Panel) -> u32 {
    let letters = panel.y.names.iter().map(|name| name.chars().count() as u32);
    let names = letters.max().map_or(0, |letters| letters * LETTER + 24);
    let lines = panel.y.lines().len() as u32;
    LEFT.max(names.min(WIDTH / 2)) + (lines - 1) * LINE
}

fn height(panel: &Panel, coordinates: &Coordinates) -> u32 {
    if panel.equal_axes {
        let inner = f64::from(WIDTH - left(panel) - 2 * MARGIN);
        let (width, height) = coordinates.spans();
        let wanted = inner * height / width;
        return wanted.clamp(SQUARE.0, SQUARE.1) as u32 + BELOW + 2 * MARGIN;
    }
    let names = panel.y.names.len() as u32;
    HEIGHT.max(names * NAME + BELOW + 2 * MARGIN)
}

#[cfg(test)]
mod tests {
    use crate::figure::{Axis, Figure, Label, Mark, Panel, Series};

    fn figure(x: Axis, y: Axis, mark: Mark) -> Figure {
        Figure {
            name: "f".into(),
            title: "A <title> & more".into(),
            panels: vec![Panel {
                title: "panel".into(),
                x,
                y,
                series: vec![
                    Series::line("first", [(1.0, 10.0), (2.0, f64::NAN), (3.0, 1000.0)])
                        .with_mark(mark),
                ],
                labels: vec![Label {
                    x: 1.0,
                    y: 10.0,
                    text: "peak".into(),
                }],
                ..Panel::default()
            }],
            ..Figure::default()
        }
    }

    #[test]
    fn every_mark_and_scale_is_drawn() {
        let marks = [
            Mark::Line,
            Mark::Points,
            Mark::LineAndPoints,
            Mark::Bars { width: 0.5 },
            Mark::LyingBars {
                from: vec![0.0; 3],
                width: 0.5,
            },
            Mark::Band { to: vec![5.0; 3] },
        ];
        for mark in marks {
            for (x, y) in [
                (Axis::new("a [m]"), Axis::new("b [N]")),
                (Axis::log("a [m]"), Axis::log("b [N]")),
            ] {
                let svg = figure(x, y, mark.clone()).svg().unwrap();
                assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
                for part in [
                    "a [m]",
                    "b [N]",
                    "first",
                    "peak",
                    "&lt;title&gt; &amp; more",
                ] {
                    assert!(svg.contains(part), "{part} in {mark:?}");
                }
                assert!(!svg.contains("NaN") && !svg.contains("inf"));
            }
        }
    }

    #[test]
    fn nothing_to_draw_is_an_empty_frame() {
        let empty = Figure {
            panels: vec![Panel::default()],
            ..Figure::default()
        };
        assert!(empty.svg().unwrap().ends_with("</svg>\n"));
    }
}
