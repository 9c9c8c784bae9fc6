//! Sampling in time: instruments and controllers that act at multiples of a period.

use bevy_ecs::component::Component;

/// Acts at the times k x period, k = 0, 1, 2, ...
///
/// The run never steps across such a time: every entity that carries a `Sampling` finds a step that
/// ends exactly there. An entity has one: what samples for a body (several instruments may) is an
/// entity of its own that names the body. Its system asks [`Sampling::is_due`] and then calls [`Sampling::done`].
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    period_s: f64,
    tick: u64,
}

impl Sampling {
    /// Sampling with a period in s (above zero), the first sample at time zero.
    #[must_use]
    pub fn every(period_s: f64) -> Self {
        Self { period_s, tick: 0 }
    }

    /// Time between samples, s.
    #[must_use]
    pub fn period_s(&self) -> f64 {
        self.period_s
    }

    /// The time of the next sample, s.
    #[must_use]
    pub fn next_s(&self) -> f64 {
        self.tick as f64 * self.period_s
    }

    /// Whether a sample is due at `time_s`.
    #[must_use]
    pub fn is_due(&self, time_s: f64) -> bool {
        time_s >= self.next_s()
    }

    /// Moves on to the sample after `time_s`.
    pub fn done(&mut self, time_s: f64) {
        while self.is_due(time_s) {
            self.tick += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_stand_at_exact_multiples() {
        let mut sampling = Sampling::every(0.1);
        for k in 0..1000 {
            let time = f64::from(k) * 0.1;
            assert!(sampling.is_due(time));
            sampling.done(time);
            assert!(!sampling.is_due(time));
        }
        assert_eq!(sampling.next_s(), 1000.0 * 0.1);
    }
}
