//! The kinematic tree of a system of tethers: from a base outward, every tether a limb of links, every
//! body but the base carried by one limb.
//!
//! The base of bodies that an anchor holds is the anchor; of others it is one of them. Limbs stand in
//! order: one that carries a body comes before those which that body carries.
//!
//! A tether by which a body, or an anchor, is reached a second time closes a loop. It is cut at that end: it
//! becomes a limb that carries a *tip*, a point of its own, and a [`Closure`] says where the tip has to stay
//! ([`super::loops`]). Of a tether that has been severed during a run, each [`Piece`] is a limb, and so is the link
//! at a winch, whose length changes; a node between them or at their ends is *loose*, and counts as a body that is
//! a point.
//!
//! Wherever there is a list of bodies, loose nodes stand after them, and tips after these.

use std::ops::Range;

use super::articulated_link::Stretch;
use crate::linearised_motion::topology::{End, Line, Topology};

/// A tether as a limb of the tree: `links.len()` links from its proximal to its distal end.
#[derive(Clone, Debug, PartialEq)]
pub struct Limb {
    /// The tether, as a line of the topology.
    pub line: usize,
    /// Its links among all, outward.
    pub links: Range<usize>,
    /// Whether its proximal end is the tether's `from`.
    pub is_from_outward: bool,
    /// Index of the proximal attachment among all tether points.
    first_point: usize,
    /// The body that carries it; an anchor does if there is none.
    pub parent: Option<usize>,
    /// The body, loose node or tip that it carries.
    pub child: usize,
}

/// A tether, or what is left of it between cuts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Piece {
    /// The tether, as a line of the topology.
    pub line: usize,
    /// Index of its first point, nearest to `from`, among all tether points.
    pub first_point: usize,
    /// Number of its links.
    pub links: usize,
    /// Who carries its first point; a loose node carries itself.
    pub from: End,
    /// Who carries its last point.
    pub to: End,
}

impl From<(usize, &Line)> for Piece {
    /// A line that is whole.
    fn from((index, line): (usize, &Line)) -> Self {
        Self {
            line: index,
            first_point: line.first_point,
            links: line.nodes + 1,
            from: line.from,
            to: line.to,
        }
    }
}

/// A loop that is cut: the tip of a limb, and where it belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Closure {
    /// The limb that carries the tip.
    pub limb: usize,
    /// The tip, among bodies.
    pub tip: usize,
    /// The body to which it is tied; an anchor if there is none.
    pub onto: Option<usize>,
}

impl Limb {
    /// Index among all tether points of the distal end of its link `k`, from 0 outward.
    #[inline]
    #[must_use]
    pub fn distal_point(&self, k: usize) -> usize {
        if self.is_from_outward {
            self.first_point + k + 1
        } else {
            self.first_point - k - 1
        }
    }

    /// Index of its proximal attachment.
    #[must_use]
    pub fn proximal_point(&self) -> usize {
        self.first_point
    }

    /// Index of its link `k` among segments, which have that of their point nearest to `from`.
    #[inline]
    #[must_use]
    pub fn segment(&self, k: usize) -> usize {
        if self.is_from_outward {
            self.first_point + k
        } else {
            self.first_point - k - 1
        }
    }

    /// 1 where the tether counts outward, -1 where it counts inward.
    #[must_use]
    pub fn sign(&self) -> f64 {
        if self.is_from_outward { 1.0 } else { -1.0 }
    }
}

/// What all links of one tether have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkKind {
    /// Length; of an elastic link: at rest, m.
    pub length_m: f64,
    /// Rate of it where a winch pays out or reels in, m/s.
    pub length_rate_m_s: f64,
    /// What a rod adds between its ends, -m/6; zero for a massless link, kg.
    pub coupling_kg: f64,
    /// Mass of a joint between two of them: of a rod, half of either beside it, kg.
    pub joint_mass_kg: f64,
    /// Whether they keep their length.
    pub stretch: Stretch,
}

impl LinkKind {
    /// Gives it another length (m), and the mass that goes with it.
    pub fn reel(&mut self, length_m: f64) {
        self.coupling_kg *= length_m / self.length_m;
        self.length_m = length_m;
    }

    /// Rate of the coupling of a link that is reeled, kg/s.
    #[inline]
    #[must_use]
    pub fn coupling_rate_kg_s(&self) -> f64 {
        self.coupling_kg / self.length_m * self.length_rate_m_s
    }
}

/// A tree, or several side by side.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KinematicTree {
    /// The limbs, in order.
    pub limbs: Vec<Limb>,
    /// Of each limb.
    pub kinds: Vec<LinkKind>,
    /// Bodies that nothing carries.
    pub bases: Vec<usize>,
    /// The limb that carries each body, each loose node and each tip.
    pub carried_by: Vec<Option<usize>>,
    /// Of each body, whether it is a point between two limbs: it passes on what it carries as a joint between
    /// links does.
    pub knots: Vec<bool>,
    /// Number of links.
    pub links: usize,
    /// The loops, in the order of their tips.
    pub closures: Vec<Closure>,
}

impl KinematicTree {
    /// The tree of a topology whose lines are whole: `kinds` by line, `preferred` the bodies that are to be
    /// bases, the first of a system first.
    #[must_use]
    pub fn new(topology: &Topology, kinds: &[LinkKind], preferred: &[usize]) -> Self {
        let pieces: Vec<Piece> = topology.lines.iter().enumerate().map(Piece::from).collect();
        let turns: Vec<bool> = topology.bodies.iter().map(|site| site.turns).collect();
        Self::of_pieces(&pieces, (&turns, turns.len()), kinds, preferred)
    }

    /// The tree of pieces of tethers, each with its kind of links, between bodies and loose nodes, of which `turns`
    /// says whether they turn; loose nodes begin at `loose_from`.
    #[must_use]
    pub fn of_pieces(
        pieces: &[Piece],
        (turns, loose_from): (&[bool], usize),
        kinds: &[LinkKind],
        preferred: &[usize],
    ) -> Self {
        let bodies = turns.len();
        let mut growth = Growth {
            pieces,
            kinds,
            loose_from,
            used: vec![false; pieces.len()],
            reached: vec![false; bodies],
            tree: Self {
                carried_by: vec![None; bodies],
                ..Self::default()
            },
        };
        for (index, line) in pieces.iter().enumerate() {
            if line.from == End::Held || line.to == End::Held {
                growth.grow_along(index, None);
            }
        }
        // The limbs of anchors are grown level by level, then those of each free base.
        growth.grow_from(0);
        for body in preferred.iter().copied().chain(0..bodies) {
            if !growth.reached[body] {
                growth.reached[body] = true;
                growth.tree.bases.push(body);
                let first = growth.tree.limbs.len();
                growth.grow_beyond(body);
                growth.grow_from(first);
            }
        }
        let mut tree = growth.tree;
        let is_knot = |body: usize| {
            let carries = tree.limbs.iter().filter(|limb| limb.parent == Some(body));
            let turns = turns.get(body).is_some_and(|turns| *turns);
            !turns && tree.carried_by[body].is_some() && carries.count() == 1
        };
        tree.knots = (0..tree.carried_by.len()).map(is_knot).collect();
        tree
    }
}

/// A tree on its way.
struct Growth<'a> {
    pieces: &'a [Piece],
    kinds: &'a [LinkKind],
    /// Where loose nodes begin among bodies.
    loose_from: usize,
    used: Vec<bool>,
    reached: Vec<bool>,
    tree: KinematicTree,
}

impl Growth<'_> {
    /// Grows beyond every limb from `first` on.
    fn grow_from(&mut self, first: usize) {
        let mut next = first;
        while let Some(limb) = self.tree.limbs.get(next) {
            self.grow_beyond(limb.child);
            next += 1;
        }
    }

    /// Grows all limbs that a body carries.
    fn grow_beyond(&mut self, body: usize) {
        let end = End::OnBody(body);
        for index in 0..self.pieces.len() {
            let line = &self.pieces[index];
            if !self.used[index] && (line.from == end || line.to == end) {
                self.grow_along(index, Some(body));
            }
        }
    }

    /// Adds a tether that `parent` carries, unless it has been added from its other end.
    fn grow_along(&mut self, index: usize, parent: Option<usize>) {
        let line = self.pieces[index];
        let proximal = parent.map_or(End::Held, End::OnBody);
        let is_from_outward = line.from == proximal;
        let distal = if is_from_outward { line.to } else { line.from };
        let child = match distal {
            End::OnBody(body) if !self.reached[body] => {
                self.reached[body] = true;
                body
            }
            // A loop is closed at a body: from a loose node its other piece goes on when its turn comes.
            End::OnBody(body) if body >= self.loose_from => return,
            End::OnBody(body) => self.tie_tip(Some(body)),
            End::Held => self.tie_tip(None),
        };
        self.used[index] = true;
        let links = self.tree.links..self.tree.links + line.links;
        self.tree.links = links.end;
        self.tree.kinds.push(self.kinds[index]);
        self.tree.carried_by[child] = Some(self.tree.limbs.len());
        self.tree.limbs.push(Limb {
            line: line.line,
            links,
            is_from_outward,
            first_point: if is_from_outward {
                line.first_point
            } else {
                line.first_point + line.links
            },
            parent,
            child,
        });
    }

    /// A new tip for the limb that is about to be added, to be tied to a body or to an anchor.
    fn tie_tip(&mut self, onto: Option<usize>) -> usize {
        let tip = self.tree.carried_by.len();
        self.tree.carried_by.push(None);
        let limb = self.tree.limbs.len();
        self.tree.closures.push(Closure { limb, tip, onto });
        tip
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linearised_motion::topology::BodySite;

    fn topology(bodies: usize, ends: &[(End, End)]) -> Topology {
        let mut lines = Vec::new();
        let mut first_point = 0;
        for (from, to) in ends {
            lines.push(Line {
                first_point,
                nodes: 2,
                first_state: 0,
                from: *from,
                to: *to,
            });
            first_point += 4;
        }
        let body = BodySite {
            first_state: 0,
            turns: true,
            arm_m: 1.0,
        };
        Topology {
            lines,
            bodies: vec![body; bodies],
            points: first_point,
            coordinates: 0,
        }
    }

    fn kinds(count: usize) -> Vec<LinkKind> {
        let kind = LinkKind {
            length_m: 1.0,
            length_rate_m_s: 0.0,
            coupling_kg: 0.0,
            joint_mass_kg: 1.0,
            stretch: Stretch::Rigid,
        };
        vec![kind; count]
    }

    #[test]
    fn branches_grow_outward_from_the_base() {
        use End::OnBody;
        let t = topology(
            4,
            &[
                (OnBody(0), OnBody(1)),
                (OnBody(1), OnBody(2)),
                (OnBody(3), OnBody(1)),
            ],
        );
        let tree = KinematicTree::new(&t, &kinds(3), &[1]);
        assert_eq!(tree.bases, [1]);
        let order: Vec<_> = tree
            .limbs
            .iter()
            .map(|limb| (limb.line, limb.parent, limb.child, limb.is_from_outward))
            .collect();
        let expected = [
            (0, Some(1), 0, false),
            (1, Some(1), 2, true),
            (2, Some(1), 3, false),
        ];
        assert_eq!(order, expected);
        assert_eq!(tree.limbs[0].proximal_point(), 3);
        assert_eq!(tree.limbs[0].distal_point(2), 0);
        assert_eq!(tree.limbs[1].distal_point(2), 7);
        assert_eq!((tree.limbs[0].segment(0), tree.limbs[1].segment(0)), (2, 4));
    }

    #[test]
    fn an_anchor_is_the_base_of_what_it_holds() {
        use End::{Held, OnBody};
        let t = topology(3, &[(OnBody(1), OnBody(0)), (OnBody(1), Held)]);
        let tree = KinematicTree::new(&t, &kinds(2), &[0]);
        assert_eq!(tree.bases, [2]);
        assert_eq!(tree.carried_by, [Some(1), Some(0), None]);
    }

    #[test]
    fn loops_are_cut_at_tips_also_through_anchors() {
        use End::{Held, OnBody};
        let ring = [
            (OnBody(0), OnBody(1)),
            (OnBody(1), OnBody(2)),
            (OnBody(2), OnBody(0)),
        ];
        let by_anchors = [(Held, OnBody(0)), (OnBody(0), OnBody(1)), (OnBody(1), Held)];
        let double = [(OnBody(0), OnBody(1)), (OnBody(0), OnBody(1))];
        for (bodies, ends, line, onto) in [
            (3, &ring[..], 1, Some(2)),
            (2, &by_anchors[..], 1, Some(1)),
            (2, &double[..], 1, Some(1)),
            (0, &[(Held, Held)][..], 0, None),
        ] {
            let t = topology(bodies, ends);
            let tree = KinematicTree::new(&t, &kinds(ends.len()), &[]);
            let [closure] = tree.closures.as_slice() else {
                panic!("one loop")
            };
            assert_eq!((closure.tip, closure.onto), (bodies, onto));
            let limb = &tree.limbs[closure.limb];
            assert_eq!((limb.line, limb.child), (line, closure.tip));
            assert_eq!(tree.limbs.len(), ends.len());
            let carried =
                |body: usize| tree.bases.contains(&body) || tree.carried_by[body].is_some();
            assert!((0..bodies).all(carried));
        }
    }
}
