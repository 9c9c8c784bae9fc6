//! Brings stochastic gusts to the time of an evaluation, before the air is looked at.

use bevy_ecs::system::{Res, ResMut};

use super::EnvironmentModel;
use crate::clock::Clock;

/// Makes the time of the clock the present of the gusts; the wind is a function of time alone, whoever asks.
pub fn advance_gusts(clock: Res<Clock>, mut environment: ResMut<EnvironmentModel>) {
    environment.wind.advance_gusts(clock.time_s);
}
