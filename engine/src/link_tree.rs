//! From a scene to the tree of links that the second formulation moves.

use aerobot_components::body::Anchor;
use aerobot_components::run::LinkMass;
use aerobot_components::state::Inertia;
use aerobot_components::tether::{Attachment, Tether, TetherParts};
use aerobot_systems::denoc::articulated_link::Stretch;
use aerobot_systems::denoc::kinematics::LimbOffsets;
use aerobot_systems::denoc::tree::{KinematicTree, LinkKind};
use aerobot_systems::dynamics::link_mechanism::{LinkMechanism, TreeEntities};
use bevy_ecs::world::World;

use crate::builtin::tethers::lumping;
use crate::scene::{Scene, SetupError};
use crate::topology::WorldTopology;
use crate::world::{EntityName, SceneEntities};

/// The name of the body from which a tree grows unless the scene says otherwise.
const GONDOLA: &str = "gondola";

/// The tree of a world with this topology.
///
/// # Errors
/// A loop (the checks of the scene have looked for them, but a plugin may tie its own).
pub(crate) fn build(
    world: &World,
    scene: &Scene,
    found: &WorldTopology,
) -> Result<LinkMechanism, SetupError> {
    let kinds: Vec<LinkKind> = found
        .tethers
        .iter()
        .filter_map(|tether| Some(link_kind(scene, world.get::<Tether>(*tether)?)))
        .collect();
    let tree = KinematicTree::new(&found.topology, &kinds, &bases(world, scene, found)).map_err(
        |closed| {
            let name = world
                .get::<EntityName>(found.tethers[closed.line])
                .map_or("", |name| &name.0);
            SetupError::new(
                "run.formulation",
                format!("`Denoc` moves trees of links, and `{name}` closes a loop"),
                "use `LumpedMass` (`--formulation lumped-mass`)",
            )
        },
    )?;
    let entities = entities(world, found, &tree);
    Ok(LinkMechanism::new(tree, entities))
}

fn link_kind(scene: &Scene, tether: &Tether) -> LinkKind {
    let link_kg = tether.mass_kg() / f64::from(tether.segments());
    LinkKind {
        length_m: tether.segment_length_m(),
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
    }
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
        let end = aerobot_systems::linearised_motion::topology::End::OnBody(*body);
        lines
            .filter(|line| line.from == end || line.to == end)
            .count()
    };
    by_tethers.sort_by_key(|body| std::cmp::Reverse(tethers(body)));
    bases.extend(by_tethers);
    bases
}

fn entities(world: &World, found: &WorldTopology, tree: &KinematicTree) -> TreeEntities {
    let mut entities = TreeEntities {
        turns: found
            .bodies
            .iter()
            .map(|body| world.get::<Inertia>(*body).is_some())
            .collect(),
        bodies: found.bodies.clone(),
        points: found.topology.points,
        ..TreeEntities::default()
    };
    for limb in &tree.limbs {
        let tether = found.tethers[limb.line];
        let (mut offsets, mut anchor) = (LimbOffsets::default(), None);
        if let Some(parts) = world.get::<TetherParts>(tether)
            && let (Some(first), Some(last)) = (parts.points.first(), parts.points.last())
            && let (Some(from), Some(to)) = (
                world.get::<Attachment>(*first),
                world.get::<Attachment>(*last),
            )
        {
            if limb.is_from_outward {
                entities.segments.extend(&parts.segments);
            } else {
                entities.segments.extend(parts.segments.iter().rev());
            }
            let (proximal, distal) = if limb.is_from_outward {
                (from, to)
            } else {
                (to, from)
            };
            offsets = LimbOffsets {
                proximal_m: proximal.offset_m,
                distal_m: distal.offset_m,
            };
            anchor = world
                .get::<Anchor>(proximal.carrier)
                .is_some()
                .then_some(proximal.carrier);
        }
        entities.offsets.push(offsets);
        entities.anchors.push(anchor);
    }
    entities
}
