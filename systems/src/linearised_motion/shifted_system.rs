//! The matrix `M - g D - g^2 K` of one step: factors and solutions.

use glam::{DMat3, DVec3};

use super::body_block::{BodyBlock, Place, Twist};
use super::chain::Chain;
use super::derivatives::Derivatives;
use super::few_bodies::FewBodies;
use super::joined_pair::JoinedPair;
use super::stage_solver::{Change, NotSolvable, StageSolver};
use super::symmetric3::Symmetric3;
use super::topology::{End, Topology};
use crate::nonlinear_solver::block_elimination::Elimination;
use crate::nonlinear_solver::block_sparse::{BlockMatrix, BlockPattern};

/// `along t t' + all I` of a segment in the direction t.
#[derive(Clone, Copy, Debug, Default)]
struct ElasticBlock {
    direction: DVec3,
    along: f64,
    all: f64,
}

impl ElasticBlock {
    #[inline(always)]
    fn times(&self, v: DVec3) -> DVec3 {
        self.along * self.direction.dot(v) * self.direction + self.all * v
    }
}

/// Factors of the matrix of one step, and scratch for its solutions.
#[derive(Clone, Debug)]
pub struct ShiftedSystem {
    topology: Topology,
    /// g, s.
    g: f64,
    /// Blocks of the segments: of the matrix, and of g^2 K alone.
    blocks: Vec<Symmetric3>,
    elastic: Vec<ElasticBlock>,
    /// Diagonal blocks of the nodes without those of the segments.
    own: Vec<Symmetric3>,
    chains: Vec<Chain>,
    /// Of the bodies: blocks on the diagonal by body, and beside it by line, of the motion of the `from`
    /// end on the body at the `to` end.
    diagonal: Vec<BodyBlock>,
    beside: Vec<BodyBlock>,
    /// Solves all of two bodies on one tether.
    pair: Option<JoinedPair>,
    /// Whether the factors are in `pair`.
    is_pair: bool,
    /// Solves for one or two bodies.
    few: Option<FewBodies>,
    /// Solves for more, and where the former cannot.
    matrix: BlockMatrix,
    elimination: Elimination,
    /// Whether the factors are in `few`.
    are_few: bool,
    /// Of the nodes, by point.
    loads: Vec<DVec3>,
    /// g m of the nodes, by point.
    inertia: Vec<f64>,
    /// Whether a node has a stiffness of its own.
    has_own_stiffness: bool,
    /// Of the bodies, and what loads them.
    motions: Vec<Twist>,
    pushes: Vec<Twist>,
    rhs: Vec<f64>,
}

impl ShiftedSystem {
    /// For a topology; nothing is factorised yet.
    #[must_use]
    pub fn new(topology: Topology) -> Self {
        let dims: Vec<usize> = topology.bodies.iter().map(|body| body.unknowns()).collect();
        let edges: Vec<(usize, usize)> = topology
            .lines
            .iter()
            .filter_map(|line| match (line.from, line.to) {
                (End::OnBody(from), End::OnBody(to)) => Some((from, to)),
                _ => None,
            })
            .collect();
        let pattern = BlockPattern::new(&dims, &edges);
        let chains = topology
            .lines
            .iter()
            .map(|line| Chain::new(line.nodes, line.from != End::Held))
            .collect();
        Self {
            g: 0.0,
            blocks: vec![Symmetric3::default(); topology.points],
            elastic: vec![ElasticBlock::default(); topology.points],
            own: vec![Symmetric3::default(); topology.points],
            chains,
            elimination: Elimination::analyse(&pattern),
            rhs: vec![0.0; pattern.dimension()],
            diagonal: vec![BodyBlock::ZERO; topology.bodies.len()],
            beside: vec![BodyBlock::ZERO; topology.lines.len()],
            pair: JoinedPair::new(&topology),
            is_pair: false,
            few: FewBodies::new(&topology.bodies),
            matrix: BlockMatrix::new(pattern),
            are_few: false,
            loads: vec![DVec3::ZERO; topology.points],
            inertia: vec![0.0; topology.points],
            has_own_stiffness: false,
            motions: vec![Twist::default(); topology.bodies.len()],
            pushes: vec![Twist::default(); topology.bodies.len()],
            topology,
        }
    }

    fn set_blocks(&mut self, derivatives: &Derivatives, step_s: f64) {
        let (g, g2) = (self.g, self.g * self.g);
        let gravity = derivatives.gravity_m_s2;
        let segments = derivatives.segments.iter();
        for ((segment, block), elastic) in segments.zip(&mut self.blocks).zip(&mut self.elastic) {
            let (k, c) = if segment.will_be_taut(step_s, gravity) {
                (segment.stiffness_n_m, segment.damping_n_s_m)
            } else {
                (0.0, 0.0)
            };
            let all = g2 * segment.geometric_n_m;
            let along = g2 * k - all;
            *elastic = ElasticBlock {
                direction: segment.direction,
                along,
                all,
            };
            // Drag goes with the mean velocity of the ends: a quarter for each of the four blocks,
            // of which the diagonal ones have been given a half.
            *block = Symmetric3::along(segment.direction, along + g * c, all)
                .plus_scaled(segment.drag, -0.25 * g);
        }
        self.has_own_stiffness = false;
        let own = self.own.iter_mut().zip(&mut self.inertia);
        for ((own, inertia), point) in own.zip(&derivatives.points) {
            *own = Symmetric3::identity(point.mass_kg)
                .plus_scaled(point.damping, g)
                .plus_scaled(point.stiffness, g2);
            *inertia = g * point.mass_kg;
            self.has_own_stiffness |= point.stiffness != Symmetric3::default();
        }
    }

    fn set_bodies(&mut self, derivatives: &Derivatives) {
        for (block, body) in self.diagonal.iter_mut().zip(&derivatives.bodies) {
            *block = body.mass;
            block.add(&body.damping, self.g);
            block.add(&body.stiffness, self.g * self.g);
        }
    }

    /// Factorises the whole if it is a pair of bodies; whether that was possible.
    fn factorise_pair(&mut self, derivatives: &Derivatives) -> bool {
        let (Some(pair), [line]) = (&mut self.pair, &self.topology.lines[..]) else {
            return false;
        };
        let places = derivatives.ends[0].each_ref().map(|end| &end.place);
        let own = &self.own[line.node_points()];
        pair.factorise(&self.diagonal, places, own, &self.blocks[line.segments()])
    }

    /// Factorises the blocks of the bodies if these are few; whether that was possible.
    fn factorise_few(&mut self) -> bool {
        let Some(few) = &mut self.few else {
            return false;
        };
        few.clear();
        let (pattern, bodies) = (self.matrix.pattern(), &self.topology.bodies);
        for (body, block) in self.diagonal.iter().enumerate() {
            let (at, turns) = (pattern.offset(body), bodies[body].turns);
            few.add((at, at), (turns, turns), block);
        }
        for (line, block) in self.topology.lines.iter().zip(&self.beside) {
            let (End::OnBody(a), End::OnBody(b)) = (line.from, line.to) else {
                continue;
            };
            let (at_a, at_b) = (pattern.offset(a), pattern.offset(b));
            let (a_turns, b_turns) = (bodies[a].turns, bodies[b].turns);
            few.add((at_b, at_a), (b_turns, a_turns), block);
            few.add((at_a, at_b), (a_turns, b_turns), &block.transposed());
        }
        few.factorise()
    }

    /// Writes the blocks of the bodies to the matrix.
    fn set_matrix(&mut self) {
        self.matrix.clear();
        for (body, block) in self.diagonal.iter().enumerate() {
            add_block(&mut self.matrix, body, body, block);
        }
        for (line, block) in self.topology.lines.iter().zip(&self.beside) {
            if let (End::OnBody(a), End::OnBody(b)) = (line.from, line.to) {
                add_block(&mut self.matrix, b, a, block);
                add_block(&mut self.matrix, a, b, &block.transposed());
            }
        }
    }

    /// `g M r_v + g^2 K r_x` of the bodies alone; leaves their r_x in `motions`.
    fn load_bodies(&mut self, derivatives: &Derivatives, r_x: &[f64], r_v: &[f64]) {
        let g = self.g;
        let sites = self.topology.bodies.iter();
        for ((index, site), body) in sites.enumerate().zip(&derivatives.bodies) {
            let at = site.first_state;
            let shift = twist_at(r_x, at);
            self.motions[index] = shift;
            self.pushes[index] = body.stage_load(g, shift, twist_at(r_v, at));
        }
    }

    /// The same of a line: the loads of its nodes, and what it adds to those of its bodies.
    fn pull_line(&mut self, index: usize, derivatives: &Derivatives, r_x: &[f64], r_v: &[f64]) {
        let line = self.topology.lines[index];
        let g = self.g;
        let [from, to] = &derivatives.ends[index];
        let first = motion_of(&self.motions, line.from, &from.place);
        let last = motion_of(&self.motions, line.to, &to.place);
        let states = line.first_state..line.first_state + 3 * line.nodes;
        let (x, _) = r_x[states.clone()].as_chunks::<3>();
        let (v, _) = r_v[states].as_chunks::<3>();
        let elastic = &self.elastic[line.segments()];
        let loads = &mut self.loads[line.node_points()];
        let mut on_from = DVec3::ZERO;
        let mut before = first;
        // Where the segment behind pulls.
        let mut behind = &mut on_from;
        let states = x.iter().zip(v);
        let nodes = loads.iter_mut().zip(&self.inertia[line.node_points()]);
        for (((x, v), (load, inertia)), elastic) in states.zip(nodes).zip(elastic) {
            let here = DVec3::from_array(*x);
            let pull = elastic.times(here - before);
            *behind += pull;
            *load = *inertia * DVec3::from_array(*v) - pull;
            before = here;
            behind = load;
        }
        let pull = elastic[line.nodes].times(last - before);
        *behind += pull;
        if self.has_own_stiffness {
            let points = &derivatives.points[line.node_points()];
            for ((load, point), x) in loads.iter_mut().zip(points).zip(x) {
                *load -= g * g * point.stiffness.times(DVec3::from_array(*x));
            }
        }
        push(&mut self.pushes, line.from, &from.place, on_from);
        push(&mut self.pushes, line.to, &to.place, -pull);
    }

    /// `g^2 dT/dL0 r_s` of segments whose unstretched length L0 is a first-order state: what the motion
    /// does not change is known beforehand.
    fn pull_reels(&mut self, derivatives: &Derivatives, r_s: &[f64]) {
        for reel in &derivatives.reels {
            let lines = self.topology.lines.iter();
            let Some((line, ends)) = lines
                .zip(&derivatives.ends)
                .find(|(line, _)| line.segments().contains(&reel.segment))
            else {
                continue;
            };
            let by_length = self.g * self.g * reel.tension_by_length_n_m * r_s[reel.state];
            let pull = by_length * derivatives.segments[reel.segment].direction;
            for (point, pull) in [(reel.segment, pull), (reel.segment + 1, -pull)] {
                if point == line.first_point {
                    push(&mut self.pushes, line.from, &ends[0].place, pull);
                } else if point == line.last_point() {
                    push(&mut self.pushes, line.to, &ends[1].place, pull);
                } else {
                    self.loads[point] += pull;
                }
            }
        }
    }

    /// From the loads of nodes and bodies to their motions.
    fn solve_all(&mut self, derivatives: &Derivatives) {
        if let (true, Some(pair), [line]) = (self.is_pair, &self.pair, &self.topology.lines[..]) {
            let places = derivatives.ends[0].each_ref().map(|end| &end.place);
            let loads = &mut self.loads[line.node_points()];
            self.motions.copy_from_slice(&self.pushes);
            pair.solve(places, loads, &mut self.motions);
            return;
        }
        let lines = self.topology.lines.iter().zip(&derivatives.ends);
        for ((line, [from, to]), chain) in lines.zip(&self.chains) {
            let (on_from, on_to) = chain.forward(&mut self.loads[line.node_points()]);
            push(&mut self.pushes, line.from, &from.place, on_from);
            push(&mut self.pushes, line.to, &to.place, on_to);
        }
        self.solve_bodies();
        let lines = self.topology.lines.iter().zip(&derivatives.ends);
        for ((line, [from, to]), chain) in lines.zip(&self.chains) {
            let first = motion_of(&self.motions, line.from, &from.place);
            let last = motion_of(&self.motions, line.to, &to.place);
            chain.backward(&mut self.loads[line.node_points()], first, last);
        }
    }

    fn solve_bodies(&mut self) {
        let pattern = self.matrix.pattern();
        for (index, (site, load)) in self.topology.bodies.iter().zip(&self.pushes).enumerate() {
            let rhs = &mut self.rhs[pattern.offset(index)..][..site.unknowns()];
            load.linear.write_to_slice(rhs);
            if site.turns {
                load.angular.write_to_slice(&mut rhs[3..]);
            }
        }
        match &self.few {
            Some(few) if self.are_few => few.solve(&mut self.rhs),
            _ => self.elimination.solve(&mut self.rhs),
        }
        for (index, site) in self.topology.bodies.iter().enumerate() {
            let v = &self.rhs[self.matrix.pattern().offset(index)..];
            self.motions[index] = Twist {
                linear: DVec3::from_slice(v),
                angular: if site.turns {
                    DVec3::from_slice(&v[3..])
                } else {
                    DVec3::ZERO
                },
            };
        }
    }

    /// Makes X and V of a line's nodes of their motion.
    fn take_line(&self, index: usize, r_x: &mut [f64], r_v: &mut [f64]) {
        let line = self.topology.lines[index];
        let loads = &self.loads[line.node_points()];
        let states = line.first_state..line.first_state + 3 * line.nodes;
        let (x, _) = r_x[states.clone()].as_chunks_mut::<3>();
        let (v, _) = r_v[states].as_chunks_mut::<3>();
        for ((x, v), load) in x.iter_mut().zip(v).zip(loads) {
            *x = (self.g * (*load + DVec3::from_array(*x))).to_array();
            *v = load.to_array();
        }
    }

    fn take_bodies(&mut self, r_x: &mut [f64], r_v: &mut [f64]) {
        for (site, motion) in self.topology.bodies.iter().zip(&self.motions) {
            let at = site.first_state;
            let (r_x, r_v) = (&mut r_x[at..at + 6], &mut r_v[at..at + 6]);
            motion.linear.write_to_slice(&mut r_v[..3]);
            if site.turns {
                motion.angular.write_to_slice(&mut r_v[3..]);
            } else {
                for r in &mut r_v[3..] {
                    *r *= self.g;
                }
            }
            for (x, v) in r_x.iter_mut().zip(r_v) {
                *x = self.g * (*v + *x);
            }
        }
    }
}

impl StageSolver for ShiftedSystem {
    fn factorise(
        &mut self,
        derivatives: &Derivatives,
        step_s: f64,
        gamma: f64,
    ) -> Result<(), NotSolvable> {
        let g = gamma * step_s;
        self.g = g;
        self.set_blocks(derivatives, step_s);
        self.set_bodies(derivatives);
        self.is_pair = self.factorise_pair(derivatives);
        if self.is_pair {
            return Ok(());
        }
        for (index, line) in self.topology.lines.iter().enumerate() {
            let left = self.chains[index]
                .factorise(&self.own[line.node_points()], &self.blocks[line.segments()])
                .map_err(|at| NotSolvable {
                    index: line.first_state + 3 * at.node,
                })?;
            let [from, to] = &derivatives.ends[index];
            if let End::OnBody(body) = line.from {
                let block = BodyBlock::between(&from.place, left.from_from, &from.place);
                self.diagonal[body].add(&block, 1.0);
            }
            if let End::OnBody(body) = line.to {
                let block = BodyBlock::between(&to.place, left.to_to, &to.place);
                self.diagonal[body].add(&block, 1.0);
            }
            if let (End::OnBody(_), End::OnBody(_)) = (line.from, line.to) {
                self.beside[index] = BodyBlock::between(&to.place, left.to_from, &from.place);
            }
        }
        self.are_few = self.factorise_few();
        if self.are_few {
            return Ok(());
        }
        self.set_matrix();
        self.elimination
            .factorise(&self.matrix)
            .map_err(|singular| NotSolvable {
                index: self.topology.bodies[singular.site].first_state,
            })
    }

    fn solve(&mut self, derivatives: &Derivatives, r: &mut [f64]) {
        let (r_x, rest) = r.split_at_mut(self.topology.coordinates);
        let (r_v, r_s) = rest.split_at_mut(self.topology.coordinates);
        self.load_bodies(derivatives, r_x, r_v);
        for index in 0..self.topology.lines.len() {
            self.pull_line(index, derivatives, r_x, r_v);
        }
        self.pull_reels(derivatives, r_s);
        self.solve_all(derivatives);
        for index in 0..self.topology.lines.len() {
            self.take_line(index, r_x, r_v);
        }
        self.take_bodies(r_x, r_v);
        for r in r_s {
            *r *= self.g;
        }
    }

    // The state has the coordinates of the topology itself.

    fn displace(&mut self, _: &Derivatives, _: &[f64], _: Change) {}

    fn displaced<'a>(&'a self, change: &'a [f64], _: Change) -> &'a [f64] {
        change
    }

    fn place(&self, coordinate: usize) -> usize {
        coordinate
    }
}

fn twist_at(values: &[f64], at: usize) -> Twist {
    Twist {
        linear: DVec3::from_slice(&values[at..]),
        angular: DVec3::from_slice(&values[at + 3..]),
    }
}

/// How an end of a tether moves; `motions` are those of the bodies.
fn motion_of(motions: &[Twist], end: End, place: &Place) -> DVec3 {
    match end {
        End::Held => DVec3::ZERO,
        End::OnBody(body) => place.motion(motions[body]),
    }
}

/// Adds a force on an end of a tether to the `loads` of the bodies.
fn push(loads: &mut [Twist], end: End, place: &Place, force: DVec3) {
    if let End::OnBody(body) = end {
        let load = place.load(force);
        loads[body].linear += load.linear;
        loads[body].angular += load.angular;
    }
}

/// Adds a block between two bodies, of which points take the linear part only.
fn add_block(matrix: &mut BlockMatrix, i: usize, j: usize, block: &BodyBlock) {
    let (rows, columns) = (matrix.pattern().dim(i), matrix.pattern().dim(j));
    let values = matrix.block_mut(i, j);
    let mut add = |row: usize, column: usize, part: DMat3| {
        if row < rows && column < columns {
            for (c, values_of_column) in part.to_cols_array_2d().iter().enumerate() {
                for (r, value) in values_of_column.iter().enumerate() {
                    values[(row + r) * columns + column + c] += value;
                }
            }
        }
    };
    add(0, 0, block.linear);
    add(0, 3, block.linear_by_turn);
    add(3, 0, block.turn_by_linear);
    add(3, 3, block.turn);
}

#[cfg(test)]
mod tests;
