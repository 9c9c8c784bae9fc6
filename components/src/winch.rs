//! A winch at one end of a tether: what pays it out and reels it in.

use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use serde::Deserialize;

use crate::actuator::ActuatorLimits;
use crate::scene_component::{FieldReport, SceneComponent};
use crate::tether::TetherSide;

/// A winch on the body at one end of a tether, with line on its drum. The drum is a point mass at the
/// attachment, in addition to the body's own `mass_kg`.
#[derive(Component, Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Winch {
    /// The end at which it is.
    #[serde(default = "at_from")]
    pub end: TetherSide,
    /// Length of unstretched line on the drum at the start, m; reeling in may add to it.
    #[serde(default)]
    pub stored_m: f64,
    /// What turns the drum at the command of a controller or a schedule: an actuator [`DRUM_NAME`] whose value
    /// is the rate at which line leaves the drum, m/s. It follows at once; events turn a drum without it.
    #[serde(default)]
    pub drive: Option<ActuatorLimits>,
}

/// Name of the actuator of a winch with a drive.
pub const DRUM_NAME: &str = "drum";

fn at_from() -> TetherSide {
    TetherSide::From
}

impl SceneComponent for Winch {
    const NAME: &'static str = "Winch";
    const REQUIRES: &'static [&'static [&'static str]] = &[&["Tether"]];

    fn check(&self, report: &mut FieldReport) {
        report.non_negative("stored_m", self.stored_m);
        let Some(drive) = &self.drive else { return };
        report.within("drive", |report| {
            report.non_negative("limit", drive.limit);
            let late = [
                ("lag_s", drive.lag_s != 0.0),
                ("rate_per_s", drive.rate_per_s.is_some()),
            ];
            for (field, given) in late {
                if given {
                    report.add(
                        field,
                        format!("a drum turns as it is commanded, without `{field}`"),
                        "leave it out; a controller's `rate_limit_per_s` bounds how its command changes",
                    );
                }
            }
        });
    }
}

/// The line between a winch and the first point beyond it, in the running world: its unstretched length is
/// the [`FirstOrderState`](crate::state::FirstOrderState) of the same entity, in m.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct ReeledLine {
    /// The tether.
    pub tether: Entity,
    /// The segment between the winch and the point beyond.
    pub segment: Entity,
    /// The attachment at the winch.
    pub near: Entity,
    /// The point at the segment's other end.
    pub far: Entity,
    /// The drum, a mass at the attachment.
    pub drum: Entity,
    /// Axial stiffness EA, N.
    pub stiffness_n: f64,
    /// Axial damping, that of the strain rate, N s.
    pub damping_n_s: f64,
    /// Mass per unstretched length, kg/m.
    pub line_kg_m: f64,
    /// Mass at the far point that is not of this segment, kg.
    pub far_mass_kg: f64,
    /// Length of this segment and on the drum together, unstretched, m.
    pub near_and_stored_m: f64,
    /// Nominal length of a segment, m.
    pub nominal_m: f64,
    /// Rate at which line leaves the drum, m/s.
    pub rate_m_s: f64,
}

/// Marks the segment at a winch, whose unstretched length changes.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct Reeled {
    /// The [`ReeledLine`] that has its length.
    pub line: Entity,
    /// Rate of change of its unstretched length, m/s.
    pub rate_m_s: f64,
    /// The shortest that it becomes, as a part of a nominal segment.
    pub shortest_part: f64,
    /// Change of its tension with its unstretched length, N/m, where the motion was linearised last.
    pub tension_by_length_n_m: f64,
}
