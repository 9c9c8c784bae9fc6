//! What stops a run: the first thing that goes wrong is kept, with the entity and the reason.

use bevy_ecs::entity::Entity;
use bevy_ecs::resource::Resource;

/// Something that makes the evaluation of a state meaningless.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Where it happened, if it belongs to an entity.
    pub entity: Option<Entity>,
    /// What happened, as a sentence without the time and the entity.
    pub message: String,
}

/// Holds the first fault of an evaluation until the engine takes it.
#[derive(Resource, Debug, Default)]
pub struct FaultSlot(Option<Fault>);

impl FaultSlot {
    /// Reports a fault; later ones of the same evaluation are its consequences and are dropped.
    pub fn report(&mut self, entity: Option<Entity>, message: impl FnOnce() -> String) {
        if self.0.is_none() {
            self.0 = Some(Fault {
                entity,
                message: message(),
            });
        }
    }

    /// Takes the fault, if there is one.
    pub fn take(&mut self) -> Option<Fault> {
        self.0.take()
    }
}
