//! The controls of a fixed-wing drone.

use bevy_ecs::component::Component;

/// Control surfaces and throttle as they stand. Signs as in the literature: positive elevator pitches down,
/// positive aileron rolls right, positive rudder yaws left.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct Controls {
    /// Aileron, rad.
    pub aileron_rad: f64,
    /// Elevator, rad.
    pub elevator_rad: f64,
    /// Rudder, rad.
    pub rudder_rad: f64,
    /// Throttle, the part of the battery's voltage at the motor, 0 to 1.
    pub throttle: f64,
}
