//! `states.csv`, `tethers.csv` and `channels.csv`, written as the run goes.
//!
//! Rows are buffered and handed to the file whole, at least once a second of wall time, so that a run
//! that is killed leaves files that can be read.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::time::{Duration, Instant};

use super::frame::{Frame, ResultSink};
use super::number::write_number;

/// Header of `states.csv`.
pub const STATES_HEADER: &str = "time_s,entity,x_m,y_m,z_m,vx_m_s,vy_m_s,vz_m_s,\
                                 qx,qy,qz,qw,wx_rad_s,wy_rad_s,wz_rad_s";
/// Header of `tethers.csv`.
pub const TETHERS_HEADER: &str = "time_s,tether,segment,tension_n,length_m";
/// Header of `channels.csv`.
pub const CHANNELS_HEADER: &str = "time_s,entity,channel,value";

/// Bytes that are held back before they go to the file.
const BUFFER: usize = 1 << 18;
/// Wall time after which held rows go to the file in any case.
const HOLD: Duration = Duration::from_secs(1);

/// Writes frames as CSV files in a folder.
pub struct CsvSink {
    states: Table,
    tethers: Table,
    channels: Table,
    flushed: Instant,
}

impl CsvSink {
    /// Creates the files in `folder` with their headers.
    ///
    /// # Errors
    /// As the file system.
    pub fn create(folder: &Path) -> io::Result<Self> {
        Ok(Self {
            states: Table::create(&folder.join("states.csv"), STATES_HEADER)?,
            tethers: Table::create(&folder.join("tethers.csv"), TETHERS_HEADER)?,
            channels: Table::create(&folder.join("channels.csv"), CHANNELS_HEADER)?,
            flushed: Instant::now(),
        })
    }

    /// Hands every held row to its file.
    ///
    /// # Errors
    /// As the file system.
    pub fn flush(&mut self) -> io::Result<()> {
        self.flushed = Instant::now();
        for table in [&mut self.states, &mut self.tethers, &mut self.channels] {
            table.flush()?;
        }
        Ok(())
    }
}

impl ResultSink for CsvSink {
    fn take(&mut self, frame: &Frame) -> io::Result<()> {
        let mut time = Vec::new();
        write_number(&mut time, frame.time_s)?;
        for row in &frame.states {
            let out = self.states.row(&time, &row.entity);
            let vectors = [row.position_m, row.velocity_m_s];
            write_fields(out, vectors.iter().flat_map(|vector| vector.to_array()))?;
            match row.rotation {
                Some((attitude, rate)) => {
                    write_fields(out, attitude.to_array().into_iter().chain(rate.to_array()))?;
                }
                None => out.extend_from_slice(b",,,,,,,"),
            }
            self.states.end_row()?;
        }
        for row in &frame.segments {
            let out = self.tethers.row(&time, &row.tether);
            write!(out, ",{}", row.segment)?;
            write_fields(out, [row.tension_n, row.length_m])?;
            self.tethers.end_row()?;
        }
        for row in &frame.channels {
            let out = self.channels.row(&time, &row.entity);
            write!(out, ",{}", row.channel)?;
            write_fields(out, [row.value])?;
            self.channels.end_row()?;
        }
        if self.flushed.elapsed() > HOLD {
            self.flush()
        } else {
            Ok(())
        }
    }
}

fn write_fields(out: &mut Vec<u8>, values: impl IntoIterator<Item = f64>) -> io::Result<()> {
    for value in values {
        out.push(b',');
        write_number(out, value)?;
    }
    Ok(())
}

/// One file with the rows that wait for it.
struct Table {
    file: File,
    held: Vec<u8>,
}

impl Table {
    fn create(path: &Path, header: &str) -> io::Result<Self> {
        let mut held = Vec::with_capacity(BUFFER + 4096);
        held.extend_from_slice(header.as_bytes());
        held.push(b'\n');
        let mut table = Self {
            file: File::create(path)?,
            held,
        };
        table.flush()?;
        Ok(table)
    }

    fn row(&mut self, time: &[u8], name: &str) -> &mut Vec<u8> {
        self.held.extend_from_slice(time);
        self.held.push(b',');
        self.held.extend_from_slice(name.as_bytes());
        &mut self.held
    }

    fn end_row(&mut self) -> io::Result<()> {
        self.held.push(b'\n');
        if self.held.len() >= BUFFER {
            self.flush()
        } else {
            Ok(())
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.write_all(&self.held)?;
        self.held.clear();
        Ok(())
    }
}
