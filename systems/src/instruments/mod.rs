//! Instruments and built-in channels, one quantity a file: what is read off an accepted state.

pub mod airspeed;
pub mod attachment_tension;
pub mod attitude;
pub mod channel_log;
pub mod energy;
pub mod energy_guard;
pub mod energy_sum;
pub mod momentum;
pub mod sail;
pub mod swing;
pub mod twist;
pub mod winch;
