//! A loop that is closed by a sampled law: the motion between samples under a held command, and the law from
//! sample to sample.
//!
//! ```text
//! x' = A x + b u, u held over T        x_k+1 = P x_k + g u_k       [P g; 0 1] = exp([A b; 0 0] T)
//! e_k = -C x_k                         s_k+1 = A_c s_k + B_c e_k       u_k = C_c s_k + D_c e_k
//! ```
//!
//! Broken at the command, the loop is L(z) = -H (z - F)^-1 G with the state (x, s) of both; it is stable closed
//! if no eigenvalue z of F + G H is outside the unit circle, lambda = ln(z)/T being what a mode in continuous
//! time would have (Franklin, Powell and Workman 1998, ch. 4 and 7). Margins are read off L(e^(i omega T)), 0 <
//! omega T <= pi.

use std::f64::consts::PI;

use nalgebra::{Complex, DMatrix, DVector};

use super::Matrix;

/// A law from sample to sample, linear: its matrices as in the head of this file.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearLaw {
    /// A_c.
    pub state: Matrix,
    /// B_c.
    pub by_error: Matrix,
    /// C_c, a row.
    pub command_by_state: Matrix,
    /// D_c, a row.
    pub command_by_error: Matrix,
}

/// A loop, broken at the command.
#[derive(Clone, Debug, PartialEq)]
pub struct SampledLoop {
    transition: Matrix,
    input: Matrix,
    output: Matrix,
    period_s: f64,
}

/// How far a loop is from instability; none where no change of that kind makes it unstable.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Margins {
    /// Largest factor of the gain, and the frequency at which the loop then oscillates, rad/s.
    pub gain_up: Option<(f64, f64)>,
    /// Smallest factor of the gain, and that frequency.
    pub gain_down: Option<(f64, f64)>,
    /// Smallest change of phase, rad, and the frequency at which the loop has the gain 1, rad/s.
    pub phase_rad: Option<(f64, f64)>,
    /// Smallest |1 + L|: the distance from -1.
    pub distance: f64,
}

impl SampledLoop {
    /// Of a motion with the matrix `a` and the command's column `b`, measured by the rows of `c`, and a law with a
    /// period in s.
    #[must_use]
    pub fn new(a: &Matrix, b: &Matrix, c: &Matrix, law: &LinearLaw, period_s: f64) -> Self {
        let (n, r) = (a.nrows(), law.state.nrows());
        let mut held = DMatrix::zeros(n + 1, n + 1);
        held.view_mut((0, 0), (n, n)).copy_from(&(a * period_s));
        held.view_mut((0, n), (n, 1)).copy_from(&(b * period_s));
        let held = held.exp();
        let mut transition = DMatrix::zeros(n + r, n + r);
        transition
            .view_mut((0, 0), (n, n))
            .copy_from(&held.view((0, 0), (n, n)));
        transition
            .view_mut((n, 0), (r, n))
            .copy_from(&(-&law.by_error * c));
        transition.view_mut((n, n), (r, r)).copy_from(&law.state);
        let mut input = DMatrix::zeros(n + r, 1);
        input
            .view_mut((0, 0), (n, 1))
            .copy_from(&held.view((0, n), (n, 1)));
        let mut output = DMatrix::zeros(1, n + r);
        output
            .view_mut((0, 0), (1, n))
            .copy_from(&(-&law.command_by_error * c));
        output
            .view_mut((0, n), (1, r))
            .copy_from(&law.command_by_state);
        Self {
            transition,
            input,
            output,
            period_s,
        }
    }

    /// The closed loop's lambda = ln(z)/T, 1/s, slowest first, of a pair that with the positive frequency; without
    /// what vanishes from one sample to the next.
    #[must_use]
    pub fn closed(&self) -> Vec<Complex<f64>> {
        let closed = &self.transition + &self.input * &self.output;
        let mut found: Vec<Complex<f64>> = closed
            .complex_eigenvalues()
            .iter()
            .filter(|z| z.norm_sqr() > 1e-20 && z.im >= 0.0)
            .map(|z| {
                let growth = 0.5 * libm::log(z.norm_sqr());
                Complex::new(growth, libm::atan2(z.im, z.re)) / self.period_s
            })
            .collect();
        found.sort_by(|a, b| a.norm_sqr().total_cmp(&b.norm_sqr()));
        found
    }

    /// Its margins.
    #[must_use]
    pub fn margins(&self) -> Margins {
        let response = Response::new(self);
        let lowest = 1e-5_f64;
        let angle = |k: usize| lowest * libm::pow(PI / lowest, k as f64 / POINTS as f64);
        let mut margins = Margins {
            distance: f64::INFINITY,
            ..Margins::default()
        };
        let mut before: Option<(f64, Complex<f64>)> = None;
        for k in 0..=POINTS {
            let theta = if k == POINTS { PI } else { angle(k) };
            let value = response.at(theta);
            margins.distance = margins.distance.min((value + 1.0).norm_sqr().sqrt());
            if let Some((last_theta, last)) = before {
                let gain = |value: Complex<f64>| value.norm_sqr() - 1.0;
                let across = |value: Complex<f64>| value.im;
                if gain(last) * gain(value) < 0.0 {
                    let (theta, found) = response.root(last_theta, theta, gain);
                    let phase_rad = libm::atan2(-found.im, -found.re).abs();
                    margins.add_phase(phase_rad, theta / self.period_s);
                }
                if across(last) * across(value) < 0.0 && last.re < 0.0 && k < POINTS {
                    let (theta, found) = response.root(last_theta, theta, across);
                    margins.add_gain(found.re, theta / self.period_s);
                }
            }
            before = Some((theta, value));
        }
        margins.add_gain(response.at(PI).re, PI / self.period_s);
        margins
    }
}

/// Points at which a response is looked at, evenly in the logarithm of the frequency.
const POINTS: usize = 3000;

impl Margins {
    fn add_phase(&mut self, phase_rad: f64, frequency: f64) {
        if self.phase_rad.is_none_or(|(least, _)| phase_rad < least) {
            self.phase_rad = Some((phase_rad, frequency));
        }
    }

    /// Of a loop that is real there.
    fn add_gain(&mut self, real: f64, frequency: f64) {
        if real >= 0.0 {
            return;
        }
        let factor = -1.0 / real;
        if factor > 1.0 {
            if self.gain_up.is_none_or(|(least, _)| factor < least) {
                self.gain_up = Some((factor, frequency));
            }
        } else if self.gain_down.is_none_or(|(most, _)| factor > most) {
            self.gain_down = Some((factor, frequency));
        }
    }
}

/// L on the unit circle, by a triangular form of the transition.
struct Response {
    triangle: DMatrix<Complex<f64>>,
    input: DVector<Complex<f64>>,
    output: DVector<Complex<f64>>,
}

impl Response {
    fn new(of: &SampledLoop) -> Self {
        let complex = |matrix: &Matrix| matrix.map(Complex::from);
        let (q, triangle) = complex(&of.transition).schur().unpack();
        let input = q.adjoint() * complex(&of.input);
        let output = complex(&of.output) * &q;
        Self {
            triangle,
            input: input.column(0).into_owned(),
            output: output.row(0).transpose(),
        }
    }

    /// L at e^(i theta).
    fn at(&self, theta: f64) -> Complex<f64> {
        let z = Complex::new(libm::cos(theta), libm::sin(theta));
        let n = self.input.len();
        let mut solved = self.input.clone();
        for row in (0..n).rev() {
            let mut sum = solved[row];
            for column in row + 1..n {
                sum += self.triangle[(row, column)] * solved[column];
            }
            solved[row] = sum / (z - self.triangle[(row, row)]);
        }
        -self.output.dot(&solved)
    }

    /// Where `f` of L changes its sign between two angles, and L there.
    fn root(
        &self,
        mut low: f64,
        mut high: f64,
        f: impl Fn(Complex<f64>) -> f64,
    ) -> (f64, Complex<f64>) {
        let sign = f(self.at(low));
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if f(self.at(middle)) * sign > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        (high, self.at(high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gain(value: f64) -> LinearLaw {
        LinearLaw {
            state: DMatrix::zeros(0, 0),
            by_error: DMatrix::zeros(0, 1),
            command_by_state: DMatrix::zeros(1, 0),
            command_by_error: DMatrix::from_element(1, 1, value),
        }
    }

    /// x' = u under u = -K x: z = 1 - K T, L = K T/(z - 1), whose gain is 1 where 2 sin(theta/2) = K T with the
    /// phase -90 deg - theta/2, and which is -K T/2 at z = -1.
    #[test]
    fn an_integrator_has_its_closed_form() {
        let one = DMatrix::from_element(1, 1, 1.0);
        let (k, t) = (0.8, 0.5);
        let found = SampledLoop::new(&DMatrix::zeros(1, 1), &one, &one, &gain(k), t);
        let closed = found.closed();
        assert!((closed[0].re - (1.0_f64 - k * t).ln() / t).abs() < 1e-12);
        let margins = found.margins();
        let (factor, frequency) = margins.gain_up.unwrap();
        assert!((factor - 2.0 / (k * t)).abs() < 1e-9 && (frequency - PI / t).abs() < 1e-9);
        let theta = 2.0 * (0.5 * k * t).asin();
        let (phase, at) = margins.phase_rad.unwrap();
        assert!((phase - (0.5 * PI - 0.5 * theta)).abs() < 1e-9, "{phase}");
        assert!((at - theta / t).abs() < 1e-9);
        assert_eq!(margins.gain_down, None);
    }

    /// An oscillator under a slow integrator: at the gain that the margin tells, an eigenvalue stands on the
    /// circle at the frequency that it tells.
    #[test]
    fn at_its_margin_a_loop_oscillates() {
        let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -1.0, -0.3]);
        let b = DMatrix::from_column_slice(2, 1, &[0.0, 1.0]);
        let c = DMatrix::from_row_slice(1, 2, &[1.0, 0.0]);
        let law = |factor: f64| LinearLaw {
            state: DMatrix::from_element(1, 1, 1.0),
            by_error: DMatrix::from_element(1, 1, 0.02),
            command_by_state: DMatrix::from_element(1, 1, factor),
            command_by_error: DMatrix::from_element(1, 1, 0.05 * factor),
        };
        let at = |factor: f64| SampledLoop::new(&a, &b, &c, &law(factor), 0.2);
        let (factor, frequency) = at(1.0).margins().gain_up.unwrap();
        assert!(at(1.0).closed().iter().all(|lambda| lambda.re < 0.0));
        let critical = at(factor).closed();
        let on_circle = critical.iter().find(|lambda| lambda.re.abs() < 1e-9);
        assert!((on_circle.unwrap().im - frequency).abs() < 1e-8);
        assert!(
            at(1.01 * factor)
                .closed()
                .iter()
                .any(|lambda| lambda.re > 0.0)
        );
    }
}
