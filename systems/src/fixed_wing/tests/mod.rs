//! Trim, linear model, loops and guidance of the drone, without a world.

mod flight;
mod loops;
mod trim;
