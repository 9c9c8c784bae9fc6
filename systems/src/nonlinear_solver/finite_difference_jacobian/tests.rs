use std::convert::Infallible;

use super::super::test_support::{Random, chain, dense, distance, graphs, random_dims};
use super::*;

/// Chain of masses in space joined by springs of force `k e + c e³` with the
/// extension `e`; the first spring starts at the origin.
struct Springs {
    masses: usize,
    evaluations: usize,
}

const STIFFNESS: f64 = 3.0;
const CUBIC: f64 = 0.7;
const LENGTH: f64 = 0.8;

impl Springs {
    fn spring(x: &[f64], i: usize) -> ([f64; 3], f64) {
        let below = |c: usize| if i == 0 { 0.0 } else { x[3 * i - 3 + c] };
        let d = [0, 1, 2].map(|c| x[3 * i + c] - below(c));
        (d, d.iter().map(|d| d * d).sum::<f64>().sqrt())
    }

    /// Stiffness of spring `i`, `∂(force on its upper end)/∂(upper end)`.
    fn derivative(x: &[f64], i: usize) -> [[f64; 3]; 3] {
        let (d, length) = Self::spring(x, i);
        let e = length - LENGTH;
        let tension = STIFFNESS * e + CUBIC * e * e * e;
        let tangent = STIFFNESS + 3.0 * CUBIC * e * e;
        [0, 1, 2].map(|r| {
            [0, 1, 2].map(|c| {
                let along = d[r] * d[c] / (length * length);
                let unit = if r == c { 1.0 } else { 0.0 };
                -(tangent * along + tension / length * (unit - along))
            })
        })
    }
}

impl Residual for Springs {
    type Error = Infallible;

    fn dimension(&self) -> usize {
        3 * self.masses
    }

    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), Infallible> {
        self.evaluations += 1;
        r.fill(0.0);
        for i in 0..self.masses {
            let (d, length) = Self::spring(x, i);
            let e = length - LENGTH;
            let tension = STIFFNESS * e + CUBIC * e * e * e;
            for c in 0..3 {
                r[3 * i + c] -= tension * d[c] / length;
                if i > 0 {
                    r[3 * i - 3 + c] += tension * d[c] / length;
                }
            }
        }
        Ok(())
    }
}

#[test]
fn jacobian_of_a_spring_chain_is_the_analytic_one() {
    let masses = 25;
    let mut random = Random::new(4);
    let x: Vec<f64> = (0..3 * masses)
        .map(|q| 1000.0 + (q / 3) as f64 * 0.6 + 0.2 * random.signed())
        .collect();
    let mut expected = BlockMatrix::new(BlockPattern::new(&vec![3; masses], &chain(masses)));
    for i in 0..masses {
        let derivative = Springs::derivative(&x, i);
        for (r, row) in derivative.iter().enumerate() {
            for (c, &v) in row.iter().enumerate() {
                expected.add(i, i, r, c, v);
                if i > 0 {
                    expected.add(i - 1, i - 1, r, c, v);
                    expected.add(i - 1, i, r, c, -v);
                    expected.add(i, i - 1, r, c, -v);
                }
            }
        }
    }
    let mut jacobian = BlockMatrix::new(expected.pattern().clone());
    let mut system = Springs {
        masses,
        evaluations: 0,
    };
    let mut difference = FiniteDifference::new(expected.pattern());
    let steps = vec![1e-5; 3 * masses];
    difference
        .evaluate(&mut system, &x, &steps, &mut jacobian)
        .unwrap();
    // The first spring, from the origin, is over 1000 long: its force of
    // 1e9 carries round-off, so its two blocks are compared relatively.
    let scale = expected.block(0, 0)[0].abs();
    assert!(distance(jacobian.block(0, 0), expected.block(0, 0)) < 1e-7 * scale);
    for i in 1..masses {
        for &j in expected.pattern().row(i) {
            let error = distance(jacobian.block(i, j), expected.block(i, j));
            assert!(error < 1e-8, "block {i}, {j}: {error:e}");
        }
    }
    // Three colours of three unknowns, two residuals for each.
    assert_eq!(system.evaluations, 18);
}

/// `r_p = Σ_q a_pq x_q (1 + x_q + x_p)`: central differences are exact.
struct Quadratic {
    coefficients: Vec<Vec<f64>>,
}

impl Residual for Quadratic {
    type Error = Infallible;

    fn dimension(&self) -> usize {
        self.coefficients.len()
    }

    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), Infallible> {
        for (p, row) in self.coefficients.iter().enumerate() {
            let terms = row
                .iter()
                .zip(x)
                .map(|(a, x_q)| a * x_q * (1.0 + x_q + x[p]));
            r[p] = terms.sum();
        }
        Ok(())
    }
}

#[test]
fn quadratic_systems_of_mixed_sites_are_exact() {
    let mut random = Random::new(8);
    for sites in [1, 2, 5, 12] {
        for (name, edges) in graphs(sites, &mut random) {
            let pattern = BlockPattern::new(&random_dims(sites, &mut random), &edges);
            let source = super::super::test_support::dominant(&pattern, false, &mut random);
            let a = dense(&source);
            let x: Vec<f64> = (0..a.len()).map(|_| random.signed()).collect();
            let mut expected = a.clone();
            for p in 0..a.len() {
                for q in 0..a.len() {
                    expected[p][q] = a[p][q] * (1.0 + 2.0 * x[q] + x[p]);
                }
                expected[p][p] += (0..a.len()).map(|q| a[p][q] * x[q]).sum::<f64>();
            }
            let mut jacobian = BlockMatrix::new(pattern.clone());
            let mut system = Quadratic { coefficients: a };
            FiniteDifference::new(&pattern)
                .evaluate(&mut system, &x, &vec![0.01; x.len()], &mut jacobian)
                .unwrap();
            for (found, expected) in dense(&jacobian).iter().zip(&expected) {
                assert!(distance(found, expected) < 1e-10, "{name} of {sites}");
            }
        }
    }
}

/// An angle that is kept in (-π, π], with the residual `cos(x)`; fails
/// for unknowns outside.
struct Angle;

impl Residual for Angle {
    type Error = &'static str;

    fn dimension(&self) -> usize {
        1
    }

    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), &'static str> {
        if x[0].abs() > std::f64::consts::PI {
            return Err("outside");
        }
        r[0] = x[0].cos();
        Ok(())
    }

    fn apply(&mut self, x: &mut [f64], dx: &[f64]) {
        x[0] += dx[0];
        if x[0] > std::f64::consts::PI {
            x[0] -= std::f64::consts::TAU;
        }
    }
}

#[test]
fn increments_are_applied_on_the_manifold_and_errors_passed_on() {
    let pattern = BlockPattern::new(&[1], &[]);
    let mut jacobian = BlockMatrix::new(pattern.clone());
    let mut difference = FiniteDifference::new(&pattern);
    let x = [std::f64::consts::PI - 1e-6];
    difference
        .evaluate(&mut Angle, &x, &[1e-4], &mut jacobian)
        .unwrap();
    assert!((jacobian.block(0, 0)[0] + x[0].sin()).abs() < 1e-8);
    let failed = difference.evaluate(&mut Angle, &[-4.0], &[1e-4], &mut jacobian);
    assert_eq!(failed, Err("outside"));
}
