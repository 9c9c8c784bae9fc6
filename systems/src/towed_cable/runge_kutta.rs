//! An explicit Runge-Kutta pair of orders 6 and 5 in eight stages with step control.
//!
//! ```text
//! k_i = f(y + h sum_j a_ij k_j)      y' = y + h sum_i b_i k_i      error = h sum_i (b_i - b*_i) k_i
//! ```
//!
//! | symbol | meaning |
//! |---|---|
//! | y, f | state of dimension `N`, its derivative (which does not depend on the arc length itself) |
//! | a, b, b* | the tableau, the weights of order 6, those of order 5 |
//! | h | step |
//!
//! Source: J. H. Verner, SIAM J. Numer. Anal. 15 (1978) 772-790, table 5 (the pair of DVERK). Steps
//! grow and shrink by 0.9 error^(-1/6), within 0.2 and 4.

const STAGES: usize = 8;

const A: [[f64; STAGES - 1]; STAGES] = [
    [0.0; 7],
    [1.0 / 6.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [4.0 / 75.0, 16.0 / 75.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [5.0 / 6.0, -8.0 / 3.0, 5.0 / 2.0, 0.0, 0.0, 0.0, 0.0],
    [
        -165.0 / 64.0,
        55.0 / 6.0,
        -425.0 / 64.0,
        85.0 / 96.0,
        0.0,
        0.0,
        0.0,
    ],
    [
        12.0 / 5.0,
        -8.0,
        4015.0 / 612.0,
        -11.0 / 36.0,
        88.0 / 255.0,
        0.0,
        0.0,
    ],
    [
        -8263.0 / 15000.0,
        124.0 / 75.0,
        -643.0 / 680.0,
        -81.0 / 250.0,
        2484.0 / 10625.0,
        0.0,
        0.0,
    ],
    [
        3501.0 / 1720.0,
        -300.0 / 43.0,
        297275.0 / 52632.0,
        -319.0 / 2322.0,
        24068.0 / 84065.0,
        0.0,
        3850.0 / 26703.0,
    ],
];

const SIXTH_ORDER: [f64; STAGES] = [
    3.0 / 40.0,
    0.0,
    875.0 / 2244.0,
    23.0 / 72.0,
    264.0 / 1955.0,
    0.0,
    125.0 / 11592.0,
    43.0 / 616.0,
];

const FIFTH_ORDER: [f64; STAGES] = [
    13.0 / 160.0,
    0.0,
    2375.0 / 5984.0,
    5.0 / 16.0,
    12.0 / 85.0,
    3.0 / 44.0,
    0.0,
    0.0,
];

/// Why a way cannot be gone to its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Obstacle<E> {
    /// The derivative could not be evaluated.
    Derivative(E),
    /// The steps became too short.
    TooShort,
}

/// Bounds of the steps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steps {
    /// The first one, which the error control may shorten.
    pub(super) first: f64,
    /// None is longer.
    pub(super) longest: f64,
    /// A shorter one is an obstacle.
    pub(super) shortest: f64,
}

/// An integration that starts at place zero.
pub(super) struct Integration<const N: usize> {
    steps: Steps,
    /// Size of an error that is allowed in each component in a step.
    tolerance: [f64; N],
    /// Where it stands.
    pub(super) place: f64,
    /// The state there.
    pub(super) state: [f64; N],
    step: f64,
}

impl<const N: usize> Integration<N> {
    /// From a state at place zero.
    pub(super) fn new(state: [f64; N], tolerance: [f64; N], steps: Steps) -> Self {
        Self {
            steps,
            tolerance,
            place: 0.0,
            state,
            step: steps.first,
        }
    }

    /// Goes on to `stop`, which is not behind it.
    pub(super) fn advance_to<E>(
        &mut self,
        stop: f64,
        derivative: &mut dyn FnMut(&[f64; N]) -> Result<[f64; N], E>,
    ) -> Result<(), Obstacle<E>> {
        while self.place < stop {
            let remaining = stop - self.place;
            // A stop within two steps is reached in two equal ones, so that no sliver remains.
            let (h, last) = if remaining <= self.step {
                (remaining, true)
            } else if remaining < 2.0 * self.step {
                (0.5 * remaining, false)
            } else {
                (self.step, false)
            };
            let (state, error) = self.try_step(h, derivative).map_err(Obstacle::Derivative)?;
            let factor = (0.9 * libm::pow(error.max(1e-12), -1.0 / 6.0)).clamp(0.2, 4.0);
            if error <= 1.0 {
                self.place = if last { stop } else { self.place + h };
                self.state = state;
                // A step that a stop cut short says nothing against the one that was wanted.
                let wanted = if last {
                    self.step.max(h * factor)
                } else {
                    h * factor
                };
                self.step = wanted.min(self.steps.longest);
            } else {
                self.step = h * factor;
                if self.step < self.steps.shortest {
                    return Err(Obstacle::TooShort);
                }
            }
        }
        Ok(())
    }

    /// The state after a step, and its error in parts of the tolerance (infinite if not a number).
    fn try_step<E>(
        &self,
        h: f64,
        derivative: &mut dyn FnMut(&[f64; N]) -> Result<[f64; N], E>,
    ) -> Result<([f64; N], f64), E> {
        let mut slopes = [[0.0; N]; STAGES];
        for stage in 0..STAGES {
            let mut state = self.state;
            for (weight, slope) in A[stage].iter().zip(&slopes).take(stage) {
                for (value, slope) in state.iter_mut().zip(slope) {
                    *value += h * weight * slope;
                }
            }
            slopes[stage] = derivative(&state)?;
        }
        let (mut state, mut worst) = (self.state, 0.0_f64);
        for (component, (value, tolerance)) in state.iter_mut().zip(&self.tolerance).enumerate() {
            let (mut change, mut error) = (0.0, 0.0);
            for ((slope, high), low) in slopes.iter().zip(&SIXTH_ORDER).zip(&FIFTH_ORDER) {
                change += high * slope[component];
                error += (high - low) * slope[component];
            }
            *value += h * change;
            let scaled = (h * error / tolerance).abs();
            worst = if scaled.is_nan() {
                f64::INFINITY
            } else {
                worst.max(scaled)
            };
        }
        Ok((state, worst))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The clock in the third component makes it depend on the place: y'' = -y + place.
    fn rotation(y: &[f64; 3]) -> Result<[f64; 3], ()> {
        Ok([y[1], y[2] - y[0], 1.0])
    }

    const STEPS: Steps = Steps {
        first: 0.1,
        longest: 0.5,
        shortest: 1e-13,
    };

    fn exact(place: f64) -> f64 {
        place.cos() - place.sin() + place
    }

    fn end(fixed_step: f64) -> [f64; 3] {
        let mut run = Integration::new([1.0, 0.0, 0.0], [f64::INFINITY; 3], STEPS);
        let steps = (3.0 / fixed_step).round() as usize;
        for _ in 0..steps {
            run.state = run.try_step(fixed_step, &mut rotation).unwrap().0;
        }
        run.state
    }

    #[test]
    fn every_row_of_the_tableau_sums_to_its_node() {
        let nodes = [
            0.0,
            1.0 / 6.0,
            4.0 / 15.0,
            2.0 / 3.0,
            5.0 / 6.0,
            1.0,
            1.0 / 15.0,
            1.0,
        ];
        for (row, node) in A.iter().zip(nodes) {
            assert!((row.iter().sum::<f64>() - node).abs() < 1e-14, "{row:?}");
        }
        for weights in [SIXTH_ORDER, FIFTH_ORDER] {
            for power in 0..5 {
                let moment: f64 = weights
                    .iter()
                    .zip(nodes)
                    .map(|(weight, node)| weight * node.powi(power))
                    .sum();
                assert!((moment * f64::from(power + 1) - 1.0).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn it_is_of_sixth_order() {
        let errors = [0.3, 0.15, 0.075].map(|step| (end(step)[0] - exact(3.0)).abs());
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((order - 6.0).abs() < 0.3, "{errors:?}: {order}");
        }
    }

    #[test]
    fn it_passes_every_stop_exactly_within_its_tolerance() {
        let mut run = Integration::new([1.0, 0.0, 0.0], [1e-12; 3], STEPS);
        for stop in [0.0, 0.1, 0.1, 1.7, 3.0] {
            run.advance_to(stop, &mut rotation).unwrap();
            assert_eq!(run.place, stop);
            assert!((run.state[0] - exact(stop)).abs() < 1e-11, "at {stop}");
        }
    }

    #[test]
    fn what_is_not_a_number_ends_in_steps_too_short() {
        let mut run = Integration::new([1.0], [1e-12], STEPS);
        let mut broken = |_: &[f64; 1]| Ok::<_, ()>([f64::NAN]);
        let obstacle = run.advance_to(1.0, &mut broken).unwrap_err();
        assert_eq!((obstacle, run.place), (Obstacle::TooShort, 0.0));
    }
}
