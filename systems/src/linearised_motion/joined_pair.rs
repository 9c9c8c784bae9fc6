//! Two bodies on the ends of one tether, the commonest of all scenes: the body at `from` is eliminated
//! first, then the nodes, then the body at `to`, so that nothing has to be carried along the tether but
//! 3x3 matrices.
//!
//! With B the matrix of the first body without the tether, `y = B^-1 b` its answer to its own load b,
//! `Y = B^-1 J'` that to a force at its place (motion `J w`), and E_0 the first segment:
//!
//! ```text
//! E_0' = (I + E_0 J Y)^-1 E_0     the segment in line with the body
//! f    = E_0' (x_1 - J y)         the force on the body         w = y + Y f
//! ```
//!
//! The nodes follow as in [`chain`](super::chain), from E_0' instead of E_0, with matrices that need not
//! be symmetric, as that of a body is not; `G_i' = C_i E_i` no longer holds, and the latter is kept.

use glam::{DMat3, DVec3};

use super::body_block::{BodyBlock, Place, Twist};
use super::few_bodies::FewBodies;
use super::symmetric3::Symmetric3;
use super::topology::{BodySite, End, Topology};

/// What is kept of a node.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// C = (F + E)^-1.
    compliance: DMat3,
    /// G = E C.
    carried: DMat3,
    /// C E.
    back: DMat3,
}

/// Factors of two bodies and the nodes between them.
#[derive(Clone, Debug)]
pub struct JoinedPair {
    /// Indices of the bodies at `from` and at `to`.
    bodies: [usize; 2],
    sites: [BodySite; 2],
    from: FewBodies,
    to: FewBodies,
    /// Y: linear and angular.
    response: [DMat3; 2],
    /// E_0'.
    first: DMat3,
    nodes: Vec<Node>,
}

impl JoinedPair {
    /// For this topology, if it is one.
    #[must_use]
    pub fn new(topology: &Topology) -> Option<Self> {
        let [line] = topology.lines[..] else {
            return None;
        };
        let (End::OnBody(from), End::OnBody(to)) = (line.from, line.to) else {
            return None;
        };
        if topology.bodies.len() != 2 || from == to {
            return None;
        }
        let sites = [topology.bodies[from], topology.bodies[to]];
        let nothing = Node {
            compliance: DMat3::ZERO,
            carried: DMat3::ZERO,
            back: DMat3::ZERO,
        };
        Some(Self {
            bodies: [from, to],
            sites,
            from: FewBodies::new(&sites[..1])?,
            to: FewBodies::new(&sites[1..])?,
            response: [DMat3::ZERO; 2],
            first: DMat3::ZERO,
            nodes: vec![nothing; line.nodes],
        })
    }

    /// Eliminates all: the blocks of the `bodies` without the tether, the places of its ends, its nodes
    /// and segments as for a [`Chain`](super::chain::Chain). False where a pivot is not positive.
    #[must_use]
    pub fn factorise(
        &mut self,
        bodies: &[BodyBlock],
        [from, to]: [&Place; 2],
        own: &[Symmetric3],
        segments: &[Symmetric3],
    ) -> bool {
        let Some((first, segments)) = segments.split_first() else {
            return false;
        };
        self.from.clear();
        let turns = self.sites[0].turns;
        let block = &bodies[self.bodies[0]];
        self.from.add((0, 0), (turns, turns), block);
        if !self.from.factorise() {
            return false;
        }
        let columns =
            [DVec3::X, DVec3::Y, DVec3::Z].map(|force| self.answer_of_from(from.load(force)));
        let [x, y, z] = columns.map(|w| w.linear);
        let linear = DMat3::from_cols(x, y, z);
        let [x, y, z] = columns.map(|w| w.angular);
        let angular = DMat3::from_cols(x, y, z);
        self.response = [linear, angular];
        let first = DMat3::from(*first);
        let in_line = DMat3::IDENTITY + first * (linear + from.turn * angular);
        // Not symmetric at all, so that its determinant alone says something.
        let (inverse, determinant, _) = inverse(&in_line);
        let mut positive = determinant > 0.0;
        self.first = inverse * first;
        let mut before = self.first;
        for ((node, own), segment) in self.nodes.iter_mut().zip(own).zip(segments) {
            let so_far = before + DMat3::from(*own);
            let segment = DMat3::from(*segment);
            let (compliance, determinant, minors) = self::inverse(&(so_far + segment));
            positive &= minors && determinant > 0.0;
            let carried = segment * compliance;
            *node = Node {
                compliance,
                carried,
                back: compliance * segment,
            };
            before = carried * so_far;
        }
        if !positive {
            return false;
        }
        self.to.clear();
        let mut block = BodyBlock::between(to, before, to);
        block.add(&bodies[self.bodies[1]], 1.0);
        let turns = self.sites[1].turns;
        self.to.add((0, 0), (turns, turns), &block);
        self.to.factorise()
    }

    /// Solves for the motions of the bodies, of which `motions` are the loads, and of the nodes, of which
    /// `r` are.
    pub fn solve(&self, [from, to]: [&Place; 2], r: &mut [DVec3], motions: &mut [Twist]) {
        let [at_from, at_to] = self.bodies;
        let alone = self.answer_of_from(motions[at_from]);
        let place = from.motion(alone);
        let mut carried = self.first * place;
        for (r, node) in r.iter_mut().zip(&self.nodes) {
            *r += carried;
            carried = node.carried * *r;
        }
        let load = to.load(carried);
        motions[at_to].linear += load.linear;
        motions[at_to].angular += load.angular;
        let last = answer(&self.to, self.sites[1].turns, motions[at_to]);
        motions[at_to] = last;
        // Apart, as it need not wait for the node after.
        for (r, node) in r.iter_mut().zip(&self.nodes) {
            *r = node.compliance * *r;
        }
        let mut next = to.motion(last);
        for (r, node) in r.iter_mut().zip(&self.nodes).rev() {
            next = *r + node.back * next;
            *r = next;
        }
        let force = self.first * (next - place);
        motions[at_from] = Twist {
            linear: alone.linear + self.response[0] * force,
            angular: alone.angular + self.response[1] * force,
        };
    }

    fn answer_of_from(&self, load: Twist) -> Twist {
        answer(&self.from, self.sites[0].turns, load)
    }
}

/// The motion of a body under a load; a point does not turn.
fn answer(body: &FewBodies, turns: bool, load: Twist) -> Twist {
    let mut x = [0.0; 6];
    load.linear.write_to_slice(&mut x);
    if turns {
        load.angular.write_to_slice(&mut x[3..]);
    }
    body.solve(&mut x);
    Twist {
        linear: DVec3::from_slice(&x),
        angular: DVec3::from_slice(&x[3..]),
    }
}

/// The inverse, with the determinant of the matrix and whether the leading minors before it are positive.
#[inline(always)]
fn inverse(m: &DMat3) -> (DMat3, f64, bool) {
    let (x, y, z) = (m.x_axis, m.y_axis, m.z_axis);
    let rows = (y.cross(z), z.cross(x), x.cross(y));
    let determinant = x.dot(rows.0);
    let minors = x.x > 0.0 && rows.2.z > 0.0;
    let scale = 1.0 / determinant;
    let inverse = DMat3::from_cols(
        scale * DVec3::new(rows.0.x, rows.1.x, rows.2.x),
        scale * DVec3::new(rows.0.y, rows.1.y, rows.2.y),
        scale * DVec3::new(rows.0.z, rows.1.z, rows.2.z),
    );
    (inverse, determinant, minors)
}
