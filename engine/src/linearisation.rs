//! The world linearised: the Linearise schedule, and the way of its derivatives into flat arrays.

use aerobot_components::body::Anchor;
use aerobot_components::derivatives::{ForceDerivatives, SegmentDerivatives, TorqueDerivatives};
use aerobot_components::segment::{KelvinVoigt, Segment, SegmentGeometry, Tension};
use aerobot_components::state::{
    AddedInertia, Attitude, FirstOrderState, Force, Inertia, Mass, Position, StateIndex,
};
use aerobot_components::tether::{Attachment, TetherNode, TetherPoint};
use aerobot_components::winch::{Reeled, ReeledLine};
use aerobot_systems::dynamics::first_order::FirstOrderIndex;
use aerobot_systems::dynamics::rigid_body::CarriedMass;
use aerobot_systems::environment::EnvironmentModel;
use aerobot_systems::linearised_motion::body_block::{BodyBlock, Place};
use aerobot_systems::linearised_motion::derivatives::{Derivatives, LinearReel, LinearSegment};
use aerobot_systems::linearised_motion::error_norm::{position_error, strain_error};
use aerobot_systems::linearised_motion::stage_solver::{Change, StageSolver};
use aerobot_systems::linearised_motion::symmetric3::Symmetric3;
use aerobot_systems::linearised_motion::topology::{BodyIndex, Topology};
use bevy_ecs::query::{QueryState, With, Without};
use bevy_ecs::world::World;
use glam::DMat3;

use crate::sequence::Sequence;
use crate::topology::LineEnd;

type Segments = (
    &'static Segment,
    &'static SegmentGeometry,
    &'static Tension,
    &'static SegmentDerivatives,
);
type Bodies = (
    &'static BodyIndex,
    &'static Mass,
    &'static AddedInertia,
    Option<&'static Inertia>,
    &'static CarriedMass,
    &'static Attitude,
    &'static ForceDerivatives,
    &'static TorqueDerivatives,
);

/// The Linearise schedule with what carries its result to the solver.
pub(crate) struct Linearisation {
    schedule: Sequence,
    topology: Topology,
    solver: Box<dyn StageSolver>,
    derivatives: Derivatives,
    /// Tensions below this say nothing of a strain error, N.
    least_tension_n: f64,
    /// Errors of first-order states that matter as much as 1 m.
    first_order_scales: Vec<f64>,
    /// Whether a tether was slack at the last linearisation.
    pub(crate) has_slack: bool,
    segments: QueryState<Segments>,
    nodes: QueryState<(&'static TetherPoint, &'static ForceDerivatives), With<TetherNode>>,
    bodies: QueryState<Bodies, Without<Anchor>>,
    ends: QueryState<(&'static LineEnd, &'static Attachment, &'static Force)>,
    attitudes: QueryState<&'static Attitude>,
    reels: QueryState<(
        &'static ReeledLine,
        &'static FirstOrderIndex,
        &'static FirstOrderState,
    )>,
}

impl Linearisation {
    /// For a world of this topology, which is empty where the integrator never asks; with the errors of
    /// first-order states that matter as much as 1 m.
    pub(crate) fn new(
        world: &mut World,
        schedule: Sequence,
        first_order_scales: Vec<f64>,
        (topology, solver): (Topology, Box<dyn StageSolver>),
    ) -> Self {
        let mut linearisation = Self {
            least_tension_n: 0.0,
            schedule,
            topology: Topology::default(),
            solver,
            derivatives: Derivatives::default(),
            first_order_scales: Vec::new(),
            has_slack: false,
            segments: world.query(),
            nodes: world.query_filtered(),
            bodies: world.query_filtered(),
            ends: world.query(),
            attitudes: world.query(),
            reels: world.query(),
        };
        linearisation.take(world, first_order_scales, topology);
        linearisation
    }

    /// The same for a topology that has changed.
    pub(crate) fn renew(
        &mut self,
        world: &mut World,
        first_order_scales: Vec<f64>,
        topology: Topology,
        solver: Box<dyn StageSolver>,
    ) {
        self.solver = solver;
        self.take(world, first_order_scales, topology);
    }

    fn take(&mut self, world: &mut World, first_order_scales: Vec<f64>, topology: Topology) {
        let mut derivatives = Derivatives::new(&topology);
        let mut masses = world.query_filtered::<(&TetherPoint, &Mass), With<TetherNode>>();
        for (point, mass) in masses.iter(world) {
            if let Some(point) = derivatives.points.get_mut(point.index) {
                point.mass_kg = mass.0;
            }
        }
        derivatives.gravity_m_s2 = world
            .resource::<EnvironmentModel>()
            .gravity
            .acceleration_m_s2(0.0);
        self.least_tension_n = least_tension_n(world);
        self.derivatives = derivatives;
        self.bodies.update_archetypes(world);
        self.ends.update_archetypes(world);
        self.attitudes.update_archetypes(world);
        self.reels.update_archetypes(world);
        self.first_order_scales = first_order_scales;
        self.topology = topology;
    }

    /// Finds masses and derivatives at the state that was evaluated last.
    pub(crate) fn linearise(&mut self, world: &mut World) {
        self.schedule.run(world);
        let derivatives = &mut self.derivatives;
        for point in &mut derivatives.points {
            point.damping = Symmetric3::default();
        }
        let mut largest_gap_m = 0.0_f64;
        for (segment, geometry, tension, own) in self.segments.iter(world) {
            let index = segment.from_point;
            let drag = Symmetric3::part_of(own.drag_n_s_m);
            derivatives.segments[index] = LinearSegment {
                drag,
                direction: geometry.direction,
                length_m: geometry.length_m,
                stiffness_n_m: own.axial_stiffness_n_m,
                damping_n_s_m: own.axial_damping_n_s_m,
                geometric_n_m: own.geometric_stiffness_n_m,
                gap_m: own.gap_m,
                closing_m_s: own.closing_m_s,
                tension_n: tension.0,
            };
            largest_gap_m = largest_gap_m.max(own.gap_m);
            let [first, second] = &mut derivatives.points[index..index + 2] else {
                continue;
            };
            first.damping = first.damping.plus_scaled(drag, 0.5);
            second.damping = second.damping.plus_scaled(drag, 0.5);
        }
        self.has_slack = largest_gap_m > 0.0;
        for (point, own) in self.nodes.iter(world) {
            let point = &mut derivatives.points[point.index];
            let damping = Symmetric3::part_of(own.by_velocity_n_s_m);
            point.damping = point.damping.plus_scaled(damping, -1.0);
            point.stiffness =
                Symmetric3::default().plus_scaled(Symmetric3::part_of(own.by_position_n_m), -1.0);
        }
        self.linearise_bodies(world);
        self.linearise_reels(world);
    }

    fn linearise_reels(&mut self, world: &World) {
        let derivatives = &mut self.derivatives;
        derivatives.reels.clear();
        for (line, state, length) in self.reels.iter_manual(world) {
            if let (Some(point), Some(mass)) = (
                world.get::<TetherPoint>(line.far),
                world.get::<Mass>(line.far),
            ) {
                derivatives.points[point.index].mass_kg = mass.0;
            }
            if let (Some(segment), Some(reeled)) = (
                world.get::<Segment>(line.segment),
                world.get::<Reeled>(line.segment),
            ) {
                derivatives.reels.push(LinearReel {
                    segment: segment.from_point,
                    state: state.0,
                    length_m: length.value,
                    tension_by_length_n_m: reeled.tension_by_length_n_m,
                });
            }
        }
    }

    fn linearise_bodies(&mut self, world: &World) {
        let derivatives = &mut self.derivatives;
        for (index, mass, added, inertia, carried, attitude, force, torque) in
            self.bodies.iter_manual(world)
        {
            let body = &mut derivatives.bodies[index.0];
            let inertia = inertia.map_or(DMat3::ZERO, |inertia| inertia.0);
            body.mass = BodyBlock::mass(
                mass.0 + added.0 + carried.mass_kg,
                carried.first_moment_kg_m,
                inertia + carried.inertia_kg_m2,
                attitude.0,
            );
            body.damping = BodyBlock::ZERO;
            body.damping.linear = -force.by_velocity_n_s_m;
            body.damping.turn = -torque.by_rate_n_m_s;
            body.stiffness = BodyBlock::ZERO;
            body.stiffness.linear = -force.by_position_n_m;
            body.stiffness.turn = -torque.by_rotation_n_m;
        }
        for (end, attachment, force) in self.ends.iter_manual(world) {
            let Ok(attitude) = self.attitudes.get_manual(world, attachment.carrier) else {
                continue;
            };
            let at = &mut derivatives.ends[end.0][end.1];
            at.place = Place::new(attitude.0, attachment.offset_m);
            at.offset_m = attachment.offset_m;
            at.load_n = attitude.0.conjugate() * force.0;
        }
        derivatives.load_bodies(&self.topology);
    }

    /// Factorises the matrix of a step; the place in the state where that fails.
    pub(crate) fn factorise(&mut self, step_s: f64, gamma: f64) -> Result<(), usize> {
        self.solver
            .factorise(&self.derivatives, step_s, gamma)
            .map_err(|at| at.index)
    }

    /// Solves for the increments of a stage.
    pub(crate) fn solve(&mut self, r: &mut [f64]) {
        self.solver.solve(&self.derivatives, r);
    }

    /// The largest error of positions and of first-order states over the tolerance.
    pub(crate) fn position_error(&mut self, error: &[f64], tolerance_m: f64) -> (f64, usize) {
        self.solver
            .displace(&self.derivatives, error, Change::Error);
        let moved = self.solver.displaced(error, Change::Error);
        let (mut largest, coordinate) = position_error(&self.topology, moved, self.has_slack);
        let mut place = self.solver.place(coordinate);
        let first = error.len() - self.first_order_scales.len();
        for (k, (error, scale)) in error[first..]
            .iter()
            .zip(&self.first_order_scales)
            .enumerate()
        {
            let in_metres = error.abs() / scale;
            if in_metres > largest {
                (largest, place) = (in_metres, first + k);
            }
        }
        (largest / tolerance_m, place)
    }

    /// The largest error of a segment's tension over what is allowed.
    pub(crate) fn strain_error(&mut self, error: &[f64], increment: &[f64]) -> (f64, usize) {
        for (change, of) in [(error, Change::Error), (increment, Change::Increment)] {
            self.solver.displace(&self.derivatives, change, of);
        }
        let (largest, coordinate) = strain_error(
            &self.topology,
            &self.derivatives,
            self.solver.displaced(error, Change::Error),
            self.solver.displaced(increment, Change::Increment),
            self.least_tension_n,
        );
        (largest, self.solver.place(coordinate))
    }
}

/// The weight of the heaviest body, N; without weight, the tension of a strain of 1e-6.
fn least_tension_n(world: &mut World) -> f64 {
    let gravity = world.resource::<EnvironmentModel>().gravity;
    let heaviest = world
        .query_filtered::<(&Mass, &Position), With<StateIndex>>()
        .iter(world)
        .map(|(mass, position)| mass.0 * gravity.acceleration_m_s2(position.0.z))
        .fold(0.0, f64::max);
    world
        .query::<&KelvinVoigt>()
        .iter(world)
        .map(|spring| 1e-6 * spring.stiffness_n_m * spring.rest_length_m)
        .fold(heaviest, f64::max)
}
