//! The tables of a run as CSV. A last line without its end, as a kill leaves it, is passed over.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

use aerobot_engine::recording::csv_sink::{CHANNELS_HEADER, STATES_HEADER, TETHERS_HEADER};
use glam::{DQuat, DVec3};

use super::RecordError;
use super::tables::{State, Tables};

/// Reads the three tables of a folder into `tables`.
pub(super) fn read(folder: &Path, tables: &mut Tables) -> Result<(), RecordError> {
    read_rows(&folder.join("states.csv"), STATES_HEADER, |fields| {
        let time_s = number(fields.next())?;
        let name = fields.next().ok_or("a field is missing")?;
        let position_m = vector(fields)?;
        let velocity_m_s = vector(fields)?;
        let rotation = rotation(fields)?;
        let state = State {
            position_m,
            velocity_m_s,
            rotation,
        };
        tables.take_state(time_s, name, state)
    })?;
    read_rows(&folder.join("tethers.csv"), TETHERS_HEADER, |fields| {
        let time_s = number(fields.next())?;
        let name = fields.next().ok_or("a field is missing")?;
        let segment = fields.next().and_then(|field| field.parse().ok());
        let segment = segment.ok_or("a segment is a number from 1")?;
        let values = (number(fields.next())?, number(fields.next())?);
        tables.take_segment(time_s, name, segment, values)
    })?;
    read_rows(&folder.join("channels.csv"), CHANNELS_HEADER, |fields| {
        let time_s = number(fields.next())?;
        let entity = fields.next().ok_or("a field is missing")?;
        let channel = fields.next().ok_or("a field is missing")?;
        tables.take_channel(time_s, entity, channel, number(fields.next())?)
    })
}

type Fields<'a> = std::str::Split<'a, char>;

fn read_rows(
    file: &Path,
    header: &str,
    mut take: impl FnMut(&mut Fields<'_>) -> Result<(), &'static str>,
) -> Result<(), RecordError> {
    let unreadable = |error: std::io::Error| RecordError::Unreadable {
        file: file.to_owned(),
        reason: error.to_string(),
    };
    let mut reader = BufReader::with_capacity(1 << 20, File::open(file).map_err(unreadable)?);
    let mut text = String::new();
    for line in 1.. {
        text.clear();
        let read = reader.read_line(&mut text).map_err(unreadable)?;
        let is_cut = read == 0 || !text.ends_with('\n');
        if is_cut && line > 1 {
            break;
        }
        let row = text.trim_end();
        let taken = match line {
            1 if row == header => Ok(()),
            1 => Err("the header is not that of a run's table"),
            _ => take(&mut row.split(',')),
        };
        taken.map_err(|reason| RecordError::Line {
            file: file.to_owned(),
            line,
            reason: reason.to_owned(),
        })?;
    }
    Ok(())
}

fn number(field: Option<&str>) -> Result<f64, &'static str> {
    let field = field.ok_or("a field is missing")?;
    let value: f64 = field.parse().map_err(|_| "a field is not a number")?;
    match value.is_finite() {
        true => Ok(value),
        false => Err("a number is not finite"),
    }
}

fn vector(fields: &mut Fields<'_>) -> Result<DVec3, &'static str> {
    Ok(DVec3::new(
        number(fields.next())?,
        number(fields.next())?,
        number(fields.next())?,
    ))
}

/// Attitude and rate; a node's seven fields are empty.
fn rotation(fields: &mut Fields<'_>) -> Result<Option<(DQuat, DVec3)>, &'static str> {
    let first = fields.next();
    if first == Some("") {
        return Ok(None);
    }
    let attitude = DQuat::from_xyzw(
        number(first)?,
        number(fields.next())?,
        number(fields.next())?,
        number(fields.next())?,
    );
    Ok(Some((attitude, vector(fields)?)))
}
