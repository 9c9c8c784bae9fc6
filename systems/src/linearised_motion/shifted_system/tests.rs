//! Against the matrix written out by the motion of every point, in a dense solution.

use glam::DQuat;

use super::*;
use crate::linearised_motion::body_block::cross_matrix;
use crate::linearised_motion::derivatives::{LinearPoint, LinearSegment};
use crate::linearised_motion::topology::{BodySite, Line};
use crate::nonlinear_solver::test_support::{Random, dense_solve};

const STEP_S: f64 = 0.2;
const GAMMA: f64 = 0.4;

fn vector(random: &mut Random) -> DVec3 {
    DVec3::new(random.signed(), random.signed(), random.signed())
}

/// Symmetric and positive definite.
fn positive(random: &mut Random) -> Symmetric3 {
    Symmetric3::along(vector(random), 1.0, 1.5 + random.signed())
}

/// Lines as (from, to, nodes), `None` an anchor; bodies by whether they turn.
fn topology(bodies: &[bool], lines: &[(Option<usize>, Option<usize>, usize)]) -> Topology {
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
fn derivatives(topology: &Topology, random: &mut Random) -> Derivatives {
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

type Dense = Vec<Vec<f64>>;

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
fn dense_matrices(topology: &Topology, derivatives: &Derivatives) -> [Dense; 3] {
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

/// Increments of velocities by the dense solution; points do not turn, and their angles stay.
fn dense_increments(topology: &Topology, derivatives: &Derivatives, r: &[f64]) -> Vec<f64> {
    let g = GAMMA * STEP_S;
    let n = topology.coordinates;
    let [mass, damping, stiffness] = dense_matrices(topology, derivatives);
    let mut matrix = mass.clone();
    let mut load = vec![0.0; n];
    for i in 0..n {
        for j in 0..n {
            matrix[i][j] += g * damping[i][j] + g * g * stiffness[i][j];
            load[i] += g * mass[i][j] * r[n + j] - g * g * stiffness[i][j] * r[j];
        }
    }
    for site in topology.bodies.iter().filter(|site| !site.turns) {
        for k in site.first_state + 3..site.first_state + 6 {
            matrix[k].fill(0.0);
            for row in &mut matrix {
                row[k] = 0.0;
            }
            matrix[k][k] = 1.0;
            load[k] = g * r[n + k];
        }
    }
    dense_solve(matrix, &load)
}

/// With what segments and places give to points and bodies.
fn ready(topology: &Topology, given: &Derivatives) -> Derivatives {
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

/// The increments that a system finds, against the dense ones.
fn check(system: &mut ShiftedSystem, ready: &Derivatives, r: &[f64], expected: &[f64], case: &str) {
    let n = expected.len();
    let mut u = r.to_vec();
    system.solve(ready, &mut u);
    for k in 0..n {
        let v = expected[k];
        assert!((u[n + k] - v).abs() < 1e-9, "{case}, velocity {k}");
        let x = GAMMA * STEP_S * (v + r[k]);
        assert!((u[k] - x).abs() < 1e-9, "{case}, position {k}");
    }
    for k in 2 * n..r.len() {
        assert!((u[k] - GAMMA * STEP_S * r[k]).abs() < 1e-15, "{case}");
    }
}

#[test]
fn bodies_and_tethers_answer_as_the_dense_system_does() {
    let mut random = Random::new(3);
    let (a, b, c) = (Some(0), Some(1), Some(2));
    let cases = [
        topology(&[], &[(None, None, 4)]),
        topology(&[true], &[(None, a, 3)]),
        topology(&[false], &[(a, None, 2)]),
        topology(&[true, true], &[(a, b, 5)]),
        topology(&[false, true], &[(b, a, 0)]),
        // Two tethers between the same bodies, and one that hangs loose beside them.
        topology(&[true, true], &[(a, b, 2), (b, a, 1), (None, b, 3)]),
        topology(&[true, true], &[(None, a, 2), (None, b, 1)]),
        // A closed loop.
        topology(&[true, false, true], &[(a, b, 2), (b, c, 0), (c, a, 1)]),
    ];
    for (case, topology) in cases.into_iter().enumerate() {
        let given = derivatives(&topology, &mut random);
        let n = topology.coordinates;
        let r: Vec<f64> = (0..2 * n + 2).map(|_| random.signed()).collect();
        let expected = dense_increments(&topology, &given, &r);
        let ready = ready(&topology, &given);
        let whole = ShiftedSystem::new(topology);
        let few = ShiftedSystem {
            pair: None,
            ..whole.clone()
        };
        let many = ShiftedSystem {
            few: None,
            ..few.clone()
        };
        for mut system in [whole, few, many] {
            system.factorise(&ready, STEP_S, GAMMA).unwrap();
            assert_eq!(system.is_pair, system.pair.is_some());
            let are_few = system.few.is_some() && !system.is_pair;
            assert_eq!(system.are_few, are_few);
            check(&mut system, &ready, &r, &expected, &format!("case {case}"));
        }
    }
}

/// A body that would run away by itself within the step: nothing is positive definite any more.
#[test]
fn what_is_not_positive_definite_is_solved_with_row_exchanges() {
    let mut random = Random::new(5);
    let topology = topology(&[true, true], &[(Some(0), Some(1), 3)]);
    let mut given = derivatives(&topology, &mut random);
    given.bodies[0].stiffness.linear = DMat3::from_diagonal(DVec3::splat(-5e4));
    let n = topology.coordinates;
    let r: Vec<f64> = (0..2 * n).map(|_| random.signed()).collect();
    let expected = dense_increments(&topology, &given, &r);
    let ready = ready(&topology, &given);
    let mut system = ShiftedSystem::new(topology);
    system.factorise(&ready, STEP_S, GAMMA).unwrap();
    assert!(!system.is_pair && !system.are_few);
    check(&mut system, &ready, &r, &expected, "runaway");
}
