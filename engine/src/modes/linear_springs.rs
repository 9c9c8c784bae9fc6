//! Masses, and the springs of tethers, as matrices in closed form.
//!
//! A segment of direction t, length L and tension T pulls its ends together, when they move against each
//! other by u, with
//!
//! ```text
//! f = (k t t' + T/L (I - t t')) u + c t t' u'
//! ```
//!
//! k stiffness (N/m), c damping (N s/m). An end at r (body frame) on a body moves with `J = [I, -R [r]]`;
//! a force f there follows its place as the body turns by theta, which adds the torque `r x (R' f x theta)`
//! in the body frame. Of a segment that is slack there is nothing.

use aerobot_components::run::{Formulation, LinkMass};
use aerobot_components::segment::{KelvinVoigt, RigidLink, SegmentGeometry, Tension};
use aerobot_components::state::{AddedInertia, Attitude, Inertia, Mass};
use aerobot_components::tether::{Attachment, Tether, TetherParts};
use aerobot_systems::dynamics::links::mass_of;
use aerobot_systems::dynamics::rigid_body::CarriedMass;
use aerobot_systems::linearised_motion::body_block::{BodyBlock, Place, cross_matrix};
use aerobot_systems::modes::sparse_motion::SparseMotion;
use aerobot_systems::nonlinear_solver::block_sparse::BlockMatrix;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;
use glam::DMat3;

use super::sites::Sites;
use crate::scene::Scene;

/// An end of a segment on something that moves.
struct End {
    site: usize,
    place: Place,
    attachment: Option<Attachment>,
}

/// Masses and springs about the state that was evaluated last; and how many segments are slack.
pub(super) fn masses_and_springs(
    world: &mut World,
    scene: &Scene,
    sites: &Sites,
) -> (SparseMotion, usize) {
    let mut motion = SparseMotion::zeros(&sites.pattern);
    for (index, site) in sites.all.iter().enumerate() {
        let block = mass(world, site.entity, site.is_node);
        add_block(&mut motion.mass, (index, index), &block);
    }
    let mut slack = 0;
    let mut tethers = world.query::<(&Tether, &TetherParts)>();
    for (tether, parts) in tethers.iter(world) {
        let coupling_kg = coupling_kg(scene, tether);
        for (segment, points) in parts.segments.iter().zip(parts.points.windows(2)) {
            let ends = [points[0], points[1]].map(|point| end(world, sites, point));
            if coupling_kg != 0.0 {
                let isotropic = DMat3::from_diagonal(glam::DVec3::splat(coupling_kg));
                add_between(&mut motion.mass, &ends, isotropic);
            }
            slack += usize::from(!add_spring(world, &mut motion, *segment, &ends));
        }
    }
    (motion, slack)
}

/// What the inertia of a rod between its ends adds to halves of its mass there, kg: a sixth of it, taken
/// off their motion against each other.
pub(super) fn coupling_kg(scene: &Scene, tether: &Tether) -> f64 {
    let is_rod = scene.run.formulation == Formulation::Denoc && scene.run.links == LinkMass::Rod;
    if is_rod {
        -tether.mass_kg() / f64::from(tether.segments()) / 6.0
    } else {
        0.0
    }
}

fn mass(world: &World, entity: Entity, is_node: bool) -> BodyBlock {
    let entity = world.entity(entity);
    let own = entity.get::<Mass>().copied().unwrap_or_default();
    if is_node {
        return BodyBlock {
            linear: DMat3::from_diagonal(glam::DVec3::splat(own.0)),
            ..BodyBlock::ZERO
        };
    }
    mass_of(
        &own,
        &entity.get::<AddedInertia>().copied().unwrap_or_default(),
        entity.get::<Inertia>(),
        &entity.get::<CarriedMass>().copied().unwrap_or_default(),
        &entity.get::<Attitude>().copied().unwrap_or_default(),
    )
}

fn end(world: &World, sites: &Sites, point: Entity) -> Option<End> {
    let attachment = world.get::<Attachment>(point).copied();
    let carrier = attachment.map_or(point, |attachment| attachment.carrier);
    let site = *sites.index.get(&carrier)?;
    let offset_m = attachment.map_or(glam::DVec3::ZERO, |attachment| attachment.offset_m);
    Some(End {
        site,
        place: Place::new(sites.all[site].attitude, offset_m),
        attachment,
    })
}

/// Adds a spring; whether there was one that is taut.
fn add_spring(
    world: &World,
    motion: &mut SparseMotion,
    segment: Entity,
    ends: &[Option<End>; 2],
) -> bool {
    let segment = world.entity(segment);
    let (Some(spring), Some(geometry), Some(tension)) = (
        segment.get::<KelvinVoigt>(),
        segment.get::<SegmentGeometry>(),
        segment.get::<Tension>(),
    ) else {
        return true;
    };
    if segment.contains::<RigidLink>() {
        return true;
    }
    if spring.slack && geometry.length_m <= spring.rest_length_m {
        return false;
    }
    let t = geometry.direction;
    let along = DMat3::from_cols(t * t.x, t * t.y, t * t.z);
    let across = tension.0 / geometry.length_m;
    let stiffness = along * spring.stiffness_n_m + (DMat3::IDENTITY - along) * across;
    add_between(&mut motion.stiffness, ends, stiffness);
    add_between(&mut motion.damping, ends, along * spring.damping_n_s_m);
    let pulls = [tension.0 * t, -tension.0 * t];
    for (end, pull) in ends.iter().zip(pulls) {
        let Some(end) = end else { continue };
        let (Some(attachment), true) = (end.attachment, motion.mass.pattern().dim(end.site) == 6)
        else {
            continue;
        };
        let pull_body = attachment_frame(world, &attachment) * pull;
        let follows = BodyBlock {
            turn: -(cross_matrix(attachment.offset_m) * cross_matrix(pull_body)),
            ..BodyBlock::ZERO
        };
        add_block(&mut motion.stiffness, (end.site, end.site), &follows);
    }
    true
}

/// Inertial to body frame of the carrier.
fn attachment_frame(world: &World, attachment: &Attachment) -> glam::DQuat {
    world
        .get::<Attitude>(attachment.carrier)
        .map_or(glam::DQuat::IDENTITY, |attitude| attitude.0.conjugate())
}

/// Adds what a matrix between the motions of two ends is to their sites.
fn add_between(matrix: &mut BlockMatrix, ends: &[Option<End>; 2], s: DMat3) {
    for (row, a) in ends.iter().enumerate() {
        for (column, b) in ends.iter().enumerate() {
            if let (Some(a), Some(b)) = (a, b) {
                let sign = if row == column { 1.0 } else { -1.0 };
                let block = BodyBlock::between(&a.place, s * sign, &b.place);
                add_block(matrix, (a.site, b.site), &block);
            }
        }
    }
}

/// Adds as much of a block as the two sites have coordinates.
fn add_block(matrix: &mut BlockMatrix, (i, j): (usize, usize), block: &BodyBlock) {
    let (rows, columns) = (matrix.pattern().dim(i), matrix.pattern().dim(j));
    let parts = [
        [block.linear, block.linear_by_turn],
        [block.turn_by_linear, block.turn],
    ];
    for row in 0..rows {
        for column in 0..columns {
            let value = parts[row / 3][column / 3].col(column % 3)[row % 3];
            matrix.add(i, j, row, column, value);
        }
    }
}
