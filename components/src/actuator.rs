//! Actuators: a named scalar of an entity (the deflection of a rudder) that follows a command within limits,
//! at a limited rate and with a lag.

use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use serde::Deserialize;

use crate::scene_component::FieldReport;

/// What an actuator can do; a part of the component that has one. The unit of its value is the owner's: rad
/// for a rudder.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename = "actuator", deny_unknown_fields)]
pub struct ActuatorLimits {
    /// Largest command to either side, in the unit of the value; commands beyond it are cut.
    pub limit: f64,
    /// Largest rate of the value, per second; any unless given. Needs a lag.
    #[serde(default)]
    pub rate_per_s: Option<f64>,
    /// Time constant of the lag, s; none unless given, and then the value is the command.
    #[serde(default)]
    pub lag_s: f64,
}

impl ActuatorLimits {
    /// Reports what cannot be.
    pub fn check(&self, report: &mut FieldReport) {
        report.non_negative("limit", self.limit);
        report.non_negative("lag_s", self.lag_s);
        let Some(rate_per_s) = self.rate_per_s else {
            return;
        };
        report.positive("rate_per_s", rate_per_s);
        if self.lag_s == 0.0 {
            report.add(
                "rate_per_s",
                "a limited rate needs a lag: the value follows its command by d' = (command - d)/lag, cut at the rate",
                "give `lag_s`, small against the period of the commands",
            );
        }
    }

    /// A command within the limits.
    #[must_use]
    pub fn cut(&self, command: f64) -> f64 {
        command.clamp(-self.limit, self.limit)
    }
}

/// An actuator of a running world: an entity of its own.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct Actuator {
    /// The entity that has it.
    pub owner: Entity,
    /// What it can do.
    pub limits: ActuatorLimits,
    /// Where its value and its command are recorded.
    pub channels: ActuatorChannels,
}

/// Names of the channels of an actuator, each with its unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ActuatorChannels {
    /// Of its value.
    pub value: &'static str,
    /// Of its command.
    pub command: &'static str,
}

/// What an actuator is to do, in the unit of its value. A controller writes it in `Control` and leaves it; it
/// is held until the next sample.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct Command(pub f64);

/// What an actuator does now: what its owner's laws read.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct ActuatorValue(pub f64);
