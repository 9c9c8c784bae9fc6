//! One link of the recursion: from what it carries to what it passes on.
//!
//! The link joins the points P and Q = P + L e and adds E (a_Q - a_P) at Q and its opposite at P, E
//! symmetric (-m/6 I for a rod, whose halves count at the points). What is carried at Q, the point's own
//! mass and E included, is B a_Q + b. The link is rigid: a_Q - a_P = c e + (across e), so that
//!
//! ```text
//! -E a_P + B a_Q + b = -T e                   T tension of the link
//! g = B^-1 e     s = 1/(e.g)     h = e - E g     y = B^-1 b
//! T = -s (h.a_P + c + g.b)                    a_Q = B^-1 E a_P - y - T g
//! A_P = (E - E B^-1 E) + s h h'               b_P = -T_0 h + E y,   T_0 = T at a_P = 0
//! ```
//!
//! D of the recursion is B across e; this form of its Schur complement, by the matrix inversion lemma,
//! says what happens: along e a link passes on the inertia s of all that it carries, across it hardly more
//! than its own. A heavy tip on light links makes s many times what stands beside it, so the two parts are
//! never added: with B = R + s h h' of the link beyond, r = 1 + s h.R^-1 h and |R| the determinant,
//!
//! ```text
//! B^-1 = (R^-1 - s [h] R [h] / |R|) / r       e.B^-1 e = (e.R^-1 e + s (e x h).R (e x h) / |R|) / r
//! ```
//!
//! has sums of positive terms where the usual rank-one update takes differences. An elastic link is free
//! along e too: s = 0, and its tension is a force in b.

use glam::{DMat3, DVec3};

use crate::linearised_motion::symmetric3::Symmetric3;

/// What a joint carries: `light + heavy h h'`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Carried {
    /// What is carried in all directions.
    pub light: Symmetric3,
    /// s of a rigid link beyond, or zero.
    pub heavy: f64,
    /// h of it.
    pub along: DVec3,
}

impl Carried {
    /// With `own` carried besides.
    #[inline(always)]
    #[must_use]
    pub fn plus(self, own: Symmetric3) -> Self {
        Self {
            light: self.light.plus(own),
            ..self
        }
    }

    /// All in one matrix.
    #[must_use]
    pub fn total(&self) -> Symmetric3 {
        self.light
            .plus(Symmetric3::along(self.along, self.heavy, 0.0))
    }
}

impl From<Symmetric3> for Carried {
    fn from(light: Symmetric3) -> Self {
        Self {
            light,
            ..Self::default()
        }
    }
}

/// What a link adds between its ends: E.
pub trait Coupling: Copy {
    /// `E v`.
    fn times(&self, v: DVec3) -> DVec3;
    /// `E - E B^-1 E`, with `inverse` = B^-1.
    fn reduced(&self, inverse: &Symmetric3) -> Symmetric3;
    /// `own + E`.
    fn added_to(&self, own: Symmetric3) -> Symmetric3;
}

/// A multiple of the identity, as the inertia of a rod is.
impl Coupling for f64 {
    #[inline(always)]
    fn times(&self, v: DVec3) -> DVec3 {
        *self * v
    }

    #[inline(always)]
    fn reduced(&self, inverse: &Symmetric3) -> Symmetric3 {
        Symmetric3::identity(*self).plus_scaled(*inverse, -self * self)
    }

    #[inline(always)]
    fn added_to(&self, own: Symmetric3) -> Symmetric3 {
        own.plus(Symmetric3::identity(*self))
    }
}

impl Coupling for Symmetric3 {
    #[inline(always)]
    fn times(&self, v: DVec3) -> DVec3 {
        Self::times(self, v)
    }

    #[inline(always)]
    fn reduced(&self, inverse: &Symmetric3) -> Symmetric3 {
        self.plus_scaled(Self::product(&self.by(inverse), self), -1.0)
    }

    #[inline(always)]
    fn added_to(&self, own: Symmetric3) -> Symmetric3 {
        own.plus(*self)
    }
}

/// Whether a link keeps its length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stretch {
    /// It does: its tension is a force of constraint.
    Rigid,
    /// It does not: its tension is a force like any other.
    Elastic,
}

/// A link with what it carries eliminated.
#[derive(Clone, Copy, Debug, Default)]
pub struct ArticulatedLink<E> {
    coupling: E,
    /// B^-1.
    pub(super) inverse: Symmetric3,
    /// g.
    across: DVec3,
    /// h.
    along: DVec3,
    /// s.
    pub(super) stiffness: f64,
}

/// The sweep inward of a link: its part that does not depend on how P accelerates.
#[derive(Clone, Copy, Debug, Default)]
pub struct LinkBias {
    /// a_Q at a_P = 0.
    pub distal: DVec3,
    /// T at a_P = 0.
    pub tension: f64,
    /// b_P: what is passed on.
    pub passed_on: DVec3,
}

impl LinkBias {
    /// Of both loads together.
    #[inline]
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            distal: self.distal + other.distal,
            tension: self.tension + other.tension,
            passed_on: self.passed_on + other.passed_on,
        }
    }
}

impl<E: Coupling> ArticulatedLink<E> {
    /// Eliminates what is carried: `carried` is B without the link's own E, `direction` e. With A_P, and
    /// whether B is positive definite.
    #[inline(always)]
    #[must_use]
    pub fn new(
        carried: Carried,
        coupling: E,
        direction: DVec3,
        stretch: Stretch,
    ) -> (Self, Carried, bool) {
        let light = coupling.added_to(carried.light);
        let (h, heavy) = (carried.along, carried.heavy);
        let (inverse_light, positive) = light.inverse();
        // 1/|R| of the inverse: heavy links make |R| the smaller number, never zero.
        let by_determinant = heavy * inverse_light.determinant();
        let scale = 1.0 / (1.0 + heavy * h.dot(inverse_light.times(h)));
        let inverse = inverse_light
            .plus_scaled(light.between_crosses(h), by_determinant)
            .scaled(scale);
        let crossed = direction.cross(h);
        let turned = light.times(crossed) * by_determinant;
        let by_light = inverse_light.times(direction);
        let across = (by_light + h.cross(turned)) * scale;
        let stiffness = match stretch {
            Stretch::Rigid => 1.0 / ((direction.dot(by_light) + crossed.dot(turned)) * scale),
            Stretch::Elastic => 0.0,
        };
        let along = direction - coupling.times(across);
        let passed_on = Carried {
            light: coupling.reduced(&inverse),
            heavy: stiffness,
            along,
        };
        let link = Self {
            coupling,
            inverse,
            across,
            along,
            stiffness,
        };
        (link, passed_on, positive)
    }

    /// The sweep inward: `carried` is b, `centripetal` c.
    #[inline(always)]
    #[must_use]
    pub fn inward(&self, carried: DVec3, centripetal: f64) -> LinkBias {
        let y = self.inverse.times(carried);
        let tension = -self.stiffness * (centripetal + self.across.dot(carried));
        LinkBias {
            distal: -y - tension * self.across,
            tension,
            passed_on: self.coupling.times(y) - tension * self.along,
        }
    }

    /// The sweep outward: how Q accelerates, and the tension, where P accelerates by `proximal`.
    #[inline(always)]
    #[must_use]
    pub fn outward(&self, bias: &LinkBias, proximal: DVec3) -> (DVec3, f64) {
        let more = -self.stiffness * self.along.dot(proximal);
        let follows = self.inverse.times(self.coupling.times(proximal));
        (
            bias.distal + follows - more * self.across,
            bias.tension + more,
        )
    }

    /// How Q follows P where nothing else pushes: F in a_Q = F a_P + W f, f a force at Q; F' f is what the
    /// link passes on of it.
    #[inline]
    #[must_use]
    pub fn follows(&self) -> DMat3 {
        let column = |v: DVec3| {
            let pulled = (self.stiffness * self.along.dot(v)) * self.across;
            self.inverse.times(self.coupling.times(v)) + pulled
        };
        DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z))
    }

    /// How Q yields to a force on it while P is held: W.
    #[inline]
    #[must_use]
    pub fn yields(&self) -> Symmetric3 {
        let pulled = Symmetric3::along(self.across, self.stiffness, 0.0);
        self.inverse.plus_scaled(pulled, -1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> (Carried, DVec3) {
        let m = DMat3::from_cols(
            DVec3::new(4.0, 0.3, -0.8),
            DVec3::new(0.3, 2.5, 0.6),
            DVec3::new(-0.8, 0.6, 3.1),
        );
        let carried = Carried {
            light: Symmetric3::part_of(m),
            heavy: 7.0,
            along: DVec3::new(0.3, -0.5, 0.9),
        };
        (carried, DVec3::new(0.48, -0.6, 0.64).normalize())
    }

    /// The link's own equations, whatever the blocks are.
    fn check(coupling: Symmetric3, stretch: Stretch) {
        let (carried, e) = sample();
        let (b, c) = (DVec3::new(1.0, -2.0, 0.5), -0.7);
        let c = if stretch == Stretch::Rigid { c } else { 0.0 };
        let (link, passed_on, positive) = ArticulatedLink::new(carried, coupling, e, stretch);
        assert!(positive);
        let (carried, passed_on) = (carried.total(), passed_on.total());
        let bias = link.inward(b, c);
        let proximal = DVec3::new(0.2, 0.9, -1.4);
        let (distal, tension) = link.outward(&bias, proximal);
        let at_distal = carried.times(distal) + coupling.times(distal - proximal) + b;
        assert!((at_distal + tension * e).length() < 1e-13);
        let at_proximal = coupling.times(proximal - distal) + tension * -e;
        let passed = passed_on.times(proximal) + bias.passed_on;
        assert!((at_proximal - passed).length() < 1e-13, "{passed}");
        match stretch {
            Stretch::Rigid => assert!((e.dot(distal - proximal) - c).abs() < 1e-14),
            Stretch::Elastic => assert_eq!(tension, 0.0),
        }
        let pushed = link.inward(-b, 0.0);
        let (answer, _) = link.outward(&pushed, proximal);
        let expected = link.follows() * proximal + link.yields().times(b);
        assert!((answer - expected).length() < 1e-13);
        assert!((pushed.passed_on + link.follows().transpose() * b).length() < 1e-13);
    }

    #[test]
    fn a_link_obeys_its_equations() {
        let anisotropic = Symmetric3::along(DVec3::new(0.1, 0.2, -0.3), 0.5, 0.2);
        for stretch in [Stretch::Rigid, Stretch::Elastic] {
            for coupling in [
                Symmetric3::default(),
                Symmetric3::identity(-0.4),
                anisotropic,
            ] {
                check(coupling, stretch);
            }
        }
    }

    #[test]
    fn a_rod_is_a_coupling_by_a_multiple_of_the_identity() {
        let (carried, e) = sample();
        let (short, passed_on, _) = ArticulatedLink::new(carried, -0.4, e, Stretch::Rigid);
        let (long, expected, _) =
            ArticulatedLink::new(carried, Symmetric3::identity(-0.4), e, Stretch::Rigid);
        let v = DVec3::new(1.0, 2.0, 3.0);
        let (passed_on, expected) = (passed_on.total(), expected.total());
        assert!((passed_on.times(v) - expected.times(v)).length() < 1e-14);
        let b = DVec3::new(1.0, -2.0, 0.5);
        let (a, t) = short.outward(&short.inward(b, 0.3), v);
        let (a_expected, t_expected) = long.outward(&long.inward(b, 0.3), v);
        assert!((a - a_expected).length() < 1e-14);
        assert!((t - t_expected).abs() < 1e-14);
    }
}
