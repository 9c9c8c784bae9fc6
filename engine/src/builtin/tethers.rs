//! Tethers: from one component of a scene to attachments, nodes and segments.

use aerobot_components::aerodynamics::SphereRadius;
use aerobot_components::body::{Body, Fixed, Motion, Moving};
use aerobot_components::derivatives::SegmentDerivatives;
use aerobot_components::inertia::InertiaShape;
use aerobot_components::run::{Formulation, LinkMass};
use aerobot_components::scene_component::FieldReport;
use aerobot_components::segment::{
    KelvinVoigt, RigidLink, Segment, SegmentDrag, SegmentGeometry, SegmentLoad, Tension,
};
use aerobot_components::state::{Acceleration, Air, Force, Mass, Origin, Position, Velocity};
use aerobot_components::tether::{
    Attachment, AttachmentPoint, Lumping, NamedPoint, Tether, TetherEnd, TetherNode, TetherParts,
    TetherPoint, TetherSide,
};
use aerobot_components::tether_ring::Tethers;
use aerobot_systems::dynamics::attachments::{load_carriers, place_attachments};
use aerobot_systems::dynamics::point_mass::accelerate_nodes;
use aerobot_systems::dynamics::rigid_body::CarriedMass;
use aerobot_systems::dynamics::segments::{PointArrays, load_points, segment_geometry};
use aerobot_systems::forces::segment_drag::{segment_drag, segment_drag_derivatives};
use aerobot_systems::forces::spring::{rigid_link_derivatives, spring, spring_derivatives};
use bevy_ecs::bundle::Bundle;
use bevy_ecs::entity::Entity;
use bevy_ecs::schedule::IntoScheduleConfigs;
use bevy_ecs::world::World;
use glam::DVec3;

use crate::plugin::{Plugin, Simulator};
use crate::scene::checks::meant;
use crate::scene::{Scene, SceneEntity, SetupError};
use crate::schedule::Phase;
use crate::world::{EntityName, Free, SceneEntities, SpawnOrder, next_spawn_order};

/// Tethers of lumped masses and Kelvin-Voigt segments.
pub struct TethersPlugin;

impl Plugin for TethersPlugin {
    fn build(&self, simulator: &mut Simulator) {
        simulator
            .register_component::<Tether>()
            .register_component::<Tethers>()
            .add_expansion(Tethers::members)
            .add_check(check_ends)
            .add_setup(set_up)
            .add_systems(Phase::Prepare, || {
                (place_attachments, segment_geometry).chain()
            })
            .add_systems_in(Phase::Forces, has_springs, || spring)
            .add_systems_if(Phase::Forces, has_drag, || segment_drag)
            .add_systems_for::<Tether, _, _>(Phase::Dynamics, || {
                (load_points, load_carriers).chain()
            })
            .add_systems_in(Phase::Dynamics, has_free_nodes, || accelerate_nodes)
            .add_systems_in(Phase::Derivatives, has_springs, || spring_derivatives)
            .add_systems_in(Phase::Derivatives, has_rigid_links, || {
                rigid_link_derivatives
            })
            .add_systems_if(Phase::Derivatives, has_drag, || segment_drag_derivatives);
    }
}

/// Whether tethers move as trees of links.
pub(crate) fn has_links(scene: &Scene, formulation: Formulation) -> bool {
    formulation == Formulation::Denoc && scene.with::<Tether>().next().is_some()
}

/// Whether the links keep their length.
pub(super) fn has_rigid_links(scene: &Scene, formulation: Formulation) -> bool {
    has_links(scene, formulation) && !scene.run.elastic_links
}

/// Whether segments stretch.
pub(super) fn has_springs(scene: &Scene, formulation: Formulation) -> bool {
    scene.with::<Tether>().next().is_some() && !has_rigid_links(scene, formulation)
}

/// Whether nodes move by themselves.
fn has_free_nodes(scene: &Scene, formulation: Formulation) -> bool {
    scene.with::<Tether>().next().is_some() && !has_links(scene, formulation)
}

/// Where the mass of a tether goes: half of a rod counts at each of its ends.
pub(crate) fn lumping(scene: &Scene, tether: &Tether) -> Lumping {
    if has_links(scene, scene.run.formulation) && scene.run.links == LinkMass::Rod {
        Lumping::HalfSegment
    } else {
        tether.lumping
    }
}

fn has_drag(scene: &Scene) -> bool {
    scene
        .with::<Tether>()
        .any(|(_, tether)| tether.drag.is_some())
}

fn check_ends(scene: &Scene, report: &mut FieldReport) {
    for (entity, tether) in scene.with::<Tether>() {
        let path = entity.path::<Tether>();
        for (field, end) in [("from", &tether.from), ("to", &tether.to)] {
            check_end(scene, entity, end, &format!("{path}.{field}"), report);
        }
        if tether.from.0 == tether.to.0 {
            report.add(
                &format!("{path}.to"),
                format!("the tether runs from `{}` to itself", tether.to.0),
                "the two ends of a tether are on different bodies or anchors",
            );
        }
    }
}

fn check_end(
    scene: &Scene,
    tether: &SceneEntity,
    end: &TetherEnd,
    path: &str,
    report: &mut FieldReport,
) {
    let TetherEnd(name, point) = end;
    let Some(target) = scene.entity(name) else {
        if scene.may_be_unread(name) {
            return;
        }
        let carriers = scene
            .entities
            .iter()
            .filter(|entity| !entity.has::<Tether>() && entity.name != tether.name);
        let help = scene.groups.help(name);
        let help = help.unwrap_or_else(|| meant(name, carriers));
        report.add(
            path,
            format!("there is no entity `{name}` to tether to"),
            help,
        );
        return;
    };
    if !target.complete {
        return;
    }
    if let Some(other) = target.get::<Tether>() {
        let closes = other.from.0 == tether.name || other.to.0 == tether.name;
        let message = if closes && target.name != tether.name {
            format!(
                "`{}` and `{name}` are tethered to each other in a cycle",
                tether.name
            )
        } else {
            format!("`{name}` is a tether, and a tether ends at a body or an anchor")
        };
        report.add(
            path,
            message,
            "give the name of an entity with `Body`, `Fixed` or `Moving`",
        );
        return;
    }
    if !(target.has::<Body>() || target.has::<Fixed>() || target.has::<Moving>()) {
        report.add(
            path,
            format!("`{name}` is neither a body nor an anchor"),
            "an entity with `Body`, `Fixed` or `Moving` can carry a tether",
        );
        return;
    }
    check_point(target, *point, path, report);
}

fn check_point(target: &SceneEntity, point: AttachmentPoint, path: &str, report: &mut FieldReport) {
    let shape = target.get::<Body>().map(|body| body.inertia);
    let has_sphere = target.has::<aerobot_components::aerodynamics::Sphere>();
    let named_height = matches!(
        point,
        AttachmentPoint::Named(NamedPoint::Bottom | NamedPoint::Top)
            | AttachmentPoint::Displaced(NamedPoint::Bottom | NamedPoint::Top, _)
    );
    if named_height && !has_sphere && shape.and_then(|shape| shape.half_height_m()).is_none() {
        report.add(
            path,
            format!("`{}` has no shape whose top or bottom would be known", target.name),
            "give the offset (x, y, z) in metres, or the body a `Sphere` or an inertia with a height",
        );
    }
    let off_centre = named_height
        || matches!(point, AttachmentPoint::Displaced(..))
        || matches!(point, AttachmentPoint::Offset(x, y, z) if x != 0.0 || y != 0.0 || z != 0.0);
    let is_anchor = target.has::<Fixed>() || target.has::<Moving>();
    if off_centre && !is_anchor && matches!(shape, Some(InertiaShape::Point)) {
        report.add(
            path,
            format!(
                "`{}` is a point: it has no place off its centre",
                target.name
            ),
            "attach at `Centre`, or give the body an `inertia`",
        );
    }
}

/// Place of an attachment from the carrier's centre of mass, body frame, m.
fn offset_m(world: &World, carrier: Entity, point: AttachmentPoint) -> DVec3 {
    let half_height = world
        .get::<SphereRadius>(carrier)
        .map(|radius| radius.0)
        .or_else(|| {
            world
                .get::<Body>(carrier)
                .and_then(|body| body.inertia.half_height_m())
        })
        .unwrap_or(0.0);
    let named_m = |named| match named {
        NamedPoint::Centre => DVec3::ZERO,
        NamedPoint::Bottom => DVec3::new(0.0, 0.0, -half_height),
        NamedPoint::Top => DVec3::new(0.0, 0.0, half_height),
    };
    match point {
        AttachmentPoint::Offset(x, y, z) => DVec3::new(x, y, z),
        AttachmentPoint::Named(named) => named_m(named),
        AttachmentPoint::Displaced(named, by_m) => named_m(named) + by_m,
    }
}

fn set_up(world: &mut World, scene: &Scene) -> Result<(), SetupError> {
    let mut points = 0;
    for (entity, tether) in scene.with::<Tether>() {
        let names = world.resource::<SceneEntities>();
        let (Some(id), Some(from), Some(to)) = (
            names.get(&entity.name),
            names.get(&tether.from.0),
            names.get(&tether.to.0),
        ) else {
            continue;
        };
        let velocity = entity
            .get::<Motion>()
            .map_or(DVec3::ZERO, |motion| motion.velocity_m_s);
        let mut parts = TetherParts::default();
        let lumping = lumping(scene, tether);
        let end_mass_kg = tether.end_mass_kg(lumping);
        let ends = [
            (from, tether.from.1, TetherSide::From),
            (to, tether.to.1, TetherSide::To),
        ];
        parts
            .points
            .push(spawn_attachment(world, id, end_mass_kg, ends[0], points));
        let order = next_spawn_order(world).0;
        for number in 1..=tether.nodes {
            let place = number as usize;
            parts.points.push(
                world
                    .spawn((
                        EntityName(format!("{}/{number}", entity.name).into()),
                        SpawnOrder(order + place),
                        TetherNode { tether: id, number },
                        TetherPoint {
                            index: points + place,
                        },
                        node(tether.node_mass_kg(lumping), DVec3::ZERO, velocity),
                    ))
                    .id(),
            );
        }
        let last = points + tether.nodes as usize + 1;
        parts
            .points
            .push(spawn_attachment(world, id, end_mass_kg, ends[1], last));
        for number in 1..=tether.segments() {
            let segment = spawn_segment(world, id, tether, number, points);
            parts.segments.push(segment);
            if has_rigid_links(scene, scene.run.formulation) {
                world.entity_mut(segment).insert(RigidLink);
            }
        }
        points = last + 1;
        world.entity_mut(id).insert(parts);
    }
    world.insert_resource(PointArrays::new(points));
    Ok(())
}

/// A node of a mass (kg) at a place (m) with a velocity (m/s).
fn node(mass_kg: f64, position_m: DVec3, velocity_m_s: DVec3) -> impl Bundle {
    (
        Free,
        Mass(mass_kg),
        Position(position_m),
        Origin(position_m),
        Velocity(velocity_m_s),
        Force::default(),
        Acceleration::default(),
    )
}

/// A node that comes in during a run; its name, number and place in the order are given when all are known.
pub(crate) fn spawn_node(
    world: &mut World,
    tether: Entity,
    mass_kg: f64,
    (position_m, velocity_m_s): (DVec3, DVec3),
) -> Entity {
    let unnumbered = (
        EntityName("".into()),
        SpawnOrder(0),
        TetherNode { tether, number: 0 },
        TetherPoint { index: 0 },
    );
    world
        .spawn((unnumbered, node(mass_kg, position_m, velocity_m_s)))
        .id()
}

fn spawn_attachment(
    world: &mut World,
    tether_id: Entity,
    mass_kg: f64,
    end: (Entity, AttachmentPoint, TetherSide),
    index: usize,
) -> Entity {
    let (carrier, point, side) = end;
    let offset_m = offset_m(world, carrier, point);
    if let Some(mut carried) = world.get_mut::<CarriedMass>(carrier) {
        carried.add(mass_kg, offset_m);
    }
    world
        .spawn((
            Attachment {
                tether: tether_id,
                carrier,
                offset_m,
                side,
            },
            TetherPoint { index },
            Mass(mass_kg),
            Position::default(),
            Velocity::default(),
            Force::default(),
            Acceleration::default(),
        ))
        .id()
}

pub(crate) fn spawn_segment(
    world: &mut World,
    tether_id: Entity,
    tether: &Tether,
    number: u32,
    first_point: usize,
) -> Entity {
    let mut segment = world.spawn((
        Segment {
            tether: tether_id,
            number,
            from_point: first_point + number as usize - 1,
        },
        KelvinVoigt {
            rest_length_m: tether.segment_length_m(),
            stiffness_n_m: tether.segment_stiffness_n_m(),
            damping_n_s_m: tether.segment_damping_n_s_m(),
            slack: tether.slack,
        },
        SegmentGeometry::default(),
        SegmentLoad::default(),
        SegmentDerivatives::default(),
        Tension::default(),
    ));
    if let Some(drag) = tether.drag {
        segment.insert((
            SegmentDrag {
                diameter_m: tether.diameter_m,
                normal: drag.normal,
                tangential: drag.tangential,
            },
            Air::default(),
        ));
    }
    segment.id()
}
