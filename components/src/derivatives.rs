//! Derivatives of forces, by which an implicit integrator takes long steps over stiff motion.
//!
//! A law supplies derivatives where it is stiff; a law that does not is integrated all the same, with
//! its full order, as long as it alone is not stiff. They are zeroed and found anew once per step.

use bevy_ecs::component::Component;
use glam::DMat3;

/// Derivatives of the forces of a segment.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct SegmentDerivatives {
    /// Change of tension with length dT/dL, N/m: what it is while the segment is taut.
    pub axial_stiffness_n_m: f64,
    /// Change of tension with the rate of length, N s/m: what it is while the segment is taut.
    pub axial_damping_n_s_m: f64,
    /// Tension over length T/L, N/m: the stiffness across the segment; not negative.
    pub geometric_stiffness_n_m: f64,
    /// By how much the segment is too short to be taut, m; zero or less if it is taut.
    pub gap_m: f64,
    /// How fast the gap closes, m/s.
    pub closing_m_s: f64,
    /// Minus the change of the drag of the whole segment with its velocity, inertial frame, N s/m;
    /// symmetric. Half of it counts at each end.
    pub drag_n_s_m: DMat3,
}

impl Default for SegmentDerivatives {
    /// No derivatives. (Not derived: the default of a matrix in glam is the identity.)
    fn default() -> Self {
        Self {
            axial_stiffness_n_m: 0.0,
            axial_damping_n_s_m: 0.0,
            geometric_stiffness_n_m: 0.0,
            gap_m: 0.0,
            closing_m_s: 0.0,
            drag_n_s_m: DMat3::ZERO,
        }
    }
}

/// Derivatives of the force on a body or on a node of a tether, inertial frame.
///
/// Free bodies have it; a plugin with a stiff force on nodes inserts it on them.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct ForceDerivatives {
    /// dF/dx, N/m.
    pub by_position_n_m: DMat3,
    /// dF/dv, N s/m.
    pub by_velocity_n_s_m: DMat3,
}

impl Default for ForceDerivatives {
    /// No derivatives.
    fn default() -> Self {
        Self {
            by_position_n_m: DMat3::ZERO,
            by_velocity_n_s_m: DMat3::ZERO,
        }
    }
}

/// Derivatives of the torque on a body about its centre of mass, body frame.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct TorqueDerivatives {
    /// Change with a small rotation, N m/rad.
    pub by_rotation_n_m: DMat3,
    /// Change with the angular velocity, N m s.
    pub by_rate_n_m_s: DMat3,
}

impl Default for TorqueDerivatives {
    /// No derivatives.
    fn default() -> Self {
        Self {
            by_rotation_n_m: DMat3::ZERO,
            by_rate_n_m_s: DMat3::ZERO,
        }
    }
}
