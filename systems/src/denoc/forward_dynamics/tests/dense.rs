//! The decoupled natural orthogonal complement written out: N = N_l N_d, H = N' M N and its block UDU'
//! factorisation as dense matrices, in six-dimensional twists about each link's proximal joint, for
//! comparison with the recursion.

use glam::{DMat3, DVec3};

use super::{Drawn, Sample, chain};
use crate::linearised_motion::body_block::cross_matrix;
use crate::linearised_motion::topology::End;

/// A dense matrix, by rows.
type Matrix = Vec<Vec<f64>>;

fn zeros(rows: usize, columns: usize) -> Matrix {
    vec![vec![0.0; columns]; rows]
}

fn add(matrix: &mut Matrix, row: usize, column: usize, block: DMat3) {
    for (c, values) in block.to_cols_array_2d().iter().enumerate() {
        for (r, value) in values.iter().enumerate() {
            matrix[row + r][column + c] += value;
        }
    }
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let mut out = zeros(a.len(), b[0].len());
    for (row, a) in out.iter_mut().zip(a) {
        for (a, b) in a.iter().zip(b) {
            if *a != 0.0 {
                for (out, b) in row.iter_mut().zip(b) {
                    *out += a * b;
                }
            }
        }
    }
    out
}

fn transposed(a: &Matrix) -> Matrix {
    (0..a[0].len())
        .map(|c| a.iter().map(|row| row[c]).collect())
        .collect()
}

/// Solves by Gaussian elimination from the last row to the first, as UDU' does; with the pivot blocks
/// D of the given sizes, as logarithms of their determinants.
fn solve(mut h: Matrix, mut r: Vec<f64>, sizes: &[usize]) -> (Vec<f64>, Vec<f64>) {
    let n = r.len();
    let mut pivots = vec![0.0; n];
    for k in (0..n).rev() {
        pivots[k] = h[k][k];
        for i in 0..k {
            let factor = h[i][k] / h[k][k];
            let (above, below) = h.split_at_mut(k);
            for (value, pivot) in above[i].iter_mut().zip(&below[0]).take(k + 1) {
                *value -= factor * pivot;
            }
            r[i] -= factor * r[k];
        }
    }
    for k in 0..n {
        for j in 0..k {
            r[k] -= h[k][j] * r[j];
        }
        r[k] /= h[k][k];
    }
    let mut first = 0;
    let logs = sizes.iter().map(|size| {
        let block = &pivots[first..first + size];
        first += size;
        block.iter().map(|pivot| pivot.ln()).sum()
    });
    (r, logs.collect())
}

/// One member of the tree: where it is in the twists and in the joint rates, and how it moves.
struct Member {
    /// What carries it.
    parent: Option<usize>,
    /// From the joint that carries the parent to the one that carries this.
    arm_m: DVec3,
    /// Basis of its angular velocity: three columns at most.
    turns: Vec<DVec3>,
    /// Whether it also moves freely.
    is_base: bool,
    /// Mass, first moment and moment of inertia about its joint, inertial frame.
    mass: (f64, DVec3, DMat3),
    /// Force and moment about its joint, velocity terms of its own taken off.
    load: (DVec3, DVec3),
    omega: DVec3,
}

/// Rods carry their mass themselves here, and bodies nothing of it.
fn members(sample: &Sample) -> Vec<Member> {
    let mut members: Vec<Member> = Vec::new();
    let mut of_body = vec![usize::MAX; sample.bodies.len()];
    for &base in &sample.tree.bases {
        of_body[base] = members.len();
        members.push(body_member(sample, base, None, DVec3::ZERO, DVec3::ZERO));
    }
    for (index, limb) in sample.tree.limbs.iter().enumerate() {
        let offsets = sample.offsets[index];
        let mut parent = limb.parent.map(|body| of_body[body]);
        let mut arm_m = limb.parent.map_or(DVec3::ZERO, |body| {
            let state = &sample.bodies[body];
            let carried = sample.tree.carried_by[body]
                .map_or(DVec3::ZERO, |limb| sample.offsets[limb].distal_m);
            state.attitude * (offsets.proximal_m - carried)
        });
        for k in limb.links.clone() {
            let (d, rate) = (sample.links.span_m[k], sample.links.rate_m_s[k]);
            let e = d.normalize();
            let (first, second) = e.any_orthonormal_pair();
            let kg = -6.0 * sample.tree.kinds[index].coupling_kg;
            let square = DMat3::from_diagonal(DVec3::splat(d.length_squared()));
            let inertia = (square - DMat3::from_cols(d * d.x, d * d.y, d * d.z)) * (kg / 3.0);
            let mut load = DVec3::ZERO;
            let mut moment = DVec3::ZERO;
            let number = k - limb.links.start;
            if number + 1 < limb.links.len() {
                load = sample.loads.point_n[limb.distal_point(number)];
                moment = d.cross(load);
            }
            let omega = e.cross(rate) / d.length();
            members.push(Member {
                parent,
                arm_m,
                turns: vec![first, second],
                is_base: false,
                mass: (kg, 0.5 * kg * d, inertia),
                load: (load, moment),
                omega,
            });
            parent = Some(members.len() - 1);
            arm_m = d;
        }
        of_body[limb.child] = members.len();
        members.push(body_member(
            sample,
            limb.child,
            parent,
            arm_m,
            offsets.distal_m,
        ));
    }
    members
}

/// The body alone, about the joint at `offset_m` that carries it.
fn body_member(
    sample: &Sample,
    body: usize,
    parent: Option<usize>,
    arm_m: DVec3,
    offset_m: DVec3,
) -> Member {
    let (state, load) = (&sample.bodies[body], &sample.loads.bodies[body]);
    let rotation = DMat3::from_quat(state.attitude);
    let half_kg = |limb: usize| -3.0 * sample.tree.kinds[limb].coupling_kg;
    let mut kg = load.mass.linear.x_axis.x;
    let mut inertia = load.mass.turn;
    let mut moment = DVec3::ZERO;
    for (index, limb) in sample.tree.limbs.iter().enumerate() {
        let offsets = sample.offsets[index];
        let ends = [
            (limb.parent, offsets.proximal_m),
            (Some(limb.child), offsets.distal_m),
        ];
        for (_, r) in ends.into_iter().filter(|(on, _)| *on == Some(body)) {
            let half = half_kg(index);
            kg -= half;
            moment += half * r;
            let square = DMat3::from_diagonal(DVec3::splat(r.length_squared()));
            inertia -= (square - DMat3::from_cols(r * r.x, r * r.y, r * r.z)) * half;
        }
    }
    let rate = state.rate_rad_s;
    // Force and torque without the velocity terms of what was carried; with those of the body alone.
    let force = load.load.linear + state.attitude * rate.cross(rate.cross(moment));
    let torque = load.load.angular + rate.cross(load.mass.turn * rate) - rate.cross(inertia * rate);
    let r = rotation * offset_m;
    let world = rotation * inertia * rotation.transpose();
    let square = DMat3::from_diagonal(DVec3::splat(r.length_squared()));
    let about_joint = world + (square - DMat3::from_cols(r * r.x, r * r.y, r * r.z)) * kg;
    Member {
        parent,
        arm_m,
        turns: vec![DVec3::X, DVec3::Y, DVec3::Z],
        is_base: parent.is_none() && sample.tree.bases.contains(&body),
        mass: (kg, -kg * r, about_joint),
        load: (force, state.attitude * torque - r.cross(force)),
        omega: state.attitude * rate,
    }
}

/// Adds B N_l of the parent to the rows of a member: its joint moves with the twist of the parent, and
/// angular velocities are joint rates.
fn carry(n_l: &mut Matrix, member: usize, parent: usize, arm_m: DVec3) {
    let rows = n_l[6 * parent..6 * parent + 6].to_vec();
    for (column, _) in rows[0].iter().enumerate() {
        let v = DVec3::from_array(std::array::from_fn(|r| rows[r][column]));
        let omega = DVec3::from_array(std::array::from_fn(|r| rows[r + 3][column]));
        let moved = v + omega.cross(arm_m);
        for r in 0..3 {
            n_l[6 * member + r][column] += moved[r];
        }
    }
}

/// Accelerations of the joints from the dense equations, and the logarithms of det D block by block.
fn dense_solution(sample: &Sample, members: &[Member]) -> (Vec<f64>, Vec<f64>) {
    let n = members.len();
    let sizes: Vec<usize> = members
        .iter()
        .map(|member| member.turns.len() + if member.is_base { 3 } else { 0 })
        .collect();
    let (mut n_l, mut n_d, mut m) = (
        zeros(6 * n, 6 * n),
        zeros(6 * n, sizes.iter().sum()),
        zeros(6 * n, 6 * n),
    );
    // Accelerations of the joints at zero joint accelerations, and what they ask of the loads.
    let mut proximal = vec![DVec3::ZERO; n];
    let mut w = vec![0.0; 6 * n];
    let mut column = 0;
    let anchor = sample
        .loads
        .anchor_m_s2
        .first()
        .copied()
        .unwrap_or_default();
    for (i, member) in members.iter().enumerate() {
        add(&mut n_l, 6 * i, 6 * i, DMat3::IDENTITY);
        add(&mut n_l, 6 * i + 3, 6 * i + 3, DMat3::IDENTITY);
        if let Some(p) = member.parent {
            carry(&mut n_l, i, p, member.arm_m);
            let omega = members[p].omega;
            proximal[i] = proximal[p] + omega.cross(omega.cross(member.arm_m));
        } else if !member.is_base {
            proximal[i] = anchor;
        }
        if member.is_base {
            add(&mut n_d, 6 * i, column, DMat3::IDENTITY);
            column += 3;
        }
        for turn in &member.turns {
            for r in 0..3 {
                n_d[6 * i + 3 + r][column] = turn[r];
            }
            column += 1;
        }
        let (kg, moment, inertia) = member.mass;
        add(&mut m, 6 * i, 6 * i, DMat3::from_diagonal(DVec3::splat(kg)));
        add(&mut m, 6 * i, 6 * i + 3, -cross_matrix(moment));
        add(&mut m, 6 * i + 3, 6 * i, cross_matrix(moment));
        add(&mut m, 6 * i + 3, 6 * i + 3, inertia);
        let omega = member.omega;
        // A rod has no rate about itself, so its gyroscopic torque is that of d x (omega x (omega x d)) = 0.
        let force = member.load.0 - kg * proximal[i] - omega.cross(omega.cross(moment));
        let own_gyroscopic = if member.turns.len() == 3 {
            // In the load already about the centre of mass; about the joint the arm adds its own.
            let r = moment / kg;
            r.cross(kg * omega.cross(omega.cross(r)))
        } else {
            DVec3::ZERO
        };
        let torque = member.load.1 - moment.cross(proximal[i]) - own_gyroscopic;
        for r in 0..3 {
            w[6 * i + r] = force[r];
            w[6 * i + 3 + r] = torque[r];
        }
    }
    let natural = product(&n_l, &n_d);
    let across = transposed(&natural);
    let h = product(&product(&across, &m), &natural);
    let tau: Vec<f64> = across
        .iter()
        .map(|row| row.iter().zip(&w).map(|(a, b)| a * b).sum())
        .collect();
    solve(h, tau, &sizes)
}

fn compare(sample: &Sample) {
    let members = members(sample);
    let (rates, logs) = dense_solution(sample, &members);
    let (dynamics, out) = sample.solve();
    let mut member = sample.tree.bases.len();
    let mut place = 6 * member;
    for &base in &sample.tree.bases {
        let found = out.bodies[base];
        let expected = DVec3::from_slice(&rates[0..]);
        assert!((found.linear - expected).length() < 1e-10 * (1.0 + expected.length()));
        let angular = sample.bodies[base].attitude * found.angular;
        assert!((angular - DVec3::from_slice(&rates[3..])).length() < 1e-10);
    }
    for limb in &sample.tree.limbs {
        for k in limb.links.clone() {
            let (d, rate) = (sample.links.span_m[k], sample.links.rate_m_s[k]);
            let turns = &members[member].turns;
            let alpha = rates[place] * turns[0] + rates[place + 1] * turns[1];
            let expected = alpha.cross(d) - rate.length_squared() / d.length_squared() * d;
            let difference = (out.span_m_s2[k] - expected).length();
            assert!(
                difference < 1e-10 * (1.0 + expected.length()),
                "link {k}: {difference:e}"
            );
            // D = L^2 (B across e), whose determinant is that of B over s.
            let (inverse, s) = (dynamics.links[k].inverse, dynamics.links[k].stiffness);
            let log = -glam::DMat3::from(inverse).determinant().ln() - s.ln()
                + 2.0 * d.length_squared().ln();
            assert!((log - logs[member]).abs() < 1e-10, "D of link {k}");
            (member, place) = (member + 1, place + 2);
        }
        let angular = sample.bodies[limb.child].attitude * out.bodies[limb.child].angular;
        let expected = DVec3::from_slice(&rates[place..]);
        assert!((angular - expected).length() < 1e-10 * (1.0 + expected.length()));
        let log = -(-dynamics.bodies[limb.child].turning).determinant().ln();
        assert!((log - logs[member]).abs() < 1e-10, "D of a body");
        (member, place) = (member + 1, place + 3);
    }
    assert_eq!(place, rates.len());
}

#[test]
fn the_dense_mass_matrix_of_twenty_links_agrees() {
    for (seed, is_free) in [(3, false), (4, true)] {
        for tip_kg in [0.05, 10.0] {
            let drawn = Drawn {
                spread: 0.7,
                rod_kg: 0.3,
                seed,
            };
            compare(&chain(20, tip_kg, is_free, drawn));
        }
    }
}

#[test]
fn the_dense_mass_matrix_of_a_branched_tree_agrees() {
    let at = End::OnBody;
    let ropes = [(at(0), at(1), 8), (at(2), at(1), 5), (at(1), at(3), 7)];
    let drawn = Drawn {
        spread: 0.9,
        rod_kg: 0.4,
        seed: 11,
    };
    compare(&Sample::new(&ropes, &[40.0, 9.0, 8.0, 12.0], drawn));
}
