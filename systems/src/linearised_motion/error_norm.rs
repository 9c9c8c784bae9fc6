//! How large an error of a step is, for a world of tethers: in metres, and in the strain of segments.
//!
//! Positions of bodies count over the tolerance, rotations times their arm, positions of nodes less. The
//! strain error `k (|t.(e_(s+1) - e_s)| + |e_(s+1) - e_s|^2 / 2 L)`, t the direction at the end of the step,
//! counts over a part of the line's tension: at a loose tolerance in metres an error within it can still be a
//! tension that no tether bears, and throws the chain into a slack rattle. Velocities do not count: they would
//! make the step follow axial waves that the method damps.

use glam::DVec3;

use super::body_block::Twist;
use super::derivatives::{Derivatives, LinearEnd, LinearSegment};
use super::topology::{End, Line, Topology};

/// Errors of nodes count by this beside bodies: they are transverse waves of the tethers, most of which
/// average out before they reach a body. Not so where something is slack: a fold does not average out.
const WEIGHT_OF_NODES: f64 = 0.15;
/// Part of the reference tension that a strain error may be. At a tenth, very stiff lines slowly gather
/// energy at loose tolerances; at this they do not, and need no more steps.
const PART_OF_TENSION: f64 = 0.05;

/// The largest error of a position in `e`, weighed, in m, and its place in the state; `has_slack` says whether
/// something is slack.
#[must_use]
pub fn position_error(topology: &Topology, e: &[f64], has_slack: bool) -> (f64, usize) {
    let mut largest = (0.0, 0);
    let mut consider = |square: f64, index: usize| {
        if square > largest.0 || square.is_nan() {
            largest = (square, index);
        }
    };
    for body in &topology.bodies {
        let at = body.first_state;
        consider(DVec3::from_slice(&e[at..]).length_squared(), at);
        let turn = DVec3::from_slice(&e[at + 3..]).length_squared();
        consider(body.arm_m * body.arm_m * turn, at + 3);
    }
    let weight = if has_slack || topology.bodies.is_empty() {
        1.0
    } else {
        WEIGHT_OF_NODES
    };
    for line in &topology.lines {
        let nodes = &e[line.first_state..line.first_state + 3 * line.nodes];
        for (i, node) in nodes.chunks_exact(3).enumerate() {
            let square = DVec3::from_slice(node).length_squared();
            consider(weight * weight * square, line.first_state + 3 * i);
        }
    }
    (largest.0.sqrt(), largest.1)
}

/// The largest error of a segment's tension for the error `e` of a step by `increment`, over what is
/// allowed, and a place in the state by it. What is allowed is a part of the line's own tension, of at least
/// the weight of the lighter body at its ends; `least_tension_n`, of the heaviest body, where that is less.
#[must_use]
pub fn strain_error(
    topology: &Topology,
    derivatives: &Derivatives,
    e: &[f64],
    increment: &[f64],
    least_tension_n: f64,
) -> (f64, usize) {
    let mut worst = (0.0, 0);
    for (line, ends) in topology.lines.iter().zip(&derivatives.ends) {
        let mut largest = (0.0, 0);
        let mut tension_n = reference_n(derivatives, line, least_tension_n);
        let segments = &derivatives.segments[line.segments()];
        let mut before = end_error(topology, line.from, &ends[0], e);
        let mut moved = end_error(topology, line.from, &ends[0], increment);
        let mut consider = |segment: &LinearSegment, step: DVec3, turn: DVec3, node: usize| {
            let span = segment.length_m * segment.direction + turn;
            let length_m = span.length_squared().sqrt().max(0.5 * segment.length_m);
            let along = span.dot(step).abs() + 0.5 * step.length_squared();
            let error = segment.stiffness_n_m * along / length_m;
            if error > largest.0 {
                largest = (error, line.first_state + 3 * node);
            }
            tension_n = tension_n.max(segment.tension_n);
        };
        let states = line.first_state..line.first_state + 3 * line.nodes;
        let nodes = e[states.clone()]
            .chunks_exact(3)
            .zip(increment[states].chunks_exact(3));
        for (i, ((node, shift), segment)) in nodes.zip(segments).enumerate() {
            let (here, to) = (DVec3::from_slice(node), DVec3::from_slice(shift));
            consider(segment, here - before, to - moved, i);
            before = here;
            moved = to;
        }
        let last = end_error(topology, line.to, &ends[1], e) - before;
        let turn = end_error(topology, line.to, &ends[1], increment) - moved;
        consider(
            &segments[line.nodes],
            last,
            turn,
            line.nodes.saturating_sub(1),
        );
        let of_line = largest.0 / (PART_OF_TENSION * tension_n);
        if of_line > worst.0 || of_line.is_nan() {
            worst = (of_line, largest.1);
        }
    }
    worst
}

/// The smallest reference tension of a line, N: the weight of the lighter body at its ends, at most
/// `least_n`. A line that carries little beside one that carries much would else rattle within what the
/// other allows.
fn reference_n(derivatives: &Derivatives, line: &Line, least_n: f64) -> f64 {
    let weights = [line.from, line.to]
        .into_iter()
        .filter_map(|end| match end {
            End::OnBody(body) => {
                let mass_kg = derivatives.bodies[body].mass.linear.x_axis.x;
                Some(mass_kg * derivatives.gravity_m_s2)
            }
            End::Held => None,
        });
    let lightest_n = weights.fold(least_n, f64::min);
    if lightest_n > 0.0 {
        lightest_n
    } else {
        least_n
    }
}

/// The error of an end of a tether, m.
fn end_error(topology: &Topology, end: End, at: &LinearEnd, e: &[f64]) -> DVec3 {
    match end {
        End::Held => DVec3::ZERO,
        End::OnBody(body) => {
            let first = topology.bodies[body].first_state;
            at.place.motion(Twist {
                linear: DVec3::from_slice(&e[first..]),
                angular: DVec3::from_slice(&e[first + 3..]),
            })
        }
    }
}
