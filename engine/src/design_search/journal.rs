//! The journal of a search: a line for each finished run of a design, in the order in which they finish.

use std::collections::BTreeMap;

use super::definition::DesignSearch;
use crate::campaign::CampaignError;
use crate::campaign::fingerprint::{sealed, unsealed};
use crate::campaign::line_journal::{Heading, LineJournal};
use crate::campaign::manifest::Study;
use crate::campaign::record::{Record, RecordLine};

/// Name of the journal.
pub const JOURNAL: &str = "runs.journal";

/// Records by the key of their design and their index.
pub type RunRecords = BTreeMap<(String, u64), Record>;

/// The line of a run: its design, its record, and a sum over both.
pub(super) fn line(key: &str, record: &Record) -> String {
    let record = record.to_line();
    sealed(&format!("{key}\t{}", record.trim_end_matches('\n')))
}

fn of_line(line: &str, metrics: usize) -> Option<(String, Record)> {
    let (key, record) = unsealed(line)?.split_once('\t')?;
    let record = RecordLine::of_line(record, (metrics, 0))?;
    Some((key.to_owned(), record.record()))
}

/// Opens the journal of a search to go on with it, or begins one; gives the records that it has.
///
/// # Errors
/// Another process is at it, it is of another search, or the file system refused something.
pub fn open_search_journal(
    search: &DesignSearch,
) -> Result<(LineJournal, RunRecords), CampaignError> {
    let heading = Heading {
        study: Study::DesignSearch,
        fingerprint: search.runs.manifest.fingerprint.clone(),
    };
    let metrics = search.specification.metrics.0.len();
    let mut records = RunRecords::new();
    let journal = LineJournal::open(&heading, &search.folder.join(JOURNAL), &mut |line| {
        if let Some((key, record)) = of_line(line, metrics) {
            records.entry((key, record.index)).or_insert(record);
        }
    })?;
    Ok((journal, records))
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
