//! The maximum of a smooth function of a few numbers, and the curvature there.
//!
//! Newton's method with derivatives by central differences, damped as Levenberg and Marquardt do: a step is
//! shortened towards the gradient until it gains.
//!
//! Source: Marquardt (1963), J. SIAM 11, 431-441.
//!
//! Assumptions: the numbers are scaled so that `step` is small for the function, and all of order one.

use nalgebra::{DMatrix, DVector};

const ITERATIONS: usize = 60;
/// The gain that a further step promises, below which it is not worth taking.
const LEAST_GAIN: f64 = 1e-9;
/// A gain that round-off may hide.
const HIDDEN_GAIN: f64 = 1e-4;
/// The first derivatives are found with this part of the step: they say where the maximum is, and their error
/// grows with its square. The second ones need more of a difference.
const PART_FOR_GRADIENT: f64 = 0.01;
const FIRST_DAMPING: f64 = 1e-3;
const MOST_DAMPING: f64 = 1e12;

/// A place where a function is at its largest.
#[derive(Clone, Debug)]
pub(super) struct Maximum {
    pub(super) place: Vec<f64>,
    pub(super) value: f64,
    /// Minus the matrix of second derivatives with respect to the free numbers.
    pub(super) information: DMatrix<f64>,
}

/// The maximum near `start`, where the numbers in `free` may change; `None` if there is none nearby.
pub(super) fn find(
    function: &dyn Fn(&[f64]) -> f64,
    start: &[f64],
    free: &[usize],
    step: f64,
) -> Option<Maximum> {
    let mut place = start.to_vec();
    let mut value = function(&place);
    let mut damping = FIRST_DAMPING;
    for _ in 0..ITERATIONS {
        let (gradient, information) = derivatives(function, &place, value, free, step);
        let promised = information
            .clone()
            .cholesky()
            .map(|factor| gradient.dot(&factor.solve(&gradient)));
        let next = match promised {
            Some(gain) if gain < LEAST_GAIN => None,
            _ => uphill(
                function,
                (&place, value),
                (&gradient, &information),
                free,
                &mut damping,
            ),
        };
        match next {
            Some(next) => (place, value) = next,
            None if promised.is_some_and(|gain| gain < HIDDEN_GAIN) => {
                return Some(Maximum {
                    place,
                    value,
                    information,
                });
            }
            None => return None,
        }
    }
    None
}

/// A step that gains.
fn uphill(
    function: &dyn Fn(&[f64]) -> f64,
    (place, value): (&[f64], f64),
    (gradient, information): (&DVector<f64>, &DMatrix<f64>),
    free: &[usize],
    damping: &mut f64,
) -> Option<(Vec<f64>, f64)> {
    while *damping < MOST_DAMPING {
        let mut damped = information.clone();
        for index in 0..free.len() {
            damped[(index, index)] += *damping * information[(index, index)].abs().max(1.0);
        }
        if let Some(factor) = damped.cholesky() {
            let change = factor.solve(gradient);
            let mut next = place.to_vec();
            for (index, change) in free.iter().zip(change.iter()) {
                next[*index] += change;
            }
            let found = function(&next);
            if found >= value {
                *damping = (*damping * 0.1).max(1e-12);
                return Some((next, found));
            }
        }
        *damping *= 10.0;
    }
    None
}

/// The gradient, and minus the second derivatives.
fn derivatives(
    function: &dyn Fn(&[f64]) -> f64,
    place: &[f64],
    value: f64,
    free: &[usize],
    step: f64,
) -> (DVector<f64>, DMatrix<f64>) {
    let at = |moves: &[(usize, f64)]| {
        let mut moved = place.to_vec();
        for (index, by) in moves {
            moved[*index] += by;
        }
        function(&moved)
    };
    let count = free.len();
    let mut gradient = DVector::zeros(count);
    let mut information = DMatrix::zeros(count, count);
    for (i, a) in free.iter().enumerate() {
        let (up, down) = (at(&[(*a, step)]), at(&[(*a, -step)]));
        let short = PART_FOR_GRADIENT * step;
        gradient[i] = (at(&[(*a, short)]) - at(&[(*a, -short)])) / (2.0 * short);
        information[(i, i)] = (2.0 * value - up - down) / (step * step);
        for (j, b) in free.iter().enumerate().take(i) {
            let same = at(&[(*a, step), (*b, step)]) + at(&[(*a, -step), (*b, -step)]);
            let opposite = at(&[(*a, step), (*b, -step)]) + at(&[(*a, -step), (*b, step)]);
            let mixed = (opposite - same) / (4.0 * step * step);
            information[(i, j)] = mixed;
            information[(j, i)] = mixed;
        }
    }
    (gradient, information)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_climbs_a_curved_ridge_and_knows_the_curvature_at_its_top() {
        // Rosenbrock's valley upside down: second derivatives at (1, 1) are 802, -400 and 200.
        let ridge = |p: &[f64]| -100.0 * (p[1] - p[0] * p[0]).powi(2) - (1.0 - p[0]).powi(2);
        let top = find(&ridge, &[-1.2, 1.0], &[0, 1], 1e-4).unwrap();
        // A gain of 1e-9 along the flattest direction, whose curvature is 0.4.
        let near = (2e-9_f64 / 0.4).sqrt() * 5.0_f64.sqrt();
        assert!((top.place[0] - 1.0).abs() < near && (top.place[1] - 1.0).abs() < near);
        for (found, expected) in top.information.iter().zip([802.0, -400.0, -400.0, 200.0]) {
            assert!((found - expected).abs() < 1e-2, "{found} {expected}");
        }
        let held = find(&ridge, &[0.5, 1.0], &[1], 1e-4).unwrap();
        assert!((held.place[1] - 0.25).abs() < 1e-6 && held.place[0] == 0.5);
    }
}
