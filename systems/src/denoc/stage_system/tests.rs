//! Against the absolute matrices of points and bodies, restricted to what the joints allow and solved
//! densely.

use glam::{DMat3, DVec3};

use super::*;
use crate::denoc::tree::LinkKind;
use crate::linearised_motion::dense_motion::{Dense, dense_matrices, derivatives, ready, topology};
use crate::linearised_motion::topology::End;
use crate::nonlinear_solver::test_support::{Random, dense_solve};

const STEP_S: f64 = 0.2;
const GAMMA: f64 = 0.4;

/// Where joint coordinates stand: bodies, then links.
fn places(tree: &KinematicTree, topology: &Topology) -> JointPlaces {
    let mut at = 0;
    let mut take = |count: usize| {
        at += count;
        at - count
    };
    let bodies = tree.carried_by.iter().zip(&topology.bodies);
    let bodies = bodies
        .map(|(carried_by, site)| match (carried_by, site.turns) {
            (None, _) => {
                let first = take(6);
                (Some(first), Some(first + 3))
            }
            (Some(_), true) => (None, Some(take(3))),
            (Some(_), false) => (None, None),
        })
        .collect();
    JointPlaces {
        bodies,
        first_link: at,
        coordinates: at + 3 * tree.links,
    }
}

/// How absolute coordinates move with joint ones, a column each: worked out limb by limb, body by body.
fn jacobian(
    tree: &KinematicTree,
    topology: &Topology,
    places: &JointPlaces,
    d: &Derivatives,
) -> Dense {
    let mut j = vec![vec![0.0; places.coordinates]; topology.coordinates];
    let mut place = |row: usize, motion: &[(usize, DMat3)]| {
        for (column, m) in motion {
            for c in 0..3 {
                for r in 0..3 {
                    j[row + r][column + c] += m.col(c)[r];
                }
            }
        }
    };
    // Of the centre of each body, and of its rotation.
    let mut centres: Vec<Vec<(usize, DMat3)>> = vec![Vec::new(); topology.bodies.len()];
    let turn_of = |body: usize, turn: DMat3| {
        let rotation = places.bodies[body]
            .1
            .filter(|_| topology.bodies[body].turns);
        rotation.map(|at| (at, turn))
    };
    for &base in &tree.bases {
        centres[base] = places.bodies[base]
            .0
            .map(|at| (at, DMat3::IDENTITY))
            .into_iter()
            .collect();
    }
    for limb in &tree.limbs {
        let line = &topology.lines[limb.line];
        let ends = &d.ends[limb.line];
        let (near, far) = if line.to == End::OnBody(limb.child) {
            (&ends[0], &ends[1])
        } else {
            (&ends[1], &ends[0])
        };
        let mut at: Vec<(usize, DMat3)> = limb.parent.map_or_else(Vec::new, |parent| {
            let mut at = centres[parent].clone();
            at.extend(turn_of(parent, near.place.turn));
            at
        });
        for (k, link) in limb.links.clone().enumerate() {
            at.push((places.first_link + 3 * link, DMat3::IDENTITY));
            if k + 1 < limb.links.len() {
                let node = limb.distal_point(k) - line.first_point - 1;
                place(line.first_state + 3 * node, &at);
            }
        }
        at.extend(turn_of(limb.child, -far.place.turn));
        centres[limb.child] = at;
    }
    for (body, site) in topology.bodies.iter().enumerate() {
        place(site.first_state, &centres[body]);
        if let Some(turn) = turn_of(body, DMat3::IDENTITY) {
            place(site.first_state + 3, &[turn]);
        }
    }
    j
}

/// Columns that span what the joints allow.
fn basis(
    tree: &KinematicTree,
    places: &JointPlaces,
    topology: &Topology,
    d: &Derivatives,
) -> Vec<Vec<f64>> {
    let mut columns = Vec::new();
    let mut column = |at: usize, v: DVec3| {
        let mut column = vec![0.0; places.coordinates];
        v.write_to_slice(&mut column[at..]);
        columns.push(column);
    };
    for (body, (displacement, rotation)) in places.bodies.iter().enumerate() {
        let rotation = rotation.filter(|_| topology.bodies[body].turns);
        for at in [*displacement, rotation].into_iter().flatten() {
            for v in DVec3::AXES {
                column(at, v);
            }
        }
    }
    for (limb, kind) in tree.limbs.iter().zip(&tree.kinds) {
        for (k, link) in limb.links.clone().enumerate() {
            let at = places.first_link + 3 * link;
            let e = d.segments[limb.segment(k)].direction;
            let (a, b) = e.any_orthonormal_pair();
            column(at, a);
            column(at, b);
            if kind.stretch == Stretch::Elastic {
                column(at, e);
            }
        }
    }
    columns
}

fn times(matrix: &Dense, v: &[f64]) -> Vec<f64> {
    matrix.iter().map(|row| dot(row, v)).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn compare(
    bodies: &[bool],
    lines: &[(Option<usize>, Option<usize>, usize)],
    stretch: Stretch,
    seed: u64,
) {
    let mut random = Random::new(seed);
    let topology = topology(bodies, lines);
    let mut given = derivatives(&topology, &mut random);
    // The recursion keeps symmetric blocks: of what turns with loads, the symmetric part.
    for ends in &mut given.ends {
        for end in ends {
            end.load_n = DVec3::ZERO;
        }
    }
    for body in &mut given.bodies {
        let turn = body.stiffness.turn;
        body.stiffness.turn = 0.5 * (turn + turn.transpose());
    }
    let kind = LinkKind {
        length_m: 1.0,
        length_rate_m_s: 0.0,
        coupling_kg: -0.05,
        joint_mass_kg: 0.0,
        stretch,
    };
    let tree = KinematicTree::new(&topology, &vec![kind; lines.len()], &[]);
    let places = places(&tree, &topology);
    let [mut mass, damping, stiffness] = dense_matrices(&topology, &given);
    let g = GAMMA * STEP_S;
    let j = jacobian(&tree, &topology, &places, &given);
    let columns = basis(&tree, &places, &topology, &given);
    // What rods add between their ends, by the joint coordinate that is the difference of these.
    let rods = |v: &[f64], w: &[f64]| {
        let links = places.first_link;
        kind.coupling_kg * dot(&v[links..], &w[links..])
    };
    for site in topology.bodies.iter().filter(|site| !site.turns) {
        let turns = site.first_state + 3..site.first_state + 6;
        for (k, row) in mass.iter_mut().enumerate().skip(turns.start).take(3) {
            row[k] = 0.0;
        }
    }
    // Rates of the state lie in what the joints allow.
    let mut allowed = || {
        let mut r = vec![0.0; places.coordinates];
        for column in &columns {
            let amount = random.signed();
            r.iter_mut().zip(column).for_each(|(r, c)| *r += amount * c);
        }
        r
    };
    let (r_x, r_v) = (allowed(), allowed());
    let (x, v) = (times(&j, &r_x), times(&j, &r_v));
    let (m_v, k_x) = (times(&mass, &v), times(&stiffness, &x));
    let mut matrix = Vec::new();
    let mut load = Vec::new();
    for a in &columns {
        let moved = times(&j, a);
        matrix.push(
            columns
                .iter()
                .map(|b| {
                    let other = times(&j, b);
                    let whole = |m: &Dense| dot(&moved, &times(m, &other));
                    whole(&mass) + rods(a, b) + g * whole(&damping) + g * g * whole(&stiffness)
                })
                .collect(),
        );
        load.push(g * (dot(&moved, &m_v) + rods(a, &r_v)) - g * g * dot(&moved, &k_x));
    }
    let amounts = dense_solve(matrix, &load);
    let mut expected = vec![0.0; places.coordinates];
    for (column, amount) in columns.iter().zip(&amounts) {
        expected
            .iter_mut()
            .zip(column)
            .for_each(|(e, c)| *e += amount * c);
    }
    let ready = ready(&topology, &given);
    let n = places.coordinates;
    let mut system = LinkStages::new(tree, topology, places, Extras::default());
    system.factorise(&ready, STEP_S, GAMMA).unwrap();
    let mut r: Vec<f64> = r_x.iter().chain(&r_v).copied().chain([2.0]).collect();
    system.solve(&ready, &mut r);
    for k in 0..n {
        assert!((r[n + k] - expected[k]).abs() < 1e-9, "velocity {k}");
        assert!(
            (r[k] - g * (expected[k] + r_x[k])).abs() < 1e-9,
            "position {k}"
        );
    }
    assert_eq!(r[2 * n], 2.0 * g);
    // Displacements are those of the Jacobian.
    system.displace(&ready, &r_x, Change::Error);
    let found = system.displaced(&r_x, Change::Error);
    for (found, expected) in found.iter().zip(&x) {
        assert!((found - expected).abs() < 1e-12);
    }
}

#[test]
fn trees_answer_as_the_restricted_dense_system_does() {
    let (a, b, c) = (Some(0), Some(1), Some(2));
    for stretch in [Stretch::Rigid, Stretch::Elastic] {
        compare(&[true], &[(None, a, 3)], stretch, 3);
        compare(&[false], &[(a, None, 2)], stretch, 4);
        compare(&[true, true], &[(a, b, 5)], stretch, 5);
        compare(&[true, true, false], &[(b, a, 2), (b, c, 3)], stretch, 6);
        compare(
            &[true, false, true],
            &[(None, a, 2), (b, a, 0), (a, c, 4)],
            stretch,
            7,
        );
    }
}
