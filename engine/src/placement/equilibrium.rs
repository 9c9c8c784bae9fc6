//! Newton's method on the forces of the run: no force on any node, no force and no torque on any
//! body that is free to find its place.

use std::collections::BTreeMap;

use aerobot_components::segment::{KelvinVoigt, Segment};
use aerobot_components::state::{Attitude, Force, Inertia, Mass, Position, Torque};
use aerobot_components::tether::{Attachment, Tether, TetherNode, TetherParts, TetherStart};
use aerobot_systems::dynamics::rotation_chart::{exponential, logarithm};
use aerobot_systems::environment::EnvironmentModel;
use aerobot_systems::fault::Fault;
use aerobot_systems::nonlinear_solver::block_sparse::BlockPattern;
use aerobot_systems::nonlinear_solver::damped_newton::{DampedNewton, NewtonError, NewtonSettings};
use aerobot_systems::nonlinear_solver::finite_difference_jacobian::Residual;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;
use glam::{DQuat, DVec3};

use super::{Unplaced, floating};
use crate::evaluation::Evaluation;
use crate::scene::{Scene, SetupError};
use crate::stopping::owner_name;
use crate::world::EntityName;

/// What is free to find its place, with its place in the unknowns.
#[derive(Clone, Copy, Debug)]
struct Site {
    entity: Entity,
    /// The place of three displacements, m, if it may move.
    translation: Option<usize>,
    /// The place of three components of a rotation vector, rad, inertial axes, if it may turn.
    rotation: Option<usize>,
    /// Where it stood in the guess.
    position_m: DVec3,
    attitude: DQuat,
}

/// A heading that nothing restores is held by this part of the weight times a metre per radian. Where
/// tethers do restore it the hold is out of the result, for the last solution starts from the one
/// before and has not turned from it.
const HEADING_HOLD: f64 = 1e-6;

/// Forces on the sites as a function of their displacements from the guess.
struct Forces<'a> {
    world: &'a mut World,
    evaluation: &'a mut Evaluation,
    sites: &'a [Site],
    dimension: usize,
    /// Stiffness against turning about the vertical away from the guess, N m/rad.
    heading_hold_n_m: f64,
}

impl Residual for Forces<'_> {
    type Error = Fault;

    fn dimension(&self) -> usize {
        self.dimension
    }

    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), Fault> {
        for site in self.sites {
            let mut entity = self.world.entity_mut(site.entity);
            if let (Some(at), Some(mut position)) = (site.translation, entity.get_mut::<Position>())
            {
                position.0 = site.position_m + DVec3::from_slice(&x[at..]);
            }
            if let (Some(at), Some(mut attitude)) = (site.rotation, entity.get_mut::<Attitude>()) {
                attitude.0 = exponential(DVec3::from_slice(&x[at..])) * site.attitude;
            }
        }
        self.evaluation.run(self.world)?;
        for site in self.sites {
            let entity = self.world.entity(site.entity);
            if let (Some(at), Some(force)) = (site.translation, entity.get::<Force>()) {
                force.0.write_to_slice(&mut r[at..]);
            }
            if let (Some(at), Some(torque)) = (site.rotation, entity.get::<Torque>()) {
                let held = DVec3::new(0.0, 0.0, self.heading_hold_n_m * x[at + 2]);
                (torque.0 - held).write_to_slice(&mut r[at..]);
            }
        }
        Ok(())
    }

    /// Rotation vectors compose as rotations do; torques are conjugate to turns in inertial axes.
    fn apply(&mut self, x: &mut [f64], dx: &[f64]) {
        for site in self.sites {
            if let Some(at) = site.translation {
                for (x, dx) in x[at..at + 3].iter_mut().zip(&dx[at..at + 3]) {
                    *x += dx;
                }
            }
            if let Some(at) = site.rotation {
                let turn = DVec3::from_slice(&dx[at..]);
                if turn != DVec3::ZERO {
                    let before = exponential(DVec3::from_slice(&x[at..]));
                    logarithm(exponential(turn) * before).write_to_slice(&mut x[at..]);
                }
            }
        }
    }
}

/// Brings everything unplaced from its guess to equilibrium.
pub(super) fn solve(
    world: &mut World,
    evaluation: &mut Evaluation,
    scene: &Scene,
    unplaced: &Unplaced,
) -> Result<(), SetupError> {
    // A floating system settles in altitude between the solutions of its shape; one whose radius was
    // chosen for its altitude is there at once.
    for _ in 0..60 {
        let (sites, pattern) = sites(world, unplaced);
        if !sites.is_empty() {
            solve_shape(world, evaluation, &sites, &pattern)?;
            solve_shape(world, evaluation, &sites_here(world, sites), &pattern)?;
        }
        if !floating::shift_altitudes(world, evaluation, scene, unplaced)? {
            return Ok(());
        }
    }
    Err(SetupError::new(
        "entities",
        format!(
            "`{}`: the balloon finds no altitude at which it floats",
            scene.name
        ),
        "give the balloon a `Pose`",
    ))
}

/// The same sites, counted from where they stand now.
fn sites_here(world: &World, mut sites: Vec<Site>) -> Vec<Site> {
    for site in &mut sites {
        site.position_m = world
            .get::<Position>(site.entity)
            .map_or(site.position_m, |p| p.0);
        site.attitude = world
            .get::<Attitude>(site.entity)
            .map_or(site.attitude, |a| a.0);
    }
    sites
}

/// Bodies without a pose, and the nodes of tethers that start in equilibrium or hold such a body.
fn sites(world: &mut World, unplaced: &Unplaced) -> (Vec<Site>, BlockPattern) {
    let mut sites = Vec::new();
    let mut dims = Vec::new();
    let mut offset = 0;
    let mut add = |world: &World, entity: Entity, moves: bool, turns: bool| {
        let translation = moves.then_some(offset);
        offset += if moves { 3 } else { 0 };
        let rotation = turns.then_some(offset);
        offset += if turns { 3 } else { 0 };
        dims.push(3 * (usize::from(moves) + usize::from(turns)));
        sites.push(Site {
            entity,
            translation,
            rotation,
            position_m: world.get::<Position>(entity).map_or(DVec3::ZERO, |p| p.0),
            attitude: world
                .get::<Attitude>(entity)
                .map_or(DQuat::IDENTITY, |a| a.0),
        });
    };
    for body in &unplaced.bodies {
        let moves = !unplaced.floating.contains(body);
        let turns = world.get::<Inertia>(*body).is_some();
        if moves || turns {
            add(world, *body, moves, turns);
        }
    }
    let mut tethers = world.query::<(&Tether, &TetherParts)>();
    for (tether, parts) in tethers.iter(world) {
        let holds = [parts.points.first(), parts.points.last()]
            .into_iter()
            .flatten()
            .any(|point| {
                let carrier = world.get::<Attachment>(*point).map(|end| end.carrier);
                carrier.is_some_and(|carrier| unplaced.bodies.contains(&carrier))
            });
        if holds || tether.start == TetherStart::Equilibrium {
            for node in parts
                .points
                .iter()
                .filter(|p| world.get::<TetherNode>(**p).is_some())
            {
                add(world, *node, true, false);
            }
        }
    }
    let edges = edges(world, &sites);
    let pattern = BlockPattern::new(&dims, &edges);
    (sites, pattern)
}

/// Pairs of sites that a segment joins.
fn edges(world: &mut World, sites: &[Site]) -> Vec<(usize, usize)> {
    let places: BTreeMap<Entity, usize> = sites
        .iter()
        .enumerate()
        .map(|(place, site)| (site.entity, place))
        .collect();
    let mut tethers = world.query::<&TetherParts>();
    let mut edges = Vec::new();
    for parts in tethers.iter(world) {
        let place = |point: &Entity| {
            let owner = world
                .get::<Attachment>(*point)
                .map_or(*point, |end| end.carrier);
            places.get(&owner).copied()
        };
        for pair in parts.points.windows(2) {
            if let (Some(a), Some(b)) = (place(&pair[0]), place(&pair[1])) {
                edges.push((a, b));
            }
        }
    }
    edges
}

fn solve_shape(
    world: &mut World,
    evaluation: &mut Evaluation,
    sites: &[Site],
    pattern: &BlockPattern,
) -> Result<(), SetupError> {
    let scales = Scales::of(world);
    let dimension = pattern.dimension();
    let mut difference_step = vec![0.0; dimension];
    let mut largest_step = vec![0.0; dimension];
    let mut residual_scale = vec![0.0; dimension];
    for site in sites {
        for (at, difference, largest, residual) in [
            (
                site.translation,
                scales.difference_m,
                scales.length_m,
                scales.force_n,
            ),
            (site.rotation, 1e-4, 0.3, scales.force_n),
        ] {
            let Some(at) = at else { continue };
            difference_step[at..at + 3].fill(difference);
            largest_step[at..at + 3].fill(largest);
            residual_scale[at..at + 3].fill(residual);
        }
    }
    let settings = NewtonSettings {
        difference_step: &difference_step,
        largest_step: &largest_step,
        residual_scale: &residual_scale,
        tolerance: 1e-13,
        floor: scales.floor,
        smallest_damping: 1e-10,
        largest_iterations: 500,
    };
    let mut x = vec![0.0; dimension];
    let heading_hold_n_m = HEADING_HOLD * scales.force_n;
    let mut problem = Forces {
        world,
        evaluation,
        sites,
        dimension,
        heading_hold_n_m,
    };
    let outcome = DampedNewton::new(pattern).solve(&mut problem, &mut x, &settings);
    // The last trial need not be the solution: leave the solution in the components.
    let mut residual = vec![0.0; dimension];
    let checked = problem.residual(&x, &mut residual);
    outcome
        .map_err(|error| failure(world, sites, scales.force_n, error))
        .and(checked.map_err(|fault| fault_on_the_way(world, &fault)))
}

/// What a failed search means for a reader; residuals count in parts of `force_n`.
fn failure(world: &World, sites: &[Site], force_n: f64, error: NewtonError<Fault>) -> SetupError {
    match error {
        NewtonError::Evaluation(fault) => fault_on_the_way(world, &fault),
        NewtonError::Singular { site } => {
            let entity = sites.get(site).map(|site| site.entity);
            no_equilibrium(world, entity, "nothing holds it")
        }
        NewtonError::NotConverged {
            largest_residual,
            worst_unknown,
            ..
        } => {
            let holds =
                |at: Option<usize>| at.is_some_and(|at| (at..at + 3).contains(&worst_unknown));
            let site = sites
                .iter()
                .find(|site| holds(site.translation) || holds(site.rotation));
            let force = largest_residual * force_n;
            let reason = format!("a force of {force:.3e} N remains on it");
            no_equilibrium(world, site.map(|site| site.entity), &reason)
        }
    }
}

/// Sizes that make the problem dimensionless.
pub(super) struct Scales {
    pub(super) force_n: f64,
    length_m: f64,
    difference_m: f64,
    pub(super) floor: f64,
}

impl Scales {
    pub(super) fn of(world: &mut World) -> Self {
        let gravity = world.resource::<EnvironmentModel>().gravity;
        let mut masses = world.query::<(&Mass, &Position)>();
        let weight_n: f64 = masses
            .iter(world)
            .map(|(mass, position)| mass.0 * gravity.acceleration_m_s2(position.0.z))
            .sum();
        let highest = masses
            .iter(world)
            .map(|(_, p)| p.0.abs().max_element())
            .fold(1.0, f64::max);
        let mut nodes = world.query_filtered::<&Mass, bevy_ecs::query::With<TetherNode>>();
        let lightest_n = nodes
            .iter(world)
            .map(|mass| mass.0 * gravity.acceleration_m_s2(highest))
            .fold(weight_n, f64::min);
        let mut tethers = world.query::<&Tether>();
        let length_m = tethers
            .iter(world)
            .map(|tether| tether.length_m)
            .fold(0.0, f64::max);
        let mut segments = world.query::<(&Segment, &KelvinVoigt)>();
        let (mut shortest, mut stiffest) = (1.0_f64, 0.0_f64);
        for (_, spring) in segments.iter(world) {
            shortest = shortest.min(spring.rest_length_m);
            stiffest = stiffest.max(spring.stiffness_n_m);
        }
        let force_n = weight_n.max(1e-9);
        Self {
            force_n,
            length_m: (0.25 * length_m).max(1.0),
            // Well within the stretch of the lightest part on the stiffest spring, so that a difference
            // does not straddle the kink where that goes slack; well above round-off.
            difference_m: (0.1 * lightest_n / stiffest.max(1e-9))
                .min(1e-4 * shortest)
                .max(1e3 * f64::EPSILON * highest),
            // Round-off of positions, seen through the stiffest spring.
            floor: 1e-10 + 16.0 * f64::EPSILON * highest * stiffest / force_n,
        }
    }
}

/// The search left what can be evaluated; the cause is the fault, not the search.
pub(super) fn fault_on_the_way(world: &World, fault: &Fault) -> SetupError {
    let name = fault.entity.and_then(|entity| owner_name(world, entity));
    let path = name.as_ref().map_or_else(String::new, |name| {
        format!("entities.{}", name.split('/').next().unwrap_or(""))
    });
    let who = name.map_or_else(String::new, |name| format!("`{name}`: "));
    SetupError::new(
        path,
        format!("{who}{}", fault.message),
        "static equilibrium in still air would put it there; give it a `Pose` to start elsewhere",
    )
}

pub(super) fn no_equilibrium(world: &World, entity: Option<Entity>, reason: &str) -> SetupError {
    let name = entity
        .and_then(|entity| world.get::<EntityName>(entity))
        .map_or_else(|| "the scene".to_owned(), |name| format!("`{}`", name.0));
    let path = entity
        .and_then(|entity| world.get::<EntityName>(entity))
        .map_or_else(String::new, |name| {
            format!("entities.{}", name.0.split('/').next().unwrap_or(""))
        });
    SetupError::new(
        path,
        format!("{name} finds no static equilibrium: {reason}"),
        "give the bodies a `Pose`, and slack tethers a `start: Straight`",
    )
}
