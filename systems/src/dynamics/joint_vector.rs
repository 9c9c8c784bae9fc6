//! The state in joint coordinates, those of the second formulation.
//!
//! Coordinates, body by body and then link by link: a base has six (displacement from its [`Origin`] and
//! the rotation vector of the local chart), another body the rotation vector alone, a point none, a link
//! three ([`crate::denoc::joint_coordinates`]). Where everything else is follows from there, before any
//! force is asked for.

use aerobot_components::body::Moving;
use aerobot_components::state::{
    AngularVelocity, Attitude, ChartAttitude, Origin, Position, Velocity,
};
use aerobot_components::tether::{TetherNode, TetherPoint};
use bevy_ecs::change_detection::DetectChangesMut;
use bevy_ecs::entity::Entity;
use bevy_ecs::query::{QueryState, With, Without};
use bevy_ecs::world::World;
use glam::DVec3;

use super::anchors::on_path;
use super::first_order::FirstOrderStates;
use super::link_mechanism::LinkMechanism;
use super::rotation_chart::{exponential, rotation_rate};
use super::state_space::{Layout, StateSpace};
use crate::clock::Clock;
use crate::denoc::joint_coordinates::LinkChart;
use crate::denoc::kinematics::{BodyState, LinkStates, PointState, sweep_outward};
use crate::denoc::stage_system::JointPlaces;
use crate::denoc::tree::LinkKind;
use crate::fault::Fault;
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

/// Where in the state the coordinates of a body begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum BodyPlace {
    /// Of a base: displacement, then rotation.
    Base(usize),
    /// Of a carried body that turns: rotation.
    Turning(usize),
    /// A carried point has none.
    Point,
}

impl BodyPlace {
    fn rotation(self) -> Option<usize> {
        match self {
            Self::Base(at) => Some(at + 3),
            Self::Turning(at) => Some(at),
            Self::Point => None,
        }
    }
}

/// Moves joint coordinates between a flat vector and the components of a world.
pub struct JointVector {
    layout: Layout,
    places: Vec<BodyPlace>,
    first_link: usize,
    charts: Vec<LinkChart>,
    kinds: Vec<LinkKind>,
    links: LinkStates,
    bodies: Vec<BodyState>,
    anchors: Vec<BodyState>,
    points: Vec<PointState>,
    body_query: QueryState<Bodies, Without<TetherNode>>,
    node_query: QueryState<Nodes, With<TetherNode>>,
    anchor_query: QueryState<Anchors>,
    first_order: FirstOrderStates,
}

impl JointVector {
    /// For the tree in the [`LinkMechanism`] of `world`, with this number of first-order states.
    pub fn new(world: &mut World, first_order: usize) -> Self {
        let mechanism = world.resource::<LinkMechanism>();
        let (tree, entities) = (&mechanism.tree, &mechanism.entities);
        let mut coordinates = 0;
        let mut places = Vec::new();
        for (carried_by, turns) in tree.carried_by.iter().zip(&entities.turns) {
            places.push(match (carried_by, turns) {
                (None, _) => BodyPlace::Base(coordinates),
                (Some(_), true) => BodyPlace::Turning(coordinates),
                (Some(_), false) => BodyPlace::Point,
            });
            coordinates += match (carried_by, turns) {
                (None, _) => 6,
                (Some(_), true) => 3,
                (Some(_), false) => 0,
            };
        }
        let kinds: Vec<LinkKind> = tree
            .limbs
            .iter()
            .zip(&tree.kinds)
            .flat_map(|(limb, kind)| std::iter::repeat_n(*kind, limb.links.len()))
            .collect();
        let zeros = vec![DVec3::ZERO; tree.links];
        Self {
            layout: Layout {
                coordinates: coordinates + 3 * tree.links,
                first_order,
            },
            places,
            first_link: coordinates,
            charts: vec![LinkChart::default(); tree.links],
            kinds,
            links: LinkStates {
                span_m: zeros.clone(),
                rate_m_s: zeros,
            },
            bodies: vec![BodyState::default(); entities.bodies.len()],
            anchors: vec![BodyState::default(); tree.limbs.len()],
            points: vec![PointState::default(); entities.points],
            body_query: world.query_filtered(),
            node_query: world.query_filtered(),
            anchor_query: world.query(),
            first_order: FirstOrderStates::new(world),
        }
    }

    /// Where in the state the joint coordinates stand.
    #[must_use]
    pub fn places(&self) -> JointPlaces {
        let displacement = |place: &BodyPlace| match place {
            BodyPlace::Base(at) => Some(*at),
            BodyPlace::Turning(_) | BodyPlace::Point => None,
        };
        let bodies = self.places.iter();
        JointPlaces {
            bodies: bodies
                .map(|place| (displacement(place), place.rotation()))
                .collect(),
            first_link: self.first_link,
            coordinates: self.layout.coordinates,
        }
    }

    /// Positions and velocities of tether points and bodies as the components have them.
    fn read_components(&mut self, world: &mut World) {
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
        for (index, limb) in mechanism.tree.limbs.iter().enumerate() {
            let offsets = mechanism.entities.offsets[index];
            let parent = limb
                .parent
                .map_or(&self.anchors[index], |body| &self.bodies[body]);
            self.points[limb.proximal_point()] = parent.place(offsets.proximal_m);
            let last = limb.distal_point(limb.links.len() - 1);
            self.points[last] = self.bodies[limb.child].place(offsets.distal_m);
        }
    }

    /// Where the anchors are at the time of the evaluation that is to come.
    fn read_anchors(&mut self, world: &World) {
        let time_s = world.resource::<Clock>().time_s;
        let anchors = &world.resource::<LinkMechanism>().entities.anchors;
        for (state, anchor) in self.anchors.iter_mut().zip(anchors) {
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
    fn write_components(&mut self, world: &mut World) {
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
        mechanism.links.clone_from(&self.links);
        mechanism.bodies.copy_from_slice(&self.bodies);
    }
}

impl StateSpace for JointVector {
    fn layout(&self) -> Layout {
        self.layout
    }

    fn gather(&mut self, world: &mut World, state: &mut [f64]) {
        self.read_components(world);
        let n = self.layout.coordinates;
        state.fill(0.0);
        for (index, origin, mut chart, position, attitude, velocity, rate) in
            self.body_query.iter_mut(world)
        {
            let place = self.places[index.0];
            chart.0 = attitude.0;
            if let BodyPlace::Base(at) = place {
                (position.0 - origin.0).write_to_slice(&mut state[at..]);
                velocity.0.write_to_slice(&mut state[n + at..]);
            }
            if let Some(at) = place.rotation() {
                rate.0.write_to_slice(&mut state[n + at..]);
            }
        }
        let tree = &world.resource::<LinkMechanism>().tree;
        for (limb, kind) in tree.limbs.iter().zip(&tree.kinds) {
            let mut before = self.points[limb.proximal_point()];
            for (k, link) in limb.links.clone().enumerate() {
                let here = self.points[limb.distal_point(k)];
                let (chart, rate) = LinkChart::around(
                    here.position_m - before.position_m,
                    here.velocity_m_s - before.velocity_m_s,
                    kind.length_m,
                    kind.stretch,
                );
                self.charts[link] = chart;
                rate.write_to_slice(&mut state[n + self.first_link + 3 * link..]);
                before = here;
            }
        }
        self.first_order.gather(world, &mut state[2 * n..]);
    }

    fn scatter(&mut self, world: &mut World, state: &[f64]) -> Result<(), Fault> {
        let (coordinates, rest) = state.split_at(self.layout.coordinates);
        let (velocities, first_order) = rest.split_at(self.layout.coordinates);
        for (index, origin, chart, ..) in self.body_query.iter(world) {
            let place = self.places[index.0];
            let body = &mut self.bodies[index.0];
            if let BodyPlace::Base(at) = place {
                body.centre = PointState {
                    position_m: origin.0 + DVec3::from_slice(&coordinates[at..]),
                    velocity_m_s: DVec3::from_slice(&velocities[at..]),
                };
            }
            body.attitude = chart.0;
            if let Some(at) = place.rotation() {
                body.attitude = chart.0 * exponential(DVec3::from_slice(&coordinates[at..]));
                body.rate_rad_s = DVec3::from_slice(&velocities[at..]);
            }
        }
        let (q, _) = coordinates[self.first_link..].as_chunks::<3>();
        let (q_rate, _) = velocities[self.first_link..].as_chunks::<3>();
        let joints = q
            .iter()
            .zip(q_rate)
            .zip(self.charts.iter().zip(&self.kinds));
        let spans = self.links.span_m.iter_mut().zip(&mut self.links.rate_m_s);
        let mut beyond = None;
        for (link, (((q, q_rate), (chart, kind)), (span, rate))) in joints.zip(spans).enumerate() {
            let (q, q_rate) = (DVec3::from_array(*q), DVec3::from_array(*q_rate));
            match chart.span(q, q_rate, kind.length_m, kind.stretch) {
                Some(found) => (*span, *rate) = found,
                None => beyond = beyond.or(Some(link)),
            }
        }
        if let Some(link) = beyond {
            return Err(Fault {
                entity: Some(world.resource::<LinkMechanism>().entities.segments[link]),
                message: "a link turns by more than 80 degrees in one step".to_owned(),
            });
        }
        self.read_anchors(world);
        let mechanism = world.resource::<LinkMechanism>();
        sweep_outward(
            &mechanism.tree,
            &self.links,
            &mechanism.entities.offsets,
            &self.anchors,
            &mut self.bodies,
            &mut self.points,
        );
        self.write_components(world);
        self.first_order.scatter(world, first_order);
        Ok(())
    }

    fn gather_rates(&mut self, world: &mut World, state: &[f64], rates: &mut [f64]) {
        let n = self.layout.coordinates;
        rates[..n].copy_from_slice(&state[n..2 * n]);
        let found = &world.resource::<LinkMechanism>().accelerations;
        for (place, motion) in self.places.iter().zip(&found.bodies) {
            if let BodyPlace::Base(at) = *place {
                motion.linear.write_to_slice(&mut rates[n + at..]);
            }
            if let Some(at) = place.rotation() {
                let rotation = DVec3::from_slice(&state[at..]);
                let rate = DVec3::from_slice(&state[n + at..]);
                rotation_rate(rotation, rate).write_to_slice(&mut rates[at..]);
                motion.angular.write_to_slice(&mut rates[n + at..]);
            }
        }
        let (out, _) = rates[n + self.first_link..2 * n].as_chunks_mut::<3>();
        let links = self.charts.iter().zip(&self.kinds).zip(&found.span_m_s2);
        for (out, ((chart, kind), span)) in out.iter_mut().zip(links) {
            *out = chart
                .acceleration(*span, kind.length_m, kind.stretch)
                .to_array();
        }
        self.first_order.gather_rates(world, &mut rates[2 * n..]);
    }

    fn recentre(&mut self, world: &mut World, state: &mut [f64], rates: &mut [f64]) {
        let n = self.layout.coordinates;
        for (index, _, mut chart, _, mut attitude, _, _) in self.body_query.iter_mut(world) {
            let Some(at) = self.places[index.0].rotation() else {
                continue;
            };
            let rotation = &mut state[at..at + 3];
            chart.0 = (chart.0 * exponential(DVec3::from_slice(rotation))).normalize();
            attitude.0 = chart.0;
            rotation.fill(0.0);
            rates[at..at + 3].copy_from_slice(&state[n + at..n + at + 3]);
        }
        let found = &world.resource::<LinkMechanism>().accelerations.span_m_s2;
        let spans = self.links.span_m.iter().zip(&self.links.rate_m_s);
        let links = self.charts.iter_mut().zip(&self.kinds).zip(spans);
        for (link, (((chart, kind), (span, rate)), found)) in links.zip(found).enumerate() {
            let at = self.first_link + 3 * link;
            let (centre, rate) = LinkChart::around(*span, *rate, kind.length_m, kind.stretch);
            let acceleration = centre.acceleration(*found, kind.length_m, kind.stretch);
            *chart = centre;
            state[at..at + 3].fill(0.0);
            rate.write_to_slice(&mut state[n + at..]);
            rate.write_to_slice(&mut rates[at..]);
            acceleration.write_to_slice(&mut rates[n + at..]);
        }
    }

    fn error_scales(&mut self, world: &mut World) -> Vec<f64> {
        let mut scales = vec![1.0; self.layout.len()];
        let first = 2 * self.layout.coordinates;
        self.first_order.error_scales(world, &mut scales[first..]);
        scales
    }

    fn owner(&mut self, world: &mut World, place: usize) -> Option<Entity> {
        let place = place % self.layout.coordinates.max(1);
        let entities = &world.resource::<LinkMechanism>().entities;
        if place >= self.first_link {
            return entities
                .segments
                .get((place - self.first_link) / 3)
                .copied();
        }
        let starts = |at: &BodyPlace| match at {
            BodyPlace::Base(at) | BodyPlace::Turning(at) => Some(*at),
            BodyPlace::Point => None,
        };
        let body = self
            .places
            .iter()
            .rposition(|at| starts(at).is_some_and(|at| at <= place))?;
        Some(entities.bodies[body])
    }
}
