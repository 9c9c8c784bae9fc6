//! First-order states of components in the flat state: at its end, in every formulation.

use aerobot_components::state::FirstOrderState;
use bevy_ecs::component::Component;
use bevy_ecs::query::QueryState;
use bevy_ecs::world::World;

/// Place of a first-order state among its like.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub struct FirstOrderIndex(pub usize);

/// Moves first-order states; the slices are the end of a state.
pub struct FirstOrderStates {
    states: QueryState<(&'static FirstOrderIndex, &'static mut FirstOrderState)>,
}

impl FirstOrderStates {
    /// For the entities of `world`.
    pub fn new(world: &mut World) -> Self {
        Self {
            states: world.query(),
        }
    }

    /// Reads them from the components.
    pub fn gather(&mut self, world: &mut World, values: &mut [f64]) {
        for (index, state) in self.states.iter(world) {
            values[index.0] = state.value;
        }
    }

    /// Writes them to the components.
    pub fn scatter(&mut self, world: &mut World, values: &[f64]) {
        for (index, mut state) in self.states.iter_mut(world) {
            state.value = values[index.0];
        }
    }

    /// Reads their rates.
    pub fn gather_rates(&mut self, world: &mut World, rates: &mut [f64]) {
        for (index, state) in self.states.iter(world) {
            rates[index.0] = state.rate_per_s;
        }
    }

    /// The sizes of errors that matter as much as 1 m.
    pub fn error_scales(&mut self, world: &mut World, scales: &mut [f64]) {
        for (index, state) in self.states.iter(world) {
            scales[index.0] = state.error_scale;
        }
    }
}
