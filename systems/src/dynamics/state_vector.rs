//! The state in absolute coordinates, those of the lumped formulation: every node and every body by itself.
//!
//! Layout: coordinates, then their velocities in the same order, then first-order states. A node has
//! three coordinates (displacement from its [`Origin`], m), a free body six (displacement and the
//! rotation vector of the local chart, rad); the velocities are m/s and rad/s in the body frame.

use aerobot_components::state::{
    Acceleration, AngularAcceleration, AngularVelocity, Attitude, ChartAttitude, Origin, Position,
    StateIndex, Velocity,
};
use aerobot_components::tether::TetherNode;
use bevy_ecs::change_detection::DetectChangesMut;
use bevy_ecs::entity::Entity;
use bevy_ecs::query::{QueryState, With, Without};
use bevy_ecs::world::World;
use glam::DVec3;

use super::first_order::FirstOrderStates;
use super::rotation_chart::{exponential, rotation_rate};
use super::state_space::{Layout, StateSpace};
use crate::fault::Fault;
use crate::integration::Correction;

/// Coordinates that a node of a tether has.
pub const NODE_COORDINATES: usize = 3;
/// Coordinates that a free body has.
pub const BODY_COORDINATES: usize = 6;

type Nodes = (
    &'static StateIndex,
    &'static Origin,
    &'static mut Position,
    &'static mut Velocity,
);
type Bodies = (
    &'static StateIndex,
    &'static Origin,
    &'static mut ChartAttitude,
    &'static mut Position,
    &'static mut Attitude,
    &'static mut Velocity,
    &'static mut AngularVelocity,
);
type BodyRates = (
    &'static StateIndex,
    &'static Acceleration,
    &'static AngularAcceleration,
);

/// Moves states between a flat vector and the components of a world.
pub struct StateVector {
    layout: Layout,
    nodes: QueryState<Nodes, With<TetherNode>>,
    node_rates: QueryState<(&'static StateIndex, &'static Acceleration), With<TetherNode>>,
    bodies: QueryState<Bodies, Without<TetherNode>>,
    body_rates: QueryState<BodyRates, Without<TetherNode>>,
    first_order: FirstOrderStates,
    owners: QueryState<(&'static StateIndex, Entity)>,
}

impl StateVector {
    /// For the entities of `world`, whose indices agree with `layout`.
    pub fn new(world: &mut World, layout: Layout) -> Self {
        Self {
            layout,
            nodes: world.query_filtered(),
            node_rates: world.query_filtered(),
            bodies: world.query_filtered(),
            body_rates: world.query_filtered(),
            first_order: FirstOrderStates::new(world),
            owners: world.query(),
        }
    }
}

impl StateSpace for StateVector {
    fn layout(&self) -> Layout {
        self.layout
    }

    fn gather(&mut self, world: &mut World, state: &mut [f64]) {
        let n = self.layout.coordinates;
        state.fill(0.0);
        for (index, origin, position, velocity) in self.nodes.iter(world) {
            (position.0 - origin.0).write_to_slice(&mut state[index.0..]);
            velocity.0.write_to_slice(&mut state[n + index.0..]);
        }
        for (index, origin, _, position, _, velocity, rate) in self.bodies.iter(world) {
            (position.0 - origin.0).write_to_slice(&mut state[index.0..]);
            velocity.0.write_to_slice(&mut state[n + index.0..]);
            rate.0.write_to_slice(&mut state[n + index.0 + 3..]);
        }
        self.first_order.gather(world, &mut state[2 * n..]);
    }

    fn scatter(&mut self, world: &mut World, state: &[f64]) -> Result<(), Fault> {
        let (coordinates, rest) = state.split_at(self.layout.coordinates);
        let (velocities, first_order) = rest.split_at(self.layout.coordinates);
        for (index, origin, mut position, mut velocity) in self.nodes.iter_mut(world) {
            position.bypass_change_detection().0 =
                origin.0 + DVec3::from_slice(&coordinates[index.0..]);
            velocity.bypass_change_detection().0 = DVec3::from_slice(&velocities[index.0..]);
        }
        for (index, origin, chart, mut position, mut attitude, mut velocity, mut rate) in
            self.bodies.iter_mut(world)
        {
            position.0 = origin.0 + DVec3::from_slice(&coordinates[index.0..]);
            attitude.0 = chart.0 * exponential(DVec3::from_slice(&coordinates[index.0 + 3..]));
            velocity.0 = DVec3::from_slice(&velocities[index.0..]);
            rate.0 = DVec3::from_slice(&velocities[index.0 + 3..]);
        }
        self.first_order.scatter(world, first_order);
        Ok(())
    }

    fn gather_rates(&mut self, world: &mut World, state: &[f64], rates: &mut [f64]) {
        let n = self.layout.coordinates;
        rates[..n].copy_from_slice(&state[n..2 * n]);
        for (index, acceleration) in self.node_rates.iter(world) {
            acceleration.0.write_to_slice(&mut rates[n + index.0..]);
        }
        for (index, linear, angular) in self.body_rates.iter(world) {
            let rotation = DVec3::from_slice(&state[index.0 + 3..]);
            let rate = DVec3::from_slice(&state[n + index.0 + 3..]);
            rotation_rate(rotation, rate).write_to_slice(&mut rates[index.0 + 3..]);
            linear.0.write_to_slice(&mut rates[n + index.0..]);
            angular.0.write_to_slice(&mut rates[n + index.0 + 3..]);
        }
        self.first_order.gather_rates(world, &mut rates[2 * n..]);
    }

    fn recentre(&mut self, world: &mut World, state: &mut [f64], rates: &mut [f64]) -> Correction {
        let n = self.layout.coordinates;
        for (index, _, mut chart, _, mut attitude, _, _) in self.bodies.iter_mut(world) {
            let rotation = &mut state[index.0 + 3..index.0 + 6];
            chart.0 = (chart.0 * exponential(DVec3::from_slice(rotation))).normalize();
            attitude.0 = chart.0;
            rotation.fill(0.0);
            let velocity = n + index.0 + 3;
            rates[index.0 + 3..index.0 + 6].copy_from_slice(&state[velocity..velocity + 3]);
        }
        Correction::None
    }

    fn error_scales(&mut self, world: &mut World) -> Vec<f64> {
        let n = self.layout.coordinates;
        let mut scales = vec![1.0; self.layout.len()];
        self.first_order.error_scales(world, &mut scales[2 * n..]);
        scales
    }

    fn owner(&mut self, world: &mut World, place: usize) -> Option<Entity> {
        let place = place % self.layout.coordinates.max(1);
        self.owners
            .iter(world)
            .filter(|(start, _)| start.0 <= place)
            .max_by_key(|(start, _)| start.0)
            .map(|(_, entity)| entity)
    }
}
