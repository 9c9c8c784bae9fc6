//! The command line of aerobot with one more instrument: how to plug in your own.
//!
//! ```text
//! cargo run --release --example atmosphere_sensor -- run scenes/examples/atmosphere_sensor.ron
//! ```
//!
//! The instrument is in `plugin.rs`; read that file. This one is all that a program with plugins of
//! its own needs: every command, option and exit code of `aerobot` comes with it, and the scene
//! language knows `AtmosphereSensor` beside the built-in components. A crate outside this repository
//! depends on `aerobot`, on `serde`, and on `bevy_ecs` in the version that `aerobot` has.

mod plugin;

use std::process::ExitCode;

use plugin::AtmosphereSensorPlugin;

fn main() -> ExitCode {
    aerobot::cli::main(&[&AtmosphereSensorPlugin])
}
