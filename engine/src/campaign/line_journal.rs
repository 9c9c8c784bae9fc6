//! A journal of lines that outlives its process: it is held by one process, a line reaches the system before the next
//! run is taken up, and the disk at least once a second. What a kill leaves of a line is cut off; a line that is not
//! whole for another reason has a sum that does not fit ([`super::fingerprint`]).

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::CampaignError;
use super::manifest::Study;

/// Bytes that are read at once.
const BUFFER: usize = 1 << 18;
/// Wall time after which lines are handed to the disk.
const HOLD: Duration = Duration::from_secs(1);
/// Wall time for which a journal that is held is asked for again: [`is_held`] holds it for a moment.
const PATIENCE: Duration = Duration::from_millis(200);

/// What the journals of a campaign or a design search begin with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Heading {
    /// What it is of.
    pub study: Study,
    /// Fingerprint of that.
    pub fingerprint: String,
}

/// An open journal, held by this process alone.
pub struct LineJournal {
    path: PathBuf,
    file: File,
    synchronised: Instant,
}

impl Heading {
    fn line(&self) -> String {
        format!("aerobot {} {}\n", self.study.word(), self.fingerprint)
    }

    fn foreign(&self, path: &Path) -> CampaignError {
        let message = format!(
            "`{}` is not a journal of this {}",
            path.display(),
            self.study.word()
        );
        CampaignError::refused(message, "name another folder")
    }

    /// Hands every line of a journal to `take`, with its place in bytes and without its end; none if there is no file.
    /// Lines are read one at a time.
    ///
    /// # Errors
    /// The file cannot be read, or is of something else.
    pub fn scan(&self, path: &Path, take: &mut dyn FnMut(u64, &str)) -> Result<(), CampaignError> {
        match File::open(path) {
            Ok(file) => self.scan_file(path, &file, take).map(|_| ()),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
            Err(error) => Err(CampaignError::unreadable(path, &error)),
        }
    }

    /// Gives the bytes of the file that are lines with an end.
    fn scan_file(
        &self,
        path: &Path,
        file: &File,
        take: &mut dyn FnMut(u64, &str),
    ) -> Result<u64, CampaignError> {
        let mut reader = BufReader::with_capacity(BUFFER, file);
        let mut line = Vec::new();
        let mut next = |line: &mut Vec<u8>| {
            line.clear();
            let read = reader.read_until(b'\n', line);
            read.map_err(|error| CampaignError::unreadable(path, &error))
        };
        let heading = self.line();
        let mut place = next(&mut line)? as u64;
        if line != heading.as_bytes() {
            let is_torn = heading.as_bytes().starts_with(&line);
            return if is_torn {
                Ok(0)
            } else {
                Err(self.foreign(path))
            };
        }
        loop {
            let length = next(&mut line)?;
            let Some(whole) = line.strip_suffix(b"\n") else {
                return Ok(place);
            };
            if let Ok(text) = std::str::from_utf8(whole) {
                take(place, text);
            }
            place += length as u64;
        }
    }
}

impl LineJournal {
    /// Opens a journal to go on with it, or begins one; `take` gets the lines that it has.
    ///
    /// # Errors
    /// Another process is at it, it is of something else, or the file system refused something.
    pub fn open(
        heading: &Heading,
        path: &Path,
        take: &mut dyn FnMut(&str),
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
        let whole = heading.scan_file(path, &file, &mut |_, line| take(line))?;
        let begun = file
            .set_len(whole)
            .and_then(|()| file.seek(SeekFrom::Start(whole)))
            .and_then(|_| match whole {
                0 => file.write_all(heading.line().as_bytes()),
                _ => Ok(()),
            });
        begun.map_err(unwritten)?;
        Ok(Self {
            path: path.to_owned(),
            file,
            synchronised: Instant::now(),
        })
    }

    /// Adds a line, which has its end.
    ///
    /// # Errors
    /// What the file system refused; the lines before are kept.
    pub fn add(&mut self, line: &str) -> Result<(), CampaignError> {
        let mut written = self.file.write_all(line.as_bytes());
        if self.synchronised.elapsed() >= HOLD {
            written = written.and_then(|()| self.file.sync_data());
            self.synchronised = Instant::now();
        }
        written.map_err(|error| CampaignError::unwritten(&self.path, &error))
    }

    /// Hands everything to the disk.
    ///
    /// # Errors
    /// What the file system refused.
    pub fn synchronise(&self) -> Result<(), CampaignError> {
        let written = self.file.sync_all();
        written.map_err(|error| CampaignError::unwritten(&self.path, &error))
    }

    /// Hands everything to the disk and gives the journal another name.
    ///
    /// # Errors
    /// What the file system refused.
    pub fn finish(self, name: &Path) -> Result<(), CampaignError> {
        self.synchronise()?;
        let renamed = std::fs::rename(&self.path, name);
        renamed.map_err(|error| CampaignError::unwritten(name, &error))
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
