//! The tables of a campaign: a row for each run, and percentiles as time goes.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use aerobot_engine::campaign::CampaignError;
use aerobot_engine::campaign::comma_separated::fields;
use aerobot_engine::campaign::envelopes::PERCENTILES;
use aerobot_engine::campaign::specification::CampaignSpec;

/// The runs of a campaign, in the order of their indices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunRows {
    /// Their indices.
    pub indices: Vec<u64>,
    /// A column for each metric, in the order of the campaign, with a value for each run that has it.
    pub metrics: Vec<Vec<Option<f64>>>,
    /// Index, outcome and reason of each run that did not get to its end.
    pub failures: Vec<(u64, String, String)>,
}

/// An envelope: percentiles over runs at fixed times.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Envelope {
    /// Its name.
    pub name: String,
    /// Times, s.
    pub times_s: Vec<f64>,
    /// At each time, how many runs got there.
    pub runs: Vec<u64>,
    /// Percentiles 0, 5, 25, 50, 75, 95 and 100 at each time.
    pub percentiles: [Vec<f64>; PERCENTILES.len()],
}

/// A table row by row, so that one of a million runs is never held as text.
pub(super) struct Table {
    header: Vec<String>,
    reader: BufReader<File>,
    file: String,
    line: usize,
}

impl Table {
    pub(super) fn open(path: &Path) -> Result<Self, CampaignError> {
        let file = File::open(path).map_err(|error| CampaignError::unreadable(path, &error))?;
        let mut table = Self {
            header: Vec::new(),
            reader: BufReader::with_capacity(1 << 20, file),
            file: path.display().to_string(),
            line: 0,
        };
        table.header = table.next()?.unwrap_or_default();
        Ok(table)
    }

    /// The fields of the next row.
    pub(super) fn next(&mut self) -> Result<Option<Vec<String>>, CampaignError> {
        let mut text = String::new();
        let read = self.reader.read_line(&mut text);
        let read =
            read.map_err(|error| CampaignError::unreadable(Path::new(&self.file), &error))?;
        self.line += 1;
        if read == 0 {
            return Ok(None);
        }
        let row = fields(self.line, text.trim_end_matches(['\n', '\r']))
            .map_err(|error| CampaignError::refused(format_args!("{}:{error}", self.file), ""))?;
        if !self.header.is_empty() && row.len() != self.header.len() {
            return Err(self.refuse("the row has not as many fields as the header"));
        }
        Ok(Some(row))
    }

    pub(super) fn refuse(&self, reason: &str) -> CampaignError {
        CampaignError::refused(format_args!("{}:{}: {reason}", self.file, self.line), "")
    }

    /// The place of a column.
    pub(super) fn column(&self, name: &str) -> Result<usize, CampaignError> {
        let place = self.header.iter().position(|column| column == name);
        place.ok_or_else(|| {
            let message = format!("{}:1: there is no column `{name}`", self.file);
            CampaignError::refused(message, "")
        })
    }

    /// A number, or none where the field is empty.
    pub(super) fn number(&self, text: &str) -> Result<Option<f64>, CampaignError> {
        if text.is_empty() {
            return Ok(None);
        }
        let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
        let refuse = || self.refuse(&format!("`{text}` is not a finite number"));
        value.ok_or_else(refuse).map(Some)
    }

    pub(super) fn whole(&self, text: &str) -> Result<u64, CampaignError> {
        let refuse = |_| self.refuse(&format!("`{text}` is not a whole number"));
        text.parse().map_err(refuse)
    }
}

/// `runs.csv` of a folder.
pub(super) fn read_runs(folder: &Path, campaign: &CampaignSpec) -> Result<RunRows, CampaignError> {
    let mut table = Table::open(&folder.join("runs.csv"))?;
    let (run, outcome) = (table.column("run")?, table.column("outcome")?);
    let reason = table.column("reason")?;
    // A field that varies cannot have the name of a metric: its path has a dot.
    let columns = campaign
        .metrics
        .0
        .iter()
        .map(|(name, _)| table.column(name));
    let columns = columns.collect::<Result<Vec<_>, _>>()?;
    let mut rows = RunRows {
        metrics: vec![Vec::new(); columns.len()],
        ..RunRows::default()
    };
    while let Some(row) = table.next()? {
        let index = table.whole(&row[run])?;
        rows.indices.push(index);
        for (values, column) in rows.metrics.iter_mut().zip(&columns) {
            values.push(table.number(&row[*column])?);
        }
        if row[outcome] != "done" {
            let failure = (index, row[outcome].clone(), row[reason].clone());
            rows.failures.push(failure);
        }
    }
    Ok(rows)
}

/// `envelopes.csv` of a folder; nothing if the campaign has none.
pub(super) fn read_envelopes(
    folder: &Path,
    campaign: &CampaignSpec,
) -> Result<Vec<Envelope>, CampaignError> {
    let names = campaign.envelopes.0.iter().map(|(name, _)| Envelope {
        name: name.clone(),
        ..Envelope::default()
    });
    let mut envelopes: Vec<Envelope> = names.collect();
    if envelopes.is_empty() {
        return Ok(envelopes);
    }
    let mut table = Table::open(&folder.join("envelopes.csv"))?;
    let (name, time, runs) = (
        table.column("envelope")?,
        table.column("time_s")?,
        table.column("runs")?,
    );
    let columns = PERCENTILES.map(|percent| table.column(&format!("p{percent:02}")));
    let columns = columns.into_iter().collect::<Result<Vec<_>, _>>()?;
    while let Some(row) = table.next()? {
        let Some(envelope) = envelopes.iter_mut().find(|own| own.name == row[name]) else {
            return Err(table.refuse(&format!("the campaign has no envelope `{}`", row[name])));
        };
        envelope
            .times_s
            .push(table.number(&row[time])?.unwrap_or(f64::NAN));
        envelope.runs.push(table.whole(&row[runs])?);
        for (values, column) in envelope.percentiles.iter_mut().zip(&columns) {
            values.push(table.number(&row[*column])?.unwrap_or(f64::NAN));
        }
    }
    Ok(envelopes)
}
