//! A rotorcraft: a body with rotors whose thrust stands along its z axis, and a flight computer.

use bevy_ecs::component::Component;
use glam::{DQuat, DVec3};
use serde::Deserialize;

use crate::scene_component::{FieldReport, SceneComponent};

/// A rotorcraft drone: rotors, motors and the gains of its flight computer.
#[derive(Component, Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Rotorcraft {
    /// Number of rotors.
    pub rotors: u32,
    /// Diameter of each, m.
    pub rotor_diameter_m: f64,
    /// Power that all motors together can give to their shafts, W.
    pub motor_power_w: f64,
    /// Part of the shaft power that momentum theory would ask for.
    #[serde(default = "figure_of_merit")]
    pub figure_of_merit: f64,
    /// Largest thrust over density, disc area and the square of the tip speed.
    #[serde(default = "thrust_coefficient")]
    pub thrust_coefficient: f64,
    /// Largest speed of the blades' tips, m/s.
    #[serde(default = "tip_speed_m_s")]
    pub tip_speed_m_s: f64,
    /// Time constant of the thrust, s.
    #[serde(default = "thrust_lag_s")]
    pub thrust_lag_s: f64,
    /// Delay with which the attitude follows a slow command, s: two over the natural frequency of a loop that is
    /// critically damped.
    #[serde(default = "attitude_lag_s")]
    pub attitude_lag_s: f64,
    /// Largest torque of the rotors about each axis of the body, N m.
    #[serde(default = "largest_torque_n_m")]
    pub largest_torque_n_m: f64,
    /// Largest tilt of the thrust that the flight computer asks for, rad.
    #[serde(default = "largest_tilt_rad")]
    pub largest_tilt_rad: f64,
    /// Velocity that an error of position asks for, 1/s.
    #[serde(default = "position_gain_per_s")]
    pub position_gain_per_s: f64,
    /// Acceleration that an error of velocity asks for, 1/s.
    #[serde(default = "velocity_gain_per_s")]
    pub velocity_gain_per_s: f64,
    /// Largest speed against the reference that an error of position asks for, m/s.
    #[serde(default = "largest_speed_m_s")]
    pub largest_speed_m_s: f64,
    /// Time between two commands of the flight computer, s.
    #[serde(default = "period_s")]
    pub period_s: f64,
    /// What it flies along unless something else guides it.
    #[serde(default)]
    pub course: Course,
}

/// What a rotorcraft flies along.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq)]
#[serde(rename = "course", deny_unknown_fields)]
pub enum Course {
    /// It stays where it starts, in the inertial frame.
    #[default]
    Hold,
    /// It drifts with the horizontal wind at its altitude.
    Drift,
    /// It follows a point that moves on a straight line.
    Along {
        /// Where the point starts, inertial frame, m.
        position_m: DVec3,
        /// How it moves, inertial frame, m/s.
        #[serde(default)]
        velocity_m_s: DVec3,
        /// Heading of the body's x axis about z from the inertial x, rad.
        #[serde(default)]
        heading_rad: f64,
    },
}

fn figure_of_merit() -> f64 {
    0.65
}
fn thrust_coefficient() -> f64 {
    0.012
}
fn tip_speed_m_s() -> f64 {
    150.0
}
fn thrust_lag_s() -> f64 {
    0.05
}
fn attitude_lag_s() -> f64 {
    0.15
}
fn largest_torque_n_m() -> f64 {
    10.0
}
fn largest_tilt_rad() -> f64 {
    0.5
}
fn position_gain_per_s() -> f64 {
    0.6
}
fn velocity_gain_per_s() -> f64 {
    2.0
}
fn largest_speed_m_s() -> f64 {
    3.0
}
fn period_s() -> f64 {
    0.05
}

impl Rotorcraft {
    /// Area of all discs, m^2.
    #[must_use]
    pub fn disc_area_m2(&self) -> f64 {
        let radius_m = 0.5 * self.rotor_diameter_m;
        f64::from(self.rotors) * std::f64::consts::PI * radius_m * radius_m
    }
}

impl SceneComponent for Rotorcraft {
    const NAME: &'static str = "Rotorcraft";
    const EXCLUDES: &'static [&'static str] = &["Fixed", "Moving", "Tether"];
    const REQUIRES: &'static [&'static [&'static str]] = &[&["Body"], &["Pose"]];

    fn check(&self, report: &mut FieldReport) {
        if self.rotors == 0 {
            report.add("rotors", "a rotorcraft has at least one rotor", "");
        }
        for (field, value) in [
            ("rotor_diameter_m", self.rotor_diameter_m),
            ("motor_power_w", self.motor_power_w),
            ("figure_of_merit", self.figure_of_merit),
            ("thrust_coefficient", self.thrust_coefficient),
            ("tip_speed_m_s", self.tip_speed_m_s),
            ("thrust_lag_s", self.thrust_lag_s),
            ("attitude_lag_s", self.attitude_lag_s),
            ("largest_torque_n_m", self.largest_torque_n_m),
            ("largest_tilt_rad", self.largest_tilt_rad),
            ("position_gain_per_s", self.position_gain_per_s),
            ("velocity_gain_per_s", self.velocity_gain_per_s),
            ("largest_speed_m_s", self.largest_speed_m_s),
            ("period_s", self.period_s),
        ] {
            report.positive(field, value);
        }
        if self.figure_of_merit > 1.0 {
            report.add(
                "figure_of_merit",
                format!(
                    "`figure_of_merit` must not be above 1, it is {}",
                    self.figure_of_merit
                ),
                "it is the part of the shaft power that momentum theory would ask for",
            );
        }
        if self.largest_tilt_rad > 1.2 {
            report.add(
                "largest_tilt_rad",
                format!(
                    "`largest_tilt_rad` must be below 1.2, it is {}",
                    self.largest_tilt_rad
                ),
                "an angle in radians",
            );
        }
        if let Course::Along {
            position_m,
            velocity_m_s,
            heading_rad,
        } = &self.course
        {
            report.within("course", |report| {
                report.finite_vector("position_m", *position_m);
                report.finite_vector("velocity_m_s", *velocity_m_s);
                report.finite("heading_rad", *heading_rad);
            });
        }
    }
}

/// What the flight computer is to follow, as of its last tick.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct FlightReference {
    /// Where the point of the body is to be, inertial frame, m; without one velocity alone counts.
    pub position_m: Option<DVec3>,
    /// How it is to move, inertial frame, m/s.
    pub velocity_m_s: DVec3,
    /// With which acceleration, inertial frame, m/s^2.
    pub acceleration_m_s2: DVec3,
    /// Heading of the body's x axis, rad.
    pub heading_rad: f64,
    /// The point, body frame, m.
    pub point_m: DVec3,
}

/// What the flight computer asks of rotors and attitude; held between its ticks.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct RotorCommand {
    /// Thrust, N.
    pub thrust_n: f64,
    /// Attitude, body to inertial.
    pub attitude: DQuat,
    /// Whether the rotors are stopped: no thrust and no torque is asked for.
    pub is_idle: bool,
}

/// What the flight computer has found at its last tick.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct FlightStatus {
    /// Thrust that it would have needed, N.
    pub needed_thrust_n: f64,
    /// Thrust that rotors and motors can give in this air, N.
    pub largest_thrust_n: f64,
    /// Whether the tilt stood at its limit.
    pub is_tilt_limited: bool,
}
