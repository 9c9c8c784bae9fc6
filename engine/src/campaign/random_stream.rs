//! Random numbers that are the same on every machine: ChaCha with twelve rounds (RFC 8439 has twenty),
//! a key from the seed of the campaign and what the numbers are for, a stream for each run or field.

use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// What numbers are drawn for; streams of different purposes have nothing to do with each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// The varied fields of a run; its stream is the run's index.
    Inputs = 1,
    /// The seed of a run; its stream is the run's index.
    RunSeed = 2,
    /// Which run gets which stratum of a Latin hypercube; a stream for each field.
    Strata = 3,
    /// The shift of a Sobol sequence; a stream for each field.
    Shift = 4,
    /// Resamples of a bootstrap; a stream for each metric.
    Bootstrap = 5,
    /// Resamples of base samples, for intervals of Sobol indices; a stream for each metric.
    IndexBootstrap = 6,
    /// The order of runs in which a field has the same value; a stream for each field and metric.
    Ties = 7,
}

/// An endless stream of random numbers.
pub struct RandomStream(ChaCha12Rng);

impl RandomStream {
    /// The stream of a number for a purpose.
    #[must_use]
    pub fn new(seed: u64, purpose: Purpose, number: u64) -> Self {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        key[8] = purpose as u8;
        let mut generator = ChaCha12Rng::from_seed(key);
        generator.set_stream(number);
        Self(generator)
    }

    /// Any 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// A number above 0 and below 1, the middle of one of 2^52 equal parts.
    pub fn unit(&mut self) -> f64 {
        ((self.bits() >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
    }

    /// A whole number from 0 to `count` - 1, all alike to within `count` / 2^64.
    pub fn below(&mut self, count: u64) -> u64 {
        ((u128::from(self.bits()) * u128::from(count)) >> 64) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean 1/2 and variance 1/12 of many numbers, within four standard errors, and no end of the interval.
    #[test]
    fn units_are_uniform() {
        let mut stream = RandomStream::new(1, Purpose::Inputs, 0);
        let values: Vec<f64> = (0..40_000).map(|_| stream.unit()).collect();
        let mean = values.iter().sum::<f64>() / 4e4;
        let variance = values.iter().map(|u| (u - 0.5) * (u - 0.5)).sum::<f64>() / 4e4;
        assert!((mean - 0.5).abs() < 4.0 * libm::sqrt(1.0 / 12.0 / 4e4));
        // The fourth central moment is 1/80.
        let error = libm::sqrt((1.0 / 80.0 - 1.0 / 144.0) / 4e4);
        assert!((variance - 1.0 / 12.0).abs() < 4.0 * error);
        assert!(values.iter().all(|u| 0.0 < *u && *u < 1.0));
    }

    #[test]
    fn streams_differ_in_seed_purpose_and_number() {
        let first = |seed, purpose, number| RandomStream::new(seed, purpose, number).bits();
        let mut found = vec![
            first(1, Purpose::Inputs, 0),
            first(2, Purpose::Inputs, 0),
            first(1, Purpose::RunSeed, 0),
            first(1, Purpose::Inputs, 1),
        ];
        assert_eq!(found[0], first(1, Purpose::Inputs, 0));
        found.sort_unstable();
        found.dedup();
        assert_eq!(found.len(), 4);
        let mut counts = [0; 3];
        let mut stream = RandomStream::new(3, Purpose::Strata, 0);
        (0..3000).for_each(|_| counts[stream.below(3) as usize] += 1);
        assert!(counts.iter().all(|count| (900..1100).contains(count)));
    }
}
