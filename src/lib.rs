//! The command line of `aerobot` as a library, so that a program with plugins of its own has it
//! whole: `aerobot::cli::main(&[&MyPlugin])`.
//!
//! A program that wants the results and not the files runs a scene itself:
//!
//! ```
//! use std::path::Path;
//! use aerobot::engine::plugin::Simulator;
//! use aerobot::engine::recording::frame::MemorySink;
//!
//! let simulator = Simulator::new();
//! let overrides = ["run.duration_s=2".to_owned()];
//! let scene = simulator.load(Path::new("scenes/paper/comparison_900m.ron"), &overrides)?;
//! let mut results = MemorySink::default();
//! let summary = simulator.build(&scene)?.run(&mut results, &mut |_time_s| {});
//! assert_eq!(summary.outcome, "done");
//! assert_eq!(results.positions("balloon").len(), 3);
//! # Ok::<(), aerobot::engine::scene::SceneError>(())
//! ```

pub mod cli;
pub mod comparison;
pub mod reproduce;

pub use aerobot_components as components;
pub use aerobot_engine as engine;
pub use aerobot_systems as systems;
