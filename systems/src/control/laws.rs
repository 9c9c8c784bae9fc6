//! Sampled laws. With e_k the errors (target less measured) at sample k, T the period:
//!
//! ```text
//! proportional     u = K e
//! PID              u = K e + I + D       D = (T_f D + K_d (e - e_last))/(T_f + T)
//!                  then I grows by K_i T e + min(T/T_t, 1) (command - u)
//! state feedback   u = bias + sum K_i clip(e_i, c_i)
//! ```
//!
//! The command is u within the limits and no further from the last command than the rate limit allows; what
//! is cut is taken back from the integral with the time constant T_t (back-calculation, Åström and Hägglund
//! 2006, sec. 3.5). D is the backward difference of K_d s/(1 + T_f s).

use aerobot_components::actuator::Command;
use aerobot_components::control::{BoundController, Controller, Law, LawState};
use aerobot_components::sampling::Sampling;
use bevy_ecs::system::{Query, Res};

use super::measuring::{Measured, error_of, quantity};
use crate::clock::Clock;

/// Samples every controller that is due, and commands its actuator.
pub fn sample_controllers(
    clock: Res<Clock>,
    mut controllers: Query<(&Controller, &BoundController, &mut Sampling, &mut LawState)>,
    bodies: Query<Measured>,
    mut actuators: Query<&mut Command>,
) {
    for (controller, bound, mut sampling, mut state) in &mut controllers {
        if !sampling.is_due(clock.time_s) {
            continue;
        }
        sampling.done(clock.time_s);
        let errors: Vec<f64> = bound
            .measurements
            .iter()
            .map(|measurement| {
                error_of(measurement, |part| {
                    let (_, kind, entity) = measurement.parts[part];
                    // Only bodies are bound.
                    bodies
                        .get(entity)
                        .map_or(f64::NAN, |body| quantity(kind, body))
                })
            })
            .collect();
        let command = sample(controller, bound.range, &errors, &mut state);
        if let Ok(mut held) = actuators.get_mut(bound.actuator) {
            held.0 = command;
        }
    }
}

/// The command that follows from the errors of a sample, within `range` (least, largest).
pub fn sample(
    controller: &Controller,
    range: (f64, f64),
    errors: &[f64],
    state: &mut LawState,
) -> f64 {
    let period_s = controller.period_s;
    let first = errors.first().copied().unwrap_or(0.0);
    let within = |wanted: f64, last: f64| {
        let limited = match controller.rate_limit_per_s {
            Some(rate) => wanted.clamp(last - rate * period_s, last + rate * period_s),
            None => wanted,
        };
        limited.clamp(range.0, range.1)
    };
    let command = match &controller.law {
        Law::Proportional { gain, .. } => within(gain * first, state.command),
        Law::StateFeedback { terms, bias } => {
            let wanted = terms.iter().zip(errors).fold(*bias, |sum, (term, error)| {
                let clip = term.clip.unwrap_or(f64::INFINITY);
                sum + term.gain * error.clamp(-clip, clip)
            });
            within(wanted, state.command)
        }
        Law::Pid {
            proportional,
            integral_per_s,
            derivative_s,
            filter_s,
            anti_windup_s,
            ..
        } => {
            let change = first - state.error.unwrap_or(first);
            state.derivative =
                (filter_s * state.derivative + derivative_s * change) / (filter_s + period_s);
            let wanted = proportional * first + state.integral + state.derivative;
            let command = within(wanted, state.command);
            if *integral_per_s != 0.0 {
                let own_s = (proportional / integral_per_s).abs();
                let back = match anti_windup_s.unwrap_or(own_s) {
                    0.0 => 1.0,
                    time_s => (period_s / time_s).min(1.0),
                };
                state.integral += integral_per_s * period_s * first + back * (command - wanted);
            }
            state.error = Some(first);
            command
        }
    };
    state.command = command;
    command
}

#[cfg(test)]
mod tests;
