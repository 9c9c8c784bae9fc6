//! Random linearised motions, and their matrices written out by the motion of every point: what the fast
//! solvers are tested against.

use glam::{DMat3, DQuat, DVec3};

use super::body_block::{BodyBlock, Place, cross_matrix};
use super::derivatives::{Derivatives, LinearPoint, LinearSegment};
use super::symmetric3::Symmetric3;
use super::topology::{BodySite, End, Line, Topology};
use crate::nonlinear_solver::test_support::Random;

pub(crate) fn vector(random: &mut Random) -> DVec3 {
    DVec3::new(random.signed(), random.signed(), random.signed())
}

/// Symmetric and positive definite.
fn positive(random: &mut Random) -> Symmetric3 {
    Symmetric3::along(vector(random), 1.0, 1.5 + random.signed())
}

/// Lines as (from, to, nodes), `None` an anchor; bodies by whether they turn.
pub(crate) fn topology(
    bodies: &[bool],
    lines: &[(Option<usize>, Option<usize>, usize)],
) -> Topology {
    let mut coordinates = 0;
    let bodies: Vec<BodySite> = bodies
        .iter()
        .map(|turns| {
            coordinates += 6;
            BodySite {
                first_state: coordinates - 6,
                turns: *turns,
                arm_m: 1.0,
            }
        })
        .collect();
    let mut points = 0;
    let end = |body: Option<usize>| body.map_or(End::Held, End::OnBody);
    let lines = lines
        .iter()
        .map(|(from, to, nodes)| {
            let line = Line {
                first_point: points,
                nodes: *nodes,
                first_state: coordinates,
                from: end(*from),
                to: end(*to),
            };
            points += nodes + 2;
            coordinates += 3 * nodes;
            line
        })
        .collect();
    Topology {
        lines,
        bodies,
        points,
        coordinates,
    }
}

/// Anything that is stable; what segments and places give to points and bodies is left out.
pub(crate) fn derivatives(topology: &Topology, random: &mut Random) -> Derivatives {
    let mut derivatives = Derivatives::new(topology);
    for (body, site) in derivatives.bodies.iter_mut().zip(&topology.bodies) {
        let attitude = DQuat::from_scaled_axis(vector(random));
        let inertia = positive(random).plus(Symmetric3::identity(2.0)).into();
        body.mass = BodyBlock::mass(6.0 + random.signed(), vector(random), inertia, attitude);
        if !site.turns {
            body.mass.linear_by_turn = DMat3::ZERO;
            body.mass.turn_by_linear = DMat3::ZERO;
        }
        body.damping.linear = positive(random).into();
        body.damping.turn = positive(random).into();
        body.stiffness.linear = positive(random).into();
        // Stiffnesses of attitude need not be symmetric.
        body.stiffness.turn = DMat3::from(positive(random)) + cross_matrix(vector(random));
    }
    for (line, ends) in topology.lines.iter().zip(&mut derivatives.ends) {
        for (end, at) in [line.from, line.to].into_iter().zip(ends) {
            let turns = matches!(end, End::OnBody(body) if topology.bodies[body].turns);
            at.offset_m = if turns { vector(random) } else { DVec3::ZERO };
            at.place = Place::new(DQuat::from_scaled_axis(vector(random)), at.offset_m);
            at.load_n = vector(random);
        }
        for segment in &mut derivatives.segments[line.segments()] {
            *segment = LinearSegment {
                direction: vector(random).normalize(),
                length_m: 1.0,
                stiffness_n_m: 1e4 * (1.2 + random.signed()),
                damping_n_s_m: 10.0 * (1.2 + random.signed()),
                geometric_n_m: 1.2 + random.signed(),
                drag: positive(random),
                ..LinearSegment::default()
            };
        }
        for point in &mut derivatives.points[line.node_points()] {
            *point = LinearPoint {
                mass_kg: 1.2 + random.signed(),
                damping: positive(random),
                stiffness: positive(random),
            };
        }
    }
    derivatives
}

/// The columns of the state that move a point, and by what: `v_point = sum C_k v_k`, three each.
type Motion = Vec<(usize, DMat3)>;

fn motion(topology: &Topology, derivatives: &Derivatives, line: usize, point: usize) -> Motion {
    let of = &topology.lines[line];
    let (end, at) = match point - of.first_point {
        0 => (of.from, &derivatives.ends[line][0]),
        place if place == of.nodes + 1 => (of.to, &derivatives.ends[line][1]),
        place => return vec![(of.first_state + 3 * (place - 1), DMat3::IDENTITY)],
    };
    match end {
        End::Held => Vec::new(),
        End::OnBody(body) => {
            let first = topology.bodies[body].first_state;
            vec![(first, DMat3::IDENTITY), (first + 3, at.place.turn)]
        }
    }
}

pub(crate) type Dense = Vec<Vec<f64>>;

fn add(dense: &mut Dense, row: usize, column: usize, m: DMat3) {
    for c in 0..3 {
        for r in 0..3 {
            dense[row + r][column + c] += m.col(c)[r];
        }
    }
}

/// Adds `P' m P` for the motion P.
fn add_between(dense: &mut Dense, m: DMat3, motion: &Motion) {
    for (row, left) in motion {
        for (column, right) in motion {
            add(dense, *row, *column, left.transpose() * m * *right);
        }
    }
}

fn add_body(dense: &mut Dense, at: usize, block: &BodyBlock) {
    add(dense, at, at, block.linear);
    add(dense, at, at + 3, block.linear_by_turn);
    add(dense, at + 3, at, block.turn_by_linear);
    add(dense, at + 3, at + 3, block.turn);
}

/// M, -D and -K.
pub(crate) fn dense_matrices(topology: &Topology, derivatives: &Derivatives) -> [Dense; 3] {
    let zero = vec![vec![0.0; topology.coordinates]; topology.coordinates];
    let [mut mass, mut damping, mut stiffness] = [zero.clone(), zero.clone(), zero];
    for (site, body) in topology.bodies.iter().zip(&derivatives.bodies) {
        add_body(&mut mass, site.first_state, &body.mass);
        add_body(&mut damping, site.first_state, &body.damping);
        add_body(&mut stiffness, site.first_state, &body.stiffness);
    }
    for (index, line) in topology.lines.iter().enumerate() {
        let motion = |point| motion(topology, derivatives, index, point);
        for point in line.node_points() {
            let of = &derivatives.points[point];
            let own = DMat3::from_diagonal(DVec3::splat(of.mass_kg));
            add_between(&mut mass, own, &motion(point));
            add_between(&mut damping, of.damping.into(), &motion(point));
            add_between(&mut stiffness, of.stiffness.into(), &motion(point));
        }
        for point in line.segments() {
            let segment = &derivatives.segments[point];
            let along = Symmetric3::along(segment.direction, 1.0, 0.0);
            let across = Symmetric3::identity(1.0).plus_scaled(along, -1.0);
            let (mut stretch, mut mean) = (motion(point), motion(point));
            for (_, m) in &mut stretch {
                *m = -*m;
            }
            stretch.extend(motion(point + 1));
            mean.extend(motion(point + 1));
            let own = Symmetric3::default()
                .plus_scaled(along, segment.stiffness_n_m)
                .plus_scaled(across, segment.geometric_n_m);
            add_between(&mut stiffness, own.into(), &stretch);
            let own = DMat3::from(along) * segment.damping_n_s_m;
            add_between(&mut damping, own, &stretch);
            add_between(&mut damping, DMat3::from(segment.drag) * 0.25, &mean);
        }
        for (end, at) in [line.from, line.to]
            .into_iter()
            .zip(&derivatives.ends[index])
        {
            if let End::OnBody(body) = end {
                let turn = topology.bodies[body].first_state + 3;
                let follows = -(cross_matrix(at.offset_m) * cross_matrix(at.load_n));
                add(&mut stiffness, turn, turn, follows);
            }
        }
    }
    [mass, damping, stiffness]
}

/// With what segments and places give to points and bodies.
pub(crate) fn ready(topology: &Topology, given: &Derivatives) -> Derivatives {
    let mut ready = given.clone();
    for line in &topology.lines {
        for point in line.segments() {
            let drag = given.segments[point].drag;
            for point in &mut ready.points[point..point + 2] {
                point.damping = point.damping.plus_scaled(drag, 0.5);
            }
        }
    }
    ready.load_bodies(topology);
    ready
}
