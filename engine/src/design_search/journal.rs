//! The journal of a search: a line for each finished run of a design, in the order in which they finish.
//!
//! As that of a campaign's shard: a line reaches the system before the next run is taken up, and the disk at least once
//! a second; what a kill leaves of a line has no sum that fits.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use super::definition::DesignSearch;
use crate::campaign::CampaignError;
use crate::campaign::record::{Record, RecordLine, fingerprint};

/// Name of the journal.
pub const JOURNAL: &str = "runs.journal";
/// Wall time after which lines are handed to the disk.
const HOLD: Duration = Duration::from_secs(1);

/// Records by the key of their design and their index.
pub type RunRecords = BTreeMap<(String, u64), Record>;

/// An open journal, held by this process alone.
pub struct SearchJournal {
    path: PathBuf,
    file: File,
    synchronised: Instant,
}

fn header(search: &DesignSearch) -> String {
    format!(
        "aerobot design search {}\n",
        search.runs.manifest.fingerprint
    )
}

/// The line of a run: its design, its record, and a sum over both.
fn line(key: &str, record: &Record) -> String {
    let record = record.to_line();
    let content = format!("{key}\t{}", record.trim_end_matches('\n'));
    format!("{content}\t{:016x}\n", fingerprint([content.as_bytes()]))
}

fn of_line(line: &str, metrics: usize) -> Option<(String, Record)> {
    let (content, sum) = line.rsplit_once('\t')?;
    if sum != format!("{:016x}", fingerprint([content.as_bytes()])) {
        return None;
    }
    let (key, record) = content.split_once('\t')?;
    let record = RecordLine::of_line(record, (metrics, 0))?;
    Some((key.to_owned(), record.record()))
}

/// The records in a text, and the bytes of it that are whole lines.
fn parse(search: &DesignSearch, text: &[u8]) -> Option<(RunRecords, usize)> {
    let header = header(search);
    if header.as_bytes().starts_with(text) && text.len() < header.len() {
        return Some((RunRecords::new(), 0));
    }
    let lines = text.strip_prefix(header.as_bytes())?;
    let end = lines.iter().rposition(|byte| *byte == b'\n');
    let whole = end.map_or(0, |end| end + 1);
    let metrics = search.specification.metrics.0.len();
    let mut records = RunRecords::new();
    for line in lines[..whole].split(|byte| *byte == b'\n') {
        let line = std::str::from_utf8(line).ok();
        if let Some((key, record)) = line.and_then(|line| of_line(line, metrics)) {
            records.entry((key, record.index)).or_insert(record);
        }
    }
    Some((records, header.len() + whole))
}

impl SearchJournal {
    /// Opens the journal of a search to go on with it, or begins one; gives the records that it has.
    ///
    /// # Errors
    /// Another process is at it, it is of another search, or the file system refused something.
    pub fn open(search: &DesignSearch) -> Result<(Self, RunRecords), CampaignError> {
        let path = search.folder.join(JOURNAL);
        let unwritten = |error: io::Error| CampaignError::unwritten(&path, &error);
        let mut options = OpenOptions::new();
        options.read(true).write(true).create(true).truncate(false);
        let mut file = options.open(&path).map_err(unwritten)?;
        match file.try_lock() {
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
        let Some((records, whole)) = parse(search, &text) else {
            let message = format!("`{}` is not the journal of this search", path.display());
            return Err(CampaignError::refused(message, "name another folder"));
        };
        let begun = file
            .set_len(whole as u64)
            .and_then(|()| file.seek(SeekFrom::Start(whole as u64)))
            .and_then(|_| match whole {
                0 => file.write_all(header(search).as_bytes()),
                _ => Ok(()),
            });
        begun.map_err(unwritten)?;
        let journal = Self {
            path,
            file,
            synchronised: Instant::now(),
        };
        Ok((journal, records))
    }

    /// Adds a run of the design of a key.
    ///
    /// # Errors
    /// What the file system refused; the runs before are kept.
    pub fn add(&mut self, key: &str, record: &Record) -> Result<(), CampaignError> {
        let mut written = self.file.write_all(line(key, record).as_bytes());
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
    pub fn finish(&mut self) -> Result<(), CampaignError> {
        let written = self.file.sync_all();
        written.map_err(|error| CampaignError::unwritten(&self.path, &error))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::record::Outcome;

    #[test]
    fn lines_read_back_and_torn_ones_do_not() {
        let record = Record {
            index: 3,
            outcome: Outcome::Done,
            reason: String::new(),
            simulated_s: 1.5,
            metrics: vec![Some(0.1 + 0.2)],
            envelopes: Vec::new(),
        };
        let line = line("0.1,2.0", &record);
        let whole = line.trim_end_matches('\n');
        assert_eq!(of_line(whole, 1), Some(("0.1,2.0".to_owned(), record)));
        for end in 0..whole.len() {
            assert_eq!(of_line(&whole[..end], 1), None);
        }
        assert_eq!(of_line(&whole.replacen("0.1", "0.2", 1), 1), None);
    }
}
