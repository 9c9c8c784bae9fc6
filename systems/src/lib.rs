//! What things do: the physics of a tethered balloon system as pure systems, and the mathematics
//! under them. Nothing here knows when it runs; the engine orders it.

pub mod clock;
pub mod control;
pub mod denoc;
pub mod docking;
pub mod dynamics;
pub mod environment;
pub mod fault;
pub mod fixed_wing;
pub mod forces;
pub mod gust_fit;
pub mod instruments;
pub mod integration;
pub mod linearised_motion;
pub mod modes;
pub mod nonlinear_solver;
pub mod rotorcraft;
pub mod stochastic;
pub mod towed_cable;
