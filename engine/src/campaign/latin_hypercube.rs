//! Latin hypercubes: each field is cut into as many equal parts as there are runs, and each run gets one.

use super::random_stream::{Purpose, RandomStream};

/// Which part of a field each run gets: a permutation from the seed, the field and the number of runs.
#[must_use]
pub fn strata(seed: u64, field: usize, runs: u32) -> Vec<u32> {
    let mut stream = RandomStream::new(seed, Purpose::Strata, field as u64);
    let mut order: Vec<u32> = (0..runs).collect();
    for last in (1..order.len()).rev() {
        order.swap(last, stream.below(last as u64 + 1) as usize);
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_is_taken_once_and_fields_differ() {
        let (first, second) = (strata(4, 0, 100), strata(4, 1, 100));
        assert_ne!(first, second);
        for mut order in [first, second] {
            order.sort_unstable();
            assert!(order.iter().enumerate().all(|(k, part)| k as u32 == *part));
        }
    }

    /// All six orders of three come equally often, to four standard errors.
    #[test]
    fn all_orders_are_alike() {
        let mut counts = std::collections::BTreeMap::new();
        for seed in 0..6000 {
            *counts.entry(strata(seed, 0, 3)).or_insert(0) += 1;
        }
        assert_eq!(counts.len(), 6);
        assert!(counts.values().all(|count| (885..1115).contains(count)));
    }
}
