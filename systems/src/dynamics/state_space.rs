//! What integrators see of a world: a flat vector of coordinates, velocities and first-order states, and its
//! way from and to the components. Each formulation has its own coordinates.

use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;

use crate::fault::Fault;
use crate::integration::Correction;

/// Sizes of the parts of a state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Layout {
    /// Number of coordinates, and of velocities.
    pub coordinates: usize,
    /// Number of first-order states.
    pub first_order: usize,
}

impl Layout {
    /// Length of the state.
    #[must_use]
    pub fn len(&self) -> usize {
        2 * self.coordinates + self.first_order
    }

    /// Whether there is nothing to integrate.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Moves states between a flat vector and the components of a world.
///
/// Layout: coordinates, then their velocities in the same order, then first-order states. Coordinates
/// count from a chart that is taken anew at every accepted state.
pub trait StateSpace: Send + Sync {
    /// Sizes of the state.
    fn layout(&self) -> Layout;

    /// Reads the state from the components, as new centres of the charts.
    fn gather(&mut self, world: &mut World, state: &mut [f64]);

    /// Writes a state to the components.
    ///
    /// # Errors
    /// The state lies beyond a chart: the step that led to it was too long.
    fn scatter(&mut self, world: &mut World, state: &[f64]) -> Result<(), Fault>;

    /// Reads the rates of `state` from the accelerations that the evaluation left.
    fn gather_rates(&mut self, world: &mut World, state: &[f64], rates: &mut [f64]);

    /// Takes an accepted state, which was evaluated last, as the new centre of all charts, in `state` and
    /// in `rates`, once it has been made to meet constraints.
    fn recentre(&mut self, world: &mut World, state: &mut [f64], rates: &mut [f64]) -> Correction;

    /// The scale of an error in each part of the state that matters as much as 1 m.
    fn error_scales(&mut self, world: &mut World) -> Vec<f64>;

    /// What the coordinate or velocity at a place in the state belongs to.
    fn owner(&mut self, world: &mut World, place: usize) -> Option<Entity>;
}
