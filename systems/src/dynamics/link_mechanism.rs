//! The tree of links of a running world: what the second formulation knows besides the components.

use bevy_ecs::entity::Entity;
use bevy_ecs::resource::Resource;

use super::rigid_body::CarriedMass;
use crate::denoc::closed_dynamics::{ClosedDynamics, Offsets};
use crate::denoc::forward_dynamics::{Accelerations, BodyLoad, Loads};
use crate::denoc::kinematics::{BodyState, LinkStates};
use crate::denoc::loops::LimbElasticity;
use crate::denoc::tree::KinematicTree;
use crate::linearised_motion::body_block::BodyBlock;

/// A node that is left at the end of a severed tether.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LooseNode {
    /// The node.
    pub node: Entity,
    /// Its index among all tether points.
    pub point: usize,
    /// Its mass, kg.
    pub mass_kg: f64,
}

/// A tree with the entities that stand at its ends.
#[derive(Clone, Debug, Default)]
pub struct TreeEntities {
    /// Of each body.
    pub bodies: Vec<Entity>,
    /// Of each loose node; they stand after the bodies in the tree.
    pub loose: Vec<LooseNode>,
    /// The anchor of each limb that has one.
    pub anchors: Vec<Option<Entity>>,
    /// The segment of each link, by its place in the tree.
    pub segments: Vec<Entity>,
    /// Which bodies, loose nodes and tips turn.
    pub turns: Vec<bool>,
    /// Where tethers are attached.
    pub offsets: Offsets,
    /// The anchor of each closure that has one.
    pub ties: Vec<Option<Entity>>,
    /// Mass of the tip of each closure, kg.
    pub tips_kg: Vec<f64>,
    /// What each body has lent to tips, taken off what it carries: all of it is negative.
    pub lent: Vec<CarriedMass>,
    /// Limbs of one link that are at winches, with the lines that have their lengths.
    pub reeled: Vec<(usize, Entity)>,
    /// Elasticity of each limb.
    pub elasticity: Vec<LimbElasticity>,
    /// Number of tether points.
    pub points: usize,
}

/// The tree, its state at the last evaluation, and what that came to.
#[derive(Resource, Debug, Default)]
pub struct LinkMechanism {
    /// What carries what.
    pub tree: KinematicTree,
    /// The entities of its parts.
    pub entities: TreeEntities,
    /// Spans and rates of the links.
    pub links: LinkStates,
    /// Attitudes and motions of bodies and tips.
    pub bodies: Vec<BodyState>,
    /// Of each closure that has one, its anchor.
    pub ties: Vec<BodyState>,
    /// What acts.
    pub loads: Loads,
    /// What follows.
    pub accelerations: Accelerations,
    /// The recursion.
    pub dynamics: ClosedDynamics,
    /// Place in the tree of the link of a segment, by the index of the segment's first point.
    pub link_of_segment: Vec<usize>,
}

impl TreeEntities {
    /// Loose nodes with their places among the bodies of the tree.
    pub fn loose_bodies(&self) -> impl Iterator<Item = (usize, &LooseNode)> {
        (self.bodies.len()..).zip(&self.loose)
    }
}

impl LinkMechanism {
    /// For a tree of these entities.
    #[must_use]
    pub fn new(tree: KinematicTree, entities: TreeEntities) -> Self {
        let mut link_of_segment = vec![usize::MAX; entities.points];
        for limb in &tree.limbs {
            for k in 0..limb.links.len() {
                link_of_segment[limb.segment(k)] = limb.links.start + k;
            }
        }
        let mut loads = Loads::new(&tree, entities.points);
        for (body, loose) in entities.loose_bodies() {
            loads.bodies[body].mass = BodyBlock::point(loose.mass_kg);
        }
        for (closure, kg) in tree.closures.iter().zip(&entities.tips_kg) {
            loads.bodies[closure.tip] = BodyLoad {
                mass: BodyBlock::point(*kg),
                ..BodyLoad::default()
            };
        }
        Self {
            links: LinkStates::default(),
            bodies: vec![BodyState::default(); tree.carried_by.len()],
            ties: vec![BodyState::default(); tree.closures.len()],
            loads,
            accelerations: Accelerations::new(&tree, entities.points),
            dynamics: ClosedDynamics::new(&tree, entities.elasticity.clone()),
            link_of_segment,
            tree,
            entities,
        }
    }

    /// Kinetic energy of rods beyond that of their halves at their ends, J: it is negative.
    #[must_use]
    pub fn kinetic_j(&self) -> f64 {
        self.of_links(|link, kg| 0.5 * kg * self.links.rate_m_s[link].length_squared())
    }

    /// Its rate at the last evaluation, W.
    #[must_use]
    pub fn kinetic_rate_w(&self) -> f64 {
        let found = &self.accelerations.span_m_s2;
        let steady = self.of_links(|link, kg| kg * self.links.rate_m_s[link].dot(found[link]));
        let limbs = self.tree.limbs.iter().zip(&self.tree.kinds);
        let reeled = limbs.filter(|(_, kind)| kind.length_rate_m_s != 0.0);
        let by_change = reeled.map(|(limb, kind)| {
            let rates = self.links.rate_m_s[limb.links.clone()].iter();
            let squares: f64 = rates.map(|rate| rate.length_squared()).sum();
            0.5 * kind.coupling_rate_kg_s() * squares
        });
        steady + by_change.sum::<f64>()
    }

    /// Sum over links, by place in the tree and coupling in kg.
    fn of_links(&self, part: impl Fn(usize, f64) -> f64) -> f64 {
        let limbs = self.tree.limbs.iter().zip(&self.tree.kinds);
        limbs
            .filter(|(_, kind)| kind.coupling_kg != 0.0)
            .flat_map(|(limb, kind)| limb.links.clone().map(|link| part(link, kind.coupling_kg)))
            .sum()
    }
}
