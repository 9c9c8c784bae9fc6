//! Whether an equilibrium is statically stable: whether the stiffness K = -d force / d displacement has
//! an eigenvalue mu < 0 against the masses M,
//!
//! ```text
//! K y = mu M y
//! ```
//!
//! along whose y forces push away, with a growth time of about 1 / sqrt(-mu) where nothing damps.
//! Inverse iteration with the shifts -s, y := (K + s M)^-1 M y, finds the eigenvalue nearest to -s
//! (Golub and Van Loan, "Matrix Computations", 4th ed. 2013, section 7.6.1); shifts a factor four apart
//! leave no negative one between them. What is found counts only if it is an eigenvalue: its residual is
//! checked. Drag makes K unsymmetric; an instability that oscillates is not looked for.

use aerobot_components::state::{AddedInertia, Inertia, Mass};
use aerobot_components::tether::Tether;
use aerobot_systems::environment::EnvironmentModel;
use aerobot_systems::nonlinear_solver::block_elimination::Elimination;
use aerobot_systems::nonlinear_solver::block_sparse::{BlockMatrix, BlockPattern};
use aerobot_systems::nonlinear_solver::finite_difference_jacobian::FiniteDifference;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;

use super::Unplaced;
use super::equilibrium::{Forces, Scales, unknown_scales};
use super::sites::{Site, sites};
use crate::evaluation::Evaluation;

/// Iterations with one shift: the wanted direction gains a factor two in each, or more.
const ITERATIONS: usize = 16;
/// Ratio of one shift to the one before.
const SHIFT_RATIO: f64 = 4.0;
/// An eigenvalue counts as negative below this part of that of the longest pendulum, g / L; differences
/// of stiff springs leave round-off above it.
const LEAST_PART_OF_PENDULUM: f64 = 0.03;
/// Residual of an eigenvalue that counts, as a part of it.
const LARGEST_RESIDUAL: f64 = 0.1;

/// A motion along which forces push away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Instability {
    /// What moves most.
    pub(crate) entity: Entity,
    /// Time in s over which it grows by a factor e where nothing damps.
    pub(crate) growth_time_s: f64,
}

/// Looks for a static instability of `unplaced` about where it stands; none where the forces about it
/// cannot be evaluated.
pub(super) fn find(
    world: &mut World,
    evaluation: &mut Evaluation,
    unplaced: &Unplaced,
) -> Option<Instability> {
    let (sites, pattern) = sites(world, unplaced);
    if sites.is_empty() {
        return None;
    }
    let stiffness = stiffness(world, evaluation, &sites, &pattern)?;
    let masses = masses(world, &sites, pattern.dimension());
    let least = LEAST_PART_OF_PENDULUM * pendulum_per_s2(world);
    let most = (0..pattern.sites())
        .flat_map(|site| {
            let block = stiffness.block(site, site);
            let row = pattern.offset(site);
            let norm = block
                .iter()
                .fold(0.0_f64, |most, value| most.max(value.abs()));
            masses[row..row + pattern.dim(site)]
                .iter()
                .map(move |mass| norm / mass)
        })
        .fold(least, f64::max);
    let mut shift = least;
    let mut elimination = Elimination::analyse(&pattern);
    while shift.is_finite() && shift <= SHIFT_RATIO * most {
        if let Some((eigenvalue, mode)) = nearest(&stiffness, &masses, shift, &mut elimination)
            && eigenvalue < -least
        {
            let moved = |site: &Site| {
                let at = site.translation.or(site.rotation).unwrap_or(0);
                mode[at..at + 3].iter().map(|part| part * part).sum::<f64>()
            };
            let entity = sites
                .iter()
                .max_by(|a, b| moved(a).total_cmp(&moved(b)))?
                .entity;
            return Some(Instability {
                entity,
                growth_time_s: 1.0 / (-eigenvalue).sqrt(),
            });
        }
        shift *= SHIFT_RATIO;
    }
    None
}

/// -d force / d displacement about where the sites stand.
fn stiffness(
    world: &mut World,
    evaluation: &mut Evaluation,
    sites: &[Site],
    pattern: &BlockPattern,
) -> Option<BlockMatrix> {
    let scales = Scales::of(world);
    let dimension = pattern.dimension();
    let [steps, ..] = unknown_scales(sites, &scales, dimension);
    let mut forces = Forces {
        world,
        evaluation,
        sites,
        dimension,
        heading_hold_n_m: 0.0,
    };
    let mut jacobian = BlockMatrix::new(pattern.clone());
    let here = vec![0.0; dimension];
    let evaluated =
        FiniteDifference::new(pattern).evaluate(&mut forces, &here, &steps, &mut jacobian);
    // The last difference is not where the sites stood.
    let restored = forces.put(&here);
    evaluated.and(restored).ok()?;
    let mut stiffness = BlockMatrix::new(pattern.clone());
    stiffness.set_multiple(-1.0, &jacobian);
    Some(stiffness)
}

/// The inertia of every unknown, kg and kg m^2: for rotations the mean of the principal moments, which
/// moves eigenvalues and never their signs where K is symmetric.
fn masses(world: &World, sites: &[Site], dimension: usize) -> Vec<f64> {
    let mut masses = vec![1.0; dimension];
    for site in sites {
        let mass = world.get::<Mass>(site.entity).map_or(1.0, |mass| mass.0);
        let added = world.get::<AddedInertia>(site.entity).map_or(0.0, |a| a.0);
        if let Some(at) = site.translation {
            masses[at..at + 3].fill((mass + added).max(f64::MIN_POSITIVE));
        }
        if let (Some(at), Some(inertia)) = (site.rotation, world.get::<Inertia>(site.entity)) {
            let diagonal = [inertia.0.x_axis.x, inertia.0.y_axis.y, inertia.0.z_axis.z];
            let mean = diagonal.iter().sum::<f64>() / 3.0;
            masses[at..at + 3].fill(mean.max(f64::MIN_POSITIVE));
        }
    }
    masses
}

/// g / L of the longest tether, 1/s^2.
fn pendulum_per_s2(world: &mut World) -> f64 {
    let gravity_m_s2 = world
        .resource::<EnvironmentModel>()
        .gravity
        .acceleration_m_s2(0.0);
    let mut tethers = world.query::<&Tether>();
    let longest_m = tethers
        .iter(world)
        .map(|tether| tether.length_m)
        .fold(1.0, f64::max);
    gravity_m_s2.max(1e-3) / longest_m
}

/// The eigenvalue nearest to -`shift` (1/s^2) with its vector, if the iteration has found one.
fn nearest(
    stiffness: &BlockMatrix,
    masses: &[f64],
    shift: f64,
    elimination: &mut Elimination,
) -> Option<(f64, Vec<f64>)> {
    let mut shifted = stiffness.clone();
    for site in 0..stiffness.pattern().sites() {
        let row = stiffness.pattern().offset(site);
        for part in 0..stiffness.pattern().dim(site) {
            shifted.add(site, site, part, part, shift * masses[row + part]);
        }
    }
    elimination.factorise(&shifted).ok()?;
    let mut mode: Vec<f64> = (0..masses.len()).map(irregular).collect();
    for _ in 0..ITERATIONS {
        let size = dot(&mode, masses, &mode).sqrt();
        if !(size.is_finite() && size > 0.0) {
            return None;
        }
        for (part, mass) in mode.iter_mut().zip(masses) {
            *part *= mass / size;
        }
        elimination.solve(&mut mode);
    }
    let mut pull = vec![0.0; masses.len()];
    stiffness.multiply(&mode, &mut pull);
    let size = dot(&mode, masses, &mode);
    let eigenvalue = mode.iter().zip(&pull).map(|(a, b)| a * b).sum::<f64>() / size;
    let left: f64 = pull
        .iter()
        .zip(&mode)
        .zip(masses)
        .map(|((pull, mode), mass)| (pull - eigenvalue * mass * mode).powi(2) / mass)
        .sum();
    let is_eigenvalue = left.sqrt() <= LARGEST_RESIDUAL * eigenvalue.abs() * size.sqrt();
    is_eigenvalue.then_some((eigenvalue, mode))
}

/// a' M b.
fn dot(a: &[f64], masses: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(masses)
        .zip(b)
        .map(|((a, m), b)| a * m * b)
        .sum()
}

/// Numbers between -0.5 and 0.5 without a pattern that a mode could have: multiples of the golden ratio.
fn irregular(index: usize) -> f64 {
    (index as f64 * 0.618_033_988_749_895).fract() - 0.5
}
