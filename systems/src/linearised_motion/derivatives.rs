//! Masses and derivatives of the forces at one state, as flat arrays.

use glam::{DMat3, DVec3};

use super::body_block::{BodyBlock, Place, Twist, cross_matrix};
use super::symmetric3::Symmetric3;
use super::topology::{End, Topology};

/// A segment at the state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinearSegment {
    /// Unit vector from its first point to its second, inertial frame.
    pub direction: DVec3,
    /// Length, m.
    pub length_m: f64,
    /// dT/dL while taut, N/m.
    pub stiffness_n_m: f64,
    /// dT/d(dL/dt) while taut, N s/m.
    pub damping_n_s_m: f64,
    /// T/L, N/m.
    pub geometric_n_m: f64,
    /// By how much it is too short to be taut, m.
    pub gap_m: f64,
    /// How fast that closes, m/s.
    pub closing_m_s: f64,
    /// Tension, N.
    pub tension_n: f64,
    /// -dF/dv of the drag of the whole segment, N s/m.
    pub drag: Symmetric3,
}

impl LinearSegment {
    /// Whether it is taut at some instant of a step of `step_s`, weight pulling at `gravity_m_s2`.
    #[inline]
    #[must_use]
    pub fn will_be_taut(&self, step_s: f64, gravity_m_s2: f64) -> bool {
        self.gap_m <= 0.0 || step_s * (self.closing_m_s + 0.5 * step_s * gravity_m_s2) > self.gap_m
    }
}

/// A point of a tether at the state: mass of a node; what damps a node or an attachment, half the drag
/// of each segment beside it included.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinearPoint {
    /// Mass of a node, kg.
    pub mass_kg: f64,
    /// -dF/dv, N s/m.
    pub damping: Symmetric3,
    /// -dF/dx of its own, without its segments, N/m.
    pub stiffness: Symmetric3,
}

/// A free body at the state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearBody {
    /// Mass matrix.
    pub mass: BodyBlock,
    /// -dF/dv.
    pub damping: BodyBlock,
    /// -dF/dx, without the segments.
    pub stiffness: BodyBlock,
}

impl LinearBody {
    /// What loads it in a stage with g (s) where it is shifted by `shift` and its speed by `speed`, without
    /// its tethers: `g M r_v + g^2 K r_x`.
    #[must_use]
    pub fn stage_load(&self, g: f64, shift: Twist, speed: Twist) -> Twist {
        let push = self.mass.times(speed);
        let pull = self.stiffness.times(shift);
        Twist {
            linear: g * push.linear - g * g * pull.linear,
            angular: g * push.angular - g * g * pull.angular,
        }
    }
}

/// The end of a tether on a free body, at the state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearEnd {
    /// Its place on the body.
    pub place: Place,
    /// Offset from the centre of mass, body frame, m.
    pub offset_m: DVec3,
    /// The force on it, body frame, N.
    pub load_n: DVec3,
}

impl Default for LinearEnd {
    fn default() -> Self {
        Self {
            place: Place { turn: DMat3::ZERO },
            offset_m: DVec3::ZERO,
            load_n: DVec3::ZERO,
        }
    }
}

/// A segment at a winch, whose unstretched length is a first-order state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinearReel {
    /// Index of its first point.
    pub segment: usize,
    /// Place among the first-order states.
    pub state: usize,
    /// That length, m.
    pub length_m: f64,
    /// Change of its tension with it, N/m.
    pub tension_by_length_n_m: f64,
}

/// Masses and derivatives at one state.
#[derive(Clone, Debug, Default)]
pub struct Derivatives {
    /// By index of the first point.
    pub segments: Vec<LinearSegment>,
    /// By index of the point.
    pub points: Vec<LinearPoint>,
    /// By index of the body.
    pub bodies: Vec<LinearBody>,
    /// `from` and `to` of every line.
    pub ends: Vec<[LinearEnd; 2]>,
    /// Segments at winches.
    pub reels: Vec<LinearReel>,
    /// Largest acceleration of gravity, m/s^2.
    pub gravity_m_s2: f64,
}

impl Derivatives {
    /// Arrays for a topology.
    #[must_use]
    pub fn new(topology: &Topology) -> Self {
        let body = LinearBody {
            mass: BodyBlock::ZERO,
            damping: BodyBlock::ZERO,
            stiffness: BodyBlock::ZERO,
        };
        Self {
            segments: vec![LinearSegment::default(); topology.points],
            points: vec![LinearPoint::default(); topology.points],
            bodies: vec![body; topology.bodies.len()],
            ends: vec![[LinearEnd::default(); 2]; topology.lines.len()],
            reels: Vec::new(),
            gravity_m_s2: 0.0,
        }
    }

    /// Adds to the bodies what comes to them through the ends of tethers: the drag of half a segment,
    /// and the torque by which a force follows its place as the body turns, `r x (f x theta)`.
    pub fn load_bodies(&mut self, topology: &Topology) {
        for (line, ends) in topology.lines.iter().zip(&self.ends) {
            let points = [line.first_point, line.last_point()];
            for ((end, at), point) in [line.from, line.to].into_iter().zip(ends).zip(points) {
                let End::OnBody(body) = end else { continue };
                let body = &mut self.bodies[body];
                let drag = self.points[point].damping.into();
                let drag = BodyBlock::between(&at.place, drag, &at.place);
                body.damping.add(&drag, 1.0);
                body.stiffness.turn -= cross_matrix(at.offset_m) * cross_matrix(at.load_n);
            }
        }
    }
}
