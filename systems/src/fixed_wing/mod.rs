//! The fixed-wing drone: forces and moments, trim, autopilot, guidance.
//!
//! The equations of motion are those of every rigid body (`dynamics/rigid_body.rs`); here is what the air
//! and the propeller do to this one, and who steers it. Inside, axes are those of the literature: north,
//! east, down for places and velocities, forward, right, down for the body; `north_east_down.rs` is the only
//! way in and out. Source throughout: Beard and McLain, "Small Unmanned Aircraft: Theory and Practice",
//! Princeton University Press 2012, with the revisions of 2018 that the authors publish.

pub mod aerodynamics;
pub mod autopilot;
pub mod chase;
pub mod flight_trim;
pub mod gains;
pub mod guidance;
pub mod linear_model;
pub mod loads;
pub mod north_east_down;
pub mod propeller;

#[cfg(test)]
mod tests;
