//! The built-in families of components and systems, each a plugin like any user's.

pub mod actuators;
pub mod aerodynamics;
pub mod bodies;
pub mod channels;
pub mod docking;
pub mod environment;
pub mod events;
pub mod fixed_wing;
pub mod gusts;
pub mod links;
pub mod recorder;
pub mod rotorcraft;
pub mod sails;
pub mod slack_events;
pub mod tethers;
pub mod torsion;
pub mod winches;

use aerobot_components::copies::Copies;

use crate::plugin::Simulator;
use crate::schedule::Phase;

/// Registers all of them. The order is that of their setups, and of their systems within a phase.
pub(crate) fn register(simulator: &mut Simulator) {
    simulator
        .register_component::<Copies>()
        .add_plugin(&environment::EnvironmentPlugin)
        .add_plugin(&bodies::BodiesPlugin)
        .add_plugin(&aerodynamics::AerodynamicsPlugin)
        .add_plugin(&fixed_wing::FixedWingPlugin)
        .add_plugin(&actuators::ActuatorsPlugin)
        .add_plugin(&sails::SailsPlugin)
        .add_plugin(&tethers::TethersPlugin)
        .add_plugin(&torsion::TorsionPlugin)
        .add_plugin(&winches::WinchesPlugin)
        .add_plugin(&rotorcraft::RotorcraftPlugin)
        .add_plugin(&docking::DockingPlugin)
        .add_plugin(&bodies::MotionPlugin)
        .add_plugin(&links::LinksPlugin)
        .add_plugin(&docking::RidersPlugin)
        .add_plugin(&winches::WinchPowerPlugin)
        .add_plugin(&channels::ChannelsPlugin)
        .add_plugin(&slack_events::SlackEventsPlugin)
        .add_plugin(&recorder::RecorderPlugin)
        .add_plugin(&events::EventsPlugin)
        .add_systems(Phase::Integrate, || crate::evaluation::integrate);
}
