//! A table as a Parquet file, column by column, written in groups of rows as they come.
//!
//! A file has its footer, without which nothing reads it, only once it is finished: a run that is killed leaves
//! none. Who needs rows on the way writes CSV.

use std::borrow::Cow;
use std::fs::File;
use std::io;
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int32Type, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::Type;

use super::summary::VERSION;

/// Rows that are held back before they are written as one group.
const GROUP: usize = 1 << 16;

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnKind {
    /// Text, such as names.
    Text,
    /// Whole numbers of 32 bits.
    Count,
    /// Whole numbers from 0 of 64 bits, each of which may be missing.
    Whole,
    /// Numbers, each of which may be missing.
    Number,
}

/// A column of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColumnSpec {
    /// Its name, with its unit.
    pub name: Cow<'static, str>,
    /// What it holds.
    pub kind: ColumnKind,
    /// The unit, for the file's metadata; empty where there is none.
    pub unit: Cow<'static, str>,
}

impl ColumnSpec {
    /// A column whose name and unit do not depend on what is run.
    #[must_use]
    pub const fn fixed(name: &'static str, kind: ColumnKind, unit: &'static str) -> Self {
        Self {
            name: Cow::Borrowed(name),
            kind,
            unit: Cow::Borrowed(unit),
        }
    }
}

/// The values of a column that wait.
enum Held {
    Text(Vec<ByteArray>),
    Count(Vec<i32>),
    /// The bits of values, and for every row whether it has one.
    Whole(Vec<i64>, Vec<i16>),
    /// Values, and for every row whether it has one.
    Number(Vec<f64>, Vec<i16>),
}

/// A file, and the rows that wait for it.
pub struct ParquetTable {
    writer: Option<SerializedFileWriter<File>>,
    held: Vec<Held>,
    /// The column that the next value is for.
    next: usize,
    rows: usize,
}

impl ParquetTable {
    /// Creates a file for a table of this name with these columns. Units and the version of the program stand in
    /// its metadata.
    ///
    /// # Errors
    /// As the file system.
    pub fn create(path: &Path, name: &str, columns: &[ColumnSpec]) -> io::Result<Self> {
        Self::with_units(path, name, columns, &[])
    }

    /// As [`Self::create`]; `more` are names and units that stand beside those of the columns.
    ///
    /// # Errors
    /// As the file system.
    pub fn with_units(
        path: &Path,
        name: &str,
        columns: &[ColumnSpec],
        more: &[(String, String)],
    ) -> io::Result<Self> {
        let fields = columns.iter().map(|column| field(column).map(Arc::new));
        let fields = fields.collect::<Result<Vec<_>, _>>().map_err(refused)?;
        let schema = Type::group_type_builder(name).with_fields(fields).build();
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_created_by(format!("aerobot {VERSION}"))
            .set_key_value_metadata(Some(vec![KeyValue::new(
                "units".to_owned(),
                units(columns, more),
            )]))
            .build();
        let file = File::create(path)?;
        let schema = Arc::new(schema.map_err(refused)?);
        let writer =
            SerializedFileWriter::new(file, schema, Arc::new(properties)).map_err(refused)?;
        Ok(Self {
            writer: Some(writer),
            held: columns
                .iter()
                .map(|column| Held::new(column.kind))
                .collect(),
            next: 0,
            rows: 0,
        })
    }

    /// Gives the next column of this row a text; one that holds numbers has none then.
    pub fn text(&mut self, value: &str) -> &mut Self {
        match &mut self.held[self.next] {
            Held::Text(values) => values.push(value.into()),
            other => other.skip(),
        }
        self.next += 1;
        self
    }

    /// Gives the next column of this row a whole number.
    pub fn count(&mut self, value: u32) -> &mut Self {
        match &mut self.held[self.next] {
            Held::Count(values) => values.push(i32::try_from(value).unwrap_or(i32::MAX)),
            other => other.skip(),
        }
        self.next += 1;
        self
    }

    /// Gives the next column of this row a whole number of 64 bits, or none.
    pub fn whole(&mut self, value: Option<u64>) -> &mut Self {
        match (&mut self.held[self.next], value) {
            (Held::Whole(values, given), Some(value)) => {
                values.push(value.cast_signed());
                given.push(1);
            }
            (other, _) => other.skip(),
        }
        self.next += 1;
        self
    }

    /// Gives the next column of this row a number, or none: what is not finite is none.
    pub fn number(&mut self, value: Option<f64>) -> &mut Self {
        match (&mut self.held[self.next], value.filter(|v| v.is_finite())) {
            (Held::Number(values, given), Some(value)) => {
                values.push(value);
                given.push(1);
            }
            (other, _) => other.skip(),
        }
        self.next += 1;
        self
    }

    /// Ends a row.
    ///
    /// # Errors
    /// As the file system.
    pub fn end_row(&mut self) -> io::Result<()> {
        while let Some(held) = self.held.get_mut(self.next) {
            held.skip();
            self.next += 1;
        }
        self.next = 0;
        self.rows += 1;
        if self.rows >= GROUP {
            self.write_group()
        } else {
            Ok(())
        }
    }

    /// Writes what waits, and the footer; rows that come later are dropped.
    ///
    /// # Errors
    /// As the file system.
    pub fn finish(&mut self) -> io::Result<()> {
        self.write_group()?;
        match self.writer.take() {
            Some(writer) => writer.close().map(|_| ()).map_err(refused),
            None => Ok(()),
        }
    }

    fn write_group(&mut self) -> io::Result<()> {
        let Some(writer) = self.writer.as_mut().filter(|_| self.rows > 0) else {
            return Ok(());
        };
        let mut group = writer.next_row_group().map_err(refused)?;
        for held in &mut self.held {
            held.write(&mut group).map_err(refused)?;
        }
        self.rows = 0;
        group.close().map(|_| ()).map_err(refused)
    }
}

impl Held {
    fn new(kind: ColumnKind) -> Self {
        match kind {
            ColumnKind::Text => Self::Text(Vec::new()),
            ColumnKind::Count => Self::Count(Vec::new()),
            ColumnKind::Whole => Self::Whole(Vec::new(), Vec::new()),
            ColumnKind::Number => Self::Number(Vec::new(), Vec::new()),
        }
    }

    /// A row without a value here.
    fn skip(&mut self) {
        match self {
            Self::Text(values) => values.push(ByteArray::from("")),
            Self::Count(values) => values.push(0),
            Self::Whole(_, given) | Self::Number(_, given) => given.push(0),
        }
    }

    /// Writes all that waits as the next column of a group.
    fn write(
        &mut self,
        group: &mut SerializedRowGroupWriter<'_, File>,
    ) -> Result<(), ParquetError> {
        let Some(mut column) = group.next_column()? else {
            return Ok(());
        };
        match self {
            Self::Text(values) => {
                let typed = column.typed::<ByteArrayType>();
                typed.write_batch(values, None, None)?;
                values.clear();
            }
            Self::Count(values) => {
                let typed = column.typed::<Int32Type>();
                typed.write_batch(values, None, None)?;
                values.clear();
            }
            Self::Whole(values, given) => {
                let typed = column.typed::<Int64Type>();
                typed.write_batch(values, Some(given), None)?;
                values.clear();
                given.clear();
            }
            Self::Number(values, given) => {
                let typed = column.typed::<DoubleType>();
                typed.write_batch(values, Some(given), None)?;
                values.clear();
                given.clear();
            }
        }
        column.close()
    }
}

fn field(column: &ColumnSpec) -> Result<Type, ParquetError> {
    let (physical, repetition, logical) = match column.kind {
        ColumnKind::Text => (
            Physical::BYTE_ARRAY,
            Repetition::REQUIRED,
            Some(LogicalType::String),
        ),
        ColumnKind::Count => (Physical::INT32, Repetition::REQUIRED, None),
        ColumnKind::Whole => (
            Physical::INT64,
            Repetition::OPTIONAL,
            Some(LogicalType::integer(64, false)),
        ),
        ColumnKind::Number => (Physical::DOUBLE, Repetition::OPTIONAL, None),
    };
    Type::primitive_type_builder(&column.name, physical)
        .with_repetition(repetition)
        .with_logical_type(logical)
        .build()
}

/// Columns with their units, and what else has one, as JSON.
fn units(columns: &[ColumnSpec], more: &[(String, String)]) -> String {
    let units = columns.iter().map(|column| (&*column.name, &*column.unit));
    let more = more
        .iter()
        .map(|(name, unit)| (name.as_str(), unit.as_str()));
    let units = units.chain(more).filter(|(_, unit)| !unit.is_empty());
    let units: serde_json::Map<String, serde_json::Value> = units
        .map(|(name, unit)| (name.to_owned(), unit.into()))
        .collect();
    serde_json::Value::Object(units).to_string()
}

fn refused(error: ParquetError) -> io::Error {
    io::Error::other(error)
}
