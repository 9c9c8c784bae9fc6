use std::convert::Infallible;

use super::super::test_support::chain;
use super::*;

const GRAVITY: f64 = 9.81;

/// Point masses in a row joined by linear springs; the ends may be held.
struct Chain {
    masses: Vec<f64>,
    /// Stiffness and length without force of each spring; spring `i` ends at
    /// mass `i`.
    stiffness: f64,
    length: f64,
    /// Where the first spring starts, if it exists.
    start: Option<[f64; 3]>,
    /// Where a spring behind the last mass ends, if it exists.
    end: Option<[f64; 3]>,
    /// Upward force on the first mass, less `gradient` times its height.
    lift: f64,
    gradient: f64,
}

impl Chain {
    /// Tension of the spring from `a` to `b`, and the unit vector.
    fn spring(&self, a: [f64; 3], b: [f64; 3]) -> (f64, [f64; 3]) {
        let d = [0, 1, 2].map(|c| b[c] - a[c]);
        let length = d.iter().map(|d| d * d).sum::<f64>().sqrt();
        let tension = self.stiffness * (length - self.length);
        (tension, d.map(|d| d / length))
    }

    fn solve(&mut self, x: &mut [f64]) -> NewtonReport {
        let sites = self.masses.len();
        let pattern = BlockPattern::new(&vec![3; sites], &chain(sites));
        let total: f64 = self.masses.iter().sum();
        let settings = NewtonSettings {
            difference_step: &vec![1e-6; x.len()],
            largest_step: &vec![0.05 * sites as f64 * self.length; x.len()],
            residual_scale: &vec![total * GRAVITY; x.len()],
            tolerance: 1e-12,
            floor: 1e-10,
            smallest_damping: 1e-10,
            largest_iterations: 100,
        };
        DampedNewton::new(&pattern)
            .solve(self, x, &settings)
            .unwrap()
    }
}

fn at(x: &[f64], i: usize) -> [f64; 3] {
    [x[3 * i], x[3 * i + 1], x[3 * i + 2]]
}

impl Residual for Chain {
    type Error = Infallible;

    fn dimension(&self) -> usize {
        3 * self.masses.len()
    }

    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), Infallible> {
        let last = self.masses.len() - 1;
        r.fill(0.0);
        for (i, mass) in self.masses.iter().enumerate() {
            r[3 * i + 2] -= mass * GRAVITY;
        }
        r[2] += self.lift - self.gradient * x[2];
        if let Some(start) = self.start {
            let (tension, unit) = self.spring(start, at(x, 0));
            (0..3).for_each(|c| r[c] -= tension * unit[c]);
        }
        if let Some(end) = self.end {
            let (tension, unit) = self.spring(at(x, last), end);
            (0..3).for_each(|c| r[3 * last + c] += tension * unit[c]);
        }
        for i in 1..=last {
            let (tension, unit) = self.spring(at(x, i - 1), at(x, i));
            for c in 0..3 {
                r[3 * i - 3 + c] += tension * unit[c];
                r[3 * i + c] -= tension * unit[c];
            }
        }
        Ok(())
    }
}

#[test]
fn hanging_chain_carries_the_weight_below() {
    let sites = 30;
    let mut system = Chain {
        masses: (0..sites).map(|i| 0.5 + 0.1 * (i % 4) as f64).collect(),
        stiffness: 2e4,
        length: 0.5,
        start: Some([2.0, -1.0, 40.0]),
        end: None,
        lift: 0.0,
        gradient: 0.0,
    };
    // From an arc, without any extension, far from the vertical.
    let mut x = Vec::new();
    let (mut position, mut angle) = ([2.0, -1.0, 40.0], 0.2_f64);
    for _ in 0..sites {
        position[0] += 0.5 * angle.sin() * 0.8;
        position[1] += 0.5 * angle.sin() * 0.6;
        position[2] -= 0.5 * angle.cos();
        angle += 0.01;
        x.extend(position);
    }
    let report = system.solve(&mut x);
    let mut height = 40.0;
    for i in 0..sites {
        let below: f64 = system.masses[i..].iter().sum();
        height -= system.length + below * GRAVITY / system.stiffness;
        assert!((x[3 * i] - 2.0).abs() < 1e-9, "{i}");
        assert!((x[3 * i + 1] + 1.0).abs() < 1e-9, "{i}");
        assert!((x[3 * i + 2] - height).abs() < 1e-9, "{i}");
    }
    assert!(report.largest_residual < 1e-10);
    assert!(report.iterations < 60, "{report:?}");
}

/// Positions of the masses between two supports at equal height, from the
/// horizontal force alone: all masses equal, so the vertical force in spring
/// `s` is `(n/2 - s) m g`, and the spans add up for one horizontal force only.
fn supported(sites: usize, weight: f64, stiffness: f64, length: f64, span: f64) -> Vec<[f64; 2]> {
    let shape = |horizontal: f64| -> Vec<[f64; 2]> {
        let mut position = [0.0, 0.0];
        let springs = (0..=sites).map(|s| {
            let vertical = (sites as f64 / 2.0 - s as f64) * weight;
            let tension = horizontal.hypot(vertical);
            let stretched = length + tension / stiffness;
            position[0] += stretched * horizontal / tension;
            position[1] -= stretched * vertical / tension;
            position
        });
        springs.collect()
    };
    let (mut low, mut high) = (1e-6, 1e6);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if shape(middle)[sites][0] < span {
            low = middle;
        } else {
            high = middle;
        }
    }
    shape(0.5 * (low + high))
}

#[test]
fn supported_chain_is_symmetric_and_balanced() {
    let (sites, span) = (21, 10.0);
    let mut system = Chain {
        masses: vec![0.2; sites],
        stiffness: 5e3,
        length: 0.5,
        start: Some([0.0; 3]),
        end: Some([span, 0.0, 0.0]),
        lift: 0.0,
        gradient: 0.0,
    };
    let mut x = Vec::new();
    for i in 0..sites {
        let part = (i + 1) as f64 / (sites + 1) as f64;
        x.extend([span * part, 0.1 * part, -8.0 * part * (1.0 - part)]);
    }
    let report = system.solve(&mut x);
    let expected = supported(sites, 0.2 * GRAVITY, 5e3, 0.5, span);
    for i in 0..sites {
        let mirror = sites - 1 - i;
        assert!((x[3 * i] + x[3 * mirror] - span).abs() < 1e-9);
        assert!((x[3 * i + 2] - x[3 * mirror + 2]).abs() < 1e-9);
        assert!(x[3 * i + 1].abs() < 1e-9);
        assert!((x[3 * i] - expected[i][0]).abs() < 1e-9, "{i}");
        assert!((x[3 * i + 2] - expected[i][1]).abs() < 1e-9, "{i}");
    }
    let (first, from) = system.spring([0.0; 3], at(&x, 0));
    let (last, to) = system.spring(at(&x, sites - 1), [span, 0.0, 0.0]);
    let weight = 0.2 * GRAVITY * sites as f64;
    assert!((-first * from[2] + last * to[2] - weight).abs() < 1e-9 * weight);
    assert!((first * from[0] - last * to[0]).abs() < 1e-9 * weight);
    assert!(report.iterations < 60, "{report:?}");
}

#[test]
fn long_chain_is_found_from_a_guess_under_compression() {
    // The guess is shorter than the chain, where the residual alone has
    // minima that are no equilibria.
    let (sites, span) = (400, 190.0);
    let mut system = Chain {
        masses: vec![0.2; sites],
        stiffness: 1e5,
        length: 0.5,
        start: Some([0.0; 3]),
        end: Some([span, 0.0, 0.0]),
        lift: 0.0,
        gradient: 0.0,
    };
    let mut x = Vec::new();
    for i in 0..sites {
        let part = (i + 1) as f64 / (sites + 1) as f64;
        x.extend([span * part, 0.1 * part, -20.0 * part * (1.0 - part)]);
    }
    let report = system.solve(&mut x);
    assert!(report.largest_residual < 1e-10, "{report:?}");
    let expected = supported(sites, 0.2 * GRAVITY, 1e5, 0.5, span);
    for i in 0..sites {
        assert!((x[3 * i] - expected[i][0]).abs() < 1e-8, "{i}");
        assert!((x[3 * i + 2] - expected[i][1]).abs() < 1e-8, "{i}");
        assert!(x[3 * i + 1].abs() < 1e-8, "{i}");
    }
}

/// A chain below a float that finds its height; free to move in x and y and
/// to turn about the vertical.
fn floating() -> Chain {
    let masses = vec![0.3; 12];
    let weight: f64 = masses.iter().sum::<f64>() * GRAVITY;
    Chain {
        masses,
        stiffness: 1e4,
        length: 1.0,
        start: None,
        end: None,
        lift: weight + 2.0,
        gradient: 0.4,
    }
}

#[test]
fn free_translation_and_yaw_do_not_move() {
    let mut system = floating();
    let mut x: Vec<f64> = (0..12)
        .flat_map(|i| [123.4, -56.7, 7.0 - 1.01 * i as f64])
        .collect();
    let report = system.solve(&mut x);
    assert!(report.largest_residual < 1e-10, "{report:?}");
    for i in 0..12 {
        assert!((x[3 * i] - 123.4).abs() < 1e-9, "{i}: {}", x[3 * i] - 123.4);
        assert!((x[3 * i + 1] + 56.7).abs() < 1e-9, "{i}");
    }
    assert!((x[2] - 2.0 / 0.4).abs() < 1e-9);
}

#[test]
fn bent_floating_chain_straightens_where_it_is() {
    let mut system = floating();
    let mut x: Vec<f64> = (0..12)
        .flat_map(|i| {
            let bend = 0.2 * (i as f64).sin();
            [123.4 + bend, -56.7, 7.0 - 0.98 * i as f64]
        })
        .collect();
    let report = system.solve(&mut x);
    assert!(report.largest_residual < 1e-10, "{report:?}");
    for i in 0..12 {
        assert!((x[3 * i] - x[0]).abs() < 1e-9);
        assert!((x[3 * i] - 123.4).abs() < 0.2);
        // No force ever acts along y: the plane of the bend does not turn.
        assert!(
            (x[3 * i + 1] + 56.7).abs() < 1e-9,
            "{}",
            x[3 * i + 1] + 56.7
        );
    }
}

/// One unknown with the residual of a function; fails where that is `None`.
struct Scalar<F>(F);

impl<F: Fn(f64) -> Option<f64>> Residual for Scalar<F> {
    type Error = &'static str;

    fn dimension(&self) -> usize {
        1
    }

    fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), &'static str> {
        r[0] = (self.0)(x[0]).ok_or("outside")?;
        Ok(())
    }
}

fn solve_scalar(
    function: impl Fn(f64) -> Option<f64>,
    x: f64,
    largest_iterations: usize,
) -> (Result<NewtonReport, NewtonError<&'static str>>, f64) {
    let settings = NewtonSettings {
        difference_step: &[1e-5],
        largest_step: &[1.0],
        residual_scale: &[1.0],
        tolerance: 1e-12,
        floor: 1e-9,
        smallest_damping: 1e-10,
        largest_iterations,
    };
    let mut x = [x];
    let mut newton = DampedNewton::new(&BlockPattern::new(&[1], &[]));
    let result = newton.solve(&mut Scalar(function), &mut x, &settings);
    (result, x[0])
}

#[test]
fn no_solution_ends_in_not_converged() {
    for start in [-3.0, -1.0, 0.0, 0.3, 2.0] {
        match solve_scalar(|x| Some(x * x + 1.0), start, 100).0 {
            Err(NewtonError::NotConverged {
                iterations,
                largest_residual,
                worst_unknown,
            }) => {
                assert!(iterations <= 100);
                assert!(largest_residual >= 1.0);
                assert_eq!(worst_unknown, 0);
            }
            other => panic!("{other:?}"),
        }
    }
    let (result, _) = solve_scalar(|_| Some(f64::NAN), 0.0, 100);
    assert!(matches!(
        result,
        Err(NewtonError::NotConverged { iterations: 0, .. })
    ));
}

#[test]
fn convergence_is_quadratic() {
    // From the solution of one limit on the iterations to the next.
    let force = |x: f64| Some(1.0 - x - x.powi(3));
    let errors: Vec<f64> = (1..5)
        .map(|limit| force(solve_scalar(force, 1.0, limit).1).unwrap().abs())
        .collect();
    for pair in errors.windows(2) {
        assert!(pair[1] < 2.0 * pair[0] * pair[0] + 1e-15, "{errors:?}");
    }
    assert!(errors[3] < 1e-9, "{errors:?}");
    assert!(solve_scalar(force, 1.0, 6).0.unwrap().largest_residual < 1e-12);
}

#[test]
fn failing_trial_points_shorten_the_step() {
    // The first step, from 0.2, is the largest allowed, to 1.2, where the
    // residual fails.
    let force = |x: f64| (x.abs() < 1.0).then(|| 0.9 - x.powi(2) * 1.2 - 0.1 * x);
    let (result, x) = solve_scalar(force, 0.2, 100);
    assert!(result.is_ok(), "{result:?}");
    assert!(force(x).unwrap().abs() < 1e-12);
    let (result, _) = solve_scalar(force, 2.0, 100);
    assert_eq!(result, Err(NewtonError::Evaluation("outside")));
}

#[test]
fn round_off_below_the_floor_is_accepted() {
    // Rounded to steps of 1e-10 such that it is never below 5e-11.
    let rounded = |x: f64| Some(((0.3 - x) * 1e10).round() * 1e-10 + 5e-11);
    let (result, x) = solve_scalar(rounded, 0.0, 100);
    let report = result.unwrap();
    assert!(
        report.largest_residual < 1e-9 && report.iterations < 20,
        "{report:?}"
    );
    assert!((x - 0.3).abs() < 1e-9);
}

#[test]
fn rigid_motion_without_any_stiffness_stays() {
    // A site of six unknowns of which only the heights and tilts are held.
    struct Body;
    impl Residual for Body {
        type Error = Infallible;
        fn dimension(&self) -> usize {
            6
        }
        fn residual(&mut self, x: &[f64], r: &mut [f64]) -> Result<(), Infallible> {
            r.copy_from_slice(&[0.0, 0.0, 5.0 - 1e3 * x[2], -2.0 * x[3], -2.0 * x[4], 0.0]);
            Ok(())
        }
    }
    let settings = NewtonSettings {
        difference_step: &[1e-5; 6],
        largest_step: &[0.3; 6],
        residual_scale: &[1.0; 6],
        tolerance: 1e-12,
        floor: 1e-10,
        smallest_damping: 1e-10,
        largest_iterations: 50,
    };
    let mut x = [3.0, 4.0, 1.0, 0.2, -0.1, 1.5];
    let mut newton = DampedNewton::new(&BlockPattern::new(&[6], &[]));
    let report = newton.solve(&mut Body, &mut x, &settings).unwrap();
    assert_eq!((x[0], x[1], x[5]), (3.0, 4.0, 1.5));
    assert!((x[2] - 5e-3).abs() < 1e-12 && x[3].abs() < 1e-12 && x[4].abs() < 1e-12);
    assert!(report.iterations < 10, "{report:?}");
}
