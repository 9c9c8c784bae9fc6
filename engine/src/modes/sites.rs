//! What moves in small motions: bodies and nodes, with their places among the coordinates.

use std::collections::BTreeMap;

use aerobot_components::state::{
    AngularVelocity, Attitude, Inertia, Position, StateIndex, Velocity,
};
use aerobot_components::tether::{Attachment, TetherNode, TetherParts};
use aerobot_systems::modes::Complex;
use aerobot_systems::nonlinear_solver::block_sparse::BlockPattern;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;
use glam::{DQuat, DVec3};

/// A body or a node at the steady state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Site {
    pub(super) entity: Entity,
    /// The place of its displacement, m, inertial frame; its rotation vector, rad, body frame, follows.
    pub(super) at: usize,
    pub(super) is_node: bool,
    /// Whether it has an attitude of its own.
    pub(super) turns: bool,
    pub(super) position_m: DVec3,
    pub(super) attitude: DQuat,
    pub(super) velocity_m_s: DVec3,
    pub(super) rate_rad_s: DVec3,
}

/// All of them, in the order of the state.
#[derive(Clone, Debug)]
pub(super) struct Sites {
    pub(super) all: Vec<Site>,
    pub(super) index: BTreeMap<Entity, usize>,
    /// Who is joined to whom.
    pub(super) pattern: BlockPattern,
}

/// Velocities of one site in a mode, complex amplitudes: inertial frame, and body frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SiteMotion {
    pub(super) linear: ComplexVector,
    pub(super) angular: ComplexVector,
}

/// A complex vector as two real ones.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ComplexVector {
    pub(super) real: DVec3,
    pub(super) imaginary: DVec3,
}

impl ComplexVector {
    pub(super) fn part(&self, axis: usize) -> Complex<f64> {
        Complex::new(self.real[axis], self.imaginary[axis])
    }

    pub(super) fn map(&self, linear: impl Fn(DVec3) -> DVec3) -> Self {
        Self {
            real: linear(self.real),
            imaginary: linear(self.imaginary),
        }
    }

    /// Adds a complex multiple of another.
    pub(super) fn add(&mut self, factor: Complex<f64>, other: &Self) {
        self.real += factor.re * other.real - factor.im * other.imaginary;
        self.imaginary += factor.re * other.imaginary + factor.im * other.real;
    }

    /// Sum of the squares of the parts along a unit vector.
    pub(super) fn square_along(&self, direction: DVec3) -> f64 {
        let [real, imaginary] = [self.real, self.imaginary].map(|part| part.dot(direction));
        real * real + imaginary * imaginary
    }

    pub(super) fn square(&self) -> f64 {
        self.real.length_squared() + self.imaginary.length_squared()
    }
}

impl Sites {
    /// Of a world that stands in its steady state.
    pub(super) fn of(world: &mut World) -> Self {
        let mut moving: Vec<(usize, Entity)> = world
            .query::<(&StateIndex, Entity)>()
            .iter(world)
            .map(|(place, entity)| (place.0, entity))
            .collect();
        moving.sort_unstable();
        let mut at = 0;
        let mut all = Vec::with_capacity(moving.len());
        for (_, entity) in moving {
            let turns = world.get::<Inertia>(entity).is_some();
            let value = |found: Option<DVec3>| found.unwrap_or(DVec3::ZERO);
            all.push(Site {
                entity,
                at,
                is_node: world.get::<TetherNode>(entity).is_some(),
                turns,
                position_m: value(world.get::<Position>(entity).map(|p| p.0)),
                attitude: world
                    .get::<Attitude>(entity)
                    .map_or(DQuat::IDENTITY, |a| a.0),
                velocity_m_s: value(world.get::<Velocity>(entity).map(|v| v.0)),
                rate_rad_s: value(world.get::<AngularVelocity>(entity).map(|w| w.0)),
            });
            at += if turns { 6 } else { 3 };
        }
        let index: BTreeMap<Entity, usize> = all
            .iter()
            .enumerate()
            .map(|(index, site)| (site.entity, index))
            .collect();
        let dims: Vec<usize> = all
            .iter()
            .map(|site| 3 + 3 * usize::from(site.turns))
            .collect();
        let pattern = BlockPattern::new(&dims, &edges(world, &index));
        Self {
            all,
            index,
            pattern,
        }
    }

    /// The motions of all sites for amplitudes of the coordinates.
    pub(super) fn motions(&self, x: &[Complex<f64>]) -> Vec<SiteMotion> {
        let vector = |at: usize| ComplexVector {
            real: DVec3::new(x[at].re, x[at + 1].re, x[at + 2].re),
            imaginary: DVec3::new(x[at].im, x[at + 1].im, x[at + 2].im),
        };
        let motion = |site: &Site| SiteMotion {
            linear: vector(site.at),
            angular: if site.turns {
                vector(site.at + 3)
            } else {
                ComplexVector::default()
            },
        };
        self.all.iter().map(motion).collect()
    }
}

/// Pairs of sites that a segment joins.
fn edges(world: &mut World, index: &BTreeMap<Entity, usize>) -> Vec<(usize, usize)> {
    let mut edges = Vec::new();
    let mut tethers = world.query::<&TetherParts>();
    for parts in tethers.iter(world) {
        for pair in parts.points.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|point| index.get(&carrier(world, point)));
            if let (Some(a), Some(b)) = (a, b) {
                edges.push((*a, *b));
            }
        }
    }
    edges
}

/// What a point of a tether moves with: itself, or the carrier of an attachment.
pub(super) fn carrier(world: &World, point: Entity) -> Entity {
    world
        .get::<Attachment>(point)
        .map_or(point, |end| end.carrier)
}
