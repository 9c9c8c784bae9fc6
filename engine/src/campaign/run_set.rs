//! Which runs of a shard are finished: a bit for each.

use super::shards::Shard;

/// A set of runs of a shard.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunSet {
    shard: Shard,
    words: Vec<u64>,
    /// How many are in it.
    count: u64,
}

impl RunSet {
    /// The empty set.
    #[must_use]
    pub fn new(shard: Shard) -> Self {
        Self {
            shard,
            words: Vec::new(),
            count: 0,
        }
    }

    /// Adds a run by its index; whether it is of the shard, and was not in it.
    pub fn insert(&mut self, index: u64) -> bool {
        let Some((word, bit)) = self.place(index) else {
            return false;
        };
        if self.words.len() <= word {
            self.words.resize(word + 1, 0);
        }
        let is_new = self.words[word] & bit == 0;
        self.words[word] |= bit;
        self.count += u64::from(is_new);
        is_new
    }

    /// Whether it has a run.
    #[must_use]
    pub fn contains(&self, index: u64) -> bool {
        let place = self.place(index);
        place.is_some_and(|(word, bit)| self.words.get(word).is_some_and(|found| found & bit != 0))
    }

    /// How many runs it has.
    #[must_use]
    pub fn len(&self) -> u64 {
        self.count
    }

    /// Whether it has none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    fn place(&self, index: u64) -> Option<(usize, u64)> {
        let beyond = index.checked_sub(self.shard.number - 1)?;
        let place = (beyond % self.shard.count == 0).then_some(beyond / self.shard.count)?;
        Some((usize::try_from(place / 64).ok()?, 1 << (place % 64)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_has_what_was_added_of_its_shard() {
        let mut set = RunSet::new(Shard {
            number: 2,
            count: 3,
        });
        assert!(set.insert(1) && set.insert(400) && !set.insert(400));
        assert!(!set.insert(0) && !set.insert(2));
        let found: Vec<u64> = (0..999).filter(|index| set.contains(*index)).collect();
        assert_eq!((found, set.len()), (vec![1, 400], 2));
    }
}
