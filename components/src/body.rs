//! Rigid bodies, how they start, and anchors.

use bevy_ecs::component::Component;
use glam::{DQuat, DVec3};
use serde::Deserialize;

use crate::inertia::InertiaShape;
use crate::scene_component::{FieldReport, SceneComponent};

/// A rigid body: a gondola, a probe, the envelope of a balloon with its gas.
#[derive(Component, Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// Mass, kg; of a balloon: envelope and gas together.
    pub mass_kg: f64,
    /// How the mass is spread; a point unless said.
    #[serde(default)]
    pub inertia: InertiaShape,
}

impl SceneComponent for Body {
    const NAME: &'static str = "Body";

    fn check(&self, report: &mut FieldReport) {
        report.positive("mass_kg", self.mass_kg);
        report.within("inertia", |report| self.inertia.check(report));
    }
}

/// Where a body starts. A body without one hangs where static equilibrium in still air puts it.
#[derive(Component, Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Pose {
    /// Position of the centre of mass in the inertial frame, m; z is the altitude.
    pub position_m: DVec3,
    /// Attitude, body to inertial; upright unless said.
    #[serde(default)]
    pub attitude: AttitudeSpec,
}

impl SceneComponent for Pose {
    const NAME: &'static str = "Pose";
    const EXCLUDES: &'static [&'static str] = &["Moving"];
    const REQUIRES: &'static [&'static [&'static str]] = &[&["Body", "Fixed"]];

    fn check(&self, report: &mut FieldReport) {
        report.finite_vector("position_m", self.position_m);
        report.within("attitude", |report| self.attitude.check(report));
    }
}

/// An attitude as a scene writes it.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq)]
#[serde(rename = "attitude", deny_unknown_fields)]
pub enum AttitudeSpec {
    /// The body frame parallel to the inertial frame.
    #[default]
    Upright,
    /// A quaternion (x, y, z, w), body to inertial; normalised when read.
    Quaternion(f64, f64, f64, f64),
    /// A turn by an angle about an axis of the inertial frame.
    AxisAngle {
        /// The axis; any length above zero.
        axis: DVec3,
        /// The angle, rad.
        angle_rad: f64,
    },
    /// Yaw about z, then pitch about y, then roll about x, each about the turned body's axes.
    YawPitchRoll {
        /// Yaw, rad.
        yaw_rad: f64,
        /// Pitch, rad.
        pitch_rad: f64,
        /// Roll, rad.
        roll_rad: f64,
    },
}

impl AttitudeSpec {
    /// The unit quaternion.
    #[must_use]
    pub fn quaternion(&self) -> DQuat {
        match *self {
            Self::Upright => DQuat::IDENTITY,
            Self::Quaternion(x, y, z, w) => DQuat::from_xyzw(x, y, z, w).normalize(),
            Self::AxisAngle { axis, angle_rad } => {
                DQuat::from_axis_angle(axis.normalize(), angle_rad)
            }
            Self::YawPitchRoll {
                yaw_rad,
                pitch_rad,
                roll_rad,
            } => {
                DQuat::from_rotation_z(yaw_rad)
                    * DQuat::from_rotation_y(pitch_rad)
                    * DQuat::from_rotation_x(roll_rad)
            }
        }
    }

    fn check(&self, report: &mut FieldReport) {
        match *self {
            Self::Upright => {}
            Self::Quaternion(x, y, z, w) => {
                let norm = (x * x + y * y + z * z + w * w).sqrt();
                if !(norm.is_finite() && (norm - 1.0).abs() < 1e-3) {
                    report.add(
                        "",
                        format!("a quaternion of attitude has length 1, this one {norm}"),
                        "the order is (x, y, z, w)",
                    );
                }
            }
            Self::AxisAngle { axis, angle_rad } => {
                report.finite("angle_rad", angle_rad);
                let length = axis.length();
                if !(length.is_finite() && length > 0.0) {
                    report.add("axis", "an axis must be finite and not zero", "");
                }
            }
            Self::YawPitchRoll {
                yaw_rad,
                pitch_rad,
                roll_rad,
            } => {
                report.finite("yaw_rad", yaw_rad);
                report.finite("pitch_rad", pitch_rad);
                report.finite("roll_rad", roll_rad);
            }
        }
    }
}

/// How a body, or the nodes of a tether, move at the start; at rest unless said.
#[derive(Component, Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Motion {
    /// Velocity in the inertial frame, m/s.
    #[serde(default)]
    pub velocity_m_s: DVec3,
    /// Angular velocity in the body frame (p, q, r), rad/s.
    #[serde(default)]
    pub rate_rad_s: DVec3,
}

impl SceneComponent for Motion {
    const NAME: &'static str = "Motion";
    const EXCLUDES: &'static [&'static str] = &["Fixed", "Moving"];
    const REQUIRES: &'static [&'static [&'static str]] = &[&["Body", "Tether"]];

    fn check(&self, report: &mut FieldReport) {
        report.finite_vector("velocity_m_s", self.velocity_m_s);
        report.finite_vector("rate_rad_s", self.rate_rad_s);
    }
}

/// An anchor: the entity, with whatever body it has, is held.
///
/// Where: at `position_m`; without it, at the entity's `Pose`, or where its `Sphere` floats.
#[derive(Component, Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Fixed {
    /// Position in the inertial frame, m; z is the altitude.
    #[serde(default)]
    pub position_m: Option<DVec3>,
    /// Attitude, body to inertial; upright unless said.
    #[serde(default)]
    pub attitude: AttitudeSpec,
}

impl SceneComponent for Fixed {
    const NAME: &'static str = "Fixed";
    const EXCLUDES: &'static [&'static str] = &["Moving"];

    fn check(&self, report: &mut FieldReport) {
        if let Some(position_m) = self.position_m {
            report.finite_vector("position_m", position_m);
        }
        report.within("attitude", |report| self.attitude.check(report));
    }
}

/// An anchor that moves on a given path: p(t) = p0 + v t + a sin(omega t + phase), held upright.
#[derive(Component, Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Moving {
    /// The point p0 about which it moves, m.
    pub position_m: DVec3,
    /// The steady part of its velocity v, m/s.
    #[serde(default)]
    pub velocity_m_s: DVec3,
    /// Amplitude a of its oscillation along each axis, m.
    #[serde(default)]
    pub amplitude_m: DVec3,
    /// Angular frequency omega of the oscillation, rad/s.
    #[serde(default)]
    pub frequency_rad_s: f64,
    /// Phase of the oscillation at time zero, rad.
    #[serde(default)]
    pub phase_rad: f64,
}

impl SceneComponent for Moving {
    const NAME: &'static str = "Moving";

    fn check(&self, report: &mut FieldReport) {
        report.finite_vector("position_m", self.position_m);
        report.finite_vector("velocity_m_s", self.velocity_m_s);
        report.finite_vector("amplitude_m", self.amplitude_m);
        report.non_negative("frequency_rad_s", self.frequency_rad_s);
        report.finite("phase_rad", self.phase_rad);
    }
}

/// Marks, in a running world, an entity whose position is prescribed and not integrated.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Anchor;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn yaw_turns_x_towards_y() {
        let yaw = AttitudeSpec::YawPitchRoll {
            yaw_rad: std::f64::consts::FRAC_PI_2,
            pitch_rad: 0.0,
            roll_rad: 0.0,
        };
        assert!((yaw.quaternion() * DVec3::X - DVec3::Y).length() < 1e-15);
        let axis = AttitudeSpec::AxisAngle {
            axis: DVec3::new(0.0, 0.0, 3.0),
            angle_rad: std::f64::consts::FRAC_PI_2,
        };
        assert!((axis.quaternion() * DVec3::X - DVec3::Y).length() < 1e-15);
    }
}
