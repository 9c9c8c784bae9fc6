//! The points of tethers, frame by frame: attachments on bodies that turn, and nodes.

use aerobot_components::tether::{Tether, TetherSide};
use aerobot_components::winch::Winch;
use aerobot_engine::geometry::TetherEndPlace;
use glam::DVec3;

use super::{BodyMotion, TetherMotion};
use crate::record::{Record, StateTrack, TetherTrack};

/// Every tether of which segments were recorded.
pub(super) fn motions(
    record: &Record,
    times_s: &[f64],
    bodies: &[BodyMotion],
) -> Vec<TetherMotion> {
    let tethers = record.tables.tethers.iter();
    tethers
        .filter_map(|track| motion(record, times_s, bodies, track))
        .collect()
}

fn motion(
    record: &Record,
    times_s: &[f64],
    bodies: &[BodyMotion],
    track: &TetherTrack,
) -> Option<TetherMotion> {
    let [from, to] = record.geometry.tether_ends.get(&track.name)?;
    let entity = record.scene.entity(&track.name)?;
    let tether = entity.get::<Tether>()?;
    let numbered_from_end = entity
        .get::<Winch>()
        .is_some_and(|winch| winch.end == TetherSide::From);
    let cuts = Cut::of(record, track);
    let count = track.segments.len();
    let nodes: Vec<Option<&StateTrack>> = (1..=count)
        .map(|number| record.tables.state(&format!("{}/{number}", track.name)))
        .collect();
    if count > 1 && nodes.iter().all(Option::is_none) {
        // Where its line was is not known.
        return None;
    }
    let mut points_m = Vec::with_capacity(times_s.len());
    let mut tensions_n = Vec::with_capacity(times_s.len());
    for (frame, time_s) in times_s.iter().enumerate() {
        let mut points = vec![end_m(bodies, from, frame)?];
        let mut tensions = Vec::with_capacity(count);
        let number_now = |cut: &Cut| cut.number_at(track, *time_s, numbered_from_end);
        let cut_now: Vec<usize> = cuts.iter().filter_map(number_now).collect();
        for (index, segment) in track.segments.iter().enumerate() {
            let node = nodes[index].and_then(|node| node.position_at_m(*time_s));
            let tension = segment
                .tension_at_n(*time_s)
                .filter(|_| !cut_now.contains(&(index + 1)));
            tensions.push(tension);
            points.push(match (node, tension) {
                (Some(node), _) => node,
                (None, Some(_)) => end_m(bodies, to, frame)?,
                (None, None) => points[index],
            });
        }
        points_m.push(points);
        tensions_n.push(tensions);
    }
    Some(TetherMotion {
        name: track.name.clone(),
        diameter_m: tether.diameter_m,
        points_m,
        tensions_n,
    })
}

/// A segment that was cut. It stays in the tables, without tension, between ends that part.
struct Cut {
    time_s: f64,
    /// Its number from 1, as the event tells it.
    number: usize,
    /// Segments beyond it then.
    beyond: usize,
}

impl Cut {
    /// What was cut of a tether.
    fn of(record: &Record, track: &TetherTrack) -> Vec<Self> {
        let events = record.summary.events.iter();
        events
            .filter(|event| event.kind == "cut")
            .filter_map(|event| {
                let number = event.entity.strip_prefix(&track.name)?.strip_prefix('/')?;
                let number: usize = number.parse().ok()?;
                Some(Self {
                    time_s: event.time_s,
                    number,
                    beyond: segments_at(track, event.time_s).saturating_sub(number),
                })
            })
            .collect()
    }

    /// Its number at a time (s); nothing before it is cut. A winch at `from` numbers the line anew as it
    /// turns: what is beyond the segment stays. (One that divides its line between the cut and the record
    /// before makes this wrong by one.)
    fn number_at(&self, track: &TetherTrack, time_s: f64, from_end: bool) -> Option<usize> {
        if time_s < self.time_s {
            return None;
        }
        if !from_end {
            return Some(self.number);
        }
        segments_at(track, time_s).checked_sub(self.beyond)
    }
}

/// How many segments a tether has at a time (s).
fn segments_at(track: &TetherTrack, time_s: f64) -> usize {
    let there = track.segments.iter();
    there
        .filter(|segment| segment.tension_at_n(time_s).is_some())
        .count()
}

/// Place of an attachment in a frame, inertial, m.
fn end_m(bodies: &[BodyMotion], end: &TetherEndPlace, frame: usize) -> Option<DVec3> {
    let body = bodies.iter().find(|body| body.name == end.carrier)?;
    Some(body.positions_m[frame] + body.attitudes[frame] * end.offset_m)
}
