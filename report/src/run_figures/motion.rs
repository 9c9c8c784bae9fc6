//! Where bodies go and how they turn.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};

use super::nothing;
use crate::figure::{Axis, Figure, Panel, Series};
use crate::record::{Record, StateTrack};

const AXES: [&str; 3] = ["x", "y", "z"];

/// Bodies that are ever anywhere else than at the start, with their places in the order of all.
fn moving(record: &Record) -> Vec<(usize, &StateTrack)> {
    let bodies = record.tables.bodies().enumerate();
    bodies
        .filter(|(_, body)| {
            let first = (body.positions_m[0], body.rotations[0].0);
            let states = body.positions_m.iter().zip(&body.rotations);
            states
                .clone()
                .any(|(place, (turn, _))| (*place, *turn) != first)
        })
        .collect()
}

fn over_time(body: &StateTrack, values: impl Iterator<Item = f64>) -> Vec<(f64, f64)> {
    body.times_s.iter().copied().zip(values).collect()
}

/// Displacement from the start.
pub(super) fn displacement(record: &Record) -> Result<Figure, String> {
    let bodies = moving(record);
    if bodies.is_empty() {
        return nothing("no body moves");
    }
    let panels = AXES.iter().enumerate().map(|(axis, name)| Panel {
        x: Axis::time(),
        y: Axis::new(format!("{name} displacement [m]")),
        series: bodies
            .iter()
            .map(|(place, body)| {
                let start = body.positions_m[0];
                let values = body.positions_m.iter().map(|at| (*at - start)[axis]);
                Series::line(&body.name, over_time(body, values)).with_tone(*place)
            })
            .collect(),
        ..Panel::default()
    });
    Ok(Figure {
        title: "Displacement from the start".to_owned(),
        caption: "x downwind, y to its left, z up.".to_owned(),
        panels: panels.collect(),
        ..Figure::default()
    })
}

/// Altitude.
pub(super) fn altitude(record: &Record) -> Result<Figure, String> {
    let series = record.tables.bodies().enumerate().map(|(place, body)| {
        let values = body.positions_m.iter().map(|at| at.z);
        Series::line(&body.name, over_time(body, values)).with_tone(place)
    });
    let series: Vec<Series> = series.collect();
    if series.is_empty() {
        return nothing("there is no body");
    }
    Ok(Figure {
        title: "Altitude".to_owned(),
        panels: vec![Panel {
            x: Axis::time(),
            y: Axis::new("altitude [m]"),
            series,
            ..Panel::default()
        }],
        ..Figure::default()
    })
}

/// Yaw, pitch and roll, unwound.
pub(super) fn attitude(record: &Record) -> Result<Figure, String> {
    let turns = |body: &StateTrack| {
        let first = body.rotations[0].0;
        body.rotations.iter().any(|(turn, _)| *turn != first)
    };
    let mut bodies = moving(record);
    bodies.retain(|(_, body)| turns(body));
    if bodies.is_empty() {
        return nothing("no body turns");
    }
    let names = ["yaw", "pitch", "roll"];
    let panels = names.iter().enumerate().map(|(index, name)| Panel {
        x: Axis::time(),
        y: Axis::new(format!("{name} [deg]")),
        series: bodies
            .iter()
            .map(|(place, body)| {
                let angles = body.rotations.iter();
                let angles = angles.map(|(attitude, _)| yaw_pitch_roll(*attitude)[index]);
                let degrees = unwound(angles).into_iter().map(f64::to_degrees);
                Series::line(&body.name, over_time(body, degrees)).with_tone(*place)
            })
            .collect(),
        ..Panel::default()
    });
    Ok(Figure {
        title: "Attitude".to_owned(),
        caption: "Yaw about z, then pitch about y, then roll about x; turns are counted."
            .to_owned(),
        panels: panels.collect(),
        ..Figure::default()
    })
}

/// Yaw, pitch and roll (rad) of an attitude Rz(yaw) Ry(pitch) Rx(roll).
pub(super) fn yaw_pitch_roll(attitude: DQuat) -> [f64; 3] {
    let x = attitude * DVec3::X;
    let (y, z) = (attitude * DVec3::Y, attitude * DVec3::Z);
    [
        libm::atan2(x.y, x.x),
        libm::asin((-x.z).clamp(-1.0, 1.0)),
        libm::atan2(y.z, z.z),
    ]
}

/// Angles with whole turns added so that neighbours are less than half a turn apart.
pub(super) fn unwound(angles: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut last: Option<f64> = None;
    angles
        .map(|angle| {
            let near = last.map_or(angle, |last| angle + TAU * ((last - angle) / TAU).round());
            last = Some(near);
            near
        })
        .collect()
}

/// The paths of bodies from above.
pub(super) fn path(record: &Record) -> Result<Figure, String> {
    let bodies = moving(record);
    let largest = |axis: usize| {
        let places = bodies.iter().flat_map(|(_, body)| &body.positions_m);
        places
            .map(|at| at[axis])
            .fold((f64::MAX, f64::MIN), |(low, high), x| {
                (low.min(x), high.max(x))
            })
    };
    let spans = [largest(0), largest(1)].map(|(low, high)| high - low);
    if bodies.is_empty() || spans.iter().all(|span| *span < 1e-6) {
        return nothing("no body moves level");
    }
    let series = bodies.iter().map(|(place, body)| {
        Series::line(&body.name, body.positions_m.iter().map(|at| (at.x, at.y))).with_tone(*place)
    });
    // Far along the wind and little across it would be a line.
    let equal_axes = spans[0] < 5.0 * spans[1] && spans[1] < 5.0 * spans[0];
    Ok(Figure {
        title: "Paths from above".to_owned(),
        caption: match equal_axes {
            true => String::new(),
            false => "The axes have different scales.".to_owned(),
        },
        panels: vec![Panel {
            x: Axis::new("x [m]"),
            y: Axis::new("y [m]"),
            equal_axes,
            series: series.collect(),
            ..Panel::default()
        }],
        ..Figure::default()
    })
}

/// The way of each drone with a `Docking` in the frame of what it docks with: distance and place.
pub(super) fn docking(record: &Record) -> Result<Figure, String> {
    use aerobot_components::docking::Latch;
    let mut distance = Vec::new();
    let mut beside = Vec::new();
    for (place, (entity, latch)) in record.scene.with::<Latch>().enumerate() {
        let tables = &record.tables;
        let (Some(drone), Some(target)) = (tables.state(&entity.name), tables.state(&latch.to))
        else {
            continue;
        };
        let relative: Vec<(f64, DVec3)> = drone
            .times_s
            .iter()
            .zip(&drone.positions_m)
            .filter_map(|(time_s, at)| {
                let (origin, turn) = (target.position_at_m(*time_s)?, target.attitude_at(*time_s)?);
                Some((*time_s, turn.inverse() * (*at - origin)))
            })
            .collect();
        let far = relative.iter().map(|(time_s, at)| (*time_s, at.length()));
        distance.push(Series::line(&entity.name, far).with_tone(place));
        for (axis, name) in AXES.iter().enumerate() {
            let along = relative.iter().map(|(time_s, at)| (*time_s, at[axis]));
            let name = format!("{}, {name}", entity.name);
            beside.push(Series::line(name, along).with_tone(3 * place + axis + 1));
        }
    }
    if distance.is_empty() {
        return nothing("no body has a `Latch`");
    }
    let panel = |label: &str, series| Panel {
        x: Axis::time(),
        y: Axis::new(label),
        series,
        ..Panel::default()
    };
    Ok(Figure {
        title: "Way to the port".to_owned(),
        caption: "Centre of the drone from the centre of what it docks with, in that body's frame."
            .to_owned(),
        panels: vec![panel("distance [m]", distance), panel("place [m]", beside)],
        ..Figure::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_those_of_the_turns() {
        let attitude = DQuat::from_rotation_z(0.7)
            * DQuat::from_rotation_y(-0.4)
            * DQuat::from_rotation_x(1.1);
        let found = yaw_pitch_roll(attitude);
        for (found, angle) in found.iter().zip([0.7, -0.4, 1.1]) {
            assert!((found - angle).abs() < 1e-12);
        }
    }

    #[test]
    fn turns_are_counted() {
        let steps = (0..100).map(|index| 0.3 * f64::from(index));
        let wrapped = steps
            .clone()
            .map(|angle| libm::atan2(libm::sin(angle), libm::cos(angle)));
        for (found, angle) in unwound(wrapped).iter().zip(steps) {
            assert!((found - angle).abs() < 1e-9);
        }
    }
}
