//! The way of a drone to a port: what its flight computer is to follow, phase by phase.
//!
//! Search until the port is known; approach to the place at the standoff s in front of it, p + s n; station-keeping
//! there until the error has been small for long enough; contact along the axis n of the port, with
//!
//! ```text
//! p_r = p + g n,  v_r = v + g' n + g n',  a_r = a,   g' = -V_c max(0, 1 - e / e_gate)
//! ```
//!
//! p, v, a the port as far as it is known, g the gap (m), V_c the closing speed (m/s), e the lateral error (m): far
//! beside the axis the drone waits until it is on it. n' is what is seen of the turning of the axis, smoothed over
//! a second, without which the drone would trail behind a port that turns. An approach is missed if e passes its
//! limit, if the plane of the port is passed, or if it takes too long; then the drone backs off to the standoff and
//! tries again. What cannot be reached is told, with the reason, and the drone drifts with the air.
//!
//! Assumptions: the straight way to the standoff is free; the drone comes from the side to which the port faces.

use std::fmt;

use aerobot_components::docking::{Docked, Docking, DockingPhase, DockingPort, LatchState};
use aerobot_components::rotorcraft::{FlightReference, FlightStatus};
use aerobot_components::sampling::Sampling;
use aerobot_components::state::{Acceleration, Air};
use bevy_ecs::component::Component;
use bevy_ecs::system::{Query, Res};
use glam::DVec3;

use super::observer::{PortEstimate, PortObserver};
use super::ports::{PortCarrier, PortMotion};
use crate::clock::Clock;
use crate::rotorcraft::flight_computer::FlightComputer;

/// Coming nearer by less than this is no progress, m.
const PROGRESS_M: f64 = 0.5;
/// Station is lost at this many times the error at which it is taken.
const STATION_LOST: f64 = 3.0;
/// The gap that is commanded ends here, m: behind the plane of the port, so that a port that shies is followed.
const LEAST_GAP_M: f64 = -0.3;
/// A drone whose port is this far behind the plane of the other has passed it, m.
const PASSED_M: f64 = -0.1;
/// Time over which the turning of the port's axis is smoothed, s.
const SMOOTHED_S: f64 = 1.0;
/// An axis whose horizontal part is less than this says nothing of a heading.
const LEAST_HORIZONTAL: f64 = 0.1;

/// Why a port cannot be reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unreachable {
    /// The rotors give too little.
    OutOfThrust {
        /// What is needed, N.
        needed_n: f64,
        /// What there is, N.
        largest_n: f64,
    },
    /// The port keeps away.
    TooFast {
        /// Its speed through the air about the drone, m/s.
        airspeed_m_s: f64,
    },
    /// The port is not seen.
    NotSeen,
    /// Approach after approach was missed.
    Missed {
        /// How many.
        approaches: u32,
        /// Angle by which the ports did not face each other at the last, rad.
        misalignment_rad: f64,
    },
    /// Another body rides on the port.
    Taken,
}

impl Unreachable {
    /// In two or three words.
    #[must_use]
    pub fn word(&self) -> &'static str {
        match self {
            Self::OutOfThrust { .. } => "out of thrust",
            Self::TooFast { .. } => "too fast",
            Self::NotSeen => "not seen",
            Self::Missed { .. } => "approaches missed",
            Self::Taken => "port taken",
        }
    }
}

impl fmt::Display for Unreachable {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfThrust {
                needed_n,
                largest_n,
            } => write!(
                formatter,
                "it takes a thrust of {needed_n:.1} N, and rotors and motors give {largest_n:.1} N in this air"
            ),
            Self::TooFast { airspeed_m_s } => write!(
                formatter,
                "it comes no nearer to a port that moves through the air at {airspeed_m_s:.1} m/s"
            ),
            Self::NotSeen => write!(formatter, "the port is not within the range of its sensor"),
            Self::Missed {
                approaches,
                misalignment_rad,
            } => write!(
                formatter,
                "{approaches} approaches were missed, at the last with the ports {misalignment_rad:.2} rad from facing each other"
            ),
            Self::Taken => write!(formatter, "another body rides on the port"),
        }
    }
}

/// Something to tell of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum News {
    /// A phase has begun.
    Phase(DockingPhase),
    /// An approach was missed.
    MissedApproach,
    /// The port cannot be reached.
    Unreachable(Unreachable),
}

/// Where a drone is on its way.
#[derive(Component, Clone, Debug, Default)]
pub struct Guidance {
    /// What it is doing.
    pub phase: DockingPhase,
    /// What has happened since this was last taken.
    pub news: Vec<News>,
    since_s: f64,
    missed: u32,
    nearest_m: f64,
    nearest_s: f64,
    short_s: f64,
    steady_s: f64,
    gap_m: f64,
    heading_rad: f64,
    axis: Option<DVec3>,
    axis_rate_per_s: DVec3,
}

/// What a tick of the guidance goes by.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Now, s.
    pub time_s: f64,
    /// Since the last tick, s.
    pub period_s: f64,
    /// The drone's own port.
    pub own: PortMotion,
    /// What is known of the other.
    pub seen: Option<PortEstimate>,
    /// What the flight computer has found.
    pub flight: FlightStatus,
    /// Velocity of the air about the drone, m/s.
    pub wind_m_s: DVec3,
    /// Whether another body rides on the port.
    pub taken: bool,
}

impl Guidance {
    /// That of a drone which starts with this heading, rad.
    #[must_use]
    pub fn new(heading_rad: f64) -> Self {
        Self {
            heading_rad,
            ..Self::default()
        }
    }

    /// Begins a phase.
    pub fn enter(&mut self, phase: DockingPhase, time_s: f64) {
        self.phase = phase;
        self.since_s = time_s;
        self.steady_s = 0.0;
        self.short_s = 0.0;
        self.nearest_m = f64::INFINITY;
        self.nearest_s = time_s;
        if phase != DockingPhase::Unreachable {
            self.news.push(News::Phase(phase));
        }
    }

    /// One tick: what is to be followed from now on.
    pub fn tick(&mut self, docking: &Docking, port: &DockingPort, view: &View) -> FlightReference {
        let drift = FlightReference {
            position_m: None,
            velocity_m_s: view.wind_m_s.with_z(0.0),
            acceleration_m_s2: DVec3::ZERO,
            heading_rad: self.heading_rad,
            point_m: port.at_m,
        };
        self.watch_axis(view);
        let Some(seen) = view.seen else {
            self.without_sight(docking, view.time_s);
            return drift;
        };
        if matches!(self.phase, DockingPhase::Unreachable | DockingPhase::Docked) {
            return drift;
        }
        if view.taken && self.phase != DockingPhase::Released {
            self.give_up(Unreachable::Taken, view.time_s);
            return drift;
        }
        if self.phase == DockingPhase::Search {
            self.enter(DockingPhase::Approach, view.time_s);
        }
        if let Some(heading_rad) = heading(seen.motion.axis, port.axis) {
            self.heading_rad = heading_rad;
        }
        let mut gap_rate_m_s = 0.0;
        match self.phase {
            DockingPhase::Approach => self.approach(docking, view, &seen),
            DockingPhase::StationKeeping => self.keep_station(docking, view, &seen),
            DockingPhase::Contact => gap_rate_m_s = self.close_in(docking, view, &seen),
            _ => {}
        }
        let gap_m = match self.phase {
            DockingPhase::Unreachable => return drift,
            DockingPhase::Contact => self.gap_m,
            _ => docking.standoff_m,
        };
        FlightReference {
            position_m: Some(seen.motion.position_m + gap_m * seen.motion.axis),
            velocity_m_s: seen.motion.velocity_m_s
                + gap_rate_m_s * seen.motion.axis
                + gap_m * self.axis_rate_per_s,
            acceleration_m_s2: seen.acceleration_m_s2,
            heading_rad: self.heading_rad,
            point_m: port.at_m,
        }
    }

    fn watch_axis(&mut self, view: &View) {
        let axis = view.seen.map(|seen| seen.motion.axis);
        self.axis_rate_per_s = match (self.axis, axis) {
            (Some(before), Some(now)) => {
                let rate_per_s = (now - before) / view.period_s;
                let share = view.period_s / (view.period_s + SMOOTHED_S);
                self.axis_rate_per_s.lerp(rate_per_s, share)
            }
            _ => DVec3::ZERO,
        };
        self.axis = axis;
    }

    fn without_sight(&mut self, docking: &Docking, time_s: f64) {
        match self.phase {
            DockingPhase::Search => {
                if time_s - self.since_s > docking.patience_s {
                    self.give_up(Unreachable::NotSeen, time_s);
                }
            }
            DockingPhase::Approach | DockingPhase::StationKeeping | DockingPhase::Contact => {
                self.enter(DockingPhase::Search, time_s);
            }
            DockingPhase::Docked | DockingPhase::Released | DockingPhase::Unreachable => {}
        }
    }

    fn give_up(&mut self, reason: Unreachable, time_s: f64) {
        self.enter(DockingPhase::Unreachable, time_s);
        self.news.push(News::Unreachable(reason));
    }

    fn approach(&mut self, docking: &Docking, view: &View, seen: &PortEstimate) {
        let error_m = station_error_m(docking, view, seen);
        if error_m < docking.station_error_m {
            self.enter(DockingPhase::StationKeeping, view.time_s);
            return;
        }
        if view.flight.needed_thrust_n > 0.999 * view.flight.largest_thrust_n {
            self.short_s += view.period_s;
        }
        if error_m < self.nearest_m - PROGRESS_M {
            self.nearest_m = error_m;
            self.nearest_s = view.time_s;
            self.short_s = 0.0;
        } else if view.time_s - self.nearest_s > docking.patience_s {
            let reason = if self.short_s > 0.5 * docking.patience_s {
                Unreachable::OutOfThrust {
                    needed_n: view.flight.needed_thrust_n,
                    largest_n: view.flight.largest_thrust_n,
                }
            } else {
                let through_air = seen.motion.velocity_m_s - view.wind_m_s;
                Unreachable::TooFast {
                    airspeed_m_s: through_air.length_squared().sqrt(),
                }
            };
            self.give_up(reason, view.time_s);
        }
    }

    fn keep_station(&mut self, docking: &Docking, view: &View, seen: &PortEstimate) {
        let error_m = station_error_m(docking, view, seen);
        if error_m > STATION_LOST * docking.station_error_m {
            self.enter(DockingPhase::Approach, view.time_s);
        } else if view.time_s - self.since_s > docking.patience_s {
            self.miss(docking, view, seen);
        } else if error_m < docking.station_error_m {
            self.steady_s += view.period_s;
            if self.steady_s >= docking.station_s {
                self.enter(DockingPhase::Contact, view.time_s);
                self.gap_m = docking.standoff_m;
            }
        } else {
            self.steady_s = 0.0;
        }
    }

    /// The rate of the gap, m/s.
    fn close_in(&mut self, docking: &Docking, view: &View, seen: &PortEstimate) -> f64 {
        let from_port = view.own.position_m - seen.motion.position_m;
        let ahead_m = from_port.dot(seen.motion.axis);
        let beside = from_port - ahead_m * seen.motion.axis;
        let lateral_m = beside.length_squared().sqrt();
        let longest_s = docking.standoff_m / docking.closing_speed_m_s + docking.patience_s;
        if lateral_m > docking.lateral_limit_m
            || ahead_m < PASSED_M
            || view.time_s - self.since_s > longest_s
        {
            self.miss(docking, view, seen);
            return 0.0;
        }
        let gate = (1.0 - lateral_m / docking.lateral_gate_m).max(0.0);
        let rate_m_s = -docking.closing_speed_m_s * gate;
        let before_m = self.gap_m;
        self.gap_m = (before_m + rate_m_s * view.period_s).max(LEAST_GAP_M);
        if self.gap_m > LEAST_GAP_M {
            rate_m_s
        } else {
            0.0
        }
    }

    fn miss(&mut self, docking: &Docking, view: &View, seen: &PortEstimate) {
        let time_s = view.time_s;
        self.missed += 1;
        self.news.push(News::MissedApproach);
        if self.missed >= docking.attempts {
            let reason = Unreachable::Missed {
                approaches: self.missed,
                misalignment_rad: view.own.axis.angle_between(-seen.motion.axis),
            };
            self.give_up(reason, time_s);
        } else {
            self.enter(DockingPhase::Approach, time_s);
        }
    }
}

/// How far the drone's port is from the place in front of the other, m.
fn station_error_m(docking: &Docking, view: &View, seen: &PortEstimate) -> f64 {
    let station_m = seen.motion.position_m + docking.standoff_m * seen.motion.axis;
    view.own.position_m.distance(station_m)
}

/// The heading, rad, at which a port of this axis on the body points against one of the axis `target` (inertial
/// frame); none where either is upright.
fn heading(target: DVec3, own: DVec3) -> Option<f64> {
    let horizontal = |axis: DVec3| libm::hypot(axis.x, axis.y) / axis.length_squared().sqrt();
    let is_level = horizontal(target) > LEAST_HORIZONTAL && horizontal(own) > LEAST_HORIZONTAL;
    is_level.then(|| libm::atan2(-target.y, -target.x) - libm::atan2(own.y, own.x))
}

/// Guides every drone with a tick that is due.
pub fn guide(
    clock: Res<Clock>,
    computers: Query<(&FlightComputer, &Sampling)>,
    mut drones: Query<(
        (&Docking, &DockingPort, PortCarrier, Option<&Docked>),
        (&FlightStatus, &Air),
        &mut PortObserver,
        &mut Guidance,
        &mut LatchState,
        &mut FlightReference,
    )>,
    targets: Query<(PortCarrier, &Acceleration)>,
    riders: Query<&Docked>,
) {
    for (computer, sampling) in &computers {
        if !sampling.is_due(clock.time_s) {
            continue;
        }
        let Ok((what, state, mut observer, mut guidance, mut latch, mut reference)) =
            drones.get_mut(computer.0)
        else {
            continue;
        };
        let (docking, port, own, docked) = what;
        let Ok((target, acceleration)) = targets.get(latch.target) else {
            continue;
        };
        let own = own.motion();
        let seen = observer.look(clock.time_s, &own, &target.motion(), acceleration.0);
        let view = View {
            time_s: clock.time_s,
            period_s: sampling.period_s(),
            own,
            seen,
            flight: *state.0,
            wind_m_s: state.1.velocity_m_s,
            taken: docked.is_none() && riders.iter().any(|rider| rider.carrier == latch.target),
        };
        *reference = guidance.tick(docking, port, &view);
        latch.is_armed = guidance.phase == DockingPhase::Contact && docked.is_none();
    }
}

#[cfg(test)]
mod tests;
