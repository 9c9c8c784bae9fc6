//! `states.parquet`, `tethers.parquet` and `channels.parquet`: the columns of the CSV files, with their types.

use std::io;
use std::path::Path;

use super::frame::{Frame, ResultSink};
use super::parquet_table::{ColumnKind, ColumnSpec, ParquetTable};

const fn column(name: &'static str, kind: ColumnKind, unit: &'static str) -> ColumnSpec {
    ColumnSpec::fixed(name, kind, unit)
}

const fn number(name: &'static str, unit: &'static str) -> ColumnSpec {
    column(name, ColumnKind::Number, unit)
}

/// Columns of `states.parquet`.
const STATES: [ColumnSpec; 15] = [
    number("time_s", "s"),
    column("entity", ColumnKind::Text, ""),
    number("x_m", "m"),
    number("y_m", "m"),
    number("z_m", "m"),
    number("vx_m_s", "m/s"),
    number("vy_m_s", "m/s"),
    number("vz_m_s", "m/s"),
    number("qx", "1"),
    number("qy", "1"),
    number("qz", "1"),
    number("qw", "1"),
    number("wx_rad_s", "rad/s"),
    number("wy_rad_s", "rad/s"),
    number("wz_rad_s", "rad/s"),
];
/// Columns of `tethers.parquet`.
const TETHERS: [ColumnSpec; 5] = [
    number("time_s", "s"),
    column("tether", ColumnKind::Text, ""),
    column("segment", ColumnKind::Count, "1"),
    number("tension_n", "N"),
    number("length_m", "m"),
];
/// Columns of `channels.parquet`; the name of a channel has its unit.
const CHANNELS: [ColumnSpec; 4] = [
    number("time_s", "s"),
    column("entity", ColumnKind::Text, ""),
    column("channel", ColumnKind::Text, ""),
    number("value", ""),
];

/// Writes frames as Parquet files in a folder.
pub struct ParquetSink {
    states: ParquetTable,
    tethers: ParquetTable,
    channels: ParquetTable,
}

impl ParquetSink {
    /// Creates the files in `folder`.
    ///
    /// # Errors
    /// As the file system.
    pub fn create(folder: &Path) -> io::Result<Self> {
        let table = |name: &str, columns: &[ColumnSpec]| {
            ParquetTable::create(&folder.join(format!("{name}.parquet")), name, columns)
        };
        Ok(Self {
            states: table("states", &STATES)?,
            tethers: table("tethers", &TETHERS)?,
            channels: table("channels", &CHANNELS)?,
        })
    }

    /// Finishes the files.
    ///
    /// # Errors
    /// As the file system.
    pub fn finish(&mut self) -> io::Result<()> {
        self.states.finish()?;
        self.tethers.finish()?;
        self.channels.finish()
    }
}

impl ResultSink for ParquetSink {
    fn take(&mut self, frame: &Frame) -> io::Result<()> {
        let time_s = Some(frame.time_s);
        for row in &frame.states {
            let table = self.states.number(time_s).text(&row.entity);
            for value in row.position_m.to_array() {
                table.number(Some(value));
            }
            for value in row.velocity_m_s.to_array() {
                table.number(Some(value));
            }
            if let Some((attitude, rate)) = row.rotation {
                for value in attitude.to_array().into_iter().chain(rate.to_array()) {
                    table.number(Some(value));
                }
            }
            table.end_row()?;
        }
        for row in &frame.segments {
            let table = self.tethers.number(time_s).text(&row.tether);
            table.count(row.segment).number(Some(row.tension_n));
            table.number(Some(row.length_m)).end_row()?;
        }
        for row in &frame.channels {
            let table = self.channels.number(time_s).text(&row.entity);
            table.text(row.channel).number(Some(row.value)).end_row()?;
        }
        Ok(())
    }
}
