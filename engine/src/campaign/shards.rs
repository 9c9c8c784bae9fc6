//! Shards: parts of a campaign that know nothing of each other, whatever starts them.
//!
//! Shard k of n, from 1, has the runs k - 1, k - 1 + n, and so on. Its journal is `shards/shard-0000k.part`
//! until it is finished, and then `.journal`. A scheduler has to start `aerobot campaign run DIR --shard K/N` for
//! each that is not finished, in any order and as often as it likes.

use std::path::{Path, PathBuf};

use super::CampaignError;
use super::definition::Campaign;
use super::journal::scan;
use super::record::Outcome;
use super::run_set::RunSet;

/// Name of the folder of journals.
pub const SHARDS: &str = "shards";

/// One of so many shards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Its number, from 1.
    pub number: u64,
    /// How many there are.
    pub count: u64,
}

/// How far a shard is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShardStatus {
    /// The shard.
    pub shard: Shard,
    /// Its number of runs.
    pub runs: u64,
    /// How many of them are finished.
    pub finished: u64,
    /// Whether all are, and its journal has its final name.
    pub is_finished: bool,
    /// How many of the finished runs did not get to their end.
    pub failed: u64,
}

/// The variables in which schedulers tell a job its place in an array, and what to add for a shard's number.
const VARIABLES: [(&str, u64); 4] = [
    ("SLURM_ARRAY_TASK_ID", 0),
    ("PBS_ARRAY_INDEX", 0),
    ("JOB_COMPLETION_INDEX", 1),
    ("AWS_BATCH_JOB_ARRAY_INDEX", 1),
];

/// What `auto` or `auto+M` adds to the index in an array.
fn offset_of(text: &str) -> Option<u64> {
    match text.strip_prefix("auto")? {
        "" => Some(0),
        more => more.strip_prefix('+')?.parse().ok(),
    }
}

impl Shard {
    /// Of `K/N`, or of `auto`: from the array variables of Slurm and PBS, whose indices have to be numbers of shards
    /// (`--array=1-N`, `-J 1-N`), and of Kubernetes and AWS Batch, which count from 0. `auto+M` adds M to that, for
    /// arrays that have to be shorter than the campaign. `variable` reads the environment; `count` is the number of
    /// shards that were planned.
    ///
    /// # Errors
    /// What is wrong with the text or the variables.
    pub fn of_text(
        text: &str,
        count: u64,
        variable: &dyn Fn(&str) -> Option<String>,
    ) -> Result<Self, CampaignError> {
        let refused = |message: String, help: &str| Err(CampaignError::refused(message, help));
        let shard = if let Some(offset) = offset_of(text) {
            let found = VARIABLES
                .iter()
                .find_map(|(name, add)| Some((name, add, variable(name)?)));
            let Some((name, add, value)) = found else {
                let names = VARIABLES.map(|(name, _)| format!("`{name}`")).join(", ");
                let message = format!("`--shard auto` finds none of {names}");
                return refused(message, "outside of an array of jobs: `--shard K/N`");
            };
            let Some(index) = value.trim().parse::<u64>().ok() else {
                return refused(format!("`{name}={value}` is not an index"), "");
            };
            let number = index.saturating_add(*add).saturating_add(offset);
            if number <= offset || number > count {
                let message =
                    format!("`--shard {text}` with `{name}={value}` is none of the {count} shards");
                let rest = count.saturating_sub(offset);
                let help = format!(
                    "an array of all of them: {}",
                    if *add == 0 {
                        format!("1-{rest}")
                    } else {
                        format!("0-{}", rest.saturating_sub(1))
                    }
                );
                return refused(message, &help);
            }
            Self { number, count }
        } else {
            let parts = text.split_once('/');
            let parts = parts.and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
            let Some((number, of)) = parts else {
                return refused(
                    format!("`--shard {text}`: expected `K/N`, `auto` or `auto+M`"),
                    "",
                );
            };
            if of != count {
                let message = format!("`--shard {text}`: the campaign has {count} shards");
                return refused(
                    message,
                    "`aerobot campaign plan` says into how many it is divided",
                );
            }
            Self { number, count: of }
        };
        if shard.number == 0 || shard.number > shard.count {
            let message = format!("`--shard {text}`: shards are numbered from 1 to {count}");
            return refused(message, "");
        }
        Ok(shard)
    }

    /// Its runs out of so many.
    pub fn indices(self, runs: u64) -> impl Iterator<Item = u64> {
        (self.number - 1..runs).step_by(usize::try_from(self.count).unwrap_or(usize::MAX))
    }

    /// Its journal while it is at work.
    #[must_use]
    pub fn part_file(self, folder: &Path) -> PathBuf {
        folder
            .join(SHARDS)
            .join(format!("shard-{:05}.part", self.number))
    }

    /// Its journal when it is finished.
    #[must_use]
    pub fn finished_file(self, folder: &Path) -> PathBuf {
        folder
            .join(SHARDS)
            .join(format!("shard-{:05}.journal", self.number))
    }

    /// Its journal, finished or not.
    #[must_use]
    pub fn file(self, folder: &Path) -> PathBuf {
        let finished = self.finished_file(folder);
        if finished.exists() {
            finished
        } else {
            self.part_file(folder)
        }
    }
}

impl Campaign {
    /// All shards.
    pub fn shards(&self) -> impl Iterator<Item = Shard> {
        let count = self.manifest.shards;
        (1..=count).map(move |number| Shard { number, count })
    }

    /// How far each shard is.
    ///
    /// # Errors
    /// A journal cannot be read.
    pub fn status(&self) -> Result<Vec<ShardStatus>, CampaignError> {
        let of_shard = |shard: Shard| {
            let (mut finished, mut failed) = (RunSet::new(shard), 0);
            scan(self, &shard.file(&self.folder), &mut |_, line| {
                if finished.insert(line.index) {
                    failed += u64::from(line.outcome != Outcome::Done);
                }
            })?;
            Ok(ShardStatus {
                shard,
                runs: shard.indices(self.plan.runs).count() as u64,
                finished: finished.len(),
                is_finished: shard.finished_file(&self.folder).exists(),
                failed,
            })
        };
        self.shards().map(of_shard).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str, variable: Option<(&str, &str)>) -> Result<u64, String> {
        let read = |name: &str| {
            variable
                .filter(|(own, _)| *own == name)
                .map(|v| v.1.to_owned())
        };
        let shard = Shard::of_text(text, 8, &read).map_err(|error| error.text)?;
        Ok(shard.number)
    }

    #[test]
    fn shards_come_from_arguments_and_from_arrays() {
        assert_eq!(of("3/8", None), Ok(3));
        assert_eq!(of("auto", Some(("SLURM_ARRAY_TASK_ID", "8"))), Ok(8));
        assert_eq!(of("auto", Some(("PBS_ARRAY_INDEX", "1"))), Ok(1));
        assert_eq!(of("auto", Some(("JOB_COMPLETION_INDEX", "0"))), Ok(1));
        assert_eq!(of("auto", Some(("AWS_BATCH_JOB_ARRAY_INDEX", "7"))), Ok(8));
        assert_eq!(of("auto+5", Some(("SLURM_ARRAY_TASK_ID", "3"))), Ok(8));
        assert_eq!(of("auto+5", Some(("JOB_COMPLETION_INDEX", "0"))), Ok(6));
        for (text, variable, words) in [
            ("auto", None, "finds none of"),
            (
                "auto+5",
                Some(("SLURM_ARRAY_TASK_ID", "4")),
                "none of the 8",
            ),
            (
                "auto+5",
                Some(("SLURM_ARRAY_TASK_ID", "0")),
                "none of the 8",
            ),
            (
                "auto-5",
                Some(("SLURM_ARRAY_TASK_ID", "7")),
                "expected `K/N`",
            ),
            ("auto", Some(("SLURM_ARRAY_TASK_ID", "0")), "1-8"),
            ("auto", Some(("JOB_COMPLETION_INDEX", "8")), "0-7"),
            ("auto", Some(("PBS_ARRAY_INDEX", "one")), "not an index"),
            ("9/8", None, "from 1 to 8"),
            ("0/8", None, "from 1 to 8"),
            ("1/7", None, "has 8 shards"),
            ("first", None, "expected `K/N`"),
        ] {
            assert!(of(text, variable).unwrap_err().contains(words), "{text}");
        }
    }

    #[test]
    fn shards_share_all_runs() {
        let all = (1..=3).flat_map(|number| Shard { number, count: 3 }.indices(8));
        let mut all: Vec<u64> = all.collect();
        assert_eq!(all[..3], [0, 3, 6]);
        all.sort_unstable();
        assert_eq!(all, (0..8).collect::<Vec<_>>());
    }
}
