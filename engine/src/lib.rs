//! When things happen: the world, its schedules and phases, scene loading, plugins, recording and
//! running. The only crate that orders anything; [`schedule`] is its table of contents.

pub mod balloon_sizing;
mod building;
pub mod builtin;
pub mod campaign;
pub mod contents;
mod coordinates;
pub mod design_search;
pub mod evaluation;
mod event_location;
pub mod geometry;
mod integrator_choice;
mod linearisation;
mod link_stable_step;
mod link_start;
mod link_tree;
pub mod modes;
pub mod placement;
pub mod plugin;
pub mod recording;
mod restructure;
pub mod run_folder;
pub mod scene;
pub mod schedule;
mod sequence;
pub mod simulation;
pub mod stable_step;
mod stopping;
mod summarise;
mod topology;
mod topology_change;
pub mod trim;
pub mod world;
