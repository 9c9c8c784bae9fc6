//! What metrics and envelopes look at: a number of the rows of an instant.

use crate::recording::frame::{Frame, StateRow};
use crate::scene::source::lacks_unit;

/// A number that is recorded of an entity.
///
/// Of bodies, anchors and nodes the columns of `states.csv`; of tethers `tension_n` and `length_m`; of all of
/// them their channels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// Name of the entity or tether; `system` for channels of the whole.
    pub entity: String,
    /// Name of the channel or column, which ends with its unit.
    pub channel: String,
    /// Segment of a tether, from 1; the largest of all segments unless given.
    pub segment: Option<u32>,
}

impl Quantity {
    /// Its value in the rows of an instant, if they have it.
    #[must_use]
    pub fn read(&self, frame: &Frame) -> Option<f64> {
        self.of_segments(frame)
            .or_else(|| {
                let row = frame
                    .states
                    .iter()
                    .find(|row| *row.entity == *self.entity)?;
                of_state(row, &self.channel)
            })
            .or_else(|| {
                let is_it = |row: &&crate::recording::frame::ChannelRow| {
                    row.channel == self.channel && *row.entity == *self.entity
                };
                frame.channels.iter().find(is_it).map(|row| row.value)
            })
            .filter(|value| value.is_finite())
            // Minus zero reads as a difference where there is none.
            .map(|value| value + 0.0)
    }

    fn of_segments(&self, frame: &Frame) -> Option<f64> {
        let is_tension = self.channel == "tension_n";
        if !is_tension && self.channel != "length_m" {
            return None;
        }
        let rows = frame.segments.iter().filter(|row| {
            *row.tether == *self.entity && self.segment.is_none_or(|number| number == row.segment)
        });
        rows.map(|row| {
            if is_tension {
                row.tension_n
            } else {
                row.length_m
            }
        })
        .reduce(f64::max)
    }

    /// The unit at the end of the channel's name, as `m_s` of `vx_m_s`; empty if it has none.
    #[must_use]
    pub fn unit(&self) -> &str {
        unit_of(&self.channel)
    }
}

/// The unit at the end of a name; empty if it has none.
#[must_use]
pub fn unit_of(name: &str) -> &str {
    let parts = name.match_indices('_').map(|(at, _)| name.split_at(at));
    let unit = parts.map(|(plain, rest)| (plain, &rest[1..]));
    let mut unit = unit.filter(|(plain, _)| lacks_unit(plain, name));
    unit.next().map_or("", |(_, unit)| unit)
}

/// A unit at the end of a name as it is written by itself: `m/s` for `m_s`. What may be read in two ways, as
/// `n_m`, stays as it is.
#[must_use]
pub fn unit_symbol(unit: &str) -> String {
    let symbol = match unit {
        "n" => "N",
        "pa" => "Pa",
        "k" => "K",
        "j" => "J",
        "w" => "W",
        "v" => "V",
        "a" => "A",
        "hz" => "Hz",
        "m_s" => "m/s",
        "m_s2" => "m/s2",
        "rad_s" => "rad/s",
        "rad_s2" => "rad/s2",
        "kg_m3" => "kg/m3",
        "kg_m2" => "kg m2",
        "kg_m_s" => "kg m/s",
        "per_s" => "1/s",
        _ => unit,
    };
    symbol.to_owned()
}

fn of_state(row: &StateRow, column: &str) -> Option<f64> {
    let (position, velocity) = (row.position_m, row.velocity_m_s);
    Some(match column {
        "x_m" => position.x,
        "y_m" => position.y,
        "z_m" => position.z,
        "vx_m_s" => velocity.x,
        "vy_m_s" => velocity.y,
        "vz_m_s" => velocity.z,
        "qx" => row.rotation?.0.x,
        "qy" => row.rotation?.0.y,
        "qz" => row.rotation?.0.z,
        "qw" => row.rotation?.0.w,
        "wx_rad_s" => row.rotation?.1.x,
        "wy_rad_s" => row.rotation?.1.y,
        "wz_rad_s" => row.rotation?.1.z,
        _ => return None,
    })
}

/// Everything that the rows of an instant have, as `channel of entity`, for messages.
pub(super) fn recorded(frame: &Frame) -> Vec<(String, String)> {
    let mut found = Vec::new();
    for row in &frame.states {
        for column in [
            "x_m", "y_m", "z_m", "vx_m_s", "vy_m_s", "vz_m_s", "wx_rad_s", "wy_rad_s", "wz_rad_s",
        ] {
            if of_state(row, column).is_some() {
                found.push((row.entity.to_string(), column.to_owned()));
            }
        }
    }
    for row in frame.segments.iter().filter(|row| row.segment == 1) {
        for channel in ["tension_n", "length_m"] {
            found.push((row.tether.to_string(), channel.to_owned()));
        }
    }
    for row in &frame.channels {
        found.push((row.entity.to_string(), row.channel.to_owned()));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_the_end_of_a_name() {
        for (name, unit) in [
            ("swing_x_rad", "rad"),
            ("vx_m_s", "m_s"),
            ("torsion_n_m", "n_m"),
            ("density_kg_m3", "kg_m3"),
            ("momentum_x_kg_m_s", "kg_m_s"),
            ("impulse_x_n_s", "n_s"),
            ("qw", ""),
            ("x_m", "m"),
        ] {
            assert_eq!(unit_of(name), unit, "{name}");
        }
    }
}
