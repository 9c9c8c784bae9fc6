//! Forces on bodies and nodes as a function of their displacements and velocities about the steady state.

use aerobot_components::segment::{KelvinVoigt, RigidLink};
use aerobot_components::state::{
    AngularVelocity, Attitude, FirstOrderState, Force, Position, Torque, Velocity,
};
use aerobot_systems::dynamics::first_order::FirstOrderIndex;
use aerobot_systems::dynamics::rotation_chart::exponential;
use aerobot_systems::fault::Fault;
use bevy_ecs::entity::Entity;
use bevy_ecs::query::Without;
use bevy_ecs::world::World;
use glam::DVec3;

use super::sites::Sites;
use crate::evaluation::Evaluation;

/// A world whose parts are moved about.
pub(super) struct DisplacedForces<'a> {
    pub(super) world: &'a mut World,
    pub(super) evaluation: &'a mut Evaluation,
    pub(super) sites: &'a Sites,
    /// First-order states that take part, with their values in the steady state.
    pub(super) first_order: Vec<(Entity, f64)>,
}

/// A place in the space of displacements x, velocities v and first-order states w about the steady state.
#[derive(Clone, Debug)]
pub(super) struct Displaced {
    pub(super) x: Vec<f64>,
    pub(super) v: Vec<f64>,
    pub(super) w: Vec<f64>,
}

impl Displaced {
    pub(super) fn zeros(coordinates: usize, first_order: usize) -> Self {
        Self {
            x: vec![0.0; coordinates],
            v: vec![0.0; coordinates],
            w: vec![0.0; first_order],
        }
    }
}

impl DisplacedForces<'_> {
    /// Forces (inertial frame, N) and torques (body frame, N m) by coordinate, then rates of first-order
    /// states.
    pub(super) fn evaluate(&mut self, at: &Displaced, out: &mut [f64]) -> Result<(), Fault> {
        self.put(at);
        self.evaluation.run(self.world)?;
        for site in &self.sites.all {
            let entity = self.world.entity(site.entity);
            let force = entity.get::<Force>().map_or(DVec3::ZERO, |force| force.0);
            force.write_to_slice(&mut out[site.at..]);
            if site.turns
                && let (Some(torque), Some(attitude)) =
                    (entity.get::<Torque>(), entity.get::<Attitude>())
            {
                let torque_n_m = attitude.0.conjugate() * torque.0;
                torque_n_m.write_to_slice(&mut out[site.at + 3..]);
            }
        }
        let rates = &mut out[at.x.len()..];
        for (rate, (entity, _)) in rates.iter_mut().zip(&self.first_order) {
            let state = self.world.get::<FirstOrderState>(*entity);
            *rate = state.map_or(0.0, |state| state.rate_per_s);
        }
        Ok(())
    }

    /// Moves everything to its place.
    pub(super) fn put(&mut self, at: &Displaced) {
        for site in &self.sites.all {
            let mut entity = self.world.entity_mut(site.entity);
            if let Some(mut position) = entity.get_mut::<Position>() {
                position.0 = site.position_m + DVec3::from_slice(&at.x[site.at..]);
            }
            if let Some(mut velocity) = entity.get_mut::<Velocity>() {
                velocity.0 = site.velocity_m_s + DVec3::from_slice(&at.v[site.at..]);
            }
            if !site.turns {
                continue;
            }
            if let Some(mut attitude) = entity.get_mut::<Attitude>() {
                let turn = exponential(DVec3::from_slice(&at.x[site.at + 3..]));
                attitude.0 = site.attitude * turn;
            }
            if let Some(mut rate) = entity.get_mut::<AngularVelocity>() {
                rate.0 = site.rate_rad_s + DVec3::from_slice(&at.v[site.at + 3..]);
            }
        }
        for ((entity, value), change) in self.first_order.iter().zip(&at.w) {
            if let Some(mut state) = self.world.get_mut::<FirstOrderState>(*entity) {
                state.value = value + change;
            }
        }
    }
}

/// All first-order states of a world, in the order of the state.
pub(super) fn first_order_states(world: &mut World) -> Vec<(Entity, f64)> {
    let mut found: Vec<(usize, Entity, f64)> = world
        .query::<(&FirstOrderIndex, Entity, &FirstOrderState)>()
        .iter(world)
        .map(|(place, entity, state)| (place.0, entity, state.value))
        .collect();
    found.sort_by_key(|(place, ..)| *place);
    found
        .into_iter()
        .map(|(_, entity, value)| (entity, value))
        .collect()
}

/// Takes the springs out of a world and gives them, to be put back. What is left of the forces changes
/// gently with place, so that its differences have no round-off of altitudes times stiffness.
pub(super) fn take_springs(world: &mut World) -> Vec<(Entity, KelvinVoigt)> {
    let mut springs = world.query_filtered::<(Entity, &mut KelvinVoigt), Without<RigidLink>>();
    springs
        .iter_mut(world)
        .map(|(entity, mut spring)| {
            let own = *spring;
            *spring = KelvinVoigt {
                stiffness_n_m: 0.0,
                damping_n_s_m: 0.0,
                slack: false,
                ..own
            };
            (entity, own)
        })
        .collect()
}

/// Puts springs back.
pub(super) fn put_springs_back(world: &mut World, springs: Vec<(Entity, KelvinVoigt)>) {
    for (entity, spring) in springs {
        world.entity_mut(entity).insert(spring);
    }
}
