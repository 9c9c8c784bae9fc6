//! How the runs of a Saltelli plan are laid out: of each base sample A, B, and for each factor one that is A with
//! that factor of B. Those of a base sample follow each other, so that the first runs of a campaign are whole base
//! samples.

use super::plan::{RUN_SEED, set_seed};
use super::specification::{CampaignSpec, Faults, MOST_RUNS};

/// The layout of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Saltelli {
    /// Number of fields that are drawn.
    pub drawn: usize,
    /// Whether chance is a factor too, after those that are drawn: the seed of the run's own draws.
    pub chance: bool,
}

impl Saltelli {
    /// Of a campaign: chance is a factor unless its seed is set, or is drawn itself.
    pub(super) fn of_campaign(specification: &CampaignSpec) -> Self {
        let vary = &specification.vary.0;
        let varies = vary.iter().any(|(path, _)| path == RUN_SEED);
        Self {
            drawn: vary.len(),
            chance: !varies && set_seed(specification).is_none(),
        }
    }

    /// Number of factors.
    #[must_use]
    pub fn factors(self) -> usize {
        self.drawn + usize::from(self.chance)
    }

    /// Runs of each base sample.
    #[must_use]
    pub fn runs_each(self) -> u64 {
        self.factors() as u64 + 2
    }

    /// Whether a factor of a run is that of B.
    pub(super) fn is_of_b(self, index: u64, factor: usize) -> bool {
        let block = index % self.runs_each();
        block == 1 || block == 2 + factor as u64
    }

    /// Whether a run is one of A or B, which are independent.
    #[must_use]
    pub fn is_independent(self, index: u64) -> bool {
        index % self.runs_each() < 2
    }

    /// The stream of a run's seed.
    pub(super) fn seed_stream(self, index: u64) -> u64 {
        let of_b = self.is_of_b(index, self.drawn);
        2 * (index / self.runs_each()) + u64::from(of_b)
    }

    /// The number of runs.
    pub(super) fn runs(self, specification: &CampaignSpec, faults: &mut Faults) -> Option<u64> {
        let each = self.runs_each();
        if self.factors() == 0 {
            faults.0.add("vary", "no field varies", "give one or more");
            return None;
        }
        let of_base_samples = specification.base_samples.map(|count| count * each);
        let runs = specification.runs.or(of_base_samples)?;
        let factors = self.factors();
        if runs % each != 0 || of_base_samples.is_some_and(|own| own != runs) {
            let message = format!(
                "`runs` is {runs}, and each base sample of {factors} factors has {each} runs"
            );
            faults.0.add("runs", message, "give `base_samples` instead");
            return None;
        }
        if runs > MOST_RUNS {
            let message = format!("{runs} runs are more than {MOST_RUNS}");
            faults.0.add("base_samples", message, "");
            return None;
        }
        Some(runs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_a_base_sample_differ_from_a_in_one_factor() {
        let layout = Saltelli {
            drawn: 2,
            chance: true,
        };
        let of_b = |index| [0, 1, 2].map(|factor| layout.is_of_b(index, factor));
        let expected = [
            [false; 3],
            [true; 3],
            [true, false, false],
            [false, true, false],
            [false, false, true],
        ];
        for (block, expected) in expected.into_iter().enumerate() {
            assert_eq!(of_b(5 + block as u64), expected);
        }
        let streams: Vec<u64> = (5..10).map(|index| layout.seed_stream(index)).collect();
        assert_eq!(streams, [2, 3, 2, 2, 3]);
    }
}
