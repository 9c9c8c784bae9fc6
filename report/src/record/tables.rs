//! The tables of a run as tracks: one for each entity, segment and channel, in the order of the files.

use std::collections::HashMap;
use std::io;
use std::ops::Range;

use aerobot_engine::recording::frame::{Frame, ResultSink};
use glam::{DQuat, DVec3};

/// What was recorded of a run. A sink, so that a program can fill it while it runs.
#[derive(Clone, Debug, Default)]
pub struct Tables {
    /// Bodies, anchors and nodes.
    pub states: Vec<StateTrack>,
    /// Tethers.
    pub tethers: Vec<TetherTrack>,
    /// Channels.
    pub channels: Vec<ChannelTrack>,
    places: Places,
}

/// Where the track of a name is.
#[derive(Clone, Debug, Default)]
struct Places {
    states: HashMap<String, usize>,
    tethers: HashMap<String, usize>,
    channels: HashMap<(String, String), usize>,
}

/// A body, an anchor or a node over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StateTrack {
    /// Its name.
    pub name: String,
    /// Times, s.
    pub times_s: Vec<f64>,
    /// Positions, inertial frame, m.
    pub positions_m: Vec<DVec3>,
    /// Velocities, inertial frame, m/s.
    pub velocities_m_s: Vec<DVec3>,
    /// Attitudes, body to inertial, and rates in the body frame, rad/s; empty for a node.
    pub rotations: Vec<(DQuat, DVec3)>,
}

/// A tether over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TetherTrack {
    /// Its name.
    pub name: String,
    /// Its segments, the first at `from`.
    pub segments: Vec<SegmentTrack>,
}

/// A segment over time. A line that is cut or reeled has it only for a part of the run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SegmentTrack {
    /// Times, s.
    pub times_s: Vec<f64>,
    /// Tensions, N.
    pub tensions_n: Vec<f64>,
    /// Lengths, m.
    pub lengths_m: Vec<f64>,
}

/// A channel over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChannelTrack {
    /// Name of the entity; `system` for the whole.
    pub entity: String,
    /// Name of the channel, with its unit.
    pub channel: String,
    /// Times, s.
    pub times_s: Vec<f64>,
    /// Values.
    pub values: Vec<f64>,
}

impl StateTrack {
    /// Whether it is a body or an anchor, which have an attitude.
    #[must_use]
    pub fn is_body(&self) -> bool {
        !self.rotations.is_empty()
    }

    /// Position (m) at a time (s), linear between records; nothing outside of them.
    #[must_use]
    pub fn position_at_m(&self, time_s: f64) -> Option<DVec3> {
        let (index, part) = place(&self.times_s, time_s)?;
        let next = self
            .positions_m
            .get(index + 1)
            .unwrap_or(&self.positions_m[index]);
        Some(self.positions_m[index].lerp(*next, part))
    }

    /// Velocity (m/s) at a time (s), linear between records; nothing outside of them.
    #[must_use]
    pub fn velocity_at_m_s(&self, time_s: f64) -> Option<DVec3> {
        let (index, part) = place(&self.times_s, time_s)?;
        let next = self
            .velocities_m_s
            .get(index + 1)
            .unwrap_or(&self.velocities_m_s[index]);
        Some(self.velocities_m_s[index].lerp(*next, part))
    }

    /// Attitude at a time (s), turning evenly between records; nothing outside of them or of a node.
    #[must_use]
    pub fn attitude_at(&self, time_s: f64) -> Option<DQuat> {
        let (index, part) = place(&self.times_s, time_s)?;
        let (attitude, _) = *self.rotations.get(index)?;
        let (next, _) = *self
            .rotations
            .get(index + 1)
            .unwrap_or(&self.rotations[index]);
        Some(attitude.slerp(next, part))
    }
}

impl SegmentTrack {
    /// Tension (N) at a time (s), linear between records; nothing outside of them.
    #[must_use]
    pub fn tension_at_n(&self, time_s: f64) -> Option<f64> {
        at(&self.times_s, &self.tensions_n, time_s)
    }
}

impl ChannelTrack {
    /// Value at a time (s), linear between records; nothing outside of them.
    #[must_use]
    pub fn at(&self, time_s: f64) -> Option<f64> {
        at(&self.times_s, &self.values, time_s)
    }
}

fn at(times_s: &[f64], values: &[f64], time_s: f64) -> Option<f64> {
    let (index, part) = place(times_s, time_s)?;
    let next = values.get(index + 1).unwrap_or(&values[index]);
    Some(values[index] + part * (next - values[index]))
}

/// The record at or before a time, and the part of the way to the next; nothing outside of the times.
fn place(times_s: &[f64], time_s: f64) -> Option<(usize, f64)> {
    let after = times_s.partition_point(|other| *other <= time_s);
    let index = after.checked_sub(1)?;
    match times_s.get(after) {
        Some(next) => Some((index, (time_s - times_s[index]) / (next - times_s[index]))),
        None => (times_s[index] == time_s).then_some((index, 0.0)),
    }
}

/// A row of `states`.
#[derive(Clone, Copy, Debug)]
pub(super) struct State {
    pub(super) position_m: DVec3,
    pub(super) velocity_m_s: DVec3,
    pub(super) rotation: Option<(DQuat, DVec3)>,
}

impl Tables {
    /// The track of a body, an anchor or a node.
    #[must_use]
    pub fn state(&self, name: &str) -> Option<&StateTrack> {
        self.places
            .states
            .get(name)
            .map(|place| &self.states[*place])
    }

    /// The track of a tether.
    #[must_use]
    pub fn tether(&self, name: &str) -> Option<&TetherTrack> {
        self.places
            .tethers
            .get(name)
            .map(|place| &self.tethers[*place])
    }

    /// The track of a channel.
    #[must_use]
    pub fn channel(&self, entity: &str, channel: &str) -> Option<&ChannelTrack> {
        let key = (entity.to_owned(), channel.to_owned());
        self.places
            .channels
            .get(&key)
            .map(|place| &self.channels[*place])
    }

    /// Bodies and anchors.
    pub fn bodies(&self) -> impl Iterator<Item = &StateTrack> {
        self.states.iter().filter(|track| track.is_body())
    }

    /// First and last time of what was recorded, s.
    #[must_use]
    pub fn span_s(&self) -> Option<Range<f64>> {
        let states = self.states.iter().map(|track| &track.times_s);
        let segments = self.tethers.iter().flat_map(|tether| &tether.segments);
        let channels = self.channels.iter().map(|track| &track.times_s);
        states
            .chain(segments.map(|track| &track.times_s))
            .chain(channels)
            .filter_map(|times| Some((*times.first()?, *times.last()?)))
            .reduce(|(start, end), (first, last)| (start.min(first), end.max(last)))
            .map(|(start, end)| start..end)
    }

    pub(super) fn take_state(&mut self, time_s: f64, name: &str, row: State) -> Taken {
        let place = place_of(&mut self.places.states, name, &mut self.states, |name| {
            StateTrack {
                name,
                ..StateTrack::default()
            }
        });
        let track = &mut self.states[place];
        follow(&mut track.times_s, time_s)?;
        track.positions_m.push(row.position_m);
        track.velocities_m_s.push(row.velocity_m_s);
        track.rotations.extend(row.rotation);
        Ok(())
    }

    pub(super) fn take_segment(
        &mut self,
        time_s: f64,
        name: &str,
        number: usize,
        (tension_n, length_m): (f64, f64),
    ) -> Taken {
        let place = place_of(&mut self.places.tethers, name, &mut self.tethers, |name| {
            TetherTrack {
                name,
                segments: Vec::new(),
            }
        });
        let segments = &mut self.tethers[place].segments;
        // Rows of one time are in the order of their numbers, so that a number is new by one at most.
        if number == 0 || number > segments.len() + 1 {
            return Err("a tether has its segments in the order 1, 2, ...");
        }
        if number > segments.len() {
            segments.push(SegmentTrack::default());
        }
        let track = &mut segments[number - 1];
        follow(&mut track.times_s, time_s)?;
        track.tensions_n.push(tension_n);
        track.lengths_m.push(length_m);
        Ok(())
    }

    pub(super) fn take_channel(
        &mut self,
        time_s: f64,
        entity: &str,
        channel: &str,
        value: f64,
    ) -> Taken {
        let key = (entity.to_owned(), channel.to_owned());
        let place = *self.places.channels.entry(key).or_insert_with_key(|key| {
            self.channels.push(ChannelTrack {
                entity: key.0.clone(),
                channel: key.1.clone(),
                ..ChannelTrack::default()
            });
            self.channels.len() - 1
        });
        let track = &mut self.channels[place];
        follow(&mut track.times_s, time_s)?;
        track.values.push(value);
        Ok(())
    }
}

/// Whether a row is as a run writes it, or why not.
pub(super) type Taken = Result<(), &'static str>;

/// Times of one track do not go back.
fn follow(times_s: &mut Vec<f64>, time_s: f64) -> Taken {
    if times_s.last().is_some_and(|last| *last > time_s) {
        return Err("time goes back");
    }
    times_s.push(time_s);
    Ok(())
}

fn place_of<T>(
    places: &mut HashMap<String, usize>,
    name: &str,
    tracks: &mut Vec<T>,
    new: impl FnOnce(String) -> T,
) -> usize {
    if let Some(place) = places.get(name) {
        return *place;
    }
    tracks.push(new(name.to_owned()));
    places.insert(name.to_owned(), tracks.len() - 1);
    tracks.len() - 1
}

impl ResultSink for Tables {
    fn take(&mut self, frame: &Frame) -> io::Result<()> {
        for row in &frame.states {
            let state = State {
                position_m: row.position_m,
                velocity_m_s: row.velocity_m_s,
                rotation: row.rotation,
            };
            self.take_state(frame.time_s, &row.entity, state)
                .map_err(io::Error::other)?;
        }
        for row in &frame.segments {
            let values = (row.tension_n, row.length_m);
            self.take_segment(frame.time_s, &row.tether, row.segment as usize, values)
                .map_err(io::Error::other)?;
        }
        for row in &frame.channels {
            self.take_channel(frame.time_s, &row.entity, row.channel, row.value)
                .map_err(io::Error::other)?;
        }
        Ok(())
    }
}
