//! Who moves how in a mode: shares of the kinetic energy.
//!
//! ```text
//! 2 T = sum_bodies (m + m_a) |v|^2 + w' J w  +  sum_tethers sum_points m |v|^2 + sum_links m_c |dv|^2
//! ```
//!
//! averaged over a cycle; m_a added mass, J inertia about the centre of mass, w angular velocity in the
//! body frame. Points of a tether are its nodes and its ends, which carry half a segment each; m_c = -m/6
//! is what a rigid rod has less than halves of it at its ends.

use aerobot_components::state::{AddedInertia, Attitude, Inertia, Mass, Position};
use aerobot_components::tether::{Attachment, Tether, TetherParts};
use aerobot_systems::modes::Complex;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;
use glam::{DMat3, DQuat, DVec3};

use super::linear_springs::coupling_kg;
use super::sites::{ComplexVector, SiteMotion, Sites, carrier};
use super::{Motion, Share};
use crate::scene::Scene;
use crate::world::{EntityName, SceneEntities};

/// A body as it takes part.
#[derive(Clone, Debug)]
struct BodyPart {
    name: String,
    site: usize,
    mass_kg: f64,
    inertia_kg_m2: Option<DMat3>,
}

/// A point of a tether.
#[derive(Clone, Copy, Debug)]
struct PointPart {
    /// Where its motion comes from; nothing moves an anchor.
    site: Option<usize>,
    /// Its place on a carrier from the centre of mass, body frame, m, and the carrier's attitude.
    offset_m: DVec3,
    attitude: DQuat,
    mass_kg: f64,
    /// Unit vector along the tether.
    along: DVec3,
}

/// A tether as it takes part.
#[derive(Clone, Debug)]
struct TetherPart {
    name: String,
    points: Vec<PointPart>,
    coupling_kg: f64,
    /// Directions of the segments.
    segments: Vec<DVec3>,
}

/// All that takes part, in the order of the scene.
#[derive(Clone, Debug)]
pub(super) struct Participants {
    bodies: Vec<BodyPart>,
    tethers: Vec<TetherPart>,
}

/// Velocities of one body that share a mode, for its name.
#[derive(Clone, Debug)]
pub(super) struct BodyMotion {
    pub(super) name: String,
    pub(super) linear: ComplexVector,
}

impl Participants {
    /// Of a world in its steady state.
    pub(super) fn of(world: &World, scene: &Scene, sites: &Sites) -> Self {
        let mut found = Self {
            bodies: Vec::new(),
            tethers: Vec::new(),
        };
        for &entity in world.resource::<SceneEntities>().in_order() {
            let name = world
                .get::<EntityName>(entity)
                .map_or_else(String::new, |name| name.0.to_string());
            if let (Some(tether), Some(parts)) = (
                world.get::<Tether>(entity),
                world.get::<TetherParts>(entity),
            ) {
                let tether = tether_part(world, sites, parts, (name, coupling_kg(scene, tether)));
                found.tethers.push(tether);
            } else if let Some(&site) = sites.index.get(&entity) {
                let mass = world.get::<Mass>(entity).map_or(0.0, |mass| mass.0);
                let added = world.get::<AddedInertia>(entity).map_or(0.0, |a| a.0);
                found.bodies.push(BodyPart {
                    name,
                    site,
                    mass_kg: mass + added,
                    inertia_kg_m2: world.get::<Inertia>(entity).map(|inertia| inertia.0),
                });
            }
        }
        found
    }

    /// Shares of all in the kinetic energy of a mode, largest first; they add up to one.
    pub(super) fn shares(&self, motions: &[SiteMotion]) -> Vec<Share> {
        let mut shares = Vec::new();
        let mut add = |entity: &str, motion: Motion, part: f64| {
            shares.push(Share {
                entity: entity.to_owned(),
                motion,
                part,
            });
        };
        for body in &self.bodies {
            let motion = &motions[body.site];
            for (axis, kind) in [Motion::X, Motion::Y, Motion::Z].into_iter().enumerate() {
                let square = motion.linear.square_along(DVec3::AXES[axis]);
                add(&body.name, kind, body.mass_kg * square);
            }
            let Some(inertia) = body.inertia_kg_m2 else {
                continue;
            };
            let momentum = motion.angular.map(|rate| inertia * rate);
            let kinds = [Motion::Roll, Motion::Pitch, Motion::Yaw];
            for (axis, kind) in kinds.into_iter().enumerate() {
                let energy = (momentum.part(axis).conj() * motion.angular.part(axis)).re;
                add(&body.name, kind, energy);
            }
        }
        for tether in &self.tethers {
            let [transverse, axial] = tether.energies(motions);
            add(&tether.name, Motion::Transverse, transverse);
            add(&tether.name, Motion::Axial, axial);
        }
        let total: f64 = shares.iter().map(|share| share.part).sum();
        for share in &mut shares {
            share.part /= total.max(f64::MIN_POSITIVE);
        }
        shares.sort_by(|a, b| b.part.total_cmp(&a.part));
        shares
    }

    /// Velocities of the bodies.
    pub(super) fn body_motions(&self, motions: &[SiteMotion]) -> Vec<BodyMotion> {
        let motion = |body: &BodyPart| BodyMotion {
            name: body.name.clone(),
            linear: motions[body.site].linear,
        };
        self.bodies.iter().map(motion).collect()
    }

    /// A mode as a vector whose square is about its kinetic energy, and which of its parts are motions in
    /// the plane of x and z.
    pub(super) fn weighted(&self, motions: &[SiteMotion]) -> (Vec<Complex<f64>>, Vec<bool>) {
        let (mut parts, mut in_plane) = (Vec::new(), Vec::new());
        let mut add = |weight: f64, vector: &ComplexVector, plane: [bool; 3]| {
            for (axis, is_in_plane) in plane.into_iter().enumerate() {
                parts.push(vector.part(axis) * weight.max(0.0).sqrt());
                in_plane.push(is_in_plane);
            }
        };
        for body in &self.bodies {
            let motion = &motions[body.site];
            add(body.mass_kg, &motion.linear, [true, false, true]);
            if let Some(inertia) = body.inertia_kg_m2 {
                let mean = (inertia.x_axis.x + inertia.y_axis.y + inertia.z_axis.z) / 3.0;
                add(mean, &motion.angular, [false, true, false]);
            }
        }
        for point in self.tethers.iter().flat_map(|tether| &tether.points) {
            add(point.mass_kg, &point.velocity(motions), [true, false, true]);
        }
        (parts, in_plane)
    }
}

impl PointPart {
    fn velocity(&self, motions: &[SiteMotion]) -> ComplexVector {
        let Some(site) = self.site else {
            return ComplexVector::default();
        };
        let motion = &motions[site];
        let turn = motion
            .angular
            .map(|rate| self.attitude * rate.cross(self.offset_m));
        ComplexVector {
            real: motion.linear.real + turn.real,
            imaginary: motion.linear.imaginary + turn.imaginary,
        }
    }
}

impl TetherPart {
    /// Twice the kinetic energy across and along the tether.
    fn energies(&self, motions: &[SiteMotion]) -> [f64; 2] {
        let (mut across, mut along) = (0.0, 0.0);
        let mut add = |mass_kg: f64, velocity: &ComplexVector, direction: DVec3| {
            let axial = velocity.square_along(direction);
            along += mass_kg * axial;
            across += mass_kg * (velocity.square() - axial);
        };
        let velocities: Vec<ComplexVector> = self
            .points
            .iter()
            .map(|point| point.velocity(motions))
            .collect();
        for (point, velocity) in self.points.iter().zip(&velocities) {
            add(point.mass_kg, velocity, point.along);
        }
        for (ends, direction) in velocities.windows(2).zip(&self.segments) {
            let difference = ComplexVector {
                real: ends[1].real - ends[0].real,
                imaginary: ends[1].imaginary - ends[0].imaginary,
            };
            add(self.coupling_kg, &difference, *direction);
        }
        [across, along]
    }
}

fn tether_part(
    world: &World,
    sites: &Sites,
    parts: &TetherParts,
    (name, coupling_kg): (String, f64),
) -> TetherPart {
    let place = |point: &Entity| world.get::<Position>(*point).map_or(DVec3::ZERO, |p| p.0);
    let places: Vec<DVec3> = parts.points.iter().map(place).collect();
    let point = |(number, entity): (usize, &Entity)| {
        let before = places[number.saturating_sub(1)];
        let after = places[(number + 1).min(places.len() - 1)];
        let attachment = world.get::<Attachment>(*entity);
        let carrier = carrier(world, *entity);
        let attitude = world.get::<Attitude>(carrier);
        PointPart {
            site: sites.index.get(&carrier).copied(),
            offset_m: attachment.map_or(DVec3::ZERO, |end| end.offset_m),
            attitude: attitude.map_or(DQuat::IDENTITY, |attitude| attitude.0),
            mass_kg: world.get::<Mass>(*entity).map_or(0.0, |mass| mass.0),
            along: (after - before).normalize_or(DVec3::Z),
        }
    };
    TetherPart {
        name,
        coupling_kg,
        points: parts.points.iter().enumerate().map(point).collect(),
        segments: places
            .windows(2)
            .map(|ends| (ends[1] - ends[0]).normalize_or(DVec3::Z))
            .collect(),
    }
}
