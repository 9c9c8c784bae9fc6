//! The points of tethers, frame by frame: attachments on bodies that turn, and nodes.

use aerobot_components::tether::Tether;
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
    let tether = record.scene.entity(&track.name)?.get::<Tether>()?;
    let count = track.segments.len();
    let nodes: Vec<Option<&StateTrack>> = (1..=count)
        .map(|number| record.tables.state(&format!("{}/{number}", track.name)))
        .collect();
    let mut points_m = Vec::with_capacity(times_s.len());
    let mut tensions_n = Vec::with_capacity(times_s.len());
    for (frame, time_s) in times_s.iter().enumerate() {
        let mut points = vec![end_m(bodies, from, frame)?];
        let mut tensions = Vec::with_capacity(count);
        for (index, segment) in track.segments.iter().enumerate() {
            let node = nodes[index].and_then(|node| node.position_at_m(*time_s));
            let tension = segment.tension_at_n(*time_s);
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

/// Place of an attachment in a frame, inertial, m.
fn end_m(bodies: &[BodyMotion], end: &TetherEndPlace, frame: usize) -> Option<DVec3> {
    let body = bodies.iter().find(|body| body.name == end.carrier)?;
    Some(body.positions_m[frame] + body.attitudes[frame] * end.offset_m)
}
