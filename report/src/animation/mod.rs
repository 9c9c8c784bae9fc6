//! How a run moves: bodies with their shapes, tethers with their tensions, and the wind, frame by frame.
//!
//! A view in a page, a glTF file and a VTK series are three ways to write the same [`Animation`].

pub mod appearance;
mod frames;
#[cfg(test)]
mod tests;
mod tethers;
mod winds;

use aerobot_components::fixed_wing::FixedWing;
use glam::{DQuat, DVec3};

use crate::record::Record;
use appearance::{Part, parts};

/// A run, frame by frame. Everything has a value in every frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Animation {
    /// Times of the frames, s.
    pub times_s: Vec<f64>,
    /// Bodies and anchors.
    pub bodies: Vec<BodyMotion>,
    /// Tethers.
    pub tethers: Vec<TetherMotion>,
    /// Events in the order of time: when (s), and what happened to whom.
    pub events: Vec<(f64, String)>,
}

/// A body or an anchor.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyMotion {
    /// Its name.
    pub name: String,
    /// What it looks like.
    pub parts: Vec<Part>,
    /// Positions of its centre of mass, inertial frame, m, one for each frame.
    pub positions_m: Vec<DVec3>,
    /// Attitudes, body to inertial, one for each frame, each in the hemisphere of the one before.
    pub attitudes: Vec<DQuat>,
    /// Velocity of the air that it is in, inertial frame, m/s, one for each frame.
    pub wind_m_s: Vec<DVec3>,
}

/// A tether.
#[derive(Clone, Debug, PartialEq)]
pub struct TetherMotion {
    /// Its name.
    pub name: String,
    /// Diameter, m; zero where the scene gives none.
    pub diameter_m: f64,
    /// For each frame its points from `from` to `to`, inertial frame, m: one more than segments. A point
    /// that is not there in a frame is at the place of the one before it.
    pub points_m: Vec<Vec<DVec3>>,
    /// For each frame the tension of each segment, N; nothing where the segment is not there.
    pub tensions_n: Vec<Vec<Option<f64>>>,
}

impl Animation {
    /// The animation of a run with at most so many frames, among them the first, the last, and those
    /// nearest to the largest tension and to events.
    #[must_use]
    pub fn of(record: &Record, most_frames: usize) -> Self {
        let times_s = frames::times_s(record, most_frames);
        let mut bodies: Vec<BodyMotion> = record
            .tables
            .bodies()
            .filter_map(|track| {
                let entity = record.scene.entity(&track.name)?;
                let positions = times_s.iter().map(|time_s| track.position_at_m(*time_s));
                let attitudes = times_s.iter().map(|time_s| track.attitude_at(*time_s));
                Some(BodyMotion {
                    name: track.name.clone(),
                    parts: parts(entity, &record.geometry),
                    positions_m: positions.collect::<Option<_>>()?,
                    attitudes: one_hemisphere(attitudes.collect::<Option<_>>()?),
                    wind_m_s: Vec::new(),
                })
            })
            .collect();
        winds::blow(record, &times_s, &mut bodies);
        for body in &mut bodies {
            let own = record.scene.entity(&body.name);
            if let Some(drone) = own.and_then(|entity| entity.get::<FixedWing>()) {
                for wind_m_s in &mut body.wind_m_s {
                    *wind_m_s = drone.wind.velocity_m_s(*wind_m_s);
                }
            }
        }
        let tethers = tethers::motions(record, &times_s, &bodies);
        let events = record.summary.events.iter();
        Self {
            bodies,
            tethers,
            events: events
                .map(|event| (event.time_s, format!("{}: {}", event.entity, event.kind)))
                .collect(),
            times_s,
        }
    }

    /// Whether there is nothing to see: neither a body nor a node.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        let mut points = self.tethers.iter().flat_map(|tether| &tether.points_m);
        self.bodies.is_empty() && points.all(Vec::is_empty)
    }

    /// Least and greatest tension of any segment in any frame, N; nothing without tethers.
    #[must_use]
    pub fn tension_range_n(&self) -> Option<(f64, f64)> {
        let frames = self.tethers.iter().flat_map(|tether| &tether.tensions_n);
        let tensions = frames.flatten().flatten();
        tensions.fold(None, |range: Option<(f64, f64)>, tension| {
            let (least, most) = range.unwrap_or((*tension, *tension));
            Some((least.min(*tension), most.max(*tension)))
        })
    }
}

/// The same attitudes with signs such that neighbours are interpolated the short way round.
fn one_hemisphere(mut attitudes: Vec<DQuat>) -> Vec<DQuat> {
    for index in 1..attitudes.len() {
        if attitudes[index].dot(attitudes[index - 1]) < 0.0 {
            attitudes[index] = -attitudes[index];
        }
    }
    attitudes
}
