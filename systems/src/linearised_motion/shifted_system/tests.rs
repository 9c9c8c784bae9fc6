//! Against the matrix written out by the motion of every point, in a dense solution.

use super::*;
use crate::linearised_motion::dense_motion::{dense_matrices, derivatives, ready, topology};
use crate::nonlinear_solver::test_support::{Random, dense_solve};

const STEP_S: f64 = 0.2;
const GAMMA: f64 = 0.4;

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
