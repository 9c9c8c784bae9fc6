//! The wind: a sum of sources over altitude and time.
//!
//! ```text
//! W(z, t) = sum of  U                                       uniform
//!                   (z - z0) s e                            shear, zero at z0
//!                   V  for t in [from, until), else 0       step gust
//!                   P(z)                                    profile, see wind_profile.rs
//!                   Y(z, t) e                               stochastic gust, see gust/
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | W, U, V, P, Y | velocity of the air in the inertial frame | m/s |
//! | z, z0 | altitude, altitude without shear wind | m |
//! | s, e | gradient, unit vector | 1/s, 1 |
//! | t | time | s |
//!
//! Source: definitions (superposition of velocity fields).
//!
//! Assumptions: no dependence on the horizontal. A step gust is sharp, and the integrator never
//! steps across one of its edges ([`Wind::edges_s`]): [`Wind::begin_interval`] fixes which steps
//! blow, once for a whole interval between edges. A stochastic gust is continuous: nothing
//! switches at its knots; [`Wind::advance_gusts`] makes the time of an evaluation its present, and
//! [`Wind::step_limit_s`] says where a step should end that is to see all of it.

use super::gust::GustAxis;
use super::wind_profile::WindProfile;
use glam::DVec3;
use thiserror::Error;

/// An altitude where the wind is not known, or one that is not a number.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error(
    "altitude {altitude_m} m is outside the {source_of_wind}, which is known from {lowest_m} m to \
     {highest_m} m"
)]
pub struct OutsideWindProfile {
    /// Which kind of source ends there.
    pub source_of_wind: &'static str,
    /// The altitude asked for, m.
    pub altitude_m: f64,
    /// The lowest altitude of the profile, m; -inf where it has none.
    pub lowest_m: f64,
    /// The highest altitude of the profile, m; inf where it has none.
    pub highest_m: f64,
}

/// One part of the wind. Numbers are finite (the times of a step may be infinite) and directions
/// of unit length: whoever builds one from a file checks that.
#[derive(Debug, Clone, PartialEq)]
pub enum WindSource {
    /// The same everywhere, always.
    Uniform {
        /// Velocity of the air, m/s, inertial frame.
        velocity_m_s: DVec3,
    },
    /// Growing linearly with altitude.
    Shear {
        /// Altitude where it is zero, m.
        altitude_m: f64,
        /// Speed gained per metre upward, 1/s.
        gradient_per_s: f64,
        /// Direction above `altitude_m`, unit vector, inertial frame.
        direction: DVec3,
    },
    /// A gust of constant velocity, on `from_s <= t < until_s`.
    Step {
        /// Velocity of the air, m/s, inertial frame.
        velocity_m_s: DVec3,
        /// First time of the gust, s.
        from_s: f64,
        /// First time after the gust, s.
        until_s: f64,
    },
    /// A table over altitude.
    Profile(WindProfile),
}

impl WindSource {
    /// Velocity (m/s) at `time_s` where it does not depend on altitude, else `None`.
    fn level_velocity_m_s(&self, time_s: f64) -> Option<DVec3> {
        match *self {
            Self::Uniform { velocity_m_s } => Some(velocity_m_s),
            Self::Step {
                velocity_m_s,
                from_s,
                until_s,
            } => {
                let blows = from_s <= time_s && time_s < until_s;
                Some(if blows { velocity_m_s } else { DVec3::ZERO })
            }
            Self::Shear { .. } | Self::Profile(_) => None,
        }
    }

    /// Velocity (m/s) where it depends on altitude (m), else zero; `None` outside a profile.
    #[inline]
    fn layered_velocity_m_s(&self, z_m: f64) -> Option<DVec3> {
        match self {
            Self::Profile(profile) => profile.velocity_m_s(z_m),
            Self::Shear {
                altitude_m,
                gradient_per_s,
                direction,
            } => {
                let speed_m_s = (z_m - altitude_m) * gradient_per_s;
                z_m.is_finite().then_some(speed_m_s * *direction)
            }
            Self::Uniform { .. } | Self::Step { .. } => Some(DVec3::ZERO),
        }
    }

    /// Slope of the velocity over altitude (1/s); `None` outside a profile.
    #[inline]
    fn slope_per_s(&self, z_m: f64) -> Option<DVec3> {
        match self {
            Self::Profile(profile) => profile.slope_per_s(z_m),
            Self::Shear {
                gradient_per_s,
                direction,
                ..
            } => z_m.is_finite().then_some(*gradient_per_s * *direction),
            Self::Uniform { .. } | Self::Step { .. } => Some(DVec3::ZERO),
        }
    }

    fn scaled(&self, factor: f64) -> Self {
        match self.clone() {
            Self::Uniform { velocity_m_s } => Self::Uniform {
                velocity_m_s: factor * velocity_m_s,
            },
            Self::Shear {
                altitude_m,
                gradient_per_s,
                direction,
            } => Self::Shear {
                altitude_m,
                gradient_per_s: factor * gradient_per_s,
                direction,
            },
            Self::Step {
                velocity_m_s,
                from_s,
                until_s,
            } => Self::Step {
                velocity_m_s: factor * velocity_m_s,
                from_s,
                until_s,
            },
            Self::Profile(profile) => Self::Profile(profile.scaled(factor)),
        }
    }

    #[cold]
    fn outside(&self, altitude_m: f64) -> OutsideWindProfile {
        let (lowest_m, highest_m) = match self {
            Self::Profile(profile) => (profile.lowest_m(), profile.highest_m()),
            _ => (f64::NEG_INFINITY, f64::INFINITY),
        };
        OutsideWindProfile {
            source_of_wind: "wind profile",
            altitude_m,
            lowest_m,
            highest_m,
        }
    }
}

/// The sum of wind sources.
#[derive(Debug, Clone)]
pub struct Wind {
    /// Sources that are the same at every altitude.
    level: Vec<WindSource>,
    /// Sources that depend on altitude.
    layered: Vec<WindSource>,
    /// Gusts that are the same at every altitude.
    level_gusts: Vec<GustAxis>,
    /// Gusts that depend on altitude.
    layered_gusts: Vec<GustAxis>,
    /// Sum of `level` over the present interval, m/s.
    interval_m_s: DVec3,
    /// That and `level_gusts` at present, m/s.
    level_m_s: DVec3,
}

impl Wind {
    /// The sum of `sources`. No step that begins at a finite time blows before the first
    /// [`Self::begin_interval`].
    pub fn new(sources: Vec<WindSource>) -> Self {
        let (level, layered) = sources
            .into_iter()
            .partition(|source| source.level_velocity_m_s(0.0).is_some());
        let mut wind = Self {
            level,
            layered,
            level_gusts: Vec::new(),
            layered_gusts: Vec::new(),
            interval_m_s: DVec3::ZERO,
            level_m_s: DVec3::ZERO,
        };
        wind.begin_interval(f64::NEG_INFINITY);
        wind
    }

    /// The same wind with stochastic gusts, as they are at their present.
    #[must_use]
    pub fn with_gusts(mut self, gusts: Vec<GustAxis>) -> Self {
        let (layered, level): (Vec<_>, Vec<_>) = gusts
            .into_iter()
            .partition(|gust| gust.design().levels.is_some());
        self.level_gusts.extend(level);
        self.layered_gusts.extend(layered);
        self.sum_level();
        self
    }

    /// Its stochastic gusts.
    pub fn gusts(&self) -> impl Iterator<Item = &GustAxis> {
        self.level_gusts.iter().chain(&self.layered_gusts)
    }

    /// No wind.
    pub fn still() -> Self {
        Self::new(Vec::new())
    }

    /// The finite times (s) at which a step gust begins or ends, increasing, each once.
    pub fn edges_s(&self) -> Vec<f64> {
        let mut edges: Vec<f64> = self
            .level
            .iter()
            .filter_map(|source| match *source {
                WindSource::Step {
                    from_s, until_s, ..
                } => Some([from_s, until_s]),
                _ => None,
            })
            .flatten()
            .filter(|edge| edge.is_finite())
            .collect();
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        edges
    }

    /// The same wind, `factor` times as strong.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let scaled =
            |sources: &[WindSource]| sources.iter().map(|source| source.scaled(factor)).collect();
        let scaled_gusts =
            |gusts: &[GustAxis]| gusts.iter().map(|gust| gust.scaled(factor)).collect();
        Self {
            level: scaled(&self.level),
            layered: scaled(&self.layered),
            level_gusts: scaled_gusts(&self.level_gusts),
            layered_gusts: scaled_gusts(&self.layered_gusts),
            interval_m_s: factor * self.interval_m_s,
            level_m_s: factor * self.level_m_s,
        }
    }

    /// Fixes the step gusts that blow from `start_s` (s) until the next edge, and sums what does
    /// not depend on altitude.
    pub fn begin_interval(&mut self, start_s: f64) {
        self.interval_m_s = self
            .level
            .iter()
            .filter_map(|source| source.level_velocity_m_s(start_s))
            .sum();
        self.sum_level();
    }

    /// Makes a time (s) the present of the stochastic gusts.
    pub fn advance_gusts(&mut self, time_s: f64) {
        for gust in self.level_gusts.iter_mut().chain(&mut self.layered_gusts) {
            gust.advance_to(time_s);
        }
        self.sum_level();
    }

    /// The time (s) after `time_s` at which a step should end at the latest for the sake of the gusts.
    #[must_use]
    pub fn step_limit_s(&self, time_s: f64) -> f64 {
        let limits = self.gusts().map(|gust| gust.step_limit_s(time_s));
        limits.fold(f64::INFINITY, f64::min)
    }

    fn sum_level(&mut self) {
        self.level_m_s = self.interval_m_s;
        for gust in &self.level_gusts {
            self.level_m_s[gust.design().parameters.axis] += gust.velocity_m_s();
        }
    }

    /// Whether the wind depends on altitude.
    #[inline]
    pub fn depends_on_altitude(&self) -> bool {
        !self.layered.is_empty() || !self.layered_gusts.is_empty()
    }

    /// The part of the velocity (m/s, inertial frame) that does not depend on altitude, within the
    /// interval begun last.
    #[inline]
    pub fn level_velocity_m_s(&self) -> DVec3 {
        self.level_m_s
    }

    /// Velocity of the air (m/s, inertial frame) at an altitude (m), within the interval begun
    /// last.
    ///
    /// # Errors
    /// The altitude is outside a profile, or not finite and the wind depends on it.
    #[inline]
    pub fn velocity_m_s(&self, altitude_m: f64) -> Result<DVec3, OutsideWindProfile> {
        let mut velocity_m_s = self.level_m_s;
        for source in &self.layered {
            velocity_m_s += source
                .layered_velocity_m_s(altitude_m)
                .ok_or_else(|| source.outside(altitude_m))?;
        }
        for gust in &self.layered_gusts {
            velocity_m_s[gust.design().parameters.axis] += gust
                .velocity_at_m_s(altitude_m)
                .ok_or_else(|| outside_gust(gust, altitude_m))?;
        }
        Ok(velocity_m_s)
    }

    /// Slope of the velocity of the air over altitude (1/s, inertial frame) at an altitude (m).
    ///
    /// # Errors
    /// As [`Self::velocity_m_s`].
    #[inline]
    pub fn slope_per_s(&self, altitude_m: f64) -> Result<DVec3, OutsideWindProfile> {
        let mut slope_per_s = DVec3::ZERO;
        for source in &self.layered {
            slope_per_s += source
                .slope_per_s(altitude_m)
                .ok_or_else(|| source.outside(altitude_m))?;
        }
        for gust in &self.layered_gusts {
            slope_per_s[gust.design().parameters.axis] += gust
                .slope_per_s(altitude_m)
                .ok_or_else(|| outside_gust(gust, altitude_m))?;
        }
        Ok(slope_per_s)
    }
}

#[cold]
fn outside_gust(gust: &GustAxis, altitude_m: f64) -> OutsideWindProfile {
    let levels = gust.design().levels.as_ref();
    OutsideWindProfile {
        source_of_wind: "gust",
        altitude_m,
        lowest_m: levels.map_or(f64::NEG_INFINITY, |levels| levels.lowest_m),
        highest_m: levels.map_or(f64::INFINITY, |levels| levels.highest_m),
    }
}

#[cfg(test)]
mod tests;
