//! The linear systems of an implicit step in joint coordinates, by the recursion.
//!
//! With N the natural orthogonal complement at the accepted state, M the masses, D = dF/dv and K = dF/dx of
//! points and bodies, a stage with g = gamma h solves for the increments V = N v of their velocities
//!
//! ```text
//! N' (M - g D - g^2 K) N v + g^2 G v = N' (g M N r_v + g^2 K N r_x) - g^2 G r_x      x = g (v + r_x)
//! ```
//!
//! G = diag(T/L) over rigid links: as a link turns, its tension follows it (the second derivative of d in
//! its chart is -e/L). Terms in velocities are left out, as the integrator allows. The matrix has the form
//! of a mass matrix, so that [`super::articulated_link`] and [`super::articulated_body`] solve it as they
//! solve for accelerations; factors are kept for the stages of a step.
//!
//! Loops ask that V keeps their tips at their places, G V = g G r_v: multipliers see to it
//! ([`super::loops`]), with the answers of the factorised matrix; along what redundant tethers leave open they
//! are forces of elasticity, implicit like those of springs.

use glam::DVec3;

use super::articulated_body::{ArticulatedBody, BodyBias, CENTRE};
use super::articulated_link::{ArticulatedLink, Carried, LinkBias, Stretch};
use super::loops::{LimbElasticity, Loops};
use super::tree::{KinematicTree, Limb};
use crate::linearised_motion::body_block::{BodyBlock, Place, Twist};
use crate::linearised_motion::derivatives::Derivatives;
use crate::linearised_motion::stage_solver::{Change, NotSolvable, StageSolver};
use crate::linearised_motion::symmetric3::Symmetric3;
use crate::linearised_motion::topology::{Line, Topology};

/// Where in the state the joint coordinates stand.
#[derive(Clone, Debug, Default)]
pub struct JointPlaces {
    /// Of each body, loose node and tip: its displacement, if it is a base, and its rotation, if it has one.
    pub bodies: Vec<(Option<usize>, Option<usize>)>,
    /// Of the first link; three for each.
    pub first_link: usize,
    /// Number of coordinates.
    pub coordinates: usize,
}

/// What stands after the bodies in a tree.
#[derive(Clone, Debug, Default)]
pub struct Extras {
    /// Loose nodes, by index of the tether point.
    pub loose: Vec<usize>,
    /// Mass of the tip of each closure, lent by the body that it is tied to, kg.
    pub tips_kg: Vec<f64>,
    /// Of each limb.
    pub elasticity: Vec<LimbElasticity>,
}

/// Factors of the matrix of one step, and scratch for its solutions.
#[derive(Clone, Debug)]
pub struct LinkStages {
    tree: KinematicTree,
    topology: Topology,
    places: JointPlaces,
    g: f64,
    links: Vec<ArticulatedLink<Symmetric3>>,
    /// g^2 K of each link, G included.
    stiffness: Vec<Symmetric3>,
    bodies: Vec<ArticulatedBody>,
    /// Of bases: what they would pass on.
    at_base: Vec<Symmetric3>,
    blocks: Vec<BodyBlock>,
    /// What links pass on to knots.
    knots: Vec<Carried>,
    /// What each limb carries at its distal end.
    carried: Vec<Symmetric3>,
    extras: Extras,
    loops: Loops,
    /// Of tips from their places: to be closed, in V without the multipliers, and in r_x.
    gaps: Vec<DVec3>,
    moved_gaps: Vec<DVec3>,
    given_gaps_m: Vec<DVec3>,
    biases: Vec<LinkBias>,
    body_biases: Vec<BodyBias>,
    /// Force that a link's stage puts on its distal end, and takes from its proximal one.
    flows: Vec<DVec3>,
    /// On joints, by link beyond which they are.
    loads: Vec<DVec3>,
    body_loads: Vec<Twist>,
    /// Of the multipliers.
    tip_loads: Vec<Twist>,
    motions: Vec<Twist>,
    speeds: Vec<Twist>,
    /// Of an error and of a step.
    displaced: [Vec<f64>; 2],
}

impl LinkStages {
    /// For a tree made of a topology.
    #[must_use]
    pub fn new(
        tree: KinematicTree,
        topology: Topology,
        places: JointPlaces,
        extras: Extras,
    ) -> Self {
        let (links, bodies) = (tree.links, tree.carried_by.len());
        Self {
            g: 0.0,
            links: vec![ArticulatedLink::default(); links],
            stiffness: vec![Symmetric3::default(); links],
            bodies: vec![ArticulatedBody::default(); bodies],
            at_base: vec![Symmetric3::default(); bodies],
            blocks: vec![BodyBlock::ZERO; bodies],
            knots: vec![Carried::default(); bodies],
            carried: vec![Symmetric3::default(); tree.limbs.len()],
            loops: Loops::new(&tree, extras.elasticity.clone()),
            gaps: vec![DVec3::ZERO; tree.closures.len()],
            moved_gaps: vec![DVec3::ZERO; tree.closures.len()],
            given_gaps_m: vec![DVec3::ZERO; tree.closures.len()],
            extras,
            biases: vec![LinkBias::default(); links],
            body_biases: vec![BodyBias::default(); bodies],
            flows: vec![DVec3::ZERO; links],
            loads: vec![DVec3::ZERO; links],
            body_loads: vec![Twist::default(); bodies],
            tip_loads: vec![Twist::default(); bodies],
            motions: vec![Twist::default(); bodies],
            speeds: vec![Twist::default(); bodies],
            displaced: [(); 2].map(|()| vec![0.0; topology.coordinates]),
            tree,
            topology,
            places,
        }
    }

    /// Whether a body turns; what stands after the bodies does not.
    fn turns(&self, body: usize) -> bool {
        self.topology
            .bodies
            .get(body)
            .is_some_and(|site| site.turns)
    }

    /// Eliminates a limb and the body that it carries.
    fn factorise_limb(
        &mut self,
        index: usize,
        derivatives: &Derivatives,
        step_s: f64,
    ) -> Result<(), NotSolvable> {
        let (limb, kind) = (&self.tree.limbs[index], &self.tree.kinds[index]);
        let g = self.g;
        let (proximal, distal) = self.places(limb, derivatives);
        let child = limb.child;
        let (body, inertia) = ArticulatedBody::new(&self.blocks[child], distal, self.turns(child));
        self.bodies[child] = body;
        let mut carried = Carried::from(inertia);
        if self.tree.knots[child] {
            carried = self.knots[child].plus(inertia);
        }
        self.carried[index] = carried.total();
        for k in (0..limb.links.len()).rev() {
            let segment = &derivatives.segments[limb.segment(k)];
            let all = g * g * segment.geometric_n_m;
            let (stiffness, damping) = match kind.stretch {
                Stretch::Rigid => (Symmetric3::identity(all), 0.0),
                Stretch::Elastic => {
                    let taut = segment.will_be_taut(step_s, derivatives.gravity_m_s2);
                    let taut = f64::from(taut);
                    let along = taut * g * g * segment.stiffness_n_m - all;
                    let stiffness = Symmetric3::along(segment.direction, along, all);
                    (stiffness, taut * g * segment.damping_n_s_m)
                }
            };
            // Drag goes with the mean velocity of the ends: a quarter for each of the four blocks, of
            // which the diagonal ones have been given a half.
            let coupling = stiffness
                .plus(Symmetric3::along(
                    segment.direction,
                    damping,
                    kind.coupling_kg,
                ))
                .plus_scaled(segment.drag, -0.25 * g);
            let direction = limb.sign() * segment.direction;
            let (link, passed_on, positive) =
                ArticulatedLink::new(carried, coupling, direction, kind.stretch);
            let place = limb.links.start + k;
            if !positive {
                let index = self.places.first_link + 3 * place;
                return Err(NotSolvable { index });
            }
            self.links[place] = link;
            self.stiffness[place] = stiffness;
            carried = passed_on;
            if k > 0 {
                let point = &derivatives.points[limb.distal_point(k - 1)];
                carried = carried.plus(
                    Symmetric3::identity(point.mass_kg)
                        .plus_scaled(point.damping, g)
                        .plus_scaled(point.stiffness, g * g),
                );
            }
        }
        match limb.parent {
            Some(parent) if self.tree.knots[parent] => self.knots[parent] = carried,
            Some(parent) => {
                let block = BodyBlock::between(&proximal, carried.total().into(), &proximal);
                self.blocks[parent].add(&block, 1.0);
            }
            None => {}
        }
        Ok(())
    }

    fn places(&self, limb: &Limb, derivatives: &Derivatives) -> (Place, Place) {
        places(limb, self.topology.bodies.len(), derivatives)
    }
}

impl StageSolver for LinkStages {
    fn factorise(
        &mut self,
        derivatives: &Derivatives,
        step_s: f64,
        gamma: f64,
    ) -> Result<(), NotSolvable> {
        let g = gamma * step_s;
        self.g = g;
        self.take_reels(derivatives);
        for (block, body) in self.blocks.iter_mut().zip(&derivatives.bodies) {
            *block = body.mass;
            block.add(&body.damping, g);
            block.add(&body.stiffness, g * g);
        }
        self.weigh_points(derivatives);
        for index in (0..self.tree.limbs.len()).rev() {
            self.factorise_limb(index, derivatives, step_s)?;
        }
        for &base in &self.tree.bases {
            let (body, at_base) =
                ArticulatedBody::new(&self.blocks[base], CENTRE, self.turns(base));
            self.bodies[base] = body;
            self.at_base[base] = at_base;
            if !at_base.inverse().1 {
                let index = self.places.bodies[base].0.unwrap_or(0);
                return Err(NotSolvable { index });
            }
        }
        if !self.tree.closures.is_empty() {
            self.factorise_loops(derivatives);
        }
        Ok(())
    }

    fn solve(&mut self, derivatives: &Derivatives, r: &mut [f64]) {
        let (r_x, rest) = r.split_at_mut(self.places.coordinates);
        let (r_v, r_s) = rest.split_at_mut(self.places.coordinates);
        self.load(derivatives, r_x, r_v);
        self.pull_reels(derivatives, r_s);
        self.sweep_inward(derivatives);
        if !self.tree.closures.is_empty() {
            self.sweep_outward(derivatives, |_, _| {});
            self.close_loops(derivatives);
        }
        let g = self.g;
        self.sweep_outward(derivatives, |at, v| {
            let x = g * (v + DVec3::from_slice(&r_x[at..]));
            v.write_to_slice(&mut r_v[at..]);
            x.write_to_slice(&mut r_x[at..]);
        });
        for r in r_s {
            *r *= self.g;
        }
    }

    fn displace(&mut self, derivatives: &Derivatives, change: &[f64], of: Change) {
        for &base in &self.tree.bases {
            self.motions[base] = self.base_twist(base, change);
        }
        let mut out = std::mem::take(&mut self.displaced[of as usize]);
        for limb in &self.tree.limbs {
            let (proximal, distal) = self.places(limb, derivatives);
            let line = &self.topology.lines[limb.line];
            let mut at = limb
                .parent
                .map_or(DVec3::ZERO, |body| proximal.motion(self.motions[body]));
            for (k, link) in limb.links.clone().enumerate() {
                at += DVec3::from_slice(&change[self.places.first_link + 3 * link..]);
                let point = limb.distal_point(k);
                if line.node_points().contains(&point) {
                    let node = point - line.first_point - 1;
                    at.write_to_slice(&mut out[line.first_state + 3 * node..]);
                }
            }
            let rotation = self.places.bodies[limb.child].1;
            self.motions[limb.child] = hung(at, &distal, rotation, change);
        }
        for (body, point) in (self.topology.bodies.len()..).zip(&self.extras.loose) {
            let at = self.motions[body].linear;
            let line = self.topology.lines.iter();
            if let Some(line) = line.rev().find(|line| line.first_point < *point) {
                let node = point - line.first_point - 1;
                at.write_to_slice(&mut out[line.first_state + 3 * node..]);
            }
        }
        for (site, motion) in self.topology.bodies.iter().zip(&self.motions) {
            let out = &mut out[site.first_state..site.first_state + 6];
            motion.linear.write_to_slice(&mut out[..3]);
            motion.angular.write_to_slice(&mut out[3..]);
        }
        self.displaced[of as usize] = out;
    }

    fn displaced<'a>(&'a self, _: &'a [f64], of: Change) -> &'a [f64] {
        &self.displaced[of as usize]
    }

    fn place(&self, coordinate: usize) -> usize {
        let nodes = |line: &Line| line.first_state..line.first_state + 3 * line.nodes;
        for limb in &self.tree.limbs {
            let line = &self.topology.lines[limb.line];
            if nodes(line).contains(&coordinate) {
                return self.places.first_link + 3 * limb.links.start;
            }
        }
        let body = self
            .topology
            .bodies
            .iter()
            .rposition(|site| site.first_state <= coordinate)
            .unwrap_or(0);
        let own = self.places.bodies.get(body).copied().unwrap_or_default();
        let limb = self.tree.carried_by.get(body).copied().flatten();
        let link = limb.map(|limb| self.places.first_link + 3 * self.tree.limbs[limb].links.start);
        own.0.or(own.1).or(link).unwrap_or(0)
    }
}

/// Places of a limb's proximal and distal end on the bodies there.
fn ends(limb: &Limb, derivatives: &Derivatives) -> (Place, Place) {
    let [from, to] = &derivatives.ends[limb.line];
    if limb.is_from_outward {
        (from.place, to.place)
    } else {
        (to.place, from.place)
    }
}

/// Places of a limb's proximal end on its parent, and of its distal end on what it carries: what stands after
/// the `bodies` is a point, and has no place but itself.
fn places(limb: &Limb, bodies: usize, derivatives: &Derivatives) -> (Place, Place) {
    let (proximal, distal) = ends(limb, derivatives);
    let is_body = |body: usize| body < bodies;
    (
        if limb.parent.is_none_or(is_body) {
            proximal
        } else {
            CENTRE
        },
        if is_body(limb.child) { distal } else { CENTRE },
    )
}

/// How a body moves whose place at the end of a limb moves by `at`, with its rotation read from `r`.
fn hung(at: DVec3, place: &Place, rotation: Option<usize>, r: &[f64]) -> Twist {
    let angular = rotation.map_or(DVec3::ZERO, |first| DVec3::from_slice(&r[first..]));
    Twist {
        linear: at - place.turn * angular,
        angular,
    }
}

mod points_and_loops;
mod reels;
mod sweeps;

#[cfg(test)]
mod tests;
