//! The journal of a shard: a line for each finished run, in the order in which they finish.
//!
//! A line reaches the system before the next run is taken up, and the disk at least once a second. What a kill
//! leaves of a line has no sum that fits; it is cut off and its run done again.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::CampaignError;
use super::definition::Campaign;
use super::record::{Record, RecordLine};

/// Bytes that are read at once.
const BUFFER: usize = 1 << 18;
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

fn foreign(path: &Path) -> CampaignError {
    let message = format!("`{}` is not a journal of this campaign", path.display());
    CampaignError::refused(message, "name another folder")
}

/// Hands every whole line of a journal to `take`, with its place in bytes; none if there is no file. Lines are
/// read one at a time.
///
/// # Errors
/// The file cannot be read, or is of another campaign.
pub fn scan(
    campaign: &Campaign,
    path: &Path,
    take: &mut dyn FnMut(u64, &RecordLine),
) -> Result<(), CampaignError> {
    match File::open(path) {
        Ok(file) => scan_file(campaign, path, &file, take).map(|_| ()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
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

/// The bytes of a file that are whole lines.
fn scan_file(
    campaign: &Campaign,
    path: &Path,
    file: &File,
    take: &mut dyn FnMut(u64, &RecordLine),
) -> Result<u64, CampaignError> {
    let mut reader = BufReader::with_capacity(BUFFER, file);
    let mut line = Vec::new();
    let mut next = |line: &mut Vec<u8>| {
        line.clear();
        let read = reader.read_until(b'\n', line);
        read.map_err(|error| CampaignError::unreadable(path, &error))
    };
    let header = header(campaign);
    let mut place = next(&mut line)? as u64;
    if line != header.as_bytes() {
        let is_torn = header.as_bytes().starts_with(&line);
        return if is_torn { Ok(0) } else { Err(foreign(path)) };
    }
    let counts = campaign.counts();
    loop {
        let length = next(&mut line)?;
        let Some(whole) = line.strip_suffix(b"\n") else {
            return Ok(place);
        };
        let text = std::str::from_utf8(whole).ok();
        if let Some(found) = text.and_then(|text| RecordLine::of_line(text, counts)) {
            take(place, &found);
        }
        place += length as u64;
    }
}

/// What a journal has of a run.
///
/// # Errors
/// As [`scan`].
pub fn find_record(
    campaign: &Campaign,
    path: &Path,
    index: u64,
) -> Result<Option<Record>, CampaignError> {
    let mut found = None;
    scan(campaign, path, &mut |_, line| {
        if line.index == index && found.is_none() {
            found = Some(line.record());
        }
    })?;
    Ok(found)
}

impl Journal {
    /// Opens a journal to go on with it, or begins one; `take` gets the lines that it has.
    ///
    /// # Errors
    /// Another process is at it, it is of another campaign, or the file system refused something.
    pub fn open(
        campaign: &Campaign,
        path: &Path,
        take: &mut dyn FnMut(&RecordLine),
    ) -> Result<Self, CampaignError> {
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
        let whole = scan_file(campaign, path, &file, &mut |_, line| take(line))?;
        let begun = file
            .set_len(whole)
            .and_then(|()| file.seek(SeekFrom::Start(whole)))
            .and_then(|_| match whole {
                0 => file.write_all(header(campaign).as_bytes()),
                _ => Ok(()),
            });
        begun.map_err(unwritten)?;
        Ok(Self {
            path: path.to_owned(),
            file,
            synchronised: Instant::now(),
        })
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
