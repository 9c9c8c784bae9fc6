//! Newton's method on the forces of the run: no force on any node, no force and no torque on any
//! body that is free to find its place.

use aerobot_components::segment::{KelvinVoigt, Segment};
use aerobot_components::state::{Attitude, Force, Mass, Position, Torque};
use aerobot_components::tether::{Tether, TetherNode};
use aerobot_systems::dynamics::rotation_chart::{exponential, logarithm};
use aerobot_systems::environment::EnvironmentModel;
use aerobot_systems::fault::Fault;
use aerobot_systems::nonlinear_solver::block_sparse::BlockPattern;
use aerobot_systems::nonlinear_solver::damped_newton::{DampedNewton, NewtonError, NewtonSettings};
use aerobot_systems::nonlinear_solver::finite_difference_jacobian::Residual;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;
use glam::DVec3;

use super::sites::{Site, sites, sites_here};
use super::{Unplaced, floating, rigid_lengths};
use crate::evaluation::Evaluation;
use crate::scene::{Scene, SetupError};
use crate::stopping::owner_name;
use crate::world::EntityName;

/// A heading that nothing restores is held by this part of the weight times a metre per radian. Where
/// tethers do restore it the hold is out of the result, for the last solution starts from the one
/// before and has not turned from it.
const HEADING_HOLD: f64 = 1e-6;
/// A solution that has turned less than this, rad, carries a hold of less than round-off.
const NO_TURN_RAD: f64 = 1e-9;
/// Solutions, each from the one before, after which a heading that still turns is left as it is.
const MOST_PASSES: usize = 50;
/// Turns that do not get smaller by this factor are round-off, or restored by next to nothing.
const LEAST_SETTLING: f64 = 0.97;

/// Forces on the sites as a function of their displacements from the guess.
pub(super) struct Forces<'a> {
    pub(super) world: &'a mut World,
    pub(super) evaluation: &'a mut Evaluation,
    pub(super) sites: &'a [Site],
    pub(super) dimension: usize,
    /// Stiffness against turning about the vertical away from the guess, N m/rad.
    pub(super) heading_hold_n_m: f64,
}

impl Forces<'_> {
    /// Puts the sites where `x` says, and evaluates the forces there.
    pub(super) fn put(&mut self, x: &[f64]) -> Result<(), Fault> {
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
        self.evaluation.run(self.world)
    }
}

impl Residual for Forces<'_> {
    type Error = Fault;

    fn dimension(&self) -> usize {
        self.dimension
    }

    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), Fault> {
        self.put(x)?;
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
        solve_shape(world, evaluation, unplaced)?;
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

/// Brings everything in `unplaced` to equilibrium where what floats is held in its place; rigid links
/// with the lengths that they keep.
pub(super) fn solve_shape(
    world: &mut World,
    evaluation: &mut Evaluation,
    unplaced: &Unplaced,
) -> Result<(), SetupError> {
    solve_springs(world, evaluation, unplaced)?;
    rigid_lengths::impose(world, |world| solve_springs(world, evaluation, unplaced))
}

/// The same with the lengths at rest that springs have now.
fn solve_springs(
    world: &mut World,
    evaluation: &mut Evaluation,
    unplaced: &Unplaced,
) -> Result<(), SetupError> {
    let (mut sites, pattern) = sites(world, unplaced);
    if sites.is_empty() {
        return Ok(());
    }
    let mut before_rad = f64::INFINITY;
    let newton = &mut DampedNewton::new(&pattern);
    solve_from(world, evaluation, &sites, (&pattern, newton))?;
    for _ in 0..MOST_PASSES {
        sites = sites_here(world, sites);
        let turn_rad = solve_from(world, evaluation, &sites, (&pattern, newton))?;
        if turn_rad <= NO_TURN_RAD || turn_rad > LEAST_SETTLING * before_rad {
            break;
        }
        before_rad = turn_rad;
    }
    Ok(())
}

/// Steps of differences, of iterations, and sizes of residuals, for every unknown.
pub(super) fn unknown_scales(sites: &[Site], scales: &Scales, dimension: usize) -> [Vec<f64>; 3] {
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
    [difference_step, largest_step, residual_scale]
}

/// One search from where the sites stand; the largest turn about the vertical that it made, rad.
fn solve_from(
    world: &mut World,
    evaluation: &mut Evaluation,
    sites: &[Site],
    (pattern, newton): (&BlockPattern, &mut DampedNewton),
) -> Result<f64, SetupError> {
    let scales = Scales::of(world);
    let dimension = pattern.dimension();
    let [difference_step, largest_step, residual_scale] = unknown_scales(sites, &scales, dimension);
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
    let outcome = newton.solve(&mut problem, &mut x, &settings);
    // The last trial need not be the solution: leave the solution in the components.
    let mut residual = vec![0.0; dimension];
    let checked = problem.residual(&x, &mut residual);
    outcome
        .map_err(|error| failure(world, sites, scales.force_n, error))
        .and(checked.map_err(|fault| fault_on_the_way(world, &fault)))?;
    let turns = sites.iter().filter_map(|site| site.rotation);
    Ok(turns.map(|at| x[at + 2].abs()).fold(0.0, f64::max))
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
            let reason = if force.is_finite() {
                format!("a force of {force:.3e} N remains on it")
            } else {
                "the forces on it are too large to reckon with".to_owned()
            };
            no_equilibrium(world, site.map(|site| site.entity), &reason)
        }
    }
}

/// Sizes that make the problem dimensionless.
pub(super) struct Scales {
    pub(super) force_n: f64,
    length_m: f64,
    pub(super) difference_m: f64,
    pub(super) floor: f64,
    /// Round-off of an altitude, seen through the stiffest spring, N.
    pub(super) position_noise_n: f64,
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
            position_noise_n: 2.0 * f64::EPSILON * highest * stiffest,
        }
    }
}

/// What to do about a start that cannot be evaluated.
pub(super) const OUTSIDE_HELP: &str =
    "static equilibrium in still air would put it there; give it a `Pose` to start elsewhere";
/// What to do about a start that is not found.
pub(super) const NO_EQUILIBRIUM_HELP: &str =
    "give the bodies a `Pose`, and slack tethers a `start: Straight`";

/// The search left what can be evaluated; the cause is the fault, not the search.
pub(super) fn fault_on_the_way(world: &World, fault: &Fault) -> SetupError {
    let name = fault.entity.and_then(|entity| owner_name(world, entity));
    let path = name
        .as_ref()
        .map_or_else(String::new, |name| format!("entities.{name}"));
    let who = name.map_or_else(String::new, |name| format!("`{name}`: "));
    SetupError::new(path, format!("{who}{}", fault.message), OUTSIDE_HELP)
}

pub(super) fn no_equilibrium(world: &World, entity: Option<Entity>, reason: &str) -> SetupError {
    let name = entity
        .and_then(|entity| world.get::<EntityName>(entity))
        .map_or_else(|| "the scene".to_owned(), |name| format!("`{}`", name.0));
    let path = entity
        .and_then(|entity| world.get::<EntityName>(entity))
        .map_or_else(String::new, |name| format!("entities.{}", name.0));
    SetupError::new(
        path,
        format!("{name} finds no static equilibrium: {reason}"),
        NO_EQUILIBRIUM_HELP,
    )
}
