//! The components of a tree of links: where its points, bodies and anchors are, read and written.

use aerobot_components::body::Moving;
use aerobot_components::state::{
    AddedInertia, AngularVelocity, Attitude, ChartAttitude, Inertia, Mass, Origin, Position,
    Velocity,
};
use aerobot_components::tether::{TetherNode, TetherPoint};
use bevy_ecs::change_detection::DetectChangesMut;
use bevy_ecs::query::{QueryState, With, Without};
use bevy_ecs::world::World;

use super::anchors::on_path;
use super::link_mechanism::LinkMechanism;
use super::links::mass_of;
use super::rigid_body::CarriedMass;
use crate::clock::Clock;
use crate::denoc::kinematics::{BodyState, LinkStates, PointState};
use crate::linearised_motion::topology::BodyIndex;

type Bodies = (
    &'static BodyIndex,
    &'static Origin,
    &'static mut ChartAttitude,
    &'static mut Position,
    &'static mut Attitude,
    &'static mut Velocity,
    &'static mut AngularVelocity,
);
type Nodes = (
    &'static TetherPoint,
    &'static mut Position,
    &'static mut Velocity,
);
type Anchors = (
    Option<&'static Moving>,
    &'static Position,
    &'static Velocity,
    &'static Attitude,
    &'static AngularVelocity,
);
type Masses = (
    &'static BodyIndex,
    &'static Mass,
    &'static AddedInertia,
    Option<&'static Inertia>,
    &'static CarriedMass,
    &'static Attitude,
);

/// The components, and what was read from them or is to be written.
pub struct TreeComponents {
    /// By index of the tether point.
    pub points: Vec<PointState>,
    /// By index of the body; then of loose nodes and of tips.
    pub bodies: Vec<BodyState>,
    /// Where loose nodes begin among the bodies.
    pub loose_from: usize,
    /// Of each limb that has one.
    pub anchors: Vec<BodyState>,
    /// Of each closure that has one.
    pub ties: Vec<BodyState>,
    pub(super) body_query: QueryState<Bodies, Without<TetherNode>>,
    node_query: QueryState<Nodes, With<TetherNode>>,
    anchor_query: QueryState<Anchors>,
    mass_query: QueryState<Masses>,
}

impl TreeComponents {
    /// Of the tree in the [`LinkMechanism`] of `world`.
    pub fn new(world: &mut World) -> Self {
        let mechanism = world.resource::<LinkMechanism>();
        let (tree, points) = (&mechanism.tree, mechanism.entities.points);
        Self {
            loose_from: mechanism.entities.bodies.len(),
            bodies: vec![BodyState::default(); tree.carried_by.len()],
            anchors: vec![BodyState::default(); tree.limbs.len()],
            ties: vec![BodyState::default(); tree.closures.len()],
            points: vec![PointState::default(); points],
            body_query: world.query_filtered(),
            node_query: world.query_filtered(),
            anchor_query: world.query(),
            mass_query: world.query(),
        }
    }

    /// Positions and velocities of tether points and bodies as the components have them.
    pub fn read(&mut self, world: &mut World) {
        for (point, position, velocity) in self.node_query.iter(world) {
            self.points[point.index] = PointState {
                position_m: position.0,
                velocity_m_s: velocity.0,
            };
        }
        for (index, _, _, position, attitude, velocity, rate) in self.body_query.iter(world) {
            self.bodies[index.0] = BodyState {
                centre: PointState {
                    position_m: position.0,
                    velocity_m_s: velocity.0,
                },
                attitude: attitude.0,
                rate_rad_s: rate.0,
            };
        }
        self.read_anchors(world);
        let mechanism = world.resource::<LinkMechanism>();
        for (body, loose) in mechanism.entities.loose_bodies() {
            self.bodies[body].centre = self.points[loose.point];
        }
        let offsets = &mechanism.entities.offsets;
        for (index, closure) in mechanism.tree.closures.iter().enumerate() {
            let onto = closure
                .onto
                .map_or(&self.ties[index], |body| &self.bodies[body]);
            self.bodies[closure.tip].centre = onto.place(offsets.ties_m[index]);
        }
        for (index, limb) in mechanism.tree.limbs.iter().enumerate() {
            let offsets = offsets.limbs[index];
            let parent = limb
                .parent
                .map_or(&self.anchors[index], |body| &self.bodies[body]);
            self.points[limb.proximal_point()] = parent.place(offsets.proximal_m);
            let last = limb.distal_point(limb.links.len() - 1);
            self.points[last] = self.bodies[limb.child].place(offsets.distal_m);
        }
    }

    /// Where the anchors are at the time of the evaluation that is to come.
    pub fn read_anchors(&mut self, world: &World) {
        let time_s = world.resource::<Clock>().time_s;
        let entities = &world.resource::<LinkMechanism>().entities;
        let limbs = self.anchors.iter_mut().zip(&entities.anchors);
        let ties = self.ties.iter_mut().zip(&entities.ties);
        for (state, anchor) in limbs.chain(ties) {
            let found = anchor.map(|anchor| self.anchor_query.get_manual(world, anchor));
            if let Some(Ok((path, position, velocity, attitude, rate))) = found {
                let (position_m, velocity_m_s) = path.map_or((position.0, velocity.0), |path| {
                    let (position_m, velocity_m_s, _) = on_path(path, time_s);
                    (position_m, velocity_m_s)
                });
                *state = BodyState {
                    centre: PointState {
                        position_m,
                        velocity_m_s,
                    },
                    attitude: attitude.0,
                    rate_rad_s: rate.0,
                };
            }
        }
    }

    /// Writes nodes and bodies, and hands the state to the mechanism.
    pub fn write(&mut self, world: &mut World, links: &LinkStates) {
        for (point, mut position, mut velocity) in self.node_query.iter_mut(world) {
            let state = &self.points[point.index];
            position.bypass_change_detection().0 = state.position_m;
            velocity.bypass_change_detection().0 = state.velocity_m_s;
        }
        for (index, _, _, mut position, mut attitude, mut velocity, mut rate) in
            self.body_query.iter_mut(world)
        {
            let state = &self.bodies[index.0];
            position.0 = state.centre.position_m;
            attitude.0 = state.attitude;
            velocity.0 = state.centre.velocity_m_s;
            rate.0 = state.rate_rad_s;
        }
        let mut mechanism = world.resource_mut::<LinkMechanism>();
        mechanism.links.clone_from(links);
        mechanism.bodies.copy_from_slice(&self.bodies);
        mechanism.ties.copy_from_slice(&self.ties);
    }

    /// Gives the mechanism the masses of its bodies as they stand.
    pub fn read_masses(&mut self, world: &mut World) {
        self.mass_query.update_archetypes(world);
        let mut masses = Vec::with_capacity(self.bodies.len());
        let lent = &world.resource::<LinkMechanism>().entities.lent;
        for (index, mass, added, inertia, carried, attitude) in self.mass_query.iter_manual(world) {
            let carried = carried.plus(&lent[index.0]);
            masses.push((index.0, mass_of(mass, added, inertia, &carried, attitude)));
        }
        let mut mechanism = world.resource_mut::<LinkMechanism>();
        for (index, block) in masses {
            let turns = mechanism.entities.turns[index];
            let body = &mut mechanism.loads.bodies[index];
            (body.mass, body.turns) = (block, turns);
        }
    }
}
