//! A figure as data: panels of series over axes with units. It is drawn in two ways, as SVG for papers and
//! as a part of a page.

pub mod interactive;
pub mod svg;
pub mod thinning;
pub mod tone;

use serde::Serialize;

/// A figure.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figure {
    /// Its name, unique in a page: `displacement`.
    pub name: String,
    /// Its title.
    pub title: String,
    /// What to know when reading it; empty if nothing.
    pub caption: String,
    /// Its panels, one below the other.
    pub panels: Vec<Panel>,
}

/// A panel of a figure.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Panel {
    /// Its title; empty in a figure of one panel.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// Whether a unit is as long along both axes.
    pub equal_axes: bool,
    /// What is drawn, the first at the back.
    pub series: Vec<Series>,
    /// Places that are named in the picture, such as peaks.
    pub labels: Vec<Label>,
}

/// An axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// What it shows, its SI unit in brackets: `altitude [m]`.
    pub label: String,
    /// Linear unless said.
    pub scale: Scale,
    /// What it spans, if not what the series do.
    pub range: Option<(f64, f64)>,
    /// Names at 0, 1, 2, ... in place of numbers.
    pub names: Vec<String>,
    /// Whether it is the time of a run: such axes are zoomed together in a page.
    pub is_time: bool,
}

/// The scale of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Scale {
    /// Linear.
    #[default]
    Linear,
    /// Decades; what is not positive is left out.
    Log,
}

/// What is drawn of one name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Its name in the legend; series of one name have one entry. Empty: none.
    pub name: String,
    /// Abscissae.
    pub x: Vec<f64>,
    /// Ordinates; one that is not a number is a gap.
    pub y: Vec<f64>,
    /// How it is drawn.
    pub mark: Mark,
    /// Its place in the order of tones and dashes.
    pub tone: usize,
}

/// How a series is drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Mark {
    /// A line from point to point.
    #[default]
    Line,
    /// Points.
    Points,
    /// A line with its points.
    LineAndPoints,
    /// Upright bars of this width about the abscissae, from zero.
    Bars {
        /// Width, in units of the abscissa.
        width: f64,
    },
    /// Lying bars about the ordinates, from these abscissae on.
    LyingBars {
        /// Where each begins.
        from: Vec<f64>,
        /// Width, in units of the ordinate.
        width: f64,
    },
    /// The area between the ordinates and these.
    Band {
        /// The other ordinates.
        to: Vec<f64>,
    },
}

/// A place that is named in the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// Abscissa.
    pub x: f64,
    /// Ordinate.
    pub y: f64,
    /// What stands there.
    pub text: String,
}

/// Letters of a label that stand beside a panel in one line.
const LINE: usize = 30;

impl Axis {
    /// The label in lines that are no longer than a panel is high: one, or two that are about as long.
    #[must_use]
    pub fn lines(&self) -> Vec<&str> {
        let label = self.label.as_str();
        let length = label.chars().count();
        let from_middle = |(place, _): &(usize, &str)| place.abs_diff(label.len() / 2);
        match label.match_indices(' ').min_by_key(from_middle) {
            Some((place, _)) if length > LINE => vec![&label[..place], &label[place + 1..]],
            _ => vec![label],
        }
    }

    /// A linear axis of what its series span.
    #[must_use]
    pub fn new(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            ..Self::default()
        }
    }

    /// Decades.
    #[must_use]
    pub fn log(label: impl Into<String>) -> Self {
        Self {
            scale: Scale::Log,
            ..Self::new(label)
        }
    }

    /// The time of a run.
    #[must_use]
    pub fn time() -> Self {
        Self {
            is_time: true,
            ..Self::new("time [s]")
        }
    }
}

impl Series {
    /// A line.
    #[must_use]
    pub fn line(name: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let (x, y) = points.into_iter().unzip();
        Self {
            name: name.into(),
            x,
            y,
            ..Self::default()
        }
    }

    /// The same with another mark.
    #[must_use]
    pub fn with_mark(self, mark: Mark) -> Self {
        Self { mark, ..self }
    }

    /// The same with another tone.
    #[must_use]
    pub fn with_tone(self, tone: usize) -> Self {
        Self { tone, ..self }
    }
}
