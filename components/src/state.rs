//! State of motion, inertia and the accumulators of force, one entity a thing.

use bevy_ecs::component::Component;
use glam::{DMat3, DQuat, DVec3};

/// Position in the inertial frame, m; of a body: of its centre of mass.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct Position(pub DVec3);

/// Velocity in the inertial frame, m/s.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct Velocity(pub DVec3);

/// Attitude: the rotation from the body frame to the inertial frame.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct Attitude(pub DQuat);

/// Angular velocity in the body frame (p, q, r), rad/s.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct AngularVelocity(pub DVec3);

/// Mass, kg: what has weight. Added mass stands apart in [`AddedInertia`].
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct Mass(pub f64);

/// Inertia tensor about the centre of mass in the body frame, kg m^2.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct Inertia(pub DMat3);

/// Added mass of the air that moves with a body, kg: inertia without weight.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct AddedInertia(pub f64);

/// Sum of the forces on an entity in the inertial frame, N.
///
/// Cleared at the start of every evaluation; every force system adds to it.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct Force(pub DVec3);

/// Sum of the torques on a body about its centre of mass, in the inertial frame, N m.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct Torque(pub DVec3);

/// Acceleration in the inertial frame, m/s^2: what the dynamics makes of [`Force`].
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct Acceleration(pub DVec3);

/// Angular acceleration in the body frame, rad/s^2.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct AngularAcceleration(pub DVec3);

/// The air at an entity (at the midpoint of a segment).
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct Air {
    /// Density, kg/m^3.
    pub density_kg_m3: f64,
    /// Velocity of the air in the inertial frame (the wind), m/s.
    pub velocity_m_s: DVec3,
}

/// Marks what the run integrates: a free body, or a node of a tether.
///
/// The index gives the place of the entity in the state vector; it is given when the simulation is
/// built and never depends on the order of a query.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub struct StateIndex(pub usize);

/// The position, in metres, from which the integrated displacement of an entity counts.
///
/// Integrating displacements keeps the round-off of an altitude of 56 km out of the state.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct Origin(pub DVec3);

/// The attitude from which the rotation vector of the current step counts.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct ChartAttitude(pub DQuat);

/// A first-order state of a component's own (the work done so far, the lag of an actuator),
/// integrated with the motion.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct FirstOrderState {
    /// The value, in the unit of its owner.
    pub value: f64,
    /// Its rate of change, per second: written by a system in every evaluation.
    pub rate_per_s: f64,
    /// The size of an error that matters as much as 1 m does; infinite keeps it out of step control.
    pub error_scale: f64,
}
