//! The linearised motion in the coordinates of bodies and nodes: springs in closed form, everything else
//! by differences of the forces.

use std::collections::BTreeSet;

use aerobot_components::segment::{SegmentDrag, SegmentGeometry};
use aerobot_systems::fault::Fault;
use aerobot_systems::modes::dense_motion::DenseMotion;
use aerobot_systems::modes::extrapolated_difference::differentiate;
use aerobot_systems::modes::sparse_motion::SparseMotion;
use aerobot_systems::nonlinear_solver::colouring::colour;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;

use super::displaced_forces::{
    Displaced, DisplacedForces, first_order_states, put_springs_back, take_springs,
};
use super::linear_motion::LinearMotion;
use super::linear_springs::masses_and_springs;
use super::sites::Sites;
use crate::evaluation::Evaluation;
use crate::scene::Scene;

/// Largest step of displacements, m and rad.
const STEP: f64 = 0.031_25;
/// Largest step of velocities, m/s and rad/s: small against winds, for the drag of a sphere bends within
/// centimetres per second.
const VELOCITY_STEP: f64 = 1.0 / 4096.0;

/// Which part of the state is moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Displacement,
    Velocity,
}

/// The linearised motion, and how many segments are slack.
pub(super) fn linearise(
    world: &mut World,
    evaluation: &mut Evaluation,
    scene: &Scene,
    sites: &Sites,
    is_small: bool,
) -> Result<(LinearMotion, Vec<Entity>, usize), Fault> {
    let (springs, slack) = masses_and_springs(world, scene, sites);
    let step = displacement_step(world);
    let taken = take_springs(world);
    let mut forces = DisplacedForces {
        first_order: first_order_states(world),
        world,
        evaluation,
        sites,
    };
    let found = if is_small {
        in_full(&mut forces, &springs, step)
    } else {
        forces.first_order.clear();
        between_neighbours(&mut forces, springs, step).map(|motion| (motion, Vec::new()))
    };
    forces.put(&Displaced::zeros(
        sites.pattern.dimension(),
        forces.first_order.len(),
    ));
    put_springs_back(forces.world, taken);
    found.map(|(motion, first_order)| (motion, first_order, slack))
}

/// A small part of the shortest segment whose drag turns with it.
fn displacement_step(world: &mut World) -> f64 {
    let mut segments =
        world.query_filtered::<&SegmentGeometry, bevy_ecs::query::With<SegmentDrag>>();
    segments
        .iter(world)
        .map(|geometry| geometry.length_m / 32.0)
        .fold(STEP, f64::min)
}

/// Every coordinate by itself, so that nothing has to be known of who pushes whom.
fn in_full(
    forces: &mut DisplacedForces,
    springs: &SparseMotion,
    step: f64,
) -> Result<(LinearMotion, Vec<Entity>), Fault> {
    let n = forces.sites.pattern.dimension();
    let m = forces.first_order.len();
    let mut motion = DenseMotion::of(springs, m);
    let mut at = Displaced::zeros(n, m);
    let mut column = vec![0.0; n + m];
    for k in 0..n {
        for part in [Part::Displacement, Part::Velocity] {
            let size = step_of(part, k, forces.sites, step);
            column.fill(0.0);
            differentiate(&mut column, size, |h, out| {
                values(&mut at, part)[k] = h;
                forces.evaluate(&at, out)
            })?;
            values(&mut at, part)[k] = 0.0;
            let (matrix, driven) = match part {
                Part::Displacement => (
                    &mut motion.stiffness,
                    &mut motion.first_order_by_displacement,
                ),
                Part::Velocity => (&mut motion.damping, &mut motion.first_order_by_velocity),
            };
            for (row, value) in column[..n].iter().enumerate() {
                matrix[(row, k)] -= value;
            }
            for row in 0..m {
                driven[(row, k)] = column[n + row];
            }
        }
    }
    for k in 0..m {
        column.fill(0.0);
        differentiate(&mut column, STEP, |h, out| {
            at.w[k] = h;
            forces.evaluate(&at, out)
        })?;
        at.w[k] = 0.0;
        for (row, value) in column[..n].iter().enumerate() {
            motion.by_first_order[(row, k)] = *value;
        }
        for row in 0..m {
            motion.first_order[(row, k)] = column[n + row];
        }
    }
    let entities = forces.first_order.iter().map(|(entity, _)| *entity);
    let (motion, kept) = motion.without_idle_first_order();
    let kept: BTreeSet<usize> = kept.into_iter().collect();
    let kept = entities
        .enumerate()
        .filter(|(k, _)| kept.contains(k))
        .map(|(_, entity)| entity)
        .collect();
    Ok((LinearMotion::Dense(Box::new(motion)), kept))
}

/// Sites far from each other at once.
fn between_neighbours(
    forces: &mut DisplacedForces,
    mut motion: SparseMotion,
    step: f64,
) -> Result<LinearMotion, Fault> {
    let pattern = forces.sites.pattern.clone();
    let colours = colour(&pattern);
    let most = colours.iter().copied().max().map_or(0, |most| most + 1);
    let mut at = Displaced::zeros(pattern.dimension(), 0);
    let mut column = vec![0.0; pattern.dimension()];
    for chosen in 0..most {
        let group: Vec<usize> = (0..pattern.sites())
            .filter(|site| colours[*site] == chosen)
            .collect();
        for component in 0..6 {
            let moved: Vec<usize> = group
                .iter()
                .copied()
                .filter(|site| component < pattern.dim(*site))
                .collect();
            if moved.is_empty() {
                continue;
            }
            for part in [Part::Displacement, Part::Velocity] {
                let first = pattern.offset(moved[0]) + component;
                let size = step_of(part, first, forces.sites, step);
                column.fill(0.0);
                differentiate(&mut column, size, |h, out| {
                    for site in &moved {
                        values(&mut at, part)[pattern.offset(*site) + component] = h;
                    }
                    forces.evaluate(&at, out)
                })?;
                values(&mut at, part).fill(0.0);
                let matrix = match part {
                    Part::Displacement => &mut motion.stiffness,
                    Part::Velocity => &mut motion.damping,
                };
                for &site in &moved {
                    for &row in pattern.row(site) {
                        for place in 0..pattern.dim(row) {
                            let value = -column[pattern.offset(row) + place];
                            matrix.add(row, site, place, component, value);
                        }
                    }
                }
            }
        }
    }
    Ok(LinearMotion::Sparse(Box::new(motion)))
}

fn values(at: &mut Displaced, part: Part) -> &mut [f64] {
    match part {
        Part::Displacement => &mut at.x,
        Part::Velocity => &mut at.v,
    }
}

fn step_of(part: Part, coordinate: usize, sites: &Sites, displacement: f64) -> f64 {
    let index = sites.all.partition_point(|site| site.at <= coordinate) - 1;
    let is_turn = coordinate >= sites.all[index].at + 3;
    match part {
        Part::Velocity => VELOCITY_STEP,
        Part::Displacement if is_turn => STEP,
        Part::Displacement => displacement,
    }
}
