//! What a comparison keeps of a run while it is written: positions of bodies and tensions of segments.

use std::collections::BTreeMap;
use std::io;
use std::sync::Arc;

use aerobot_components::body::Anchor;
use aerobot_components::state::Attitude;
use aerobot_components::tether::TetherParts;
use aerobot_engine::recording::frame::{Frame, ResultSink};
use aerobot_engine::world::{EntityName, SceneEntities};
use bevy_ecs::world::World;
use glam::DVec3;

/// The way of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyTrack {
    /// Name of the body.
    pub name: Arc<str>,
    /// When it was recorded, s.
    pub times_s: Vec<f64>,
    /// Where it was then, m.
    pub positions_m: Vec<DVec3>,
}

/// The tensions of a tether.
#[derive(Clone, Debug, PartialEq)]
pub struct TetherTrack {
    /// Name of the tether.
    pub name: Arc<str>,
    /// Number of its segments.
    pub segments: usize,
    /// When it was recorded, s.
    pub times_s: Vec<f64>,
    /// The tension of each segment from `from` on, N, time after time.
    pub tensions_n: Vec<f64>,
}

impl TetherTrack {
    /// The tensions of all segments at the time of a number, N.
    #[must_use]
    pub fn tensions_at(&self, number: usize) -> &[f64] {
        let start = number * self.segments;
        self.tensions_n
            .get(start..start + self.segments)
            .unwrap_or_default()
    }
}

/// Everything that is kept of a run, in the order of the scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tracks {
    /// The bodies that are free to move.
    pub bodies: Vec<BodyTrack>,
    /// The tethers.
    pub tethers: Vec<TetherTrack>,
    body_places: BTreeMap<Arc<str>, usize>,
    tether_places: BTreeMap<Arc<str>, usize>,
}

impl Tracks {
    /// Empty tracks for what is in a world.
    #[must_use]
    pub fn of(world: &World) -> Self {
        let mut tracks = Self::default();
        let Some(entities) = world.get_resource::<SceneEntities>() else {
            return tracks;
        };
        for &entity in entities.in_order() {
            let Some(EntityName(name)) = world.get(entity) else {
                continue;
            };
            if let Some(parts) = world.get::<TetherParts>(entity) {
                let place = tracks.tethers.len();
                tracks.tether_places.insert(name.clone(), place);
                tracks.tethers.push(TetherTrack {
                    name: name.clone(),
                    segments: parts.segments.len(),
                    times_s: Vec::new(),
                    tensions_n: Vec::new(),
                });
            }
            if world.get::<Attitude>(entity).is_some() && world.get::<Anchor>(entity).is_none() {
                let place = tracks.bodies.len();
                tracks.body_places.insert(name.clone(), place);
                tracks.bodies.push(BodyTrack {
                    name: name.clone(),
                    times_s: Vec::new(),
                    positions_m: Vec::new(),
                });
            }
        }
        tracks
    }
}

impl ResultSink for Tracks {
    fn take(&mut self, frame: &Frame) -> io::Result<()> {
        for row in frame.states.iter().filter(|row| row.rotation.is_some()) {
            let place = self.body_places.get(&row.entity);
            if let Some(track) = place.and_then(|place| self.bodies.get_mut(*place)) {
                track.times_s.push(frame.time_s);
                track.positions_m.push(row.position_m);
            }
        }
        for rows in frame.segments.chunk_by(|a, b| a.tether == b.tether) {
            let place = rows
                .first()
                .and_then(|row| self.tether_places.get(&row.tether));
            if let Some(track) = place.and_then(|place| self.tethers.get_mut(*place)) {
                track.times_s.push(frame.time_s);
                track
                    .tensions_n
                    .extend(rows.iter().map(|row| row.tension_n));
            }
        }
        Ok(())
    }
}
