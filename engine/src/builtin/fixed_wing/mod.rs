//! Fixed-wing drones: forces, the start in trim, the autopilot that samples and holds, what is recorded and told.

mod checks;
mod control;
mod instruments;
mod start;

use aerobot_components::fixed_wing::FixedWing;
use aerobot_systems::fixed_wing::loads::fixed_wing_loads;
use bevy_ecs::schedule::IntoScheduleConfigs;
use bevy_ecs::system::Res;

use aerobot_systems::clock::Clock;

use super::recorder::Recorder;
use crate::plugin::{Plugin, Simulator};
use crate::schedule::Phase;

pub use start::{DroneTrim, describe};

/// Fixed-wing drones.
pub struct FixedWingPlugin;

impl Plugin for FixedWingPlugin {
    fn build(&self, simulator: &mut Simulator) {
        simulator
            .register_component::<FixedWing>()
            .add_check(checks::check)
            .add_setup(start::set_up)
            .add_systems_for::<FixedWing, _, _>(Phase::Control, || control::control)
            .add_systems_for::<FixedWing, _, _>(Phase::Forces, || fixed_wing_loads)
            .add_systems_for::<FixedWing, _, _>(Phase::Observe, || {
                (
                    instruments::record.run_if(channels_due),
                    instruments::tell_stalls,
                )
                    .chain()
            });
    }
}

fn channels_due(clock: Res<Clock>, recorder: Res<Recorder>) -> bool {
    recorder.channels_due(clock.time_s)
}
