//! Joint coordinates of a link without singularities, in a chart over one step.
//!
//! At the start of a step a rigid link points along e_0. Its coordinate is what its span d = L e has across
//! e_0, a length in that plane, and its speed that coordinate's rate:
//!
//! ```text
//! q = d - (d.e_0) e_0     d = q + sqrt(L^2 - q^2) e_0     d' = q' + ((L L' - q.q') / sqrt(L^2 - q^2)) e_0
//! q'' = d'' - (d''.e_0) e_0
//! ```
//!
//! L' is zero but for a link that a winch pays out or reels in.
//! Two numbers move; they are kept as a vector of the inertial frame, so that no basis has to be chosen. The
//! chart holds for turns of less than a right angle within one step, and every accepted step starts a new
//! one: d keeps its length by construction. The coordinate of an elastic link is d - d_0 itself.

use glam::DVec3;

use super::articulated_link::Stretch;
use super::tree::LinkKind;

/// Square of the part of its length by which a link may stand across e_0 (a turn of 84 degrees): beyond, it
/// is too close to the edge of its chart.
const EDGE: f64 = 0.99;

/// The chart of one link.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinkChart {
    /// d_0, m.
    pub centre_m: DVec3,
    /// e_0 of a rigid link.
    direction: DVec3,
}

impl LinkChart {
    /// Span d (m) and its rate (m/s) from the coordinate `q` (m) and its rate `q_rate` (m/s), for a link of
    /// this kind; `None` beyond the chart.
    #[inline]
    #[must_use]
    pub fn span(&self, q: DVec3, q_rate: DVec3, kind: &LinkKind) -> Option<(DVec3, DVec3)> {
        if kind.stretch == Stretch::Elastic {
            return Some((self.centre_m + q, q_rate));
        }
        let length_m = kind.length_m;
        let across = q.length_squared();
        if across > EDGE * length_m * length_m {
            return None;
        }
        let along_m = (length_m * length_m - across).sqrt();
        let rises_m_s = (length_m * kind.length_rate_m_s - q.dot(q_rate)) / along_m;
        Some((
            q + along_m * self.direction,
            q_rate + rises_m_s * self.direction,
        ))
    }

    /// Acceleration of the coordinate for that of the span, m/s^2.
    #[inline]
    #[must_use]
    pub fn acceleration(&self, span_m_s2: DVec3, kind: &LinkKind) -> DVec3 {
        match kind.stretch {
            Stretch::Elastic => span_m_s2,
            Stretch::Rigid => across(span_m_s2, self.direction),
        }
    }

    /// Rate of the coordinate at the centre for that of the span there, m/s.
    #[inline]
    #[must_use]
    pub fn rate(&self, span_m_s: DVec3, kind: &LinkKind) -> DVec3 {
        if kind.length_rate_m_s == 0.0 || kind.stretch == Stretch::Elastic {
            return span_m_s;
        }
        across(span_m_s, self.direction)
    }

    /// A chart whose centre is the span `d` (m), made to have its length if it is rigid; with its rate (m/s),
    /// made to have that of the length.
    #[inline]
    #[must_use]
    pub fn around(span_m: DVec3, rate_m_s: DVec3, kind: &LinkKind) -> (Self, DVec3) {
        match kind.stretch {
            Stretch::Elastic => {
                let chart = Self {
                    centre_m: span_m,
                    direction: DVec3::ZERO,
                };
                (chart, rate_m_s)
            }
            Stretch::Rigid => {
                let direction = span_m.normalize_or(DVec3::NEG_Z);
                let centre_m = kind.length_m * direction;
                let rate_m_s = across(rate_m_s, direction) + kind.length_rate_m_s * direction;
                let chart = Self {
                    centre_m,
                    direction,
                };
                (chart, rate_m_s)
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

    fn kind(length_m: f64, length_rate_m_s: f64) -> LinkKind {
        LinkKind {
            length_m,
            length_rate_m_s,
            coupling_kg: 0.0,
            joint_mass_kg: 0.0,
            stretch: Stretch::Rigid,
        }
    }

    /// Lengths and rates against differences along a path, far out in the chart; of a link that is reeled too.
    #[test]
    fn a_link_has_its_length_and_moves_at_its_rate() {
        for length_rate in [0.0, 0.7, -0.4] {
            let at = |t: f64| kind(3.0 + length_rate * t, length_rate);
            let start = DVec3::new(1.0, -2.0, 2.0);
            let (chart, _) = LinkChart::around(start, DVec3::ZERO, &at(0.0));
            let e = chart.centre_m / 3.0;
            let q = 2.2 * e.cross(DVec3::X).normalize();
            let rate = e.cross(DVec3::new(0.3, 0.9, -0.4));
            let (d, d_rate) = chart.span(q, rate, &at(0.0)).expect("inside the chart");
            assert!((d.length() - 3.0).abs() < 1e-14);
            assert!((d.dot(d_rate) - 3.0 * length_rate).abs() < 1e-14);
            let h = 1e-6;
            let ahead = chart.span(q + h * rate, rate, &at(h));
            let behind = chart.span(q - h * rate, rate, &at(-h));
            let slope = (ahead.expect("near").0 - behind.expect("near").0) / (2.0 * h);
            assert!((slope - d_rate).length() < 1e-9);
            assert!(chart.span(1.4 * q, rate, &at(0.0)).is_none());
        }
    }

    #[test]
    fn a_new_chart_does_not_change_the_motion() {
        for length_rate in [0.0, 0.7] {
            let kind = kind(2.0, length_rate);
            let (old, _) = LinkChart::around(DVec3::new(0.0, 0.0, -2.0), DVec3::ZERO, &kind);
            let (q, rate) = (DVec3::new(0.7, -0.4, 0.0), DVec3::new(0.2, 0.5, 0.0));
            let (d, d_rate) = old.span(q, rate, &kind).expect("inside the chart");
            let (new, new_rate) = LinkChart::around(d, d_rate, &kind);
            let q_rate = new.rate(new_rate, &kind);
            let (again, again_rate) = new.span(DVec3::ZERO, q_rate, &kind).expect("the centre");
            assert!((again - d).length() < 1e-15);
            assert!((again_rate - d_rate).length() < 1e-15);
        }
    }
}
