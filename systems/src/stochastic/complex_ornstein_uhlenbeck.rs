//! The complex Ornstein-Uhlenbeck process, of unit variance.
//!
//! ```text
//! Z' = (-alpha + i omega) Z + sqrt(2 alpha) (W1' + i W2'),   Z = X + i Y
//! E[X(t + tau) X(t)] =  e^(-alpha |tau|) cos(omega tau)
//! E[X(t + tau) Y(t)] = -e^(-alpha |tau|) sin(omega tau)
//! Z(t + h) = e^((-alpha + i omega) h) Z(t) + sqrt(1 - e^(-2 alpha h)) (xi_1 + i xi_2)      exactly
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | alpha, omega | decay, frequency | 1/s, rad/s |
//! | W1, W2 | independent Wiener processes | s^1/2 |
//! | xi_1, xi_2 | independent standard normal numbers | 1 |
//!
//! Source: the paper, sec. 3.5, eq. 4; Gardiner (1985), Handbook of Stochastic Methods, 4.4.

/// The process of one alpha and omega.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComplexOrnsteinUhlenbeck {
    /// alpha, 1/s, positive.
    pub decay_per_s: f64,
    /// omega, rad/s.
    pub frequency_rad_s: f64,
}

impl ComplexOrnsteinUhlenbeck {
    /// E[X(t + tau) X(t)] for a lag tau in s.
    #[must_use]
    pub fn autocorrelation(&self, lag_s: f64) -> f64 {
        libm::exp(-self.decay_per_s * lag_s.abs()) * libm::cos(self.frequency_rad_s * lag_s)
    }

    /// E[X(t + tau) Y(t)] for a lag tau in s.
    #[must_use]
    pub fn quadrature(&self, lag_s: f64) -> f64 {
        -libm::exp(-self.decay_per_s * lag_s.abs()) * libm::sin(self.frequency_rad_s * lag_s)
    }

    /// What carries the process over a time h in s.
    #[must_use]
    pub fn step(&self, step_s: f64) -> ExactStep {
        let decay = libm::exp(-self.decay_per_s * step_s);
        let (sine, cosine) = libm::sincos(self.frequency_rad_s * step_s);
        ExactStep {
            cosine: decay * cosine,
            sine: decay * sine,
            noise: (-libm::expm1(-2.0 * self.decay_per_s * step_s)).sqrt(),
        }
    }
}

/// The exact step over one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExactStep {
    /// e^(-alpha h) cos(omega h).
    pub cosine: f64,
    /// e^(-alpha h) sin(omega h).
    pub sine: f64,
    /// sqrt(1 - e^(-2 alpha h)).
    pub noise: f64,
}

impl ExactStep {
    /// Z at the end of the step, from Z = (X, Y) at its start and (xi_1, xi_2).
    #[inline]
    #[must_use]
    pub fn advance(&self, z: [f64; 2], xi: [f64; 2]) -> [f64; 2] {
        [
            self.cosine * z[0] - self.sine * z[1] + self.noise * xi[0],
            self.sine * z[0] + self.cosine * z[1] + self.noise * xi[1],
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two steps are one, and what the noise adds is what the decay has taken.
    #[test]
    fn steps_compose_and_keep_the_variance() {
        let process = ComplexOrnsteinUhlenbeck {
            decay_per_s: 0.05,
            frequency_rad_s: 0.2,
        };
        let (short, long) = (process.step(0.3), process.step(0.6));
        let twice = short.advance(short.advance([1.0, 0.0], [0.0; 2]), [0.0; 2]);
        assert!((twice[0] - long.cosine).abs() < 1e-15 && (twice[1] - long.sine).abs() < 1e-15);
        for step in [short, long, process.step(1e-9), process.step(1e9)] {
            let kept = step.cosine * step.cosine + step.sine * step.sine;
            assert!((kept + step.noise * step.noise - 1.0).abs() < 1e-15);
        }
        assert_eq!(long.cosine, process.autocorrelation(0.6));
        assert_eq!(long.sine, -process.quadrature(0.6));
    }
}
