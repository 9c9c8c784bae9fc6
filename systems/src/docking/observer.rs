//! How a drone sees a port: measurements that are noisy and late, and a third-order observer of the port's motion.
//!
//! ```text
//! p(k+1) = p + v h + 1/2 a h^2 + (1 - b^3) e
//! v(k+1) = v + a h + 3/2 (1 - b)^2 (1 + b) e / h
//! a(k+1) = a + (1 - b)^3 e / h^2,      b = e^(-L h)
//! ```
//!
//! e measured place of the port less the one predicted, h time between measurements (s), L the three poles (rad/s):
//! the error of the observer falls as b^k, all three poles at b (the fading-memory filter; Morrison 1969,
//! Introduction to Sequential Smoothing and Prediction, ch. 13). A measurement is the place of the port against the
//! drone with a normal error on each axis; the drone adds its own place at that instant, which it knows. What is known
//! of the port is carried on by the delay with constant acceleration.
//!
//! Assumptions: direction of the port's axis without error, but late too; nothing hides the port within its range.

use std::collections::VecDeque;

use aerobot_components::docking::Navigation;
use bevy_ecs::component::Component;
use glam::DVec3;

use super::ports::PortMotion;
use crate::stochastic::normal_draws::NormalDraws;

/// Above the streams of random numbers that anything else names.
const FIRST_STREAM: u64 = 1 << 40;
/// The port is known once this many time constants of the observer have passed.
const SETTLED: f64 = 3.0;
/// However far away the port is, the poles are at least this part of what they are nearby.
const LEAST_POLES: f64 = 0.2;

/// What is known of the port now.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PortEstimate {
    /// Where it is and how it moves.
    pub motion: PortMotion,
    /// Its acceleration, m/s^2.
    pub acceleration_m_s2: DVec3,
}

/// A measurement that has not arrived.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Measurement {
    position_m: DVec3,
    axis: DVec3,
}

/// The sensor and the observer of one drone.
#[derive(Component, Clone, Debug)]
pub struct PortObserver {
    navigation: Navigation,
    draws: NormalDraws,
    /// Those on their way, the latest at the back; nothing where the port was out of range.
    on_their_way: VecDeque<Option<Measurement>>,
    known: Option<PortEstimate>,
    settled: f64,
    ticks: u64,
}

impl PortObserver {
    /// With the random numbers of a seed; `place` names their stream where the navigation does not.
    #[must_use]
    pub fn new(navigation: Navigation, seed: u64, place: u32) -> Self {
        let stream = match navigation {
            Navigation::Perfect => place,
            Navigation::Measured { stream, .. } => stream.unwrap_or(place),
        };
        Self {
            navigation,
            draws: NormalDraws::new(seed, FIRST_STREAM + u64::from(stream)),
            on_their_way: VecDeque::new(),
            known: None,
            settled: 0.0,
            ticks: 0,
        }
    }

    /// Looks at the port at `time_s`, from a port of one's own; says what is known of it by then, if that is enough.
    /// `acceleration_m_s2` is known to perfect navigation alone.
    pub fn look(
        &mut self,
        time_s: f64,
        own: &PortMotion,
        port: &PortMotion,
        acceleration_m_s2: DVec3,
    ) -> Option<PortEstimate> {
        let Navigation::Measured {
            period_s,
            delay_s,
            range_m,
            ..
        } = self.navigation
        else {
            return Some(PortEstimate {
                motion: *port,
                acceleration_m_s2,
            });
        };
        if time_s >= self.ticks as f64 * period_s {
            while time_s >= self.ticks as f64 * period_s {
                self.ticks += 1;
            }
            let distance_m = own.position_m.distance(port.position_m);
            let measured = (distance_m <= range_m).then(|| self.measure(distance_m, port));
            self.on_their_way.push_back(measured);
            let delayed = (delay_s / period_s).round() as usize;
            if self.on_their_way.len() > delayed
                && let Some(arrived) = self.on_their_way.pop_front()
            {
                self.take(arrived, own, period_s);
            }
        }
        let since_s = time_s - (self.ticks as f64 - 1.0) * period_s + delay_s;
        let known = self.known.as_ref()?;
        (self.settled >= SETTLED).then(|| known.after(since_s))
    }

    fn measure(&mut self, distance_m: f64, port: &PortMotion) -> Measurement {
        let mut error = DVec3::ZERO;
        if let Navigation::Measured {
            noise_m_per_m,
            least_noise_m,
            most_noise_m,
            ..
        } = self.navigation
        {
            let ([x, y], [z, _]) = (self.draws.pair(), self.draws.pair());
            let deviation_m = (noise_m_per_m * distance_m).clamp(least_noise_m, most_noise_m);
            error = deviation_m * DVec3::new(x, y, z);
        }
        Measurement {
            position_m: port.position_m + error,
            axis: port.axis,
        }
    }

    /// Takes what has arrived into what is known.
    fn take(&mut self, arrived: Option<Measurement>, own: &PortMotion, period_s: f64) {
        let Some(measured) = arrived else {
            // What is out of sight is as good as unknown.
            self.known = None;
            self.settled = 0.0;
            return;
        };
        let Some(known) = &mut self.known else {
            self.known = Some(PortEstimate {
                motion: PortMotion {
                    position_m: measured.position_m,
                    velocity_m_s: own.velocity_m_s,
                    axis: measured.axis,
                },
                acceleration_m_s2: DVec3::ZERO,
            });
            return;
        };
        let distance_m = own.position_m.distance(measured.position_m);
        let poles_rad_s = match self.navigation {
            Navigation::Perfect => 0.0,
            Navigation::Measured {
                observer_rad_s,
                observer_near_m,
                ..
            } => observer_rad_s * (observer_near_m / distance_m).clamp(LEAST_POLES, 1.0),
        };
        *known = known.after(period_s);
        let fading = libm::exp(-poles_rad_s * period_s);
        let rest = 1.0 - fading;
        let error = measured.position_m - known.motion.position_m;
        known.motion.position_m += (1.0 - fading * fading * fading) * error;
        known.motion.velocity_m_s += (1.5 * rest * rest * (1.0 + fading) / period_s) * error;
        known.acceleration_m_s2 += (rest * rest * rest / (period_s * period_s)) * error;
        known.motion.axis = measured.axis;
        self.settled += poles_rad_s * period_s;
    }
}

impl PortEstimate {
    /// After a time (s) of constant acceleration.
    fn after(&self, time_s: f64) -> Self {
        let mut later = *self;
        later.motion.position_m +=
            time_s * self.motion.velocity_m_s + 0.5 * time_s * time_s * self.acceleration_m_s2;
        later.motion.velocity_m_s += time_s * self.acceleration_m_s2;
        later
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(noise: f64, delay_s: f64) -> Navigation {
        Navigation::Measured {
            period_s: 0.05,
            delay_s,
            noise_m_per_m: 0.0,
            least_noise_m: noise,
            most_noise_m: noise,
            range_m: 1000.0,
            observer_rad_s: 3.0,
            observer_near_m: 100.0,
            stream: None,
        }
    }

    fn port(at: impl Fn(f64) -> DVec3, time_s: f64) -> PortMotion {
        PortMotion {
            position_m: at(time_s),
            velocity_m_s: DVec3::ZERO,
            axis: DVec3::NEG_X,
        }
    }

    fn fly(
        navigation: Navigation,
        at: impl Fn(f64) -> DVec3 + Copy,
        ticks: u32,
    ) -> Vec<(f64, PortEstimate)> {
        let mut observer = PortObserver::new(navigation, 7, 0);
        let mut seen = Vec::new();
        for tick in 0..ticks {
            let time_s = f64::from(tick) * 0.05;
            let known = observer.look(
                time_s,
                &PortMotion::default(),
                &port(at, time_s),
                DVec3::ZERO,
            );
            seen.extend(known.map(|known| (time_s, known)));
        }
        seen
    }

    /// A third-order observer follows constant acceleration without error, however late it hears of it.
    #[test]
    fn constant_acceleration_is_followed_without_error() {
        let at = |t: f64| DVec3::new(10.0 + 2.0 * t + 0.05 * t * t, 3.0 * t, -0.1 * t * t);
        let seen = fly(measured(0.0, 0.1), at, 400);
        let (time_s, last) = seen.last().copied().unwrap_or_default();
        let velocity = DVec3::new(2.0 + 0.1 * time_s, 3.0, -0.2 * time_s);
        assert!((last.motion.position_m - at(time_s)).length() < 1e-9);
        assert!((last.motion.velocity_m_s - velocity).length() < 1e-9);
        assert!((last.acceleration_m_s2 - DVec3::new(0.1, 0.0, -0.2)).length() < 1e-9);
    }

    /// The error of a step falls as a polynomial of second degree times b^k: the ratio of third differences of
    /// e / b^k is nothing.
    #[test]
    fn all_three_poles_are_where_they_should_be() {
        let mut observer = PortObserver::new(measured(0.0, 0.0), 7, 0);
        let own = PortMotion::default();
        let errors: Vec<f64> = (0..40)
            .map(|tick| {
                let x = if tick == 0 { 0.0 } else { 1.0 };
                let at = port(|_| DVec3::X * x, 0.0);
                observer.look(f64::from(tick) * 0.05, &own, &at, DVec3::ZERO);
                let known = observer.known.unwrap_or_default();
                1.0 - known.motion.position_m.x
            })
            .skip(1)
            .collect();
        let fading = (-3.0_f64 * 0.05).exp();
        let scaled: Vec<f64> = errors
            .iter()
            .zip(0..)
            .map(|(e, k)| e / fading.powi(k))
            .collect();
        for window in scaled.windows(4) {
            let third = window[3] - 3.0 * window[2] + 3.0 * window[1] - window[0];
            assert!(third.abs() < 1e-9, "{third}");
        }
    }

    /// The observer is a least-squares fit of a parabola to the past in which a measurement that is k ticks old counts
    /// b^k: weights w_k = b^k (c_0 + c_1 k + c_2 k^2) with sum w = 1, sum k w = 0, sum k^2 w = 0. In white noise the
    /// mean square of its place is sum w^2 times that of the noise.
    #[test]
    fn noise_is_smoothed_as_much_as_it_should_be() {
        let seen = fly(measured(0.2, 0.0), |_| DVec3::ZERO, 40_000);
        let later = &seen[1000..];
        let squares: f64 = later
            .iter()
            .map(|(_, known)| known.motion.position_m.length_squared())
            .sum();
        let found = squares / (3.0 * later.len() as f64);
        let fading = (-3.0_f64 * 0.05).exp();
        let powers = |k: i32| DVec3::new(1.0, f64::from(k), f64::from(k * k));
        let mut sums = glam::DMat3::ZERO;
        for k in 0..1000 {
            let p = powers(k);
            sums += fading.powi(k) * glam::DMat3::from_cols(p * p.x, p * p.y, p * p.z);
        }
        let c = sums.inverse() * DVec3::X;
        let weights = (0..1000).map(|k| fading.powi(k) * c.dot(powers(k)));
        let expected = 0.04 * weights.map(|w| w * w).sum::<f64>();
        assert!((found / expected - 1.0).abs() < 0.05, "{found} {expected}");
    }

    #[test]
    fn what_is_out_of_range_is_not_seen() {
        let far = |t: f64| DVec3::new(900.0 + 10.0 * t, 0.0, 0.0);
        let seen = fly(measured(0.1, 0.05), far, 400);
        let last_s = seen.last().map_or(0.0, |(time_s, _)| *time_s);
        assert!(last_s > 9.9 && last_s < 10.2, "{last_s}");
    }
}
