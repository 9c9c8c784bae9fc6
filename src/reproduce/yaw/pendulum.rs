//! The multifilar pendulum: a body that turns about the vertical on inextensible massless tethers between
//! two level circles. In closed form, and independent of the simulation.
//!
//! ```text
//! h(psi)^2 = L^2 - a^2 - b^2 + 2 a b cos psi                            how far one circle is below the other
//! (I + m h'^2) psi'' + m h' h'' psi'^2 = m g h'                         Lagrange, T = I psi'^2/2 + m h'^2 psi'^2/2
//! omega^2 = m g a b/(h(0) I) for small angles
//! ```
//!
//! The number of tethers is not in it.

use std::f64::consts::{PI, TAU};

/// Steps of the quadrature of a quarter period; it converges exponentially.
const QUADRATURE: u32 = 64;

/// A body on a ring of tethers, released at the heading of rest with a rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MultifilarPendulum {
    /// Mass m of the body, kg.
    pub mass_kg: f64,
    /// Its moment of inertia I about the vertical, kg m^2.
    pub moment_kg_m2: f64,
    /// Radius a of the circle above, m.
    pub upper_radius_m: f64,
    /// Radius b of the circle below, m.
    pub lower_radius_m: f64,
    /// Length L of a tether, m.
    pub length_m: f64,
    /// Gravity g, m/s^2.
    pub gravity_m_s2: f64,
    /// Rate at the start, rad/s.
    pub rate_rad_s: f64,
}

impl MultifilarPendulum {
    fn radii_product_m2(&self) -> f64 {
        self.upper_radius_m * self.lower_radius_m
    }

    /// h, m.
    fn depth_m(&self, heading_rad: f64) -> f64 {
        let (a, b, l) = (self.upper_radius_m, self.lower_radius_m, self.length_m);
        (l * l - a * a - b * b + 2.0 * a * b * libm::cos(heading_rad)).sqrt()
    }

    /// dh/dpsi, m.
    fn slope_m(&self, heading_rad: f64) -> f64 {
        -self.radii_product_m2() * libm::sin(heading_rad) / self.depth_m(heading_rad)
    }

    /// Frequency of small angles, Hz.
    #[must_use]
    pub fn small_frequency_hz(&self) -> f64 {
        let stiffness =
            self.mass_kg * self.gravity_m_s2 * self.radii_product_m2() / self.depth_m(0.0);
        (stiffness / self.moment_kg_m2).sqrt() / TAU
    }

    /// How far it turns: where the rise has taken the energy of the start, rad; nothing if it turns over.
    #[must_use]
    pub fn amplitude_rad(&self) -> Option<f64> {
        let energy_j = 0.5 * self.moment_kg_m2 * self.rate_rad_s * self.rate_rad_s;
        let rise_m = energy_j / (self.mass_kg * self.gravity_m_s2);
        // h(0)^2 - h(psi)^2 = 2 a b (1 - cos psi) = 4 a b sin^2(psi/2)
        let squares_m2 = rise_m * (2.0 * self.depth_m(0.0) - rise_m);
        let half_sine = (squares_m2 / (4.0 * self.radii_product_m2())).sqrt();
        (half_sine <= 1.0).then(|| 2.0 * libm::asin(half_sine))
    }

    /// Frequency at the amplitude that it has, Hz; nothing if it turns over.
    ///
    /// The period is four times the integral of dpsi/psi' up to the amplitude A, with psi = A sin s.
    #[must_use]
    pub fn frequency_hz(&self) -> Option<f64> {
        let amplitude = self.amplitude_rad()?;
        let step = 0.5 * PI / f64::from(QUADRATURE);
        let quarter_s: f64 = (0..QUADRATURE)
            .map(|index| {
                let s = (f64::from(index) + 0.5) * step;
                let heading = amplitude * libm::sin(s);
                let slope = self.slope_m(heading);
                let inertia = self.moment_kg_m2 + self.mass_kg * slope * slope;
                // m g (h(psi) - h(A)) by the difference of squares and of cosines.
                let sines =
                    libm::sin(0.5 * (amplitude + heading)) * libm::sin(0.5 * (amplitude - heading));
                let fall_m = 4.0 * self.radii_product_m2() * sines
                    / (self.depth_m(heading) + self.depth_m(amplitude));
                let rate = (2.0 * self.mass_kg * self.gravity_m_s2 * fall_m / inertia).sqrt();
                amplitude * libm::cos(s) / rate * step
            })
            .sum();
        Some(0.25 / quarter_s)
    }

    /// Headings at the start and every `interval_s` after, `count` of them, rad; RK4.
    #[must_use]
    pub fn record_rad(&self, interval_s: f64, count: usize) -> Vec<f64> {
        const SUBSTEPS: u32 = 4;
        let step = interval_s / f64::from(SUBSTEPS);
        let mut state = [0.0, self.rate_rad_s];
        let mut record = Vec::with_capacity(count);
        while record.len() < count {
            record.push(state[0]);
            for _ in 0..SUBSTEPS {
                state = self.advanced(state, step);
            }
        }
        record
    }

    fn rates(&self, [heading, rate]: [f64; 2]) -> [f64; 2] {
        let slope = self.slope_m(heading);
        let curvature =
            -(self.radii_product_m2() * libm::cos(heading) + slope * slope) / self.depth_m(heading);
        let push = self.gravity_m_s2 - curvature * rate * rate;
        let inertia = self.moment_kg_m2 / self.mass_kg + slope * slope;
        [rate, slope * push / inertia]
    }

    fn advanced(&self, state: [f64; 2], step: f64) -> [f64; 2] {
        let moved = |by: [f64; 2], part: f64| {
            [
                state[0] + part * step * by[0],
                state[1] + part * step * by[1],
            ]
        };
        let first = self.rates(state);
        let second = self.rates(moved(first, 0.5));
        let third = self.rates(moved(second, 0.5));
        let fourth = self.rates(moved(third, 1.0));
        let sum = |i: usize| first[i] + 2.0 * (second[i] + third[i]) + fourth[i];
        moved([sum(0), sum(1)], 1.0 / 6.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pendulum(length_m: f64) -> MultifilarPendulum {
        MultifilarPendulum {
            mass_kg: 20.0,
            moment_kg_m2: 61.0,
            upper_radius_m: 1.0,
            lower_radius_m: 1.0,
            length_m,
            gravity_m_s2: 8.87,
            rate_rad_s: 0.1,
        }
    }

    /// A separate program integrated the pendulum with an adaptive method of order 8.
    #[test]
    fn frequency_and_amplitude_are_those_of_a_separate_program() {
        for (length_m, hz, degrees) in [
            (10.0, 0.08564679, 10.6394),
            (20.0, 0.06042883, 15.0685),
            (50.0, 0.03796588, 23.9306),
        ] {
            let pendulum = pendulum(length_m);
            let frequency = pendulum.frequency_hz().unwrap_or(f64::NAN);
            assert!((frequency - hz).abs() < 1e-8, "{frequency} {hz}");
            let amplitude = pendulum.amplitude_rad().unwrap_or(f64::NAN);
            assert!((amplitude.to_degrees() - degrees).abs() < 6e-5);
        }
    }

    #[test]
    fn a_small_swing_has_the_small_frequency() {
        let gentle = MultifilarPendulum {
            rate_rad_s: 1e-4,
            ..pendulum(10.0)
        };
        let ratio = gentle.frequency_hz().unwrap_or(f64::NAN) / gentle.small_frequency_hz();
        assert!((ratio - 1.0).abs() < 1e-7, "{ratio}");
        let fast = MultifilarPendulum {
            rate_rad_s: 1.2,
            ..gentle
        };
        assert_eq!((fast.amplitude_rad(), fast.frequency_hz()), (None, None));
    }

    /// The integral of the period and the integration of the motion know nothing of each other.
    #[test]
    fn the_record_comes_back_after_a_period() {
        let pendulum = pendulum(50.0);
        let period_s = 1.0 / pendulum.frequency_hz().unwrap_or(f64::NAN);
        let record = pendulum.record_rad(period_s / 400.0, 401);
        let amplitude = pendulum.amplitude_rad().unwrap_or(f64::NAN);
        assert!(record[400].abs() < 1e-9, "{}", record[400]);
        assert!((record[100] - amplitude).abs() < 1e-9);
        assert!((record[300] + amplitude).abs() < 1e-9);
    }
}
