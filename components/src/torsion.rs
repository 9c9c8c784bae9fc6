//! Torsion of tethers: what a scene says of it, and what it is in the running world.

use std::ops::Range;

use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use glam::DVec3;
use serde::Deserialize;

use crate::scene_component::FieldReport;

/// How a tether resists being twisted: torque = (GJ / L) twist + c (rate of twist), L its rest length.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename = "torsion", deny_unknown_fields)]
pub struct TetherTorsion {
    /// Torsional stiffness GJ, N m^2.
    pub stiffness_n_m2: f64,
    /// Torsional damping c of the whole tether, N m s (per rad).
    #[serde(default)]
    pub damping_n_m_s: f64,
    /// Twist of the line as its ends are placed, rad: of `to` against `from`, right-handed about the
    /// direction from `from` to `to`; any number of turns.
    #[serde(default)]
    pub twist_rad: f64,
}

impl TetherTorsion {
    /// Reports what is wrong with the fields.
    pub(crate) fn check(&self, report: &mut FieldReport) {
        report.non_negative("stiffness_n_m2", self.stiffness_n_m2);
        report.non_negative("damping_n_m_s", self.damping_n_m_s);
        report.finite("twist_rad", self.twist_rad);
    }
}

/// The torsion of a tether in the running world.
#[derive(Component, Clone, Debug, PartialEq)]
pub struct Torsion {
    /// Stiffness GJ / L, N m (per rad).
    pub stiffness_n_m: f64,
    /// Damping c, N m s (per rad).
    pub damping_n_m_s: f64,
    /// Indices of the tether's points, from attachment to attachment.
    pub points: Range<usize>,
    /// The end at `from`.
    pub from: ClampedEnd,
    /// The end at `to`.
    pub to: ClampedEnd,
}

/// How a body or an anchor holds the end of a tether against turning: unit vectors in its body frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClampedEnd {
    /// What holds it.
    pub carrier: Entity,
    /// The axis along which the line leaves `from`, or arrives at `to`.
    pub axis: DVec3,
    /// A direction across the axis: the two are parallel, carried along the line, where it is not twisted.
    pub across: DVec3,
}

/// The twist of a tether, found anew in every evaluation.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct Twist {
    /// Twist, turns included, rad.
    pub twist_rad: f64,
    /// Its rate, rad/s.
    pub rate_rad_s: f64,
    /// Torque along the line, N m: positive turns `from` along the twist and `to` against it.
    pub torque_n_m: f64,
    /// How the twist grows as `from` is turned against it and as `to` is turned: d twist = `to_arm` .
    /// (turn of `to`) - `from_arm` . (turn of `from`), inertial frame. Along the line where that is straight.
    pub from_arm: DVec3,
    /// See `from_arm`.
    pub to_arm: DVec3,
}

/// The twist of the last accepted state, from which its turns are counted.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct AcceptedTwist {
    /// Twist, rad.
    pub twist_rad: f64,
    /// Its rate, rad/s.
    pub rate_rad_s: f64,
    /// Time of the state, s.
    pub time_s: f64,
}
