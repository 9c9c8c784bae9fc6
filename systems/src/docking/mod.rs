//! Docking: where ports are against each other, how a drone sees one and goes there, and what a latch does when it
//! closes, holds and opens.

pub mod guidance;
pub mod impact;
pub mod observer;
pub mod ports;
pub mod ridden_body;
