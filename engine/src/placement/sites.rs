//! What is free to find its place, and where it stands among the unknowns of a search for
//! equilibrium.

use std::collections::BTreeMap;

use aerobot_components::state::{Attitude, Inertia, Position};
use aerobot_components::tether::{Attachment, Tether, TetherNode, TetherParts, TetherStart};
use aerobot_components::torsion::Torsion;
use aerobot_systems::nonlinear_solver::block_sparse::BlockPattern;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;
use glam::{DQuat, DVec3};

use super::Unplaced;

/// What is free to find its place, with its place in the unknowns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Site {
    pub(super) entity: Entity,
    /// The place of three displacements, m, if it may move.
    pub(super) translation: Option<usize>,
    /// The place of three components of a rotation vector, rad, inertial axes, if it may turn.
    pub(super) rotation: Option<usize>,
    /// Where it stood in the guess.
    pub(super) position_m: DVec3,
    pub(super) attitude: DQuat,
}

/// Sites as they are added.
#[derive(Default)]
struct Sites {
    sites: Vec<Site>,
    dims: Vec<usize>,
    offset: usize,
}

impl Sites {
    fn add(&mut self, world: &World, entity: Entity, moves: bool, turns: bool) {
        let translation = moves.then_some(self.offset);
        self.offset += if moves { 3 } else { 0 };
        let rotation = turns.then_some(self.offset);
        self.offset += if turns { 3 } else { 0 };
        self.dims
            .push(3 * (usize::from(moves) + usize::from(turns)));
        self.sites.push(Site {
            entity,
            translation,
            rotation,
            position_m: world.get::<Position>(entity).map_or(DVec3::ZERO, |p| p.0),
            attitude: world
                .get::<Attitude>(entity)
                .map_or(DQuat::IDENTITY, |a| a.0),
        });
    }
}

/// The bodies of `unplaced` and the nodes of its tethers, with the pairs that segments join.
pub(super) fn sites(world: &mut World, unplaced: &Unplaced) -> (Vec<Site>, BlockPattern) {
    let mut found = Sites::default();
    for body in &unplaced.bodies {
        let moves = !unplaced.floating.contains(body);
        let turns = world.get::<Inertia>(*body).is_some();
        if moves || turns {
            found.add(world, *body, moves, turns);
        }
    }
    let mut tethers = world.query::<(Entity, &Tether, &TetherParts)>();
    for (entity, tether, parts) in tethers.iter(world) {
        let settles = match &unplaced.tethers {
            Some(tethers) => tethers.contains(&entity),
            None => {
                tether.start == TetherStart::Equilibrium || holds_one_of(world, parts, unplaced)
            }
        };
        let nodes = parts.points.iter();
        for node in nodes.filter(|p| settles && world.get::<TetherNode>(**p).is_some()) {
            found.add(world, *node, true, false);
        }
    }
    let edges = edges(world, &found.sites);
    let pattern = BlockPattern::new(&found.dims, &edges);
    (found.sites, pattern)
}

/// Whether a tether ends at a body that is yet to be placed.
fn holds_one_of(world: &World, parts: &TetherParts, unplaced: &Unplaced) -> bool {
    [parts.points.first(), parts.points.last()]
        .into_iter()
        .flatten()
        .any(|point| {
            let carrier = world.get::<Attachment>(*point).map(|end| end.carrier);
            carrier.is_some_and(|carrier| unplaced.bodies.contains(&carrier))
        })
}

/// The same sites, counted from where they stand now.
pub(super) fn sites_here(world: &World, mut sites: Vec<Site>) -> Vec<Site> {
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

/// Pairs of sites that a segment joins, or a tether that one of them twists against the other.
fn edges(world: &mut World, sites: &[Site]) -> Vec<(usize, usize)> {
    let places: BTreeMap<Entity, usize> = sites
        .iter()
        .enumerate()
        .map(|(place, site)| (site.entity, place))
        .collect();
    let mut tethers = world.query::<(&TetherParts, Option<&Torsion>)>();
    let mut edges = Vec::new();
    for (parts, torsion) in tethers.iter(world) {
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
        let twisting = torsion.map(|torsion| [torsion.from.carrier, torsion.to.carrier]);
        if let Some([Some(a), Some(b)]) =
            twisting.map(|ends| ends.map(|end| places.get(&end).copied()))
            && parts.points.len() > 2
        {
            edges.push((a, b));
        }
    }
    edges
}
