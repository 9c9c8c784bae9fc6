//! Joint coordinates of a link without singularities, in a chart over one step.
//!
//! At the start of a step a rigid link points along e_0. Its coordinate is what its span d = L e has across
//! e_0, a length in that plane, and its speed that coordinate's rate:
//!
//! ```text
//! q = d - (d.e_0) e_0     d = q + sqrt(L^2 - q^2) e_0     d' = q' - (q.q' / sqrt(L^2 - q^2)) e_0
//! q'' = d'' - (d''.e_0) e_0
//! ```
//!
//! Two numbers move; they are kept as a vector of the inertial frame, so that no basis has to be chosen. The
//! chart holds for turns of less than a right angle within one step, and every accepted step starts a new
//! one: d keeps its length by construction. The coordinate of an elastic link is d - d_0 itself.

use glam::DVec3;

use super::articulated_link::Stretch;

/// Square of the part of its length by which a link may stand across e_0 (a turn of 84 degrees): beyond, it
/// is too close to the edge of its chart.
const EDGE: f64 = 0.99;

/// The chart of one link.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinkChart {
    /// d_0, m.
    pub centre_m: DVec3,
}

impl LinkChart {
    /// Span d (m) and its rate (m/s) from the coordinate `q` (m) and its rate `q_rate` (m/s), for a link of
    /// this length at rest (m); `None` beyond the chart.
    #[inline]
    #[must_use]
    pub fn span(
        &self,
        q: DVec3,
        q_rate: DVec3,
        length_m: f64,
        stretch: Stretch,
    ) -> Option<(DVec3, DVec3)> {
        if stretch == Stretch::Elastic {
            return Some((self.centre_m + q, q_rate));
        }
        let across = q.length_squared();
        if across > EDGE * length_m * length_m {
            return None;
        }
        let direction = self.centre_m / length_m;
        let along_m = (length_m * length_m - across).sqrt();
        let falls_m_s = q.dot(q_rate) / along_m;
        Some((q + along_m * direction, q_rate - falls_m_s * direction))
    }

    /// Acceleration of the coordinate for that of the span, m/s^2.
    #[inline]
    #[must_use]
    pub fn acceleration(&self, span_m_s2: DVec3, length_m: f64, stretch: Stretch) -> DVec3 {
        match stretch {
            Stretch::Elastic => span_m_s2,
            Stretch::Rigid => across(span_m_s2, self.centre_m / length_m),
        }
    }

    /// A chart whose centre is the span `d` (m), made to have its length if it is rigid; with the rate of
    /// its coordinate there for that of the span (m/s).
    #[inline]
    #[must_use]
    pub fn around(
        span_m: DVec3,
        rate_m_s: DVec3,
        length_m: f64,
        stretch: Stretch,
    ) -> (Self, DVec3) {
        match stretch {
            Stretch::Elastic => (Self { centre_m: span_m }, rate_m_s),
            Stretch::Rigid => {
                let direction = span_m.normalize_or(DVec3::NEG_Z);
                let centre_m = length_m * direction;
                (Self { centre_m }, across(rate_m_s, direction))
            }
        }
    }
}

#[inline]
fn across(v: DVec3, direction: DVec3) -> DVec3 {
    v - v.dot(direction) * direction
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lengths and rates against differences along a path, far out in the chart.
    #[test]
    fn a_link_keeps_its_length_and_moves_at_its_rate() {
        let length = 3.0;
        let (chart, _) = LinkChart::around(
            DVec3::new(1.0, -2.0, 2.0),
            DVec3::ZERO,
            length,
            Stretch::Rigid,
        );
        let e = chart.centre_m / length;
        let q = 2.2 * e.cross(DVec3::X).normalize();
        let rate = e.cross(DVec3::new(0.3, 0.9, -0.4));
        let (d, d_rate) = chart
            .span(q, rate, length, Stretch::Rigid)
            .expect("inside the chart");
        assert!((d.length() - length).abs() < 1e-15 * 10.0);
        assert!(d.dot(d_rate).abs() < 1e-14);
        let h = 1e-6;
        let ahead = chart.span(q + h * rate, rate, length, Stretch::Rigid);
        let behind = chart.span(q - h * rate, rate, length, Stretch::Rigid);
        let slope = (ahead.expect("near").0 - behind.expect("near").0) / (2.0 * h);
        assert!((slope - d_rate).length() < 1e-9);
        assert!(chart.span(1.4 * q, rate, length, Stretch::Rigid).is_none());
    }

    #[test]
    fn a_new_chart_does_not_change_the_motion() {
        let length = 2.0;
        let old = LinkChart {
            centre_m: DVec3::new(0.0, 0.0, -length),
        };
        let (q, rate) = (DVec3::new(0.7, -0.4, 0.0), DVec3::new(0.2, 0.5, 0.0));
        let (d, d_rate) = old
            .span(q, rate, length, Stretch::Rigid)
            .expect("inside the chart");
        let (new, new_rate) = LinkChart::around(d, d_rate, length, Stretch::Rigid);
        let (again, again_rate) = new
            .span(DVec3::ZERO, new_rate, length, Stretch::Rigid)
            .expect("the centre");
        assert!((again - d).length() < 1e-15);
        assert!((again_rate - d_rate).length() < 1e-15);
    }
}
