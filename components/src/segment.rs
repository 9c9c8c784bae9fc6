//! Segments of a tether in the running world: Kelvin-Voigt elements with the drag of the line.

use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use glam::DVec3;

/// A segment between two consecutive points of a tether.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segment {
    /// The tether's entity.
    pub tether: Entity,
    /// Number from 1 at the tether's `from`.
    pub number: u32,
    /// Index of the point on the side of `from`; the other one is the next.
    pub from_point: usize,
}

/// Spring and damper in parallel: T = k (L - L0) + c dL/dt.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct KelvinVoigt {
    /// Rest length L0, m.
    pub rest_length_m: f64,
    /// Stiffness k of the segment, N/m.
    pub stiffness_n_m: f64,
    /// Damping c of the segment, N s/m.
    pub damping_n_s_m: f64,
    /// Whether it goes slack: no force where L <= L0, and never a push.
    pub slack: bool,
}

/// Drag of a segment of a line.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct SegmentDrag {
    /// Diameter d, m.
    pub diameter_m: f64,
    /// Normal coefficient C_n.
    pub normal: f64,
    /// Tangential coefficient C_t.
    pub tangential: f64,
}

/// Where a segment is and how it moves, found anew in every evaluation.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct SegmentGeometry {
    /// Unit vector from the `from` end to the `to` end, inertial frame; zero for a segment of no
    /// length.
    pub direction: DVec3,
    /// Length L, m.
    pub length_m: f64,
    /// Rate of change of the length dL/dt, m/s.
    pub length_rate_m_s: f64,
    /// Midpoint, inertial frame, m.
    pub midpoint_m: DVec3,
    /// Mean velocity of the two ends, inertial frame, m/s.
    pub velocity_m_s: DVec3,
}

/// Tension of a segment, N: positive pulls its ends together.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct Tension(pub f64);

/// Forces that a segment passes to its two ends, inertial frame, N.
///
/// Cleared at the start of every evaluation; springs, drag and a user's own laws add to it.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct SegmentLoad {
    /// On the end at `from`.
    pub from_n: DVec3,
    /// On the end at `to`.
    pub to_n: DVec3,
}

/// Marks a segment that keeps its length: a rigid link, whose tension is a force of constraint.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RigidLink;

/// Marks a segment that was cut: it has no [`KelvinVoigt`] and no [`SegmentDrag`] any more, and nothing
/// passes through it. Its two ends keep the halves of its mass.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Severed;
