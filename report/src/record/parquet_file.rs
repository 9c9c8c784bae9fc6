//! The tables of a run as Parquet.

use std::fs::File;
use std::path::Path;

use glam::{DQuat, DVec3};
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::{Field, Row};

use super::RecordError;
use super::tables::{State, Tables};

/// Reads the three tables of a folder into `tables`.
pub(super) fn read(folder: &Path, tables: &mut Tables) -> Result<(), RecordError> {
    read_rows(&folder.join("states.parquet"), |row| {
        let attitude = [
            number(row, 8),
            number(row, 9),
            number(row, 10),
            number(row, 11),
        ];
        let rotation = match attitude {
            [Some(x), Some(y), Some(z), Some(w)] => {
                Some((DQuat::from_xyzw(x, y, z, w), vector(row, 12)?))
            }
            _ => None,
        };
        let state = State {
            position_m: vector(row, 2)?,
            velocity_m_s: vector(row, 5)?,
            rotation,
        };
        tables
            .take_state(number(row, 0)?, text(row, 1)?, state)
            .ok()
    })?;
    read_rows(&folder.join("tethers.parquet"), |row| {
        let segment = match row.get_column_iter().nth(2)?.1 {
            Field::Int(number) => usize::try_from(*number).ok()?,
            Field::UInt(number) => usize::try_from(*number).ok()?,
            _ => return None,
        };
        let values = (number(row, 3)?, number(row, 4)?);
        tables
            .take_segment(number(row, 0)?, text(row, 1)?, segment, values)
            .ok()
    })?;
    read_rows(&folder.join("channels.parquet"), |row| {
        tables
            .take_channel(
                number(row, 0)?,
                text(row, 1)?,
                text(row, 2)?,
                number(row, 3)?,
            )
            .ok()
    })
}

fn read_rows(file: &Path, mut take: impl FnMut(&Row) -> Option<()>) -> Result<(), RecordError> {
    let unreadable = |reason: String| RecordError::Unreadable {
        file: file.to_owned(),
        reason,
    };
    let parquet = |error: ParquetError| unreadable(error.to_string());
    let opened = File::open(file).map_err(|error| unreadable(error.to_string()))?;
    let reader = SerializedFileReader::new(opened).map_err(parquet)?;
    for (index, row) in reader.get_row_iter(None).map_err(parquet)?.enumerate() {
        take(&row.map_err(parquet)?)
            .ok_or_else(|| unreadable(format!("row {} is not as a run writes it", index + 1)))?;
    }
    Ok(())
}

fn number(row: &Row, column: usize) -> Option<f64> {
    match row.get_column_iter().nth(column)?.1 {
        Field::Double(value) if value.is_finite() => Some(*value),
        _ => None,
    }
}

fn text(row: &Row, column: usize) -> Option<&str> {
    match row.get_column_iter().nth(column)?.1 {
        Field::Str(value) => Some(value),
        _ => None,
    }
}

fn vector(row: &Row, column: usize) -> Option<DVec3> {
    Some(DVec3::new(
        number(row, column)?,
        number(row, column + 1)?,
        number(row, column + 2)?,
    ))
}
