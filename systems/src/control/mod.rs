//! Controllers, schedules and the actuators that they command.

pub mod actuators;
pub mod laws;
pub mod measuring;
pub mod schedules;
