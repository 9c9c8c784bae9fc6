//! Events of tethers that go slack and taut again.

use std::collections::BTreeMap;

use aerobot_components::segment::{KelvinVoigt, Segment, SegmentGeometry};
use bevy_ecs::entity::Entity;
use bevy_ecs::system::{Local, Query, Res, ResMut};

use aerobot_systems::clock::Clock;

use super::tethers::has_springs;
use crate::plugin::{Plugin, Simulator};
use crate::schedule::Phase;
use crate::world::{EntityName, EventLog};

/// Logs when a tether first has a slack segment, and when it has none again.
pub struct SlackEventsPlugin;

impl Plugin for SlackEventsPlugin {
    fn build(&self, simulator: &mut Simulator) {
        simulator.add_systems_in(Phase::Observe, has_springs, || log_slack);
    }
}

fn log_slack(
    clock: Res<Clock>,
    mut events: ResMut<EventLog>,
    segments: Query<(&Segment, &KelvinVoigt, &SegmentGeometry)>,
    names: Query<&EntityName>,
    mut counts: Local<BTreeMap<Entity, (usize, usize)>>,
) {
    for (_, now) in counts.values_mut() {
        *now = 0;
    }
    for (segment, spring, geometry) in &segments {
        if spring.slack && geometry.length_m < spring.rest_length_m {
            counts.entry(segment.tether).or_default().1 += 1;
        }
    }
    for (tether, (before, now)) in counts.iter_mut() {
        let kind = match (*before > 0, *now > 0) {
            (false, true) => "slack",
            (true, false) => "taut",
            _ => continue,
        };
        let name = names.get(*tether).map_or("", |name| &name.0);
        events.add(clock.time_s, kind, name);
    }
    for (before, now) in counts.values_mut() {
        *before = *now;
    }
}
