//! Hands the missing shards of a campaign to a scheduler, as arrays of jobs.
//!
//! A shard that is finished is left out, and so is one that has a job already or whose journal a process holds:
//! submitting again is always safe. Should two jobs of a shard come about all the same, as when a machine is only
//! thought dead, then the lock of its journal lets one of them work, and the other waits for it.

use std::collections::BTreeSet;
use std::path::Path;

use super::CampaignError;
use super::definition::Campaign;
use super::fingerprint::fingerprint;
use super::line_journal::is_held;

/// Name of the folder in that of the campaign for what jobs print.
pub const OUTPUT: &str = "slurm";
/// Seconds for which a job waits for another process at its shard: a file server may take so long to give up the
/// locks of a machine that has died.
pub const WAIT_S: u64 = 300;

/// What a job is given, in the scheduler's own words where they are text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Resources {
    /// The partition or queue; the scheduler's own choice if none.
    pub partition: Option<String>,
    /// Limit on the wall time of a shard.
    pub time: Option<String>,
    /// Memory of a shard.
    pub memory: Option<String>,
    /// Processors, and threads, of a shard.
    pub cpus: u32,
}

/// What all jobs of a campaign have in common.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Order {
    /// Name of the jobs, of letters, digits, `.`, `_` and `-`.
    pub name: String,
    /// What no other campaign has, nor the same one in another folder.
    pub tag: String,
    /// The program, an absolute path.
    pub program: String,
    /// The folder of the campaign, an absolute path.
    pub folder: String,
    /// What each job is given.
    pub resources: Resources,
}

/// Part of the shards as an array: shard `offset` + i has index i.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JobArray {
    /// What to add to an index for the number of its shard.
    pub offset: u64,
    /// The indices, from 1, in rising order.
    pub indices: Vec<u64>,
}

/// A command and what it reads.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Invocation {
    /// The program and its arguments.
    pub words: Vec<String>,
    /// Its standard input.
    pub input: String,
}

/// What starts shards on machines.
pub trait Scheduler {
    /// The largest index of an array; below 1 if there are no arrays.
    ///
    /// # Errors
    /// The scheduler does not answer, in its own words.
    fn largest_index(&self) -> Result<u64, CampaignError>;

    /// The shards that wait or run.
    ///
    /// # Errors
    /// The scheduler does not answer, in its own words.
    fn queued(&self, order: &Order) -> Result<BTreeSet<u64>, CampaignError>;

    /// How an array is submitted.
    fn invocation(&self, order: &Order, array: &JobArray) -> Invocation;

    /// Submits an array; gives the scheduler's name for it.
    ///
    /// # Errors
    /// The scheduler refuses, in its own words.
    fn submit(&self, order: &Order, array: &JobArray) -> Result<String, CampaignError>;
}

/// The shards of a campaign by what is to be done about them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Shares {
    /// How many are finished.
    pub finished: u64,
    /// Those that have a job.
    pub queued: Vec<u64>,
    /// Those without a job at which a process is.
    pub held: Vec<u64>,
    /// Those to submit.
    pub missing: Vec<u64>,
}

impl Order {
    /// For a campaign and the program to run it with.
    ///
    /// # Errors
    /// A path is not absolute and cannot be made so, or is not text.
    pub fn new(
        campaign: &Campaign,
        program: &Path,
        resources: Resources,
    ) -> Result<Self, CampaignError> {
        let text_of = |path: &Path| {
            let absolute = std::path::absolute(path);
            let absolute = absolute.map_err(|error| CampaignError::unreadable(path, &error))?;
            absolute.to_str().map(str::to_owned).ok_or_else(|| {
                let message = format!("the path `{}` is not Unicode", path.display());
                CampaignError::refused(message, "give it another name")
            })
        };
        let folder = &campaign.folder;
        let real = folder.canonicalize();
        let real = real.map_err(|error| CampaignError::unreadable(folder, &error))?;
        let place = fingerprint([real.as_os_str().as_encoded_bytes()]);
        let manifest = &campaign.manifest;
        let plain = |letter: char| {
            let is_plain = letter.is_ascii_alphanumeric() || "._-".contains(letter);
            if is_plain { letter } else { '-' }
        };
        let name: String = manifest.campaign.chars().map(plain).collect();
        Ok(Self {
            name: format!("aerobot-{name}"),
            tag: format!("aerobot:{}:{place:016x}", manifest.fingerprint),
            program: text_of(program)?,
            folder: text_of(folder)?,
            resources,
        })
    }
}

impl Shares {
    /// Of a campaign, some of whose shards are queued: ask the queue first, so that a shard that ends meanwhile is
    /// seen as finished.
    ///
    /// # Errors
    /// A journal cannot be read, or its file system has no locks.
    pub fn new(campaign: &Campaign, queued: &BTreeSet<u64>) -> Result<Self, CampaignError> {
        let mut shares = Self::default();
        for shard in campaign.shards() {
            if shard.finished_file(&campaign.folder).exists() {
                shares.finished += 1;
            } else if queued.contains(&shard.number) {
                shares.queued.push(shard.number);
            } else if is_held(&shard.part_file(&campaign.folder))? {
                shares.held.push(shard.number);
            } else {
                shares.missing.push(shard.number);
            }
        }
        Ok(shares)
    }
}

/// Shards as arrays whose indices are at most so large.
///
/// # Errors
/// The scheduler has no arrays.
pub fn arrays(shards: &[u64], largest_index: u64) -> Result<Vec<JobArray>, CampaignError> {
    if largest_index == 0 {
        let message = "the scheduler is set up without arrays of jobs";
        let help = "ask who runs it to allow them, or submit `aerobot campaign run DIR --shard K/N` for each";
        return Err(CampaignError::refused(message, help));
    }
    let offset_of = |shard: u64| (shard - 1) / largest_index * largest_index;
    let of_one = |shards: &[u64]| {
        let offset = shards.first().map_or(0, |first| offset_of(*first));
        JobArray {
            offset,
            indices: shards.iter().map(|shard| shard - offset).collect(),
        }
    };
    let same = |left: &u64, right: &u64| offset_of(*left) == offset_of(*right);
    Ok(shards.chunk_by(same).map(of_one).collect())
}

/// Rising numbers as ranges: `1-3,7`.
#[must_use]
pub fn ranges(numbers: &[u64]) -> String {
    let runs = numbers.chunk_by(|left, right| left + 1 == *right);
    let text_of = |run: &[u64]| match run {
        [first, .., last] => format!("{first}-{last}"),
        [one] => one.to_string(),
        [] => String::new(),
    };
    runs.map(text_of).collect::<Vec<_>>().join(",")
}

/// A word as a shell reads it.
#[must_use]
pub fn shell_word(word: &str) -> String {
    let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "%+,-./:=@_".contains(letter);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_and_arrays_name_every_shard_once() {
        assert_eq!(ranges(&[]), "");
        assert_eq!(ranges(&[1, 2, 3, 7]), "1-3,7");
        assert_eq!(ranges(&[2, 4, 5]), "2,4-5");
        let shards: Vec<u64> = (1..=25).filter(|shard| shard % 7 != 0).collect();
        for largest in [1, 4, 10, 24, 25, 1000] {
            let arrays = arrays(&shards, largest).unwrap();
            let again = arrays.iter().flat_map(|array| {
                assert!(
                    array
                        .indices
                        .iter()
                        .all(|index| (1..=largest).contains(index))
                );
                array.indices.iter().map(|index| index + array.offset)
            });
            assert_eq!(again.collect::<Vec<_>>(), shards);
        }
        assert_eq!(arrays(&shards, 1000).unwrap().len(), 1);
        assert_eq!(arrays(&[1, 11, 12], 10).unwrap()[1].indices, [1, 2]);
        assert!(arrays(&shards, 0).is_err());
    }

    /// A shell gives back what was quoted for it.
    #[test]
    fn shells_read_quoted_words_as_they_were() {
        for word in [
            "plain/path-1.2",
            "",
            "two words",
            "it's $HOME `ls` \"x\" \\ *",
            "'",
        ] {
            let script = format!("printf %s {}", shell_word(word));
            let output = std::process::Command::new("sh")
                .args(["-c", &script])
                .output();
            assert_eq!(output.unwrap().stdout, word.as_bytes(), "{script}");
        }
    }
}
