//! Rows of one instant, and who takes them.

use std::io;
use std::sync::Arc;

use glam::{DQuat, DVec3};

/// Everything that is recorded at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// The time, s.
    pub time_s: f64,
    /// Bodies, anchors and nodes.
    pub states: Vec<StateRow>,
    /// Segments of tethers.
    pub segments: Vec<SegmentRow>,
    /// Channels.
    pub channels: Vec<ChannelRow>,
}

impl Frame {
    /// Whether it has no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.states.is_empty() && self.segments.is_empty() && self.channels.is_empty()
    }

    /// Empties it for the rows of `time_s`.
    pub fn clear(&mut self, time_s: f64) {
        self.time_s = time_s;
        self.states.clear();
        self.segments.clear();
        self.channels.clear();
    }
}

/// State of a body, an anchor or a node.
#[derive(Clone, Debug, PartialEq)]
pub struct StateRow {
    /// Name of the entity.
    pub entity: Arc<str>,
    /// Position, inertial frame, m.
    pub position_m: DVec3,
    /// Velocity, inertial frame, m/s.
    pub velocity_m_s: DVec3,
    /// Attitude, body to inertial, and rate in the body frame, rad/s; a node has none.
    pub rotation: Option<(DQuat, DVec3)>,
}

/// State of a segment.
#[derive(Clone, Debug, PartialEq)]
pub struct SegmentRow {
    /// Name of the tether.
    pub tether: Arc<str>,
    /// Number of the segment from 1 at `from`.
    pub segment: u32,
    /// Tension of the segment, N.
    pub tension_n: f64,
    /// Length of the segment, m.
    pub length_m: f64,
}

/// One value of a channel.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelRow {
    /// Name of the entity; `system` for the whole.
    pub entity: Arc<str>,
    /// Name of the channel, with its unit.
    pub channel: &'static str,
    /// The value.
    pub value: f64,
}

/// Takes the rows of a run, instant by instant.
pub trait ResultSink {
    /// Takes the rows of one instant; they stay the caller's.
    ///
    /// # Errors
    /// What kept them from being stored.
    fn take(&mut self, frame: &Frame) -> io::Result<()>;
}

/// Keeps every frame in memory: for tests and for programs that look at results themselves.
#[derive(Clone, Debug, Default)]
pub struct MemorySink {
    /// The frames, in the order of time.
    pub frames: Vec<Frame>,
}

impl ResultSink for MemorySink {
    fn take(&mut self, frame: &Frame) -> io::Result<()> {
        self.frames.push(frame.clone());
        Ok(())
    }
}

impl MemorySink {
    /// Position in m of an entity at every time it was recorded.
    #[must_use]
    pub fn positions(&self, entity: &str) -> Vec<(f64, DVec3)> {
        self.states(entity)
            .map(|(time, row)| (time, row.position_m))
            .collect()
    }

    /// Every state of an entity with its time in s.
    pub fn states<'a>(&'a self, entity: &'a str) -> impl Iterator<Item = (f64, &'a StateRow)> {
        self.frames.iter().flat_map(move |frame| {
            let rows = frame
                .states
                .iter()
                .filter(move |row| &*row.entity == entity);
            rows.map(move |row| (frame.time_s, row))
        })
    }

    /// Every value of a channel with its time in s.
    #[must_use]
    pub fn channel(&self, entity: &str, channel: &str) -> Vec<(f64, f64)> {
        let rows = self
            .frames
            .iter()
            .flat_map(|frame| frame.channels.iter().map(move |row| (frame.time_s, row)));
        rows.filter(|(_, row)| &*row.entity == entity && row.channel == channel)
            .map(|(time, row)| (time, row.value))
            .collect()
    }
}

/// Drops every frame: for measurements of cost.
#[derive(Clone, Copy, Debug, Default)]
pub struct NullSink;

impl ResultSink for NullSink {
    fn take(&mut self, _frame: &Frame) -> io::Result<()> {
        Ok(())
    }
}
