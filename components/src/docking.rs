//! Docking: ports, the latch that joins two bodies at theirs, and the guidance of a drone that goes there.

use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use glam::{DQuat, DVec3};
use serde::Deserialize;

use crate::scene_component::{FieldReport, SceneComponent};

/// Where a body can be joined to another.
#[derive(Component, Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct DockingPort {
    /// Its place on the body, body frame, m.
    pub at_m: DVec3,
    /// Outward, body frame; any length above zero. The axes of two ports that are joined oppose each other.
    pub axis: DVec3,
}

impl SceneComponent for DockingPort {
    const NAME: &'static str = "DockingPort";
    const EXCLUDES: &'static [&'static str] = &["Tether"];
    const REQUIRES: &'static [&'static [&'static str]] = &[&["Body", "Fixed", "Moving"]];

    fn check(&self, report: &mut FieldReport) {
        report.finite_vector("at_m", self.at_m);
        report.finite_vector("axis", self.axis);
        if self.axis == DVec3::ZERO {
            report.add("axis", "the axis of a port needs a direction", "");
        }
    }
}

/// A latch at the port of a body: closes onto the port of another when both are near, slow and aligned.
#[derive(Component, Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Latch {
    /// The body with the other port.
    pub to: String,
    /// Largest distance of the ports, m.
    #[serde(default = "distance_m")]
    pub distance_m: f64,
    /// Largest speed of one port against the other, m/s.
    #[serde(default = "speed_m_s")]
    pub speed_m_s: f64,
    /// Largest angle between one axis and the opposite of the other, rad.
    #[serde(default = "angle_rad")]
    pub angle_rad: f64,
    /// Time between two looks at these, s.
    #[serde(default = "look_every_s")]
    pub period_s: f64,
}

fn distance_m() -> f64 {
    0.3
}
fn speed_m_s() -> f64 {
    0.5
}
fn angle_rad() -> f64 {
    15.0_f64.to_radians()
}
fn look_every_s() -> f64 {
    0.05
}

impl SceneComponent for Latch {
    const NAME: &'static str = "Latch";
    const EXCLUDES: &'static [&'static str] = &["Fixed", "Moving", "AddedMass", "Tether"];
    const REQUIRES: &'static [&'static [&'static str]] = &[&["Body"], &["DockingPort"]];

    fn check(&self, report: &mut FieldReport) {
        report.positive("distance_m", self.distance_m);
        report.positive("speed_m_s", self.speed_m_s);
        report.positive("angle_rad", self.angle_rad);
        report.positive("period_s", self.period_s);
        if self.angle_rad > std::f64::consts::PI {
            report.add(
                "angle_rad",
                format!("`angle_rad` must not be above pi, it is {}", self.angle_rad),
                "an angle in radians",
            );
        }
    }
}

/// What a latch is doing.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub struct LatchState {
    /// The body with the other port.
    pub target: Entity,
    /// Whether it closes when it can.
    pub is_armed: bool,
}

/// A body that rides on another, rigidly. Its state follows from that of its carrier, which has its mass and
/// gets the forces on it.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct Docked {
    /// The other body.
    pub carrier: Entity,
    /// Where its centre of mass is, body frame of the carrier, m.
    pub offset_m: DVec3,
    /// Its attitude, its frame to that of the carrier.
    pub attitude: DQuat,
}

/// The guidance of a rotorcraft to the port that its latch is for.
#[derive(Component, Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Docking {
    /// How the other port is seen.
    #[serde(default)]
    pub navigation: Navigation,
    /// Distance in front of the port at which station is kept before the last part, m.
    #[serde(default = "standoff_m")]
    pub standoff_m: f64,
    /// Speed of the last part, m/s.
    #[serde(default = "closing_speed_m_s")]
    pub closing_speed_m_s: f64,
    /// Lateral error at which the last part stands still; it slows down in proportion, m.
    #[serde(default = "lateral_gate_m")]
    pub lateral_gate_m: f64,
    /// Lateral error at which the last part is given up, m.
    #[serde(default = "lateral_limit_m")]
    pub lateral_limit_m: f64,
    /// Station is kept when the error of position is below this, m, ..
    #[serde(default = "station_error_m")]
    pub station_error_m: f64,
    /// .. for this long, s.
    #[serde(default = "station_s")]
    pub station_s: f64,
    /// Approaches that may be missed.
    #[serde(default = "attempts")]
    pub attempts: u32,
    /// How long nothing may come nearer, and how long the thrust may be short, s.
    #[serde(default = "patience_s")]
    pub patience_s: f64,
}

fn standoff_m() -> f64 {
    6.0
}
fn closing_speed_m_s() -> f64 {
    0.25
}
fn lateral_gate_m() -> f64 {
    0.5
}
fn lateral_limit_m() -> f64 {
    1.0
}
fn station_error_m() -> f64 {
    0.5
}
fn station_s() -> f64 {
    2.0
}
fn attempts() -> u32 {
    5
}
fn patience_s() -> f64 {
    20.0
}

/// How a drone sees the port that it goes to.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq)]
#[serde(rename = "navigation", deny_unknown_fields)]
pub enum Navigation {
    /// As it is.
    #[default]
    Perfect,
    /// By a sensor of relative position, and an observer.
    Measured {
        /// Time between measurements, s; that of the flight computer's commands, or a multiple of it.
        period_s: f64,
        /// How late they are, s: a multiple of `period_s`.
        delay_s: f64,
        /// Standard deviation of an error along each axis, per metre of distance, ..
        noise_m_per_m: f64,
        /// .. but at least this, m, ..
        least_noise_m: f64,
        /// .. and at most this, m.
        most_noise_m: f64,
        /// Distance up to which the port is seen, m.
        range_m: f64,
        /// The three poles of the observer near the port, rad/s, ..
        observer_rad_s: f64,
        /// .. from this distance on, m; they fall with one over the distance beyond it.
        observer_near_m: f64,
        /// The stream of random numbers under the seed of the run; its place among the drones of the scene unless
        /// given.
        #[serde(default)]
        stream: Option<u32>,
    },
}

impl SceneComponent for Docking {
    const NAME: &'static str = "Docking";
    const REQUIRES: &'static [&'static [&'static str]] = &[&["Latch"], &["Rotorcraft"]];

    fn check(&self, report: &mut FieldReport) {
        for (field, value) in [
            ("standoff_m", self.standoff_m),
            ("closing_speed_m_s", self.closing_speed_m_s),
            ("lateral_gate_m", self.lateral_gate_m),
            ("lateral_limit_m", self.lateral_limit_m),
            ("station_error_m", self.station_error_m),
            ("station_s", self.station_s),
            ("patience_s", self.patience_s),
        ] {
            report.positive(field, value);
        }
        if self.attempts == 0 {
            report.add("attempts", "at least one approach has to be allowed", "");
        }
        report.within("navigation", |report| self.navigation.check(report));
    }
}

impl Navigation {
    fn check(&self, report: &mut FieldReport) {
        let Self::Measured {
            period_s,
            delay_s,
            noise_m_per_m,
            least_noise_m,
            most_noise_m,
            range_m,
            observer_rad_s,
            observer_near_m,
            stream: _,
        } = *self
        else {
            return;
        };
        report.positive("period_s", period_s);
        report.non_negative("delay_s", delay_s);
        report.non_negative("noise_m_per_m", noise_m_per_m);
        report.non_negative("least_noise_m", least_noise_m);
        report.non_negative("most_noise_m", most_noise_m);
        report.positive("range_m", range_m);
        report.positive("observer_rad_s", observer_rad_s);
        report.positive("observer_near_m", observer_near_m);
        if !is_multiple(delay_s, period_s) {
            report.add(
                "delay_s",
                format!(
                    "`delay_s` must be a multiple of `period_s`, {delay_s} is none of {period_s}"
                ),
                "measurements come at the ticks of the sensor",
            );
        }
        if least_noise_m > most_noise_m {
            report.add(
                "least_noise_m",
                format!("`least_noise_m` is {least_noise_m}, above `most_noise_m`, {most_noise_m}"),
                "",
            );
        }
        if observer_rad_s * period_s > 0.5 {
            report.add(
                "observer_rad_s",
                format!(
                    "an observer with poles of {observer_rad_s} rad/s needs more than a measurement every \
                     {period_s} s"
                ),
                "`observer_rad_s` times `period_s` may be 0.5 at most",
            );
        }
    }
}

/// Whether a time is a multiple of a period, zero included, but for round-off.
#[must_use]
pub fn is_multiple(time_s: f64, period_s: f64) -> bool {
    let times = time_s / period_s;
    (times - times.round()).abs() < 1e-6
}

/// What the guidance is doing. The numbers are those of the channel `docking_phase`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DockingPhase {
    /// The port is not seen, or not yet well: the drone drifts with the air.
    #[default]
    Search = 0,
    /// To the place in front of the port.
    Approach = 1,
    /// It is kept there.
    StationKeeping = 2,
    /// Along the port's axis until the latch closes.
    Contact = 3,
    /// The latch is closed; the rotors are stopped.
    Docked = 4,
    /// The latch was opened on command: station is kept in front of the port.
    Released = 5,
    /// The port cannot be reached: the drone drifts with the air.
    Unreachable = 6,
}

impl DockingPhase {
    /// The word for it in the events of a run.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Search => "search",
            Self::Approach => "approach",
            Self::StationKeeping => "station-keeping",
            Self::Contact => "contact",
            Self::Docked => "docked",
            Self::Released => "released",
            Self::Unreachable => "unreachable",
        }
    }
}
