//! The state in joint coordinates, those of the second formulation.
//!
//! Coordinates, body by body and then link by link: a base has six (displacement from its [`Origin`] and
//! the rotation vector of the local chart), another body the rotation vector alone, a point none, a link
//! three ([`crate::denoc::joint_coordinates`]). Where everything else is follows from there, before any
//! force is asked for.
//!
//! Read from components that the joints do not allow (a scene whose poses stretch a tether, a velocity that
//! a plugin has set), links keep their directions (`starting.rs`). Closed loops are kept closed (`closing.rs`).

mod closing;
mod starting;

use aerobot_components::state::{FirstOrderState, Origin};
use aerobot_components::winch::ReeledLine;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;
use glam::DVec3;

use super::first_order::FirstOrderStates;
use super::joint_layout::{BodyPlace, JointLayout};
use super::link_mechanism::LinkMechanism;
use super::rotation_chart::{exponential, rotation_rate};
use super::state_space::{Layout, StateSpace};
use super::tree_components::TreeComponents;
use crate::denoc::articulated_link::Stretch;
use crate::denoc::forward_dynamics::Accelerations;
use crate::denoc::joint_coordinates::LinkChart;
use crate::denoc::kinematics::{BodyState, LinkStates, PointState, sweep_outward};
use crate::denoc::stage_system::JointPlaces;
use crate::denoc::tree::LinkKind;
use crate::fault::Fault;
use crate::integration::Correction;

/// Moves joint coordinates between a flat vector and the components of a world.
pub struct JointVector {
    places: JointLayout,
    charts: Vec<LinkChart>,
    kinds: Vec<LinkKind>,
    links: LinkStates,
    components: TreeComponents,
    first_order: FirstOrderStates,
    first_order_count: usize,
    /// Where loose nodes that are bases count from, m.
    loose_origins_m: Vec<DVec3>,
    /// Scratch: a change that closes loops.
    change: Accelerations,
}

impl JointVector {
    /// For the tree in the [`LinkMechanism`] of `world`, with this number of first-order states.
    pub fn new(world: &mut World, first_order_count: usize) -> Self {
        let mechanism = world.resource::<LinkMechanism>();
        let tree = &mechanism.tree;
        let kinds: Vec<LinkKind> = tree
            .limbs
            .iter()
            .zip(&tree.kinds)
            .flat_map(|(limb, kind)| std::iter::repeat_n(*kind, limb.links.len()))
            .collect();
        let zeros = vec![DVec3::ZERO; tree.links];
        Self {
            places: JointLayout::new(mechanism),
            charts: vec![LinkChart::default(); tree.links],
            kinds,
            links: LinkStates {
                span_m: zeros.clone(),
                rate_m_s: zeros,
            },
            components: TreeComponents::new(world),
            first_order: FirstOrderStates::new(world),
            first_order_count,
            loose_origins_m: Vec::new(),
            change: world.resource::<LinkMechanism>().accelerations.clone(),
        }
    }

    /// Where in the state the joint coordinates stand.
    #[must_use]
    pub fn places(&self) -> JointPlaces {
        self.places.places()
    }

    /// Takes the lengths that links at winches have by now.
    fn take_lengths(&mut self, world: &mut World) {
        let reeled = world.resource::<LinkMechanism>().entities.reeled.clone();
        for (limb, line) in reeled {
            let (Some(length), Some(line)) = (
                world.get::<FirstOrderState>(line).copied(),
                world.get::<ReeledLine>(line).copied(),
            ) else {
                continue;
            };
            let tree = &mut world.resource_mut::<LinkMechanism>().tree;
            let kind = &mut tree.kinds[limb];
            kind.reel(length.value);
            kind.length_rate_m_s = line.rate_m_s;
            self.kinds[tree.limbs[limb].links.start] = *kind;
        }
    }

    /// Writes the state of loose nodes that are bases.
    fn write_loose(&self, state: &mut [f64]) {
        let (coordinates, velocities) = state.split_at_mut(self.places.coordinates);
        for (origin_m, body) in self
            .loose_origins_m
            .iter()
            .zip(self.components.loose_from..)
        {
            if let BodyPlace::Base(at) = self.places.bodies[body] {
                let centre = self.components.bodies[body].centre;
                (centre.position_m - *origin_m).write_to_slice(&mut coordinates[at..]);
                centre.velocity_m_s.write_to_slice(&mut velocities[at..]);
            }
        }
    }

    /// From bases and links to all points and bodies.
    fn sweep(&mut self, mechanism: &LinkMechanism) {
        for (body, loose) in mechanism.entities.loose_bodies() {
            self.components.points[loose.point] = self.components.bodies[body].centre;
        }
        sweep_outward(
            &mechanism.tree,
            &self.links,
            &mechanism.entities.offsets.limbs,
            &self.components.anchors,
            &mut self.components.bodies,
            &mut self.components.points,
        );
    }
}

/// Writes what coordinates a body has, but for its attitude, into coordinates and velocities.
fn write_body(body: &BodyState, origin: &Origin, place: BodyPlace, state: &mut [f64]) {
    let (coordinates, velocities) = state.split_at_mut(state.len() / 2);
    if let BodyPlace::Base(at) = place {
        (body.centre.position_m - origin.0).write_to_slice(&mut coordinates[at..]);
        body.centre
            .velocity_m_s
            .write_to_slice(&mut velocities[at..]);
    }
    if let Some(at) = place.rotation() {
        body.rate_rad_s.write_to_slice(&mut velocities[at..]);
    }
}

impl StateSpace for JointVector {
    fn layout(&self) -> Layout {
        Layout {
            coordinates: self.places.coordinates,
            first_order: self.first_order_count,
        }
    }

    fn gather(&mut self, world: &mut World, state: &mut [f64]) {
        self.components.read(world);
        self.components.read_masses(world);
        let is_rigid = self.kinds.iter().any(|kind| kind.stretch == Stretch::Rigid);
        let is_stretching = self.take_links(world);
        if is_rigid {
            let (points, bodies) = (
                self.components.points.clone(),
                self.components.bodies.clone(),
            );
            let is_moved = self.keep_centres_of_mass(world);
            if is_stretching || is_moved {
                // Momenta are those of the motion that was read.
                self.components.points = points;
                for (body, read) in self.components.bodies.iter_mut().zip(bodies) {
                    body.centre.velocity_m_s = read.centre.velocity_m_s;
                }
                self.take_impulses(world);
            }
        }
        let n = self.places.coordinates;
        state.fill(0.0);
        for (index, origin, mut chart, ..) in self.components.body_query.iter_mut(world) {
            let body = &self.components.bodies[index.0];
            chart.0 = body.attitude;
            write_body(
                body,
                origin,
                self.places.bodies[index.0],
                &mut state[..2 * n],
            );
        }
        let loose = self.components.bodies[self.components.loose_from..].iter();
        self.loose_origins_m = loose.map(|body| body.centre.position_m).collect();
        self.write_loose(&mut state[..2 * n]);
        let (rates, _) = state[n + self.places.first_link..2 * n].as_chunks_mut::<3>();
        let links = self.links.rate_m_s.iter().zip(&self.charts);
        for (out, ((rate, chart), kind)) in rates.iter_mut().zip(links.zip(&self.kinds)) {
            *out = chart.rate(*rate, kind).to_array();
        }
        self.first_order.gather(world, &mut state[2 * n..]);
    }

    fn scatter(&mut self, world: &mut World, state: &[f64]) -> Result<(), Fault> {
        let (coordinates, rest) = state.split_at(self.places.coordinates);
        let (velocities, first_order) = rest.split_at(self.places.coordinates);
        self.first_order.scatter(world, first_order);
        self.take_lengths(world);
        for (index, origin, chart, ..) in self.components.body_query.iter(world) {
            let place = self.places.bodies[index.0];
            let body = &mut self.components.bodies[index.0];
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
        for (origin_m, body) in self
            .loose_origins_m
            .iter()
            .zip(self.components.loose_from..)
        {
            if let BodyPlace::Base(at) = self.places.bodies[body] {
                self.components.bodies[body].centre = PointState {
                    position_m: *origin_m + DVec3::from_slice(&coordinates[at..]),
                    velocity_m_s: DVec3::from_slice(&velocities[at..]),
                };
            }
        }
        let (q, _) = coordinates[self.places.first_link..].as_chunks::<3>();
        let (q_rate, _) = velocities[self.places.first_link..].as_chunks::<3>();
        let joints = q
            .iter()
            .zip(q_rate)
            .zip(self.charts.iter().zip(&self.kinds));
        let spans = self.links.span_m.iter_mut().zip(&mut self.links.rate_m_s);
        let mut beyond = None;
        for (link, (((q, q_rate), (chart, kind)), (span, rate))) in joints.zip(spans).enumerate() {
            let (q, q_rate) = (DVec3::from_array(*q), DVec3::from_array(*q_rate));
            match chart.span(q, q_rate, kind) {
                Some(found) => (*span, *rate) = found,
                None => beyond = beyond.or(Some(link)),
            }
        }
        if let Some(link) = beyond {
            return Err(Fault {
                entity: Some(world.resource::<LinkMechanism>().entities.segments[link]),
                message:
                    "a rigid link turns by a right angle in one step: a shorter step (or `Auto()`) follows it, \
                     unless its line is pulled straight or has nothing to hold it"
                        .to_owned(),
            });
        }
        self.components.read_anchors(world);
        self.sweep(world.resource::<LinkMechanism>());
        self.components.write(world, &self.links);
        Ok(())
    }

    fn gather_rates(&mut self, world: &mut World, state: &[f64], rates: &mut [f64]) {
        let n = self.places.coordinates;
        rates[..n].copy_from_slice(&state[n..2 * n]);
        let found = &world.resource::<LinkMechanism>().accelerations;
        for (place, motion) in self.places.bodies.iter().zip(&found.bodies) {
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
        let (out, _) = rates[n + self.places.first_link..2 * n].as_chunks_mut::<3>();
        let links = self.charts.iter().zip(&self.kinds).zip(&found.span_m_s2);
        for (out, ((chart, kind), span)) in out.iter_mut().zip(links) {
            *out = chart.acceleration(*span, kind).to_array();
        }
        self.first_order.gather_rates(world, &mut rates[2 * n..]);
    }

    fn recentre(&mut self, world: &mut World, state: &mut [f64], rates: &mut [f64]) -> Correction {
        let n = self.places.coordinates;
        let correction = self.close_after_step(world);
        let is_changed = correction != Correction::None;
        for (index, origin, mut chart, _, mut attitude, _, _) in
            self.components.body_query.iter_mut(world)
        {
            let body = &self.components.bodies[index.0];
            let place = self.places.bodies[index.0];
            if is_changed {
                write_body(body, origin, place, &mut state[..2 * n]);
            }
            let Some(at) = place.rotation() else {
                continue;
            };
            chart.0 = body.attitude.normalize();
            attitude.0 = chart.0;
            state[at..at + 3].fill(0.0);
        }
        if is_changed {
            self.write_loose(&mut state[..2 * n]);
        }
        let found = &world.resource::<LinkMechanism>().accelerations.span_m_s2;
        let spans = self.links.span_m.iter().zip(&self.links.rate_m_s);
        let links = self.charts.iter_mut().zip(&self.kinds).zip(spans);
        for (link, (((chart, kind), (span, rate)), found)) in links.zip(found).enumerate() {
            let at = self.places.first_link + 3 * link;
            let (centre, rate) = LinkChart::around(*span, *rate, kind);
            let rate = centre.rate(rate, kind);
            let acceleration = centre.acceleration(*found, kind);
            *chart = centre;
            state[at..at + 3].fill(0.0);
            rate.write_to_slice(&mut state[n + at..]);
            acceleration.write_to_slice(&mut rates[n + at..]);
        }
        // At the centres of all charts, rates of coordinates are the velocities.
        rates[..n].copy_from_slice(&state[n..2 * n]);
        correction
    }

    fn error_scales(&mut self, world: &mut World) -> Vec<f64> {
        let mut scales = vec![1.0; self.layout().len()];
        let first = 2 * self.places.coordinates;
        self.first_order.error_scales(world, &mut scales[first..]);
        scales
    }

    fn owner(&mut self, world: &mut World, place: usize) -> Option<Entity> {
        let place = place % self.places.coordinates.max(1);
        let entities = &world.resource::<LinkMechanism>().entities;
        if place >= self.places.first_link {
            return entities
                .segments
                .get((place - self.places.first_link) / 3)
                .copied();
        }
        let starts = |at: &BodyPlace| match at {
            BodyPlace::Base(at) | BodyPlace::Turning(at) => Some(*at),
            BodyPlace::Point => None,
        };
        let body = self
            .places
            .bodies
            .iter()
            .rposition(|at| starts(at).is_some_and(|at| at <= place))?;
        let loose = body.checked_sub(entities.bodies.len());
        match loose {
            None => entities.bodies.get(body).copied(),
            Some(loose) => entities.loose.get(loose).map(|loose| loose.node),
        }
    }
}
