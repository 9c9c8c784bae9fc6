//! A table as CSV and as Parquet, row by row: the same rows and columns in both. Each file has a temporary name
//! until it is whole.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::CampaignError;
use super::comma_separated::quoted;
use crate::recording::number::number_text;
use crate::recording::parquet_table::{ColumnKind, ColumnSpec, ParquetTable};

/// A file under a temporary name, which goes with it unless it is finished.
struct Part {
    name: PathBuf,
    part: PathBuf,
}

impl Part {
    fn new(name: PathBuf) -> Self {
        let mut part = name.as_os_str().to_owned();
        part.push(".part");
        let part = part.into();
        Self { name, part }
    }

    fn unwritten(&self, error: &io::Error) -> CampaignError {
        CampaignError::unwritten(&self.name, error)
    }

    /// Gives the file its name once all of it is on the disk.
    fn finish(&self) -> Result<(), CampaignError> {
        let whole = File::options().append(true).open(&self.part);
        let whole = whole.and_then(|file| file.sync_all());
        whole
            .and_then(|()| fs::rename(&self.part, &self.name))
            .map_err(|error| self.unwritten(&error))
    }
}

impl Drop for Part {
    fn drop(&mut self) {
        // Of a finished file there is none.
        let _ = fs::remove_file(&self.part);
    }
}

/// Writes a file whole or not at all.
///
/// # Errors
/// What the file system refused.
pub(crate) fn write_whole(name: &Path, text: &str) -> Result<(), CampaignError> {
    let part = Part::new(name.to_owned());
    fs::write(&part.part, text).map_err(|error| part.unwritten(&error))?;
    part.finish()
}

/// `NAME.csv` and `NAME.parquet` on their way.
pub(super) struct PairedTable {
    csv: BufWriter<File>,
    parquet: ParquetTable,
    parts: [Part; 2],
    kinds: Vec<ColumnKind>,
    /// The row so far, and its number of fields.
    line: String,
    next: usize,
}

impl PairedTable {
    /// Begins both files in a folder; `units` are what the metadata of the Parquet file has besides those of
    /// columns.
    ///
    /// # Errors
    /// What the file system refused.
    pub(super) fn create(
        folder: &Path,
        name: &str,
        columns: &[ColumnSpec],
        units: &[(String, String)],
    ) -> Result<Self, CampaignError> {
        let parts = ["csv", "parquet"].map(|kind| Part::new(folder.join(format!("{name}.{kind}"))));
        let csv = File::create(&parts[0].part).map_err(|error| parts[0].unwritten(&error))?;
        let parquet = ParquetTable::with_units(&parts[1].part, name, columns, units)
            .map_err(|error| parts[1].unwritten(&error))?;
        let header = columns.iter().map(|column| quoted(&column.name));
        let mut table = Self {
            csv: BufWriter::new(csv),
            parquet,
            parts,
            kinds: columns.iter().map(|column| column.kind).collect(),
            line: header.collect::<Vec<_>>().join(","),
            next: 0,
        };
        table.end_line()?;
        Ok(table)
    }

    /// Gives the next column of this row a text.
    pub(super) fn text(&mut self, value: &str) -> &mut Self {
        self.parquet.text(value);
        self.cell(&quoted(value))
    }

    /// Gives the next column of this row a whole number.
    pub(super) fn whole(&mut self, value: u64) -> &mut Self {
        self.parquet.whole(Some(value));
        self.cell(&value.to_string())
    }

    /// Gives the next column of this row a number, or none.
    pub(super) fn number(&mut self, value: Option<f64>) -> &mut Self {
        self.parquet.number(value);
        self.cell(&value.map_or_else(String::new, number_text))
    }

    /// Gives the next column of this row a value as it stands in a scene.
    pub(super) fn given(&mut self, value: &str) -> &mut Self {
        match self.kinds.get(self.next) {
            Some(ColumnKind::Number) => self.parquet.number(value.parse().ok()),
            Some(ColumnKind::Whole) => self.parquet.whole(value.parse().ok()),
            _ => self.parquet.text(value),
        };
        self.cell(&quoted(value))
    }

    fn cell(&mut self, text: &str) -> &mut Self {
        if self.next > 0 {
            self.line.push(',');
        }
        self.line.push_str(text);
        self.next += 1;
        self
    }

    /// Ends a row.
    ///
    /// # Errors
    /// What the file system refused.
    pub(super) fn end_row(&mut self) -> Result<(), CampaignError> {
        self.end_line()?;
        let ended = self.parquet.end_row();
        ended.map_err(|error| self.parts[1].unwritten(&error))
    }

    fn end_line(&mut self) -> Result<(), CampaignError> {
        self.line.push('\n');
        let written = self.csv.write_all(self.line.as_bytes());
        self.line.clear();
        self.next = 0;
        written.map_err(|error| self.parts[0].unwritten(&error))
    }

    /// Gives both files their names.
    ///
    /// # Errors
    /// What the file system refused.
    pub(super) fn finish(mut self) -> Result<(), CampaignError> {
        let flushed = self.csv.flush();
        flushed.map_err(|error| self.parts[0].unwritten(&error))?;
        let finished = self.parquet.finish();
        finished.map_err(|error| self.parts[1].unwritten(&error))?;
        self.parts.iter().try_for_each(Part::finish)
    }
}
