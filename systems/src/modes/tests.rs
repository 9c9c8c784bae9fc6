//! Modes against closed forms, and one solver against the other.

use std::f64::consts::PI;

use nalgebra::{Complex, DMatrix};

use super::cluster::separate;
use super::dense_motion::DenseMotion;
use super::eigenmodes::{Eigenmode, Method, slowest};
use super::real_eigenvectors::eigenpairs;
use super::sparse_motion::SparseMotion;
use crate::nonlinear_solver::block_sparse::BlockPattern;

/// A string of `n` beads of mass 1 between two walls, free to move in three directions: stiffness 1
/// across in x and in y, `along` in z, and dampers of `damping` beside the springs.
fn string(n: usize, along: f64, damping: f64) -> SparseMotion {
    let edges: Vec<(usize, usize)> = (1..n).map(|k| (k - 1, k)).collect();
    let mut motion = SparseMotion::zeros(&BlockPattern::new(&vec![3; n], &edges));
    for bead in 0..n {
        for (axis, k) in [1.0, 1.0, along].into_iter().enumerate() {
            motion.mass.add(bead, bead, axis, axis, 1.0);
            motion.stiffness.add(bead, bead, axis, axis, 2.0 * k);
            motion
                .damping
                .add(bead, bead, axis, axis, 2.0 * damping * k);
            for beside in [bead.wrapping_sub(1), bead + 1] {
                if beside < n {
                    motion.stiffness.add(bead, beside, axis, axis, -k);
                    motion.damping.add(bead, beside, axis, axis, -damping * k);
                }
            }
        }
    }
    motion
}

/// omega_k = 2 sin(k pi / (2 (n + 1))) across, each twice (Goldstein, Poole and Safko 2002, sec. 12.1), and
/// a damping ratio of damping omega / 2.
fn assert_is_string(modes: &[Eigenmode], n: usize, damping: f64) {
    for (number, mode) in modes.iter().enumerate() {
        let k = number / 2 + 1;
        let omega = 2.0 * libm::sin(k as f64 * PI / (2.0 * (n + 1) as f64));
        let ratio = 0.5 * damping * omega;
        let expected = omega * Complex::new(-ratio, (1.0 - ratio * ratio).sqrt());
        let error = (mode.eigenvalue - expected).norm() / omega;
        assert!(error < 1e-11, "{number}: {} {expected}", mode.eigenvalue);
    }
}

#[test]
fn both_solvers_find_the_string_of_beads_with_springs_a_million_times_stiffer_along() {
    let (n, damping) = (12, 1e-3);
    let mut sparse = string(n, 1e6, damping);
    let mut full = DenseMotion::of(&sparse, 0);
    for method in [Method::Complete, Method::Slowest] {
        let modes = slowest(&mut sparse, 10, 0.1, method);
        assert_is_string(&modes.unwrap(), n, damping);
        let modes = slowest(&mut full, 10, 0.1, method);
        assert_is_string(&modes.unwrap(), n, damping);
    }
}

#[test]
fn long_strings_show_both_modes_of_every_pair() {
    let (n, damping) = (400, 0.1);
    let mut sparse = string(n, 1e6, damping);
    let modes = slowest(&mut sparse, 12, 0.01, Method::Slowest).unwrap();
    assert_eq!(modes.len(), 12);
    assert_is_string(&modes, n, damping);
}

/// x'' + x = w, w' = -x / 2 - w / 4: the roots of (l^2 + 1)(l + 1/4) + 1/2.
#[test]
fn first_order_states_take_part() {
    let mut motion = DenseMotion::zeros(1, 1);
    motion.mass[(0, 0)] = 1.0;
    motion.stiffness[(0, 0)] = 1.0;
    motion.by_first_order[(0, 0)] = 1.0;
    motion.first_order_by_displacement[(0, 0)] = -0.5;
    motion.first_order[(0, 0)] = -0.25;
    let modes = slowest(&mut motion, 5, 1.0, Method::Complete).unwrap();
    assert_eq!(modes.len(), 2);
    for mode in modes {
        let l = mode.eigenvalue;
        let left = (l * l + 1.0) * (l + 0.25) + 0.5;
        assert!(left.norm() < 1e-13, "{l}: {left}");
        let push = mode.first_order[0] - (l * l + 1.0) * mode.displacement[0];
        assert!(push.norm() < 1e-13, "{l}");
    }
}

/// A x = lambda x of a matrix with equal, real and complex eigenvalues, and with scales apart.
#[test]
fn eigenpairs_satisfy_their_equation() {
    let n = 30;
    let matrix = DMatrix::from_fn(n, n, |i, j| {
        let size = if j + 1 < i { 0.0 } else { 1.0 };
        size * libm::sin((7 * i + 3 * j * j) as f64) * libm::exp(-0.3 * j as f64)
    });
    let pairs = eigenpairs(matrix.clone()).unwrap();
    assert_eq!(pairs.len(), n);
    assert!(pairs.iter().any(|pair| pair.value.im != 0.0));
    assert!(pairs.iter().any(|pair| pair.value.im == 0.0));
    for pair in &pairs {
        for i in 0..n {
            let terms = pair.vector.iter().enumerate();
            let image: Complex<f64> = terms.map(|(j, x)| *x * matrix[(i, j)]).sum();
            let error = (image - pair.value * pair.vector[i]).norm();
            assert!(error < 1e-13, "{}: {error}", pair.value);
        }
    }
    let trace: Complex<f64> = pairs.iter().map(|pair| pair.value).sum();
    assert!((trace - matrix.trace()).norm() < 1e-13);
}

/// Two mixtures of a motion in place 0 and one in place 1 come apart.
#[test]
fn clusters_separate() {
    let i = Complex::new(0.0, 1.0);
    let one = Complex::new(1.0, 0.0);
    let vectors = [vec![one, 2.0 * i], vec![3.0 * i, one]];
    let combination = separate(&vectors, |place| place == 0).unwrap();
    let mixed = |column: usize, place: usize| {
        let sum = combination[(0, column)] * vectors[0][place]
            + combination[(1, column)] * vectors[1][place];
        sum.norm()
    };
    assert!(mixed(0, 1) < 1e-14 * mixed(0, 0));
    assert!(mixed(1, 0) < 1e-14 * mixed(1, 1));
}
