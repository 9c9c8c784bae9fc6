//! The journal of a shard: a line for each finished run, in the order in which they finish.
//!
//! A line reaches the system before the next run is taken up, and the disk at least once a second. What a kill
//! leaves of a line has no sum that fits; it is cut off and its run done again.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::CampaignError;
use super::definition::Campaign;
use super::record::Record;

/// Wall time after which lines are handed to the disk.
const HOLD: Duration = Duration::from_secs(1);
/// Wall time for which a journal that is held is asked for again: [`is_held`] holds it for a moment.
const PATIENCE: Duration = Duration::from_millis(200);

/// An open journal, held by this process alone.
pub struct Journal {
    path: PathBuf,
    file: File,
    synchronised: Instant,
}

fn header(campaign: &Campaign) -> String {
    format!("aerobot campaign {}\n", campaign.manifest.fingerprint)
}

/// The records in a text, and the bytes of it that are whole lines.
fn parse(campaign: &Campaign, text: &[u8]) -> Option<(BTreeMap<u64, Record>, usize)> {
    let header = header(campaign);
    if header.as_bytes().starts_with(text) && text.len() < header.len() {
        return Some((BTreeMap::new(), 0));
    }
    let lines = text.strip_prefix(header.as_bytes())?;
    let whole = lines
        .iter()
        .rposition(|byte| *byte == b'\n')
        .map_or(0, |end| end + 1);
    let specification = &campaign.specification;
    let (metrics, envelopes) = (
        specification.metrics.0.len(),
        specification.envelopes.0.len(),
    );
    let mut records = BTreeMap::new();
    for line in lines[..whole].split(|byte| *byte == b'\n') {
        let line = std::str::from_utf8(line).ok();
        if let Some(record) = line.and_then(|line| Record::of_line(line, metrics, envelopes)) {
            records.entry(record.index).or_insert(record);
        }
    }
    Some((records, header.len() + whole))
}

fn foreign(path: &Path) -> CampaignError {
    let message = format!("`{}` is not a journal of this campaign", path.display());
    CampaignError::refused(message, "name another folder")
}

/// The records of a journal by index, none if there is no file.
///
/// # Errors
/// The file cannot be read, or is of another campaign.
pub fn read_journal(
    campaign: &Campaign,
    path: &Path,
) -> Result<BTreeMap<u64, Record>, CampaignError> {
    match std::fs::read(path) {
        Ok(text) => {
            let found = parse(campaign, &text).ok_or_else(|| foreign(path))?;
            Ok(found.0)
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(BTreeMap::new()),
        Err(error) => Err(CampaignError::unreadable(path, &error)),
    }
}

/// Whether a process is at work on a journal: on this machine, or on any with which the file system shares its
/// locks.
///
/// # Errors
/// The file cannot be read, or its file system has no locks.
pub fn is_held(path: &Path) -> Result<bool, CampaignError> {
    let tried = match File::open(path) {
        Ok(file) => file.try_lock_shared(),
        Err(error) => Err(TryLockError::Error(error)),
    };
    match tried {
        Ok(()) => Ok(false),
        Err(TryLockError::WouldBlock) => Ok(true),
        Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(TryLockError::Error(error)) => Err(CampaignError::unreadable(path, &error)),
    }
}

/// Waits until no process is at work on a journal, at most so long.
///
/// # Errors
/// As [`is_held`].
pub fn wait_for(path: &Path, longest: Duration) -> Result<(), CampaignError> {
    let begun = Instant::now();
    while begun.elapsed() < longest && is_held(path)? {
        std::thread::sleep(HOLD);
    }
    Ok(())
}

/// Locks a file for this process alone.
fn lock(file: &File) -> Result<(), TryLockError> {
    let begun = Instant::now();
    loop {
        match file.try_lock() {
            Err(TryLockError::WouldBlock) if begun.elapsed() < PATIENCE => {
                std::thread::sleep(PATIENCE / 10);
            }
            other => return other,
        }
    }
}

impl Journal {
    /// Opens a journal to go on with it, or begins one; gives the records that it has.
    ///
    /// # Errors
    /// Another process is at it, it is of another campaign, or the file system refused something.
    pub fn open(
        campaign: &Campaign,
        path: &Path,
    ) -> Result<(Self, BTreeMap<u64, Record>), CampaignError> {
        let unwritten = |error: io::Error| CampaignError::unwritten(path, &error);
        let mut options = OpenOptions::new();
        options.read(true).write(true).create(true).truncate(false);
        let mut file = options.open(path).map_err(unwritten)?;
        match lock(&file) {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let message = format!("another process is at work on `{}`", path.display());
                let help = "wait for it, or end it; more than one thread is `--workers N`";
                return Err(CampaignError::refused(message, help));
            }
            Err(TryLockError::Error(error)) => return Err(unwritten(error)),
        }
        let mut text = Vec::new();
        file.read_to_end(&mut text).map_err(unwritten)?;
        let (records, whole) = parse(campaign, &text).ok_or_else(|| foreign(path))?;
        let begun = file
            .set_len(whole as u64)
            .and_then(|()| file.seek(SeekFrom::Start(whole as u64)))
            .and_then(|_| match whole {
                0 => file.write_all(header(campaign).as_bytes()),
                _ => Ok(()),
            });
        begun.map_err(unwritten)?;
        let journal = Self {
            path: path.to_owned(),
            file,
            synchronised: Instant::now(),
        };
        Ok((journal, records))
    }

    /// Adds a run.
    ///
    /// # Errors
    /// What the file system refused; the runs before are kept.
    pub fn add(&mut self, record: &Record) -> Result<(), CampaignError> {
        let mut written = self.file.write_all(record.to_line().as_bytes());
        if self.synchronised.elapsed() >= HOLD {
            written = written.and_then(|()| self.file.sync_data());
            self.synchronised = Instant::now();
        }
        written.map_err(|error| CampaignError::unwritten(&self.path, &error))
    }

    /// Hands everything to the disk and gives the journal another name.
    ///
    /// # Errors
    /// What the file system refused.
    pub fn finish(self, name: &Path) -> Result<(), CampaignError> {
        let renamed = self
            .file
            .sync_all()
            .and_then(|()| std::fs::rename(&self.path, name));
        renamed.map_err(|error| CampaignError::unwritten(name, &error))
    }
}
