//! Why a run stops before its end, in words: the time, the entity, the likely cause.

use aerobot_systems::integration::StepFailure;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;

use crate::builtin::recorder::segment_name;
use crate::evaluation::with_integration;
use crate::recording::summary::Stop;
use crate::simulation::Simulation;
use crate::world::EntityName;

impl Simulation {
    /// What a step that could not be taken from `time_s` means for a reader.
    pub(crate) fn explain(&mut self, failure: &StepFailure, time_s: f64) -> Stop {
        let remedy = match self.step_s {
            Some(step_s) if self.stable_step.step_s.is_infinite() => format!(
                "; the step is {step_s:.4e} s and no tether limits it, but drag or spin may: choose a \
                 shorter step, or `Auto()`"
            ),
            Some(step_s) => format!(
                "; the step is {step_s:.4e} s and the largest stable one was {:.4e} s at the start \
                 (segment `{}`): choose a shorter step, or `Auto()`",
                self.stable_step.step_s, self.stable_step.segment
            ),
            None => String::new(),
        };
        let (entity, reason) = match failure {
            StepFailure::Fault(fault) => {
                let entity = fault
                    .entity
                    .and_then(|entity| owner_name(&self.world, entity));
                (entity, fault.message.clone())
            }
            StepFailure::NotFinite { index } => (
                self.name_of_state(*index),
                format!("the motion is no longer a finite number{remedy}"),
            ),
            StepFailure::Runaway { index, value } => (
                self.name_of_state(*index),
                format!("the motion grows beyond all bounds ({value:.3e}){remedy}"),
            ),
            StepFailure::NotSolvable { index } => (
                self.name_of_state(*index),
                "no step is short enough to be solved for: a derivative that a plugin supplies pushes \
                 without bound"
                    .to_owned(),
            ),
            StepFailure::StepTooSmall { step_s, index } => (
                self.name_of_state(*index),
                format!(
                    "no step is short enough for the error asked for (tried {step_s:.3e} s): a force \
                     that jumps, or a tolerance below round-off"
                ),
            ),
        };
        Stop {
            time_s,
            entity,
            reason,
        }
    }

    /// The entity to which a place in the state belongs.
    fn name_of_state(&mut self, index: usize) -> Option<String> {
        with_integration(&mut self.world, |world, integration| {
            let state = &mut integration.state;
            if index >= 2 * state.layout().coordinates {
                return None;
            }
            let owner = state.owner(world, index)?;
            owner_name(world, owner)
        })?
    }
}

/// The name of an entity, or of the tether that a segment belongs to.
pub(crate) fn owner_name(world: &World, entity: Entity) -> Option<String> {
    if let Some(name) = world.get::<EntityName>(entity) {
        return Some(name.0.to_string());
    }
    let (tether, segment) = segment_name(world, entity);
    (segment > 0).then_some(tether)
}
