//! The command line of `aerobot` as a library, so that a program with plugins of its own has it
//! whole: `aerobot::cli::main(&[&MyPlugin])`.

pub mod cli;

pub use aerobot_components as components;
pub use aerobot_engine as engine;
pub use aerobot_systems as systems;
