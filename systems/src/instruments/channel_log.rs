//! Where instruments, controllers and built-in channels put what they record.

use std::collections::BTreeSet;

use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use bevy_ecs::resource::Resource;

/// One recorded value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Whose channel it is; the whole system's where there is none.
    pub entity: Option<Entity>,
    /// Name of the channel, with its unit.
    pub channel: &'static str,
    /// The value, in that unit.
    pub value: f64,
}

/// Samples of the current time, until the engine makes rows of them.
#[derive(Resource, Debug, Default)]
pub struct ChannelLog {
    samples: Vec<Sample>,
}

impl ChannelLog {
    /// Records a value of `entity`; the name of a channel ends in its unit, as `pressure_pa`.
    pub fn record(&mut self, entity: Entity, channel: &'static str, value: f64) {
        self.samples.push(Sample {
            entity: Some(entity),
            channel,
            value,
        });
    }

    /// Records a value of the whole system.
    pub fn record_system(&mut self, channel: &'static str, value: f64) {
        self.samples.push(Sample {
            entity: None,
            channel,
            value,
        });
    }

    /// Whether there is nothing to take.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.samples.is_empty()
    }

    /// Takes all samples.
    pub fn drain(&mut self) -> impl Iterator<Item = Sample> + '_ {
        self.samples.drain(..)
    }
}

/// The built-in channels that an entity records.
#[derive(Component, Clone, Debug, Default, PartialEq, Eq)]
pub struct BuiltInChannels(pub BTreeSet<&'static str>);

impl BuiltInChannels {
    /// Whether `channel` is among them.
    #[must_use]
    pub fn has(&self, channel: &str) -> bool {
        self.0.contains(channel)
    }
}
