//! Where bodies end: the final places of one body in all runs, with ellipses of their covariance.
//!
//! An ellipse holds what is at most k away from the mean, (p - m)' C^-1 (p - m) <= k^2. Of a normal distribution
//! in the plane that distance squared has the chi-square distribution of two degrees of freedom, so that it holds
//! 1 - exp(-k^2 / 2) of it: 39.3 % for k = 1, 86.5 % for k = 2, not 68.3 % and 95.4 % as on a line.

use std::f64::consts::PI;

use aerobot_engine::campaign::metrics::MetricSpec;

use crate::campaign::CampaignRecord;
use crate::figure::{Axis, Figure, Mark, Panel, Series};

use super::axis_label;

/// The most points that are drawn; means and ellipses are of all.
const MOST_POINTS: usize = 5000;
/// Corners of an ellipse.
const CORNERS: u32 = 120;
/// The coordinates of which two make a panel, with what they are called in tables.
const PAIRS: [(&str, &str); 3] = [("x_m", "y_m"), ("x_m", "z_m"), ("y_m", "z_m")];

/// Mean and covariance of points in a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Mean.
    pub mean: (f64, f64),
    /// Variance of the first coordinate, over n - 1.
    pub variance_x: f64,
    /// Variance of the second.
    pub variance_y: f64,
    /// Covariance of both.
    pub covariance: f64,
}

/// The part of a normal distribution in the plane within k standard deviations, 1 - exp(-k^2 / 2).
#[must_use]
pub fn share_within(k: f64) -> f64 {
    -libm::expm1(-0.5 * k * k)
}

impl Spread {
    /// Of points; nothing of fewer than three, or of points on a line.
    #[must_use]
    pub fn of(points: &[(f64, f64)]) -> Option<Self> {
        if points.len() < 3 {
            return None;
        }
        let count = points.len() as f64;
        let mean =
            |pick: fn(&(f64, f64)) -> f64| points.iter().map(|p| pick(p) / count).sum::<f64>();
        let mean = (mean(|point| point.0), mean(|point| point.1));
        let product = |pick: &dyn Fn(f64, f64) -> f64| {
            let terms = points.iter().map(|(x, y)| pick(x - mean.0, y - mean.1));
            terms.sum::<f64>() / (count - 1.0)
        };
        let spread = Self {
            mean,
            variance_x: product(&|x, _| x * x),
            variance_y: product(&|_, y| y * y),
            covariance: product(&|x, y| x * y),
        };
        let both = spread.variance_x * spread.variance_y;
        (spread.determinant() > 1e-12 * both).then_some(spread)
    }

    fn determinant(&self) -> f64 {
        self.variance_x * self.variance_y - self.covariance * self.covariance
    }

    /// How many standard deviations a point is from the mean (Mahalanobis).
    #[must_use]
    pub fn distance(&self, (x, y): (f64, f64)) -> f64 {
        let (x, y) = (x - self.mean.0, y - self.mean.1);
        let sum = self.variance_y * x * x - 2.0 * self.covariance * x * y + self.variance_x * y * y;
        libm::sqrt(sum / self.determinant())
    }

    /// The closed ellipse k standard deviations from the mean: the circle of that radius by the lower triangle L
    /// of C = L L'.
    #[must_use]
    pub fn ellipse(&self, k: f64) -> Vec<(f64, f64)> {
        let along = libm::sqrt(self.variance_x);
        let slanted = self.covariance / along;
        let across = libm::sqrt(self.determinant()) / along;
        let corners = (0..=CORNERS).map(|corner| {
            let angle = 2.0 * PI * f64::from(corner % CORNERS) / f64::from(CORNERS);
            let (u, v) = (k * libm::cos(angle), k * libm::sin(angle));
            (
                self.mean.0 + along * u,
                self.mean.1 + slanted * u + across * v,
            )
        });
        corners.collect()
    }
}

pub(in crate::campaign) fn figure(record: &CampaignRecord) -> Result<Figure, String> {
    let mut panels = Vec::new();
    let mut notes = String::new();
    for (first, second) in pairs(record) {
        if let Some((panel, note)) = panel(record, first, second) {
            panels.push(panel);
            notes.push_str(&note);
        }
    }
    if panels.is_empty() {
        return Err(
            "no two metrics are `Final` coordinates (`x_m`, `y_m`, `z_m`) of one entity that vary in three or more runs"
                .to_owned(),
        );
    }
    Ok(Figure {
        name: "ellipse".to_owned(),
        title: format!("{}: where runs end", record.summary.campaign),
        caption: format!(
            "Ellipses of the covariance, 1 and 2 standard deviations from the mean: of a normal distribution in the \
             plane they hold {:.1} and {:.1} % (chi-square of two degrees of freedom).{notes}",
            100.0 * share_within(1.0),
            100.0 * share_within(2.0)
        ),
        panels,
    })
}

/// Places of metrics that are two coordinates of one entity at the end.
fn pairs(record: &CampaignRecord) -> Vec<(usize, usize)> {
    let metrics = &record.specification.metrics.0;
    let finals = |wanted: &'static str| {
        metrics
            .iter()
            .enumerate()
            .filter_map(move |(place, (_, metric))| match metric {
                MetricSpec::Final {
                    entity, channel, ..
                } if channel == wanted => Some((place, entity)),
                _ => None,
            })
    };
    let mut found = Vec::new();
    for (x, y) in PAIRS {
        for (first, entity) in finals(x) {
            let others = finals(y).filter(|(_, other)| *other == entity);
            found.extend(others.map(|(second, _)| (first, second)));
        }
    }
    found
}

/// The panel of two metrics, and what their ellipses hold.
fn panel(record: &CampaignRecord, first: usize, second: usize) -> Option<(Panel, String)> {
    let [x, y] = [first, second].map(|place| &record.runs.metrics[place]);
    let rows = record.runs.indices.iter().zip(x).zip(y);
    let counts = record.independence();
    let points: Vec<(f64, f64)> = rows
        .filter(|((run, _), _)| counts(**run))
        .filter_map(|((_, x), y)| Some(((*x)?, (*y)?)))
        .collect();
    let spread = Spread::of(&points)?;
    let every = points.len().div_ceil(MOST_POINTS);
    let mut series = vec![
        Series::line("runs", points.iter().step_by(every).copied()).with_mark(Mark::Points),
        Series::line("mean", [spread.mean])
            .with_mark(Mark::Points)
            .with_tone(1),
    ];
    for (k, tone) in [(1.0, 1), (2.0, 2)] {
        let name = format!("{k} sigma, {:.1} %", 100.0 * share_within(k));
        series.push(Series::line(name, spread.ellipse(k)).with_tone(tone));
    }
    let held = |k: f64| {
        let inside = points.iter().filter(|point| spread.distance(**point) <= k);
        100.0 * inside.count() as f64 / points.len() as f64
    };
    let names = [first, second].map(|place| {
        let (name, metric) = &record.specification.metrics.0[place];
        axis_label(name, &metric.unit())
    });
    let [x, y] = names;
    let note = format!(
        " {x} and {y}: {:.1} and {:.1} % of {} runs.",
        held(1.0),
        held(2.0),
        points.len()
    );
    let panel = Panel {
        x: Axis::new(x),
        y: Axis::new(y),
        equal_axes: true,
        series,
        ..Panel::default()
    };
    Some((panel, note))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The eight corners (+-a, 0), (0, +-b) and (+-c, +-d), turned by 30 degrees: variances along the turned axes
    /// (2 a^2 + 4 c^2) / 7 and (2 b^2 + 4 d^2) / 7, and none between them.
    #[test]
    fn the_ellipse_of_a_known_covariance() {
        let (sin, cos) = (0.5, libm::sqrt(0.75));
        let turned = |(u, v): (f64, f64)| (100.0 + cos * u - sin * v, -7.0 + sin * u + cos * v);
        let (a, b, c, d) = (6.0, 1.0, 4.0, 2.0);
        let corners = [
            (a, 0.0),
            (-a, 0.0),
            (0.0, b),
            (0.0, -b),
            (c, d),
            (-c, d),
            (c, -d),
            (-c, -d),
        ];
        let points: Vec<(f64, f64)> = corners.into_iter().map(turned).collect();
        let (long, wide) = (
            (2.0 * a * a + 4.0 * c * c) / 7.0,
            (2.0 * b * b + 4.0 * d * d) / 7.0,
        );
        let spread = Spread::of(&points);
        assert!(spread.is_some());
        let Some(spread) = spread else { return };
        assert!((spread.mean.0 - 100.0).abs() < 1e-12 && (spread.mean.1 + 7.0).abs() < 1e-12);
        assert!((spread.variance_x - (0.75 * long + 0.25 * wide)).abs() < 1e-12);
        assert!((spread.covariance - sin * cos * (long - wide)).abs() < 1e-12);
        for k in [1.0, 2.0] {
            // Back along the axes: (u / (k sqrt(long)))^2 + (v / (k sqrt(wide)))^2 = 1.
            for (x, y) in spread.ellipse(k) {
                let (x, y) = (x - 100.0, y + 7.0);
                let (u, v) = (cos * x + sin * y, cos * y - sin * x);
                assert!((u * u / long + v * v / wide - k * k).abs() < 1e-12);
            }
            let tip = turned((k * libm::sqrt(long), 0.0));
            assert!((spread.distance(tip) - k).abs() < 1e-12);
        }
    }

    /// Quantiles of chi-square with two degrees of freedom from a table: 5.991 at 95 %, 9.210 at 99 %.
    #[test]
    fn shares_are_those_of_chi_square() {
        assert!((share_within(libm::sqrt(5.991_464_547)) - 0.95).abs() < 1e-10);
        assert!((share_within(libm::sqrt(9.210_340_372)) - 0.99).abs() < 1e-10);
    }

    #[test]
    fn points_on_a_line_have_no_ellipse() {
        let points: Vec<(f64, f64)> = (0..9).map(|k| (f64::from(k), 2.0 * f64::from(k))).collect();
        assert_eq!(Spread::of(&points), None);
        assert_eq!(Spread::of(&points[..2]), None);
    }
}
