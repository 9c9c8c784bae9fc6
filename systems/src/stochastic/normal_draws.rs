//! Normal numbers, drawn the same on every machine.
//!
//! ```text
//! r = sqrt(-2 ln u),  a = 2 pi v:   (r cos a, r sin a) are two independent normal numbers
//! ```
//!
//! u in (0, 1] and v in [0, 1) are 53 bits each of a ChaCha8 generator whose key is the seed, and whose
//! stream is that of the purpose: streams do not overlap, so that one more of them changes no other.
//!
//! Source: Box and Muller (1958), Ann. Math. Stat. 29, 610-611; Bernstein (2008), ChaCha, a variant of
//! Salsa20.
//!
//! Assumptions: nothing beyond 8.6 standard deviations, which comes once in 1e17 draws.

use std::f64::consts::TAU;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// 2^-53.
const LAST_BIT: f64 = 1.0 / 9_007_199_254_740_992.0;

/// A source of normal numbers.
#[derive(Clone, Debug)]
pub struct NormalDraws(ChaCha8Rng);

impl NormalDraws {
    /// The numbers of a seed and a stream.
    #[must_use]
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        let mut generator = ChaCha8Rng::from_seed(key);
        generator.set_stream(stream);
        Self(generator)
    }

    /// Two independent standard normal numbers.
    pub fn pair(&mut self) -> [f64; 2] {
        let u = ((self.0.next_u64() >> 11) + 1) as f64 * LAST_BIT;
        let v = (self.0.next_u64() >> 11) as f64 * LAST_BIT;
        let radius = (-2.0 * libm::log(u)).sqrt();
        let (sine, cosine) = libm::sincos(TAU * v);
        [radius * cosine, radius * sine]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_those_of_the_normal_distribution() {
        let mut draws = NormalDraws::new(1, 2);
        let count = 100_000;
        let mut sums = [0.0; 4];
        let mut product = 0.0;
        for _ in 0..count {
            let pair = draws.pair();
            product += pair[0] * pair[1];
            for x in pair {
                for (power, sum) in (1..).zip(&mut sums) {
                    *sum += x.powi(power);
                }
            }
        }
        let n = f64::from(2 * count);
        // Four sigma: the variance of x^k is the 2k-th moment less the square of the k-th.
        for (k, (expected, variance)) in [(0.0, 1.0), (1.0, 2.0), (0.0, 15.0), (3.0, 96.0)]
            .iter()
            .enumerate()
        {
            let error = sums[k] / n - expected;
            assert!(error.abs() < 4.0 * (variance / n).sqrt(), "{k}: {error}");
        }
        assert!((product / f64::from(count)).abs() < 4.0 / f64::from(count).sqrt());
    }

    #[test]
    fn a_seed_and_a_stream_name_the_numbers() {
        let first = |seed, stream| NormalDraws::new(seed, stream).pair();
        assert_eq!(first(3, 4), first(3, 4));
        assert_ne!(first(3, 4), first(3, 5));
        assert_ne!(first(3, 4), first(4, 4));
    }
}
