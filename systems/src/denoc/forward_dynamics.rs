//! Forward dynamics in linear time: from forces to accelerations and tensions, by one sweep inward that
//! factorises H = U D U' on its way, and one outward.

use glam::DVec3;

use super::articulated_body::{ArticulatedBody, BodyBias, CENTRE};
use super::articulated_link::{ArticulatedLink, Carried, LinkBias, Stretch};
use super::kinematics::{BodyState, LimbOffsets, LinkStates};
use super::tree::{KinematicTree, LinkKind};
use crate::linearised_motion::body_block::{BodyBlock, Place, Twist};
use crate::linearised_motion::symmetric3::Symmetric3;

/// What a body brings into the dynamics.
#[derive(Clone, Copy, Debug)]
pub struct BodyLoad {
    /// Mass matrix of the acceleration of its centre of mass (inertial frame) and its angular acceleration
    /// (body frame), with what it carries at fixed places.
    pub mass: BodyBlock,
    /// What acts on it, less its velocity terms: force in the inertial frame (N), torque about the centre
    /// of mass in the body frame (N m).
    pub load: Twist,
    /// Whether it turns; a point does not.
    pub turns: bool,
}

impl Default for BodyLoad {
    fn default() -> Self {
        Self {
            mass: BodyBlock::ZERO,
            load: Twist::default(),
            turns: false,
        }
    }
}

/// Everything that pushes and pulls on a tree.
#[derive(Clone, Debug, Default)]
pub struct Loads {
    /// Force on each joint between links, by index of the point, inertial frame, N; those on attachments
    /// are in the loads of the bodies. Tensions of elastic links are here, of rigid ones not.
    pub point_n: Vec<DVec3>,
    /// Of each body and tip.
    pub bodies: Vec<BodyLoad>,
    /// Acceleration of the anchor of each limb that has one, m/s^2.
    pub anchor_m_s2: Vec<DVec3>,
    /// Acceleration of the anchor of each closure that has one, m/s^2.
    pub tie_m_s2: Vec<DVec3>,
    /// Whether all of this is momenta and velocities, and velocities are asked for.
    pub are_momenta: bool,
}

/// What comes out.
#[derive(Clone, Debug, Default)]
pub struct Accelerations {
    /// Of the span of each link, by its place in the tree, m/s^2.
    pub span_m_s2: Vec<DVec3>,
    /// Of each joint between links, by index of the point, m/s^2; ends of limbs are left out.
    pub point_m_s2: Vec<DVec3>,
    /// Tension of each rigid link, by its place in the tree, N; positive pulls its ends together. Of a
    /// rod the mean along its length.
    pub tension_n: Vec<f64>,
    /// Of each body and tip: linear in the inertial frame, m/s^2, angular in the body frame, rad/s^2.
    pub bodies: Vec<Twist>,
}

/// The factors of the last factorisation and scratch for the sweeps.
#[derive(Clone, Debug, Default)]
pub struct ForwardDynamics {
    links: Vec<ArticulatedLink<f64>>,
    biases: Vec<LinkBias>,
    bodies: Vec<ArticulatedBody>,
    /// Of bases: what they would pass on.
    at_base: Vec<Symmetric3>,
    /// What each limb carries at its distal end.
    carried: Vec<Symmetric3>,
    body_biases: Vec<BodyBias>,
    inertias: Vec<BodyBlock>,
    /// What links pass on to knots.
    knots: Vec<Carried>,
    body_loads: Vec<Twist>,
    ends: Vec<[LimbEnd; 2]>,
    /// Of bodies and tips, in the answer to more loads.
    motions: Vec<Twist>,
}

/// An end of a limb on a body, or on an anchor, which does not turn.
#[derive(Clone, Copy, Debug)]
struct LimbEnd {
    place: Place,
    /// Acceleration of the place from the body's rate alone, m/s^2.
    centripetal: DVec3,
}

impl LimbEnd {
    fn new(body: &BodyState, offset_m: DVec3) -> Self {
        let rate = body.rate_rad_s;
        Self {
            place: Place::new(body.attitude, offset_m),
            centripetal: body.attitude * rate.cross(rate.cross(offset_m)),
        }
    }
}

/// A system that cannot be moved: somewhere there is no mass, or too little beside what it carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "something between links has no mass that would count beside what it carries: make it heavier, or a \
     node of the tether"
)]
pub struct Massless;

impl ForwardDynamics {
    /// Scratch for a tree.
    #[must_use]
    pub fn new(tree: &KinematicTree) -> Self {
        let bodies = tree.carried_by.len();
        let end = LimbEnd {
            place: CENTRE,
            centripetal: DVec3::ZERO,
        };
        Self {
            links: vec![ArticulatedLink::default(); tree.links],
            biases: vec![LinkBias::default(); tree.links],
            bodies: vec![ArticulatedBody::default(); bodies],
            at_base: vec![Symmetric3::default(); bodies],
            carried: vec![Symmetric3::default(); tree.limbs.len()],
            body_biases: vec![BodyBias::default(); bodies],
            inertias: vec![BodyBlock::ZERO; bodies],
            knots: vec![Carried::default(); bodies],
            body_loads: vec![Twist::default(); bodies],
            ends: vec![[end; 2]; tree.limbs.len()],
            motions: vec![Twist::default(); bodies],
        }
    }

    /// Solves for all accelerations and tensions.
    ///
    /// # Errors
    /// [`Massless`].
    pub fn solve(
        &mut self,
        tree: &KinematicTree,
        states: (&LinkStates, &[BodyState]),
        offsets: &[LimbOffsets],
        loads: &Loads,
        out: &mut Accelerations,
    ) -> Result<(), Massless> {
        self.sweep_inward(tree, states, offsets, loads, out)?;
        self.sweep_outward(tree, loads, out);
        Ok(())
    }

    /// The sweep inward: leaves factors, biases, and the accelerations of bases.
    ///
    /// # Errors
    /// [`Massless`].
    pub fn sweep_inward(
        &mut self,
        tree: &KinematicTree,
        states: (&LinkStates, &[BodyState]),
        offsets: &[LimbOffsets],
        loads: &Loads,
        out: &mut Accelerations,
    ) -> Result<(), Massless> {
        let (links, bodies) = states;
        for (index, limb) in tree.limbs.iter().enumerate() {
            let [proximal, distal] = &mut self.ends[index];
            if let Some(parent) = limb.parent {
                *proximal = LimbEnd::new(&bodies[parent], offsets[index].proximal_m);
            }
            *distal = LimbEnd::new(&bodies[limb.child], offsets[index].distal_m);
        }
        for (index, body) in loads.bodies.iter().enumerate() {
            self.inertias[index] = body.mass;
            self.body_loads[index] = body.load;
        }
        let mut all_positive = true;
        for index in (0..tree.limbs.len()).rev() {
            all_positive &= self.sweep_limb_inward(tree, index, links, loads);
        }
        for &base in &tree.bases {
            out.bodies[base] = self.solve_base(base, loads).ok_or(Massless)?;
        }
        if all_positive { Ok(()) } else { Err(Massless) }
    }

    /// The sweep outward, from the bases to all that they carry.
    pub fn sweep_outward(&self, tree: &KinematicTree, loads: &Loads, out: &mut Accelerations) {
        for index in 0..tree.limbs.len() {
            self.sweep_limb_outward(tree, index, loads, out);
        }
    }

    /// Eliminates the body at the end of a limb and then its links; whether all that could be.
    fn sweep_limb_inward(
        &mut self,
        tree: &KinematicTree,
        index: usize,
        states: &LinkStates,
        loads: &Loads,
    ) -> bool {
        let (limb, kind) = (&tree.limbs[index], &tree.kinds[index]);
        let [proximal, distal] = self.ends[index];
        let child = limb.child;
        let turns = loads.bodies[child].turns;
        let (body, inertia) = ArticulatedBody::new(&self.inertias[child], distal.place, turns);
        let bias = body.inward(-self.body_loads[child], distal.centripetal);
        self.bodies[child] = body;
        self.body_biases[child] = bias;
        let mut carried = Carried::from(inertia);
        if tree.knots[child] {
            carried = self.knots[child].plus(inertia);
        }
        self.carried[index] = carried.total();
        let mut force = bias.passed_on;
        let spans = &states.span_m[limb.links.clone()];
        let rates = &states.rate_m_s[limb.links.clone()];
        let links = &mut self.links[limb.links.clone()];
        let biases = &mut self.biases[limb.links.clone()];
        let mut all_positive = true;
        let count = spans.len();
        let per_length = 1.0 / kind.length_m;
        for k in (0..count).rev() {
            let (direction, along) = match kind.stretch {
                Stretch::Rigid => (spans[k] * per_length, loads.along(kind, rates[k])),
                Stretch::Elastic => (DVec3::ZERO, 0.0),
            };
            let (link, passed_on, positive) =
                ArticulatedLink::new(carried, kind.coupling_kg, direction, kind.stretch);
            let flow = loads.flow(kind, rates[k]);
            let mut bias = link.inward(force + flow, along);
            bias.passed_on -= flow;
            links[k] = link;
            biases[k] = bias;
            all_positive &= positive;
            (carried, force) = (passed_on, bias.passed_on);
            if k > 0 {
                carried = carried.plus(Symmetric3::identity(kind.joint_mass_kg));
                force -= loads.point_n[limb.distal_point(k - 1)];
            }
        }
        if let Some(parent) = limb.parent {
            let place = proximal.place;
            let total = carried.total();
            if tree.knots[parent] {
                self.knots[parent] = carried;
            } else {
                let block = BodyBlock::between(&place, total.into(), &place);
                self.inertias[parent].add(&block, 1.0);
            }
            let push = place.load(total.times(proximal.centripetal) + force);
            self.body_loads[parent].linear -= push.linear;
            self.body_loads[parent].angular -= push.angular;
        }
        all_positive
    }

    fn solve_base(&mut self, base: usize, loads: &Loads) -> Option<Twist> {
        let turns = loads.bodies[base].turns;
        let (body, inertia) = ArticulatedBody::new(&self.inertias[base], CENTRE, turns);
        let bias = body.inward(-self.body_loads[base], DVec3::ZERO);
        self.bodies[base] = body;
        self.at_base[base] = inertia;
        body.free(&bias, &inertia)
    }

    fn sweep_limb_outward(
        &self,
        tree: &KinematicTree,
        index: usize,
        loads: &Loads,
        out: &mut Accelerations,
    ) {
        let limb = &tree.limbs[index];
        let [proximal, _] = &self.ends[index];
        let mut at = match limb.parent {
            Some(parent) => proximal.place.motion(out.bodies[parent]) + proximal.centripetal,
            None => loads.anchor_m_s2[index],
        };
        let links = self.links[limb.links.clone()].iter();
        let spans = &mut out.span_m_s2[limb.links.clone()];
        let tensions = &mut out.tension_n[limb.links.clone()];
        let biases = &self.biases[limb.links.clone()];
        for (k, (link, bias)) in links.zip(biases).enumerate() {
            let (distal, tension) = link.outward(bias, at);
            spans[k] = distal - at;
            tensions[k] = tension;
            out.point_m_s2[limb.distal_point(k)] = distal;
            at = distal;
        }
        let child = limb.child;
        out.bodies[child] = self.bodies[child].outward(&self.body_biases[child], at);
    }
}

impl Loads {
    /// For a tree with `points` tether points.
    #[must_use]
    pub fn new(tree: &KinematicTree, points: usize) -> Self {
        Self {
            point_n: vec![DVec3::ZERO; points],
            bodies: vec![BodyLoad::default(); tree.carried_by.len()],
            anchor_m_s2: vec![DVec3::ZERO; tree.limbs.len()],
            tie_m_s2: vec![DVec3::ZERO; tree.closures.len()],
            are_momenta: false,
        }
    }

    /// What the ends of a rigid link do against each other along it: the acceleration that keeps its length L,
    /// (L'^2 - |d'|^2)/L (m/s^2, L' steady), or its velocity L'.
    #[inline(always)]
    fn along(&self, kind: &LinkKind, rate_m_s: DVec3) -> f64 {
        if self.are_momenta {
            return kind.length_rate_m_s;
        }
        let own = kind.length_rate_m_s * kind.length_rate_m_s;
        (own - rate_m_s.length_squared()) / kind.length_m
    }

    /// Of a rod whose mass changes with its length, E' d' of the momentum E d' that it has beyond that of its
    /// halves, N: at its distal end, the opposite at the proximal one.
    #[inline(always)]
    fn flow(&self, kind: &LinkKind, rate_m_s: DVec3) -> DVec3 {
        if self.are_momenta {
            return DVec3::ZERO;
        }
        kind.coupling_rate_kg_s() * rate_m_s
    }
}

impl Accelerations {
    /// For a tree with `points` tether points.
    #[must_use]
    pub fn new(tree: &KinematicTree, points: usize) -> Self {
        Self {
            span_m_s2: vec![DVec3::ZERO; tree.links],
            point_m_s2: vec![DVec3::ZERO; points],
            tension_n: vec![0.0; tree.links],
            bodies: vec![Twist::default(); tree.carried_by.len()],
        }
    }

    /// All zero.
    pub fn clear(&mut self) {
        self.span_m_s2.fill(DVec3::ZERO);
        self.point_m_s2.fill(DVec3::ZERO);
        self.tension_n.fill(0.0);
        self.bodies.fill(Twist::default());
    }
}

pub mod response;

#[cfg(test)]
mod tests;
