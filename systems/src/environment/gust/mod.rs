//! Stochastic gusts: a random velocity along one axis, drawn on a grid of its own in time, and over altitude
//! on levels, linear between them. So neither integrator nor step nor formulation changes the wind.
//!
//! ```text
//! Y(z, t) = F^-1(P(X(z, t))) + d
//! E[X(z, t) X(z', t + tau)] = r(tau) e^(-|z - z'|/L),   r(tau) = e^(-alpha |tau|) cos(omega tau)
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | Y, d | velocity of the air along the axis, shift of its mean | m/s |
//! | X, P | standard normal process, its probability | 1 |
//! | F | probability of the marginal | 1 |
//! | alpha, omega | decay, frequency | 1/s, rad/s |
//! | L | decay length; infinite for one gust everywhere | m |
//!
//! Source: the paper, sec. 3.5; [`design`] says how, [`parent`] draws X.
//!
//! Assumptions: the same along the horizontal. Between two knots, and between two levels, a line has less
//! variance than the process ([`design::GustDesign::loss_in_time`]).

pub mod design;
pub mod parent;
pub mod refusal;
pub mod statistics;

use design::{GustDesign, GustParameters, Levels};
use parent::Parent;
use refusal::GustError;

/// At most this many numbers are kept of what has passed, and never fewer than `LEAST_KNOTS` knots: a step
/// that is repeated goes back by less.
const KEPT_NUMBERS: usize = 1 << 16;
const LEAST_KNOTS: usize = 256;

/// A step of less than this part of the knots it may pass is none.
const SLIVER: f64 = 1e-6;

/// A gust along one axis, at a present time.
#[derive(Clone, Debug)]
pub struct GustAxis {
    design: GustDesign,
    seed: u64,
    factor: f64,
    parent: Parent,
    /// Velocities, m/s: a row of all levels for each knot from `first` on.
    knots: Vec<f64>,
    first: u64,
    /// Where the row of the knot before the present begins, and the part of the way to the next.
    row: usize,
    part: f64,
    /// At the lowest level, m/s.
    present_m_s: f64,
}

impl GustAxis {
    /// The gust of some parameters under the seed of a run, at the time 0.
    ///
    /// # Errors
    /// What is impossible.
    pub fn new(parameters: GustParameters, seed: u64) -> Result<Self, GustError> {
        let design = GustDesign::new(parameters)?;
        let mut gust = Self {
            parent: design.parent(seed),
            design,
            seed,
            factor: 1.0,
            knots: Vec::new(),
            first: 0,
            row: 0,
            part: 0.0,
            present_m_s: 0.0,
        };
        gust.advance_to(0.0);
        Ok(gust)
    }

    /// How it is drawn.
    #[must_use]
    pub fn design(&self) -> &GustDesign {
        &self.design
    }

    /// The same gust, `factor` times as strong.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let mut scaled = self.clone();
        scaled.factor *= factor;
        scaled.present_m_s *= factor;
        scaled
    }

    /// Makes a time (s) the present; before 0 it is as at 0.
    pub fn advance_to(&mut self, time_s: f64) {
        let place = (time_s / self.design.grid_s).max(0.0);
        let knot = place as u64;
        self.provide(knot);
        let levels = self.levels();
        self.row = (knot - self.first) as usize * levels;
        self.part = place - knot as f64;
        self.present_m_s = self.at_level(0);
    }

    /// The time (s) after `time_s` at which a step should end at the latest, so as not to pass over what the
    /// wind does; infinite if it may pass any number of knots.
    #[must_use]
    pub fn step_limit_s(&self, time_s: f64) -> f64 {
        let span_s = f64::from(self.design.parameters.knots_per_step) * self.design.grid_s;
        if span_s == 0.0 {
            return f64::INFINITY;
        }
        // Round-off must not make a sliver of a step.
        let passed = (time_s / span_s + SLIVER).floor();
        (passed + 1.0) * span_s
    }

    /// Velocity (m/s) at present where it is the same everywhere; else at the lowest level.
    #[inline]
    #[must_use]
    pub fn velocity_m_s(&self) -> f64 {
        self.present_m_s
    }

    /// Velocity (m/s) at present at an altitude (m); `None` outside the levels.
    #[inline]
    #[must_use]
    pub fn velocity_at_m_s(&self, altitude_m: f64) -> Option<f64> {
        let Some(levels) = &self.design.levels else {
            return altitude_m.is_finite().then_some(self.present_m_s);
        };
        let (level, part) = levels.place(altitude_m)?;
        let (below, above) = (self.at_level(level), self.at_level(level + 1));
        Some(below + part * (above - below))
    }

    /// Slope of the velocity over altitude (1/s) at present at an altitude (m); `None` outside the levels.
    #[inline]
    #[must_use]
    pub fn slope_per_s(&self, altitude_m: f64) -> Option<f64> {
        let Some(levels) = &self.design.levels else {
            return altitude_m.is_finite().then_some(0.0);
        };
        let (level, _) = levels.place(altitude_m)?;
        Some((self.at_level(level + 1) - self.at_level(level)) / levels.spacing_m)
    }

    #[inline]
    fn at_level(&self, level: usize) -> f64 {
        let here = self.row + level;
        let (before, after) = (self.knots[here], self.knots[here + self.levels()]);
        self.factor * (before + self.part * (after - before))
    }

    #[inline]
    fn levels(&self) -> usize {
        self.design.levels.as_ref().map_or(1, Levels::count)
    }

    /// Sees to it that a knot and the one after it are there.
    fn provide(&mut self, knot: u64) {
        let levels = self.levels();
        if knot < self.first {
            // Farther back than is kept: all of it is drawn again, with the same numbers.
            self.parent = self.design.parent(self.seed);
            self.knots.clear();
            self.first = 0;
        }
        let most = (KEPT_NUMBERS / levels).max(LEAST_KNOTS) as u64;
        while self.first + (self.knots.len() / levels) as u64 <= knot + 1 {
            let known = (self.knots.len() / levels) as u64;
            if known >= most {
                let half = (known / 2) as usize;
                self.knots.drain(..half * levels);
                self.first += half as u64;
            }
            let from = self.knots.len();
            self.parent.next(&mut self.knots);
            for x in &mut self.knots[from..] {
                *x = self.design.velocity_m_s(*x);
            }
        }
    }
}

#[cfg(test)]
mod tests;
