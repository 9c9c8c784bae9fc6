//! The moment when the latch closes: what moved before it and after it.

use aerobot_engine::recording::frame::{Frame, StateRow};
use glam::DVec3;

use super::super::flight::Flight;
use super::{Craft, DRONE, GONDOLA, state};

/// Drone and gondola when the latch closes, each side of it by the straight line through the two nearest outputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// When, s.
    pub time_s: f64,
    /// Momentum of both before it, kg m/s.
    pub before_kg_m_s: DVec3,
    /// Momentum of both after it, kg m/s.
    pub after_kg_m_s: DVec3,
    /// Velocity of the drone's centre of mass against the gondola's before it, m/s.
    pub drone_m_s: DVec3,
    /// Speed of one port against the other before it, m/s.
    pub ports_m_s: f64,
    /// That which the simulation has recorded, m/s.
    pub recorded_m_s: f64,
}

impl Impact {
    /// The impact at a time, s; nothing without two outputs on either side.
    pub(super) fn of(flight: &Flight, craft: &Craft, time_s: f64) -> Option<Self> {
        let frames = &flight.results.frames;
        // What is recorded at the very moment is of either side.
        let first_after = frames
            .iter()
            .position(|frame| frame.time_s > time_s + 1e-9)?;
        let last_before = frames
            .iter()
            .rposition(|frame| frame.time_s < time_s - 1e-9)?;
        let before = [last_before.checked_sub(1)?, last_before].map(|index| &frames[index]);
        let after = [frames.get(first_after)?, frames.get(first_after + 1)?];
        let at = |pair: [&Frame; 2], of: &dyn Fn(&Frame) -> Option<DVec3>| {
            let (a, b) = (of(pair[0])?, of(pair[1])?);
            let part = (time_s - pair[0].time_s) / (pair[1].time_s - pair[0].time_s);
            Some(a + part * (b - a))
        };
        let momentum = |frame: &Frame| {
            let (drone, gondola) = (state(frame, DRONE)?, state(frame, GONDOLA)?);
            Some(craft.drone_kg * drone.velocity_m_s + craft.gondola_kg * gondola.velocity_m_s)
        };
        let against = |frame: &Frame| {
            Some(state(frame, DRONE)?.velocity_m_s - state(frame, GONDOLA)?.velocity_m_s)
        };
        let of_ports = |frame: &Frame| {
            let drone = port_velocity(state(frame, DRONE)?, craft.drone_port_m)?;
            Some(drone - port_velocity(state(frame, GONDOLA)?, craft.gondola_port_m)?)
        };
        let last = frames.last()?.channels.iter();
        let mut recorded = last.filter(|row| row.channel == "contact_speed_m_s");
        Some(Self {
            time_s,
            before_kg_m_s: at(before, &momentum)?,
            after_kg_m_s: at(after, &momentum)?,
            drone_m_s: at(before, &against)?,
            ports_m_s: at(before, &of_ports)?.length(),
            recorded_m_s: recorded.next()?.value,
        })
    }

    /// What the momentum of both changes by along the horizontal, kg m/s.
    #[must_use]
    pub fn change_kg_m_s(&self) -> f64 {
        (self.after_kg_m_s - self.before_kg_m_s).truncate().length()
    }

    /// What one body gives to the other along the horizontal, kg m/s: the reduced mass times their velocity against each
    /// other, if they do not turn.
    #[must_use]
    pub fn exchanged_kg_m_s(&self, craft: &Craft) -> f64 {
        let reduced_kg = craft.drone_kg * craft.gondola_kg / (craft.drone_kg + craft.gondola_kg);
        reduced_kg * self.drone_m_s.truncate().length()
    }
}

/// Velocity of a place on a body, inertial frame, m/s.
fn port_velocity(row: &StateRow, port_m: DVec3) -> Option<DVec3> {
    let (attitude, rate_rad_s) = row.rotation?;
    Some(row.velocity_m_s + attitude * rate_rad_s.cross(port_m))
}
