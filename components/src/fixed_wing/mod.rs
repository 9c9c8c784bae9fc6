//! A fixed-wing drone: its aircraft, its autopilot, what it is to do, and the air it flies in.
//!
//! Outside of this family everything stands in the inertial frame of the scene (x downwind, y to its left,
//! z up) and in a body frame with x forward, y to the left wing and z up, so that a drone without an attitude
//! of its own flies level along x. A course counts from x towards y. The aircraft's own coefficients are
//! those of the literature: body axes forward, right, down.

pub mod aircraft;
pub mod autopilot;
pub mod controls;
pub mod guidance;

use bevy_ecs::component::Component;
use glam::DVec3;
use serde::Deserialize;

use crate::scene_component::{FieldReport, SceneComponent};
use aircraft::{Aircraft, AircraftSpec};
use autopilot::AutopilotSpec;
use guidance::GuidanceSpec;

/// A fixed-wing drone with its autopilot, on an entity with a `Body` and a `Pose`.
#[derive(Component, Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct FixedWing {
    /// The aircraft; its mass and inertia are those of the `Body`.
    #[serde(default)]
    pub aircraft: AircraftSpec,
    /// The autopilot.
    #[serde(default)]
    pub autopilot: AutopilotSpec,
    /// What the drone is to do; without it the controls stay as they are at the start.
    #[serde(default)]
    pub guidance: GuidanceSpec,
    /// The air it flies in.
    #[serde(default)]
    pub wind: DroneWind,
    /// How it starts: in trim, at this airspeed and on this course.
    pub start: TrimStart,
}

/// The velocity of the air that a drone flies in.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq)]
#[serde(rename = "wind", deny_unknown_fields)]
pub enum DroneWind {
    /// The wind of the scene, gusts included.
    #[default]
    Scene,
    /// A wind of its own, the same everywhere and always, m/s, inertial frame. The density remains that of
    /// the scene.
    Uniform(f64, f64, f64),
}

impl DroneWind {
    /// The velocity of the air where the wind of the scene is `scene_m_s`, m/s, inertial frame.
    #[inline]
    #[must_use]
    pub fn velocity_m_s(&self, scene_m_s: DVec3) -> DVec3 {
        match *self {
            Self::Scene => scene_m_s,
            Self::Uniform(x, y, z) => DVec3::new(x, y, z),
        }
    }
}

/// Steady flight to start in: the attitude, the motion and the controls that keep it.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename = "start", deny_unknown_fields)]
pub enum TrimStart {
    /// Without sideslip, level and straight unless said.
    Trim {
        /// Speed through the air, m/s.
        airspeed_m_s: f64,
        /// Direction of the flight through the air, from x towards y, deg.
        #[serde(default)]
        course_deg: f64,
        /// Angle of the path above the horizontal, deg.
        #[serde(default)]
        climb_deg: f64,
        /// Rate of turn, from x towards y, deg/s.
        #[serde(default)]
        turn_deg_s: f64,
    },
}

impl TrimStart {
    /// Speed through the air, m/s.
    #[must_use]
    pub fn airspeed_m_s(&self) -> f64 {
        let Self::Trim { airspeed_m_s, .. } = *self;
        airspeed_m_s
    }

    /// Course, climb and rate of turn, rad, rad, rad/s.
    #[must_use]
    pub fn path_rad(&self) -> (f64, f64, f64) {
        let Self::Trim {
            course_deg,
            climb_deg,
            turn_deg_s,
            ..
        } = *self;
        (
            course_deg.to_radians(),
            climb_deg.to_radians(),
            turn_deg_s.to_radians(),
        )
    }

    fn check(&self, report: &mut FieldReport) {
        let Self::Trim {
            airspeed_m_s,
            course_deg,
            climb_deg,
            turn_deg_s,
        } = *self;
        report.positive("airspeed_m_s", airspeed_m_s);
        report.finite("course_deg", course_deg);
        if climb_deg.is_nan() || climb_deg.abs() >= 60.0 {
            report.add(
                "climb_deg",
                format!("`climb_deg` must lie within 60 deg of level, it is {climb_deg}"),
                "",
            );
        }
        if turn_deg_s.is_nan() || turn_deg_s.abs() >= 90.0 {
            report.add(
                "turn_deg_s",
                format!("`turn_deg_s` must lie within 90 deg/s, it is {turn_deg_s}"),
                "",
            );
        }
    }
}

impl FixedWing {
    /// The coefficients of the aircraft.
    #[must_use]
    pub fn aircraft(&self) -> Aircraft {
        self.aircraft.coefficients()
    }
}

impl SceneComponent for FixedWing {
    const NAME: &'static str = "FixedWing";
    const EXCLUDES: &'static [&'static str] = &["Fixed", "Moving", "Motion", "Rotorcraft"];
    const REQUIRES: &'static [&'static [&'static str]] = &[&["Body"], &["Pose"]];

    fn check(&self, report: &mut FieldReport) {
        report.within("aircraft", |report| self.aircraft.check(report));
        report.within("autopilot", |report| self.autopilot.check(report));
        report.within("guidance", |report| self.guidance.check(report));
        report.within("start", |report| self.start.check(report));
        if let DroneWind::Uniform(x, y, z) = self.wind {
            report.finite_vector("wind", DVec3::new(x, y, z));
        }
    }
}
