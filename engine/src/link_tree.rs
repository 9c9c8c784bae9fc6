//! From a scene to the tree of links that the second formulation moves.

use aerobot_components::body::Anchor;
use aerobot_components::run::LinkMass;
use aerobot_components::segment::Severed;
use aerobot_components::state::{FirstOrderState, Inertia, Mass};
use aerobot_components::tether::{Attachment, Tether, TetherParts};
use aerobot_components::winch::{Reeled, ReeledLine};
use aerobot_systems::denoc::articulated_link::Stretch;
use aerobot_systems::denoc::kinematics::LimbOffsets;
use aerobot_systems::denoc::loops::LimbElasticity;
use aerobot_systems::denoc::tree::{KinematicTree, LinkKind, Piece};
use aerobot_systems::dynamics::link_mechanism::{LinkMechanism, LooseNode, TreeEntities};
use aerobot_systems::dynamics::rigid_body::CarriedMass;
use aerobot_systems::linearised_motion::topology::End;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;

use crate::builtin::tethers::lumping;
use crate::scene::Scene;
use crate::topology::WorldTopology;
use crate::world::SceneEntities;

/// The name of the body from which a tree grows unless the scene says otherwise.
const GONDOLA: &str = "gondola";

/// The tips that a body is tied to have at most this part of its mass, and their moment of inertia about its
/// centre at most this part of its least.
const LENT: f64 = 0.25;
/// Mass of a tip that is tied to an anchor, where any is right, kg.
const AT_ANCHOR_KG: f64 = 1.0;

/// The tree of a world with this topology.
pub(crate) fn build(world: &World, scene: &Scene, found: &WorldTopology) -> LinkMechanism {
    let (pieces, loose) = pieces(world, found);
    let kinds: Vec<LinkKind> = pieces
        .iter()
        .filter_map(|piece| link_kind(world, scene, found, piece))
        .collect();
    let mut turns = turns(world, found);
    let loose_from = turns.len();
    turns.resize(loose_from + loose.len(), false);
    let bases = bases(world, scene, found);
    let tree = KinematicTree::of_pieces(&pieces, (&turns, loose_from), &kinds, &bases);
    turns.resize(tree.carried_by.len(), false);
    let mut entities = TreeEntities {
        bodies: found.bodies.clone(),
        points: found.topology.points,
        loose,
        turns,
        ..TreeEntities::default()
    };
    find_ends(world, found, &tree, &mut entities);
    let mut half_links_kg = Vec::with_capacity(tree.limbs.len());
    for (index, limb) in tree.limbs.iter().enumerate() {
        let tether = world.get::<Tether>(found.tethers[limb.line]);
        half_links_kg.push(match reel(world, found, limb.line, limb.segment(0)) {
            Some(reel) => {
                entities.reeled.push((index, reel.entity));
                0.5 * reel.line.line_kg_m * reel.length_m
            }
            None => tether.map_or(0.0, |tether| tether.end_mass_kg(lumping(scene, tether))),
        });
    }
    lend_to_tips(world, &tree, &half_links_kg, &mut entities);
    LinkMechanism::new(tree, entities)
}

/// A line that is reeled at a winch.
struct Reel {
    entity: Entity,
    line: ReeledLine,
    /// Of the segment at the winch.
    length_m: f64,
}

/// The reel at a segment of a tether, given by the index of the segment among all.
fn reel(world: &World, found: &WorldTopology, line: usize, segment: usize) -> Option<Reel> {
    let parts = world.get::<TetherParts>(found.tethers[line])?;
    let number = segment - found.topology.lines[line].first_point;
    let entity = world.get::<Reeled>(*parts.segments.get(number)?)?.line;
    Some(Reel {
        entity,
        line: *world.get::<ReeledLine>(entity)?,
        length_m: world.get::<FirstOrderState>(entity)?.value,
    })
}

/// What the links of a piece have in common.
fn link_kind(
    world: &World,
    scene: &Scene,
    found: &WorldTopology,
    piece: &Piece,
) -> Option<LinkKind> {
    let tether = world.get::<Tether>(found.tethers[piece.line])?;
    let reel = reel(world, found, piece.line, piece.first_point);
    let length_m = reel
        .as_ref()
        .map_or(tether.segment_length_m(), |reel| reel.length_m);
    let link_kg = tether.mass_kg() / tether.length_m * length_m;
    Some(LinkKind {
        length_m,
        length_rate_m_s: reel.map_or(0.0, |reel| reel.line.rate_m_s),
        coupling_kg: match scene.run.links {
            LinkMass::Rod => -link_kg / 6.0,
            LinkMass::PointMass => 0.0,
        },
        joint_mass_kg: tether.node_mass_kg(lumping(scene, tether)),
        stretch: if scene.run.elastic_links {
            Stretch::Elastic
        } else {
            Stretch::Rigid
        },
    })
}

/// The bodies from which trees should grow, the most wanted first.
fn bases(world: &World, scene: &Scene, found: &WorldTopology) -> Vec<usize> {
    let names = world.resource::<SceneEntities>();
    let index = |name: &str| {
        let entity = names.get(name)?;
        found.bodies.iter().position(|body| *body == entity)
    };
    let mut bases: Vec<usize> = scene
        .run
        .base
        .as_deref()
        .and_then(index)
        .into_iter()
        .collect();
    bases.extend(index(GONDOLA));
    let mut by_tethers: Vec<usize> = (0..found.bodies.len()).collect();
    let tethers = |body: &usize| {
        let lines = found.topology.lines.iter();
        let end = End::OnBody(*body);
        lines
            .filter(|line| line.from == end || line.to == end)
            .count()
    };
    by_tethers.sort_by_key(|body| std::cmp::Reverse(tethers(body)));
    bases.extend(by_tethers);
    bases
}

/// Which bodies turn.
fn turns(world: &World, found: &WorldTopology) -> Vec<bool> {
    let bodies = found.bodies.iter();
    bodies
        .map(|body| world.get::<Inertia>(*body).is_some())
        .collect()
}

/// What is left of the tethers between their severed segments, segments at winches apart, and the nodes that are
/// loose between these.
fn pieces(world: &World, found: &WorldTopology) -> (Vec<Piece>, Vec<LooseNode>) {
    let (mut pieces, mut loose) = (Vec::new(), Vec::new());
    let bodies = found.bodies.len();
    for (index, (line, tether)) in found.topology.lines.iter().zip(&found.tethers).enumerate() {
        let Some(parts) = world.get::<TetherParts>(*tether) else {
            continue;
        };
        let is_severed = |segment: &Entity| world.get::<Severed>(*segment).is_some();
        let mut cuts: Vec<usize> = (0..parts.segments.len())
            .filter(|k| is_severed(&parts.segments[*k]))
            .collect();
        cuts.push(parts.segments.len());
        // Points `first..=last` of the tether hang together.
        let mut first = 0;
        for last in cuts {
            let mut end_at = |k: usize, end: End| {
                if k == 0 || k == parts.points.len() - 1 {
                    return end;
                }
                let known = loose
                    .iter()
                    .position(|node: &LooseNode| node.node == parts.points[k]);
                let place = known.unwrap_or_else(|| {
                    loose.push(LooseNode {
                        node: parts.points[k],
                        point: line.first_point + k,
                        mass_kg: world
                            .get::<Mass>(parts.points[k])
                            .map_or(0.0, |mass| mass.0),
                    });
                    loose.len() - 1
                });
                End::OnBody(bodies + place)
            };
            let is_reeled = |k: &usize| world.get::<Reeled>(parts.segments[*k]).is_some();
            let mut bounds = vec![first];
            for reeled in (first..last).filter(is_reeled) {
                bounds.extend([reeled, reeled + 1]);
            }
            bounds.push(last);
            bounds.dedup();
            // What is cut off alone is a node by itself.
            let _ = end_at(first, line.from);
            for ends in bounds.windows(2) {
                pieces.push(Piece {
                    line: index,
                    first_point: line.first_point + ends[0],
                    links: ends[1] - ends[0],
                    from: end_at(ends[0], line.from),
                    to: end_at(ends[1], line.to),
                });
            }
            first = last + 1;
        }
    }
    (pieces, loose)
}

/// The entities and places at the ends of limbs, and of their links.
fn find_ends(
    world: &World,
    found: &WorldTopology,
    tree: &KinematicTree,
    entities: &mut TreeEntities,
) {
    let bodies = found.bodies.len();
    let ties = bodies + entities.loose.len();
    for (limb, kind) in tree.limbs.iter().zip(&tree.kinds) {
        let tether = found.tethers[limb.line];
        let is_cut = limb.child >= ties;
        let (mut offsets, mut anchor) = (LimbOffsets::default(), None);
        if let Some(parts) = world.get::<TetherParts>(tether)
            && let (Some(first), Some(last)) = (parts.points.first(), parts.points.last())
            && let (Some(from), Some(to)) = (
                world.get::<Attachment>(*first),
                world.get::<Attachment>(*last),
            )
        {
            let line = &found.topology.lines[limb.line];
            let links = 0..limb.links.len();
            let segments = links.map(|k| parts.segments[limb.segment(k) - line.first_point]);
            entities.segments.extend(segments);
            let (proximal, distal) = if limb.is_from_outward {
                (from, to)
            } else {
                (to, from)
            };
            let anchor_of = |end: &Attachment| {
                let is_anchor = world.get::<Anchor>(end.carrier).is_some();
                is_anchor.then_some(end.carrier)
            };
            if limb.parent.is_none_or(|parent| parent < bodies) {
                offsets.proximal_m = proximal.offset_m;
                anchor = anchor_of(proximal);
            }
            if is_cut {
                entities.offsets.ties_m.push(distal.offset_m);
                entities.ties.push(anchor_of(distal));
            } else if limb.child < bodies {
                offsets.distal_m = distal.offset_m;
            }
        }
        entities.offsets.limbs.push(offsets);
        entities.anchors.push(anchor);
        let length_m = kind.length_m * limb.links.len() as f64;
        let elasticity = |tether: &Tether| LimbElasticity {
            compliance_m_n: length_m / tether.axial_stiffness_n,
            retardation_s: tether.damping_n_s_m * tether.length_m / tether.axial_stiffness_n,
        };
        let rigid = LimbElasticity {
            compliance_m_n: 0.0,
            retardation_s: 0.0,
        };
        let own = world.get::<Tether>(tether).map_or(rigid, elasticity);
        entities.elasticity.push(own);
    }
}

/// Takes the masses of tips from the bodies that they are tied to: so little that enough is left there.
fn lend_to_tips(
    world: &World,
    tree: &KinematicTree,
    half_links_kg: &[f64],
    entities: &mut TreeEntities,
) {
    entities.lent = vec![CarriedMass::default(); entities.bodies.len()];
    for (index, closure) in tree.closures.iter().enumerate() {
        let Some(body) = closure.onto else {
            entities
                .tips_kg
                .push(AT_ANCHOR_KG + half_links_kg[closure.limb]);
            continue;
        };
        let tied = tree
            .closures
            .iter()
            .filter(|other| other.onto == Some(body));
        let part = LENT / tied.count() as f64;
        let entity = entities.bodies[body];
        let offset_m = entities.offsets.ties_m[index];
        let mut kg = part * world.get::<Mass>(entity).map_or(0.0, |mass| mass.0);
        if let Some(inertia) = world.get::<Inertia>(entity) {
            let least = smallest_moment_kg_m2(inertia);
            kg = kg.min(part * least / offset_m.length_squared());
        }
        // The half link that the body carries there goes with the tip: a rod is positive with both halves only.
        kg += half_links_kg[closure.limb];
        entities.tips_kg.push(kg);
        entities.lent[body].add(-kg, offset_m);
    }
}

/// No more than the smallest moment of inertia: the determinant over the square of half the trace, which two
/// of three principal moments cannot exceed in the mean.
fn smallest_moment_kg_m2(inertia: &Inertia) -> f64 {
    let tensor = inertia.0;
    let half_trace = 0.5 * (tensor.x_axis.x + tensor.y_axis.y + tensor.z_axis.z);
    tensor.determinant() / (half_trace * half_trace)
}
