//! Equations of motion of trees of links: forces in, accelerations and tensions out, by
//! [`crate::denoc::forward_dynamics`].
//!
//! Forces act on joints, attachments and bodies as in the lumped formulation. A link's reaction - its tension,
//! and of a rod what its inertia between the ends adds - is then added to the forces at its ends, so that for
//! every node and every body, as there, force = mass x acceleration.

use aerobot_components::segment::{RigidLink, Segment, Tension};
use aerobot_components::state::{
    Acceleration, AddedInertia, AngularAcceleration, AngularVelocity, Attitude, Force, Inertia,
    Mass, Torque,
};
use aerobot_components::tether::{Attachment, TetherNode, TetherPoint};
use bevy_ecs::change_detection::DetectChangesMut;
use bevy_ecs::query::{With, Without};
use bevy_ecs::system::{Query, Res, ResMut};
use glam::DVec3;

use super::link_mechanism::LinkMechanism;
use super::rigid_body::CarriedMass;
use super::segments::PointArrays;
use crate::denoc::articulated_link::Stretch;
use crate::denoc::closed_dynamics::Motion;
use crate::denoc::forward_dynamics::BodyLoad;
use crate::fault::FaultSlot;
use crate::linearised_motion::body_block::{BodyBlock, Twist};
use crate::linearised_motion::topology::BodyIndex;

/// The mass matrix of a body with what it carries: of the acceleration of its centre of mass (inertial frame)
/// and its angular acceleration (body frame); of a point, in the linear part alone.
#[must_use]
pub fn mass_of(
    own: &Mass,
    added: &AddedInertia,
    inertia: Option<&Inertia>,
    carried: &CarriedMass,
    attitude: &Attitude,
) -> BodyBlock {
    let total = own.0 + added.0 + carried.mass_kg;
    match inertia {
        None => BodyBlock::point(total),
        Some(inertia) => BodyBlock::mass(
            total,
            carried.first_moment_kg_m,
            inertia.0 + carried.inertia_kg_m2,
            attitude.0,
        ),
    }
}

/// What a body brings into the dynamics, with the terms of its angular velocity taken off its loads.
fn load_of(
    mass: BodyBlock,
    (inertia, carried): (Option<&Inertia>, &CarriedMass),
    (attitude, rate): (&Attitude, &AngularVelocity),
    (force, torque): (&Force, &Torque),
) -> BodyLoad {
    let mut load = Twist {
        linear: force.0,
        angular: DVec3::ZERO,
    };
    if inertia.is_some() {
        let omega = rate.0;
        let moment = carried.first_moment_kg_m;
        load.linear -= attitude.0 * omega.cross(omega.cross(moment));
        load.angular = attitude.0.conjugate() * torque.0 - omega.cross(mass.turn * omega);
    }
    BodyLoad {
        mass,
        load,
        turns: inertia.is_some(),
    }
}

/// Takes the forces of the evaluation to the tree, and solves for its accelerations and tensions.
pub fn solve_links(
    mut mechanism: ResMut<LinkMechanism>,
    mut faults: ResMut<FaultSlot>,
    nodes: Query<(&TetherPoint, &Force), With<TetherNode>>,
    bodies: Query<(
        &BodyIndex,
        (&Mass, &AddedInertia, Option<&Inertia>, &CarriedMass),
        (&Attitude, &AngularVelocity),
        (&Force, &Torque),
    )>,
    anchors: Query<&Acceleration>,
    masses: Query<&Mass, With<TetherNode>>,
) {
    let mechanism = &mut *mechanism;
    let (loads, entities) = (&mut mechanism.loads, &mechanism.entities);
    for (point, force) in &nodes {
        loads.point_n[point.index] = force.0;
    }
    for (index, (own, added, inertia, carried), motion, forces) in &bodies {
        let carried = carried.plus(&entities.lent[index.0]);
        let mass = mass_of(own, added, inertia, &carried, motion.0);
        loads.bodies[index.0] = load_of(mass, (inertia, &carried), motion, forces);
    }
    for (body, loose) in entities.loose_bodies() {
        loads.bodies[body].load.linear = loads.point_n[loose.point];
        if let Ok(mass) = masses.get(loose.node) {
            loads.bodies[body].mass = BodyBlock::point(mass.0);
        }
    }
    let limbs = loads.anchor_m_s2.iter_mut().zip(&entities.anchors);
    let ties = loads.tie_m_s2.iter_mut().zip(&entities.ties);
    for (acceleration, anchor) in limbs.chain(ties) {
        if let Some(found) = anchor.and_then(|anchor| anchors.get(anchor).ok()) {
            *acceleration = found.0;
        }
    }
    let motion = Motion {
        links: &mechanism.links,
        bodies: &mechanism.bodies,
        ties: &mechanism.ties,
    };
    let solved = mechanism.dynamics.solve(
        &mechanism.tree,
        motion,
        &mechanism.entities.offsets,
        &mechanism.loads,
        &mut mechanism.accelerations,
    );
    if let Err(massless) = solved {
        faults.report(None, || massless.to_string());
    }
    if let Some((closure, gap_m)) = mechanism.dynamics.widest() {
        report_open_loop(mechanism, closure, gap_m, &mut faults);
    }
    let found = &mut mechanism.accelerations;
    for (body, loose) in mechanism.entities.loose_bodies() {
        found.point_m_s2[loose.point] = found.bodies[body].linear;
    }
}

/// A loop that has opened by more than this part of the tether that closes it cannot be closed.
const WIDEST: f64 = 0.05;

/// Reports a loop that cannot be closed: its tethers are straight, and still too short.
fn report_open_loop(mechanism: &LinkMechanism, closure: usize, gap_m: f64, faults: &mut FaultSlot) {
    let tree = &mechanism.tree;
    let limb = tree.closures[closure].limb;
    let links = tree.limbs[limb].links.clone();
    if gap_m > WIDEST * tree.kinds[limb].length_m * links.len() as f64 {
        faults.report(Some(mechanism.entities.segments[links.start]), || {
            format!(
                "a loop of rigid links is open by {gap_m:.3} m here: its tethers are too short to be joined, or a step \
                 was too long; `run.elastic_links: true` or `LumpedMass` lets tethers stretch"
            )
        });
    }
}

/// Gives nodes and bodies their accelerations.
pub fn accelerate_by_links(
    mechanism: Res<LinkMechanism>,
    mut nodes: Query<(&TetherPoint, &mut Acceleration), With<TetherNode>>,
    mut bodies: Query<
        (&BodyIndex, &mut Acceleration, &mut AngularAcceleration),
        Without<TetherNode>,
    >,
) {
    let found = &mechanism.accelerations;
    for (point, mut acceleration) in &mut nodes {
        acceleration.bypass_change_detection().0 = found.point_m_s2[point.index];
    }
    for (index, mut linear, mut angular) in &mut bodies {
        linear.0 = found.bodies[index.0].linear;
        angular.0 = found.bodies[index.0].angular;
    }
}

/// Adds the reactions of links to the forces on nodes, attachments and bodies, and gives rigid links their
/// tensions.
pub fn add_reactions(
    mechanism: Res<LinkMechanism>,
    mut arrays: ResMut<PointArrays>,
    mut segments: Query<(&Segment, &mut Tension), With<RigidLink>>,
    mut points: Query<(&TetherPoint, &mut Force)>,
    attachments: Query<(&TetherPoint, &Attachment)>,
    mut carriers: Query<(&Attitude, &mut Force, &mut Torque), Without<TetherPoint>>,
) {
    let mechanism = &*mechanism;
    let (tree, found) = (&mechanism.tree, &mechanism.accelerations);
    let loads = arrays.loads_n();
    for (limb, kind) in tree.limbs.iter().zip(&tree.kinds) {
        let per_length = 1.0 / kind.length_m;
        let mut before = limb.proximal_point();
        for (k, link) in limb.links.clone().enumerate() {
            let mut pull = kind.coupling_kg * found.span_m_s2[link]
                + kind.coupling_rate_kg_s() * mechanism.links.rate_m_s[link];
            if kind.stretch == Stretch::Rigid {
                pull += (found.tension_n[link] * per_length) * mechanism.links.span_m[link];
            }
            let distal = limb.distal_point(k);
            loads[before] += pull;
            loads[distal] -= pull;
            before = distal;
        }
    }
    for (segment, mut tension) in &mut segments {
        let link = mechanism.link_of_segment[segment.from_point];
        tension.bypass_change_detection().0 = found.tension_n[link];
    }
    for (point, attachment) in &attachments {
        let pull = loads[point.index];
        if let Ok((attitude, mut force, mut torque)) = carriers.get_mut(attachment.carrier) {
            force.0 += pull;
            torque.0 += (attitude.0 * attachment.offset_m).cross(pull);
        }
    }
    for (point, mut force) in &mut points {
        // Taken, so that the next evaluation finds zeros.
        force.bypass_change_detection().0 += std::mem::take(&mut loads[point.index]);
    }
}
