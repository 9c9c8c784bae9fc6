//! The files that the rows of a run go to.

use std::io;
use std::path::Path;

use super::csv_sink::CsvSink;
use super::frame::{Frame, ResultSink};
use super::parquet_sink::ParquetSink;

/// How the tables of a run are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TableFormat {
    /// Text, row by row as the run goes.
    #[default]
    Csv,
    /// Parquet, complete at the end of the run.
    Parquet,
}

/// The open tables of a run.
pub(crate) enum TableSink {
    Csv(CsvSink),
    Parquet(Box<ParquetSink>),
}

impl TableSink {
    /// Creates the files in `folder`.
    pub(crate) fn create(folder: &Path, format: TableFormat) -> io::Result<Self> {
        match format {
            TableFormat::Csv => CsvSink::create(folder).map(Self::Csv),
            TableFormat::Parquet => ParquetSink::create(folder).map(Box::new).map(Self::Parquet),
        }
    }

    /// Hands every held row to its file.
    pub(crate) fn finish(&mut self) -> io::Result<()> {
        match self {
            Self::Csv(sink) => sink.flush(),
            Self::Parquet(sink) => sink.finish(),
        }
    }
}

impl ResultSink for TableSink {
    fn take(&mut self, frame: &Frame) -> io::Result<()> {
        match self {
            Self::Csv(sink) => sink.take(frame),
            Self::Parquet(sink) => sink.take(frame),
        }
    }
}
