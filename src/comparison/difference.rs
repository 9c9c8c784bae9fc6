//! Differences between two tracks of one thing, at the times that both have.

use std::sync::Arc;

use aerobot_components::run::{Cadence, RecordSpec};
use glam::DVec3;

use super::tracks::{BodyTrack, TetherTrack, Tracks};

/// A number and when it was reached.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct At {
    /// The number, in the unit of its owner.
    pub value: f64,
    /// When, s.
    pub time_s: f64,
}

/// A tension, or a difference of tensions, and where and when it was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TensionAt {
    /// The number, N.
    pub value_n: f64,
    /// When, s.
    pub time_s: f64,
    /// In which segment, from 1 at `from`.
    pub segment: usize,
}

/// How far apart a body is in two runs.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyDifference {
    /// Name of the body.
    pub name: Arc<str>,
    /// Time (s) and difference of positions (m).
    pub differences_m: Vec<(f64, DVec3)>,
    /// The difference of largest size on each axis, m.
    pub largest_m: [At; 3],
    /// The largest distance, m.
    pub largest_distance_m: At,
    /// Time (s) and difference (m) at the end.
    pub last: (f64, DVec3),
}

/// How differently a tether pulls in two runs.
#[derive(Clone, Debug, PartialEq)]
pub struct TetherDifference {
    /// Name of the tether.
    pub name: Arc<str>,
    /// The largest tension in each run.
    pub largest_tension_n: [TensionAt; 2],
    /// The difference of largest size in one segment.
    pub largest_difference_n: TensionAt,
    /// The same at the end alone.
    pub final_difference_n: TensionAt,
}

/// The differences of all bodies; and of what there is none, as sentences.
pub(super) fn body_differences(
    tracks: [&Tracks; 2],
    recorded: &RecordSpec,
) -> (Vec<BodyDifference>, Vec<String>) {
    let [first, second] = tracks.map(|tracks| tracks.bodies.as_slice());
    let of = |a: &BodyTrack, b: &BodyTrack| body_difference(a, b);
    let never = (recorded.bodies == Cadence::Never && !first.is_empty())
        .then(|| "positions are not compared: `run.record.bodies` is `Never`".to_owned());
    matched(first, second, |track| &track.name, of, never)
}

/// The differences of all tethers; and of what there is none, as sentences.
pub(super) fn tether_differences(
    tracks: [&Tracks; 2],
    recorded: &RecordSpec,
) -> (Vec<TetherDifference>, Vec<String>) {
    let [first, second] = tracks.map(|tracks| tracks.tethers.as_slice());
    let of = |a: &TetherTrack, b: &TetherTrack| tether_difference(a, b);
    let never = (recorded.tethers == Cadence::Never && !first.is_empty())
        .then(|| "tensions are not compared: `run.record.tethers` is `Never`".to_owned());
    matched(first, second, |track| &track.name, of, never)
}

/// What `difference` finds between tracks of one name; and the names for which it finds nothing, unless
/// `never` says it for all.
fn matched<T, D>(
    first: &[T],
    second: &[T],
    name: impl Fn(&T) -> &Arc<str>,
    difference: impl Fn(&T, &T) -> Option<D>,
    never: Option<String>,
) -> (Vec<D>, Vec<String>) {
    if let Some(never) = never {
        return (Vec::new(), vec![never]);
    }
    let (mut found, mut missing) = (Vec::new(), Vec::new());
    for track in first {
        let other = second.iter().find(|other| name(other) == name(track));
        match other.and_then(|other| difference(track, other)) {
            Some(difference) => found.push(difference),
            None => missing.push(format!(
                "`{}` is not compared: no time was recorded in both runs",
                name(track)
            )),
        }
    }
    (found, missing)
}

/// The places of the times that both have, in each.
fn shared(first: &[f64], second: &[f64]) -> Vec<(usize, usize)> {
    let (mut i, mut j) = (0, 0);
    let mut places = Vec::with_capacity(first.len().min(second.len()));
    // Rows stand at exact multiples of a period, in every run at the same.
    while let (Some(a), Some(b)) = (first.get(i), second.get(j)) {
        if a == b {
            places.push((i, j));
        }
        (i, j) = (i + usize::from(a <= b), j + usize::from(b <= a));
    }
    places
}

fn body_difference(first: &BodyTrack, second: &BodyTrack) -> Option<BodyDifference> {
    let differences_m: Vec<(f64, DVec3)> = shared(&first.times_s, &second.times_s)
        .into_iter()
        .filter_map(|(i, j)| {
            let (a, b) = (first.positions_m.get(i)?, second.positions_m.get(j)?);
            Some((*first.times_s.get(i)?, *b - *a))
        })
        .collect();
    let last = *differences_m.last()?;
    let largest = |part: fn(DVec3) -> f64| {
        let parts = differences_m.iter().map(|&(time_s, difference)| At {
            value: part(difference),
            time_s,
        });
        farther(parts, |at| at.value).unwrap_or_default()
    };
    Some(BodyDifference {
        name: first.name.clone(),
        largest_m: [largest(|d| d.x), largest(|d| d.y), largest(|d| d.z)],
        largest_distance_m: largest(DVec3::length),
        last,
        differences_m,
    })
}

fn tether_difference(first: &TetherTrack, second: &TetherTrack) -> Option<TetherDifference> {
    let places = shared(&first.times_s, &second.times_s);
    let differences_at = |&(i, j): &(usize, usize)| {
        let time_s = first.times_s.get(i).copied().unwrap_or_default();
        let pairs = first.tensions_at(i).iter().zip(second.tensions_at(j));
        pairs.enumerate().map(move |(index, (a, b))| TensionAt {
            value_n: b - a,
            time_s,
            segment: index + 1,
        })
    };
    let largest_of = |track: &TetherTrack, numbers: &mut dyn Iterator<Item = usize>| {
        let tensions = numbers.flat_map(|number| {
            let time_s = track.times_s.get(number).copied().unwrap_or_default();
            let tensions = track.tensions_at(number).iter().enumerate();
            tensions.map(move |(index, tension_n)| TensionAt {
                value_n: *tension_n,
                time_s,
                segment: index + 1,
            })
        });
        tensions.reduce(|most, next| {
            if next.value_n > most.value_n {
                next
            } else {
                most
            }
        })
    };
    Some(TetherDifference {
        name: first.name.clone(),
        largest_tension_n: [
            largest_of(first, &mut places.iter().map(|place| place.0))?,
            largest_of(second, &mut places.iter().map(|place| place.1))?,
        ],
        largest_difference_n: farther(places.iter().flat_map(differences_at), |at| at.value_n)?,
        final_difference_n: farther(differences_at(places.last()?), |at| at.value_n)?,
    })
}

/// The first of those whose number is farthest from zero.
fn farther<T>(items: impl Iterator<Item = T>, number: impl Fn(&T) -> f64) -> Option<T> {
    items.reduce(|most, next| {
        if number(&next).abs() > number(&most).abs() {
            next
        } else {
            most
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(times_s: &[f64], xs_m: &[f64]) -> BodyTrack {
        BodyTrack {
            name: "probe".into(),
            times_s: times_s.to_vec(),
            positions_m: xs_m.iter().map(|x| DVec3::new(*x, 0.0, 7.0)).collect(),
        }
    }

    #[test]
    fn positions_are_compared_at_the_times_that_both_have() {
        let first = body(&[0.0, 1.0, 2.0, 3.0], &[0.0, 10.0, 20.0, 30.0]);
        let second = body(&[0.0, 0.5, 1.0, 3.0], &[0.0, 99.0, 8.0, 31.0]);
        let found = body_difference(&first, &second).unwrap();
        let times: Vec<f64> = found.differences_m.iter().map(|(time, _)| *time).collect();
        assert_eq!(times, [0.0, 1.0, 3.0]);
        assert_eq!(
            (found.largest_m[0].value, found.largest_m[0].time_s),
            (-2.0, 1.0)
        );
        assert_eq!(
            (found.largest_distance_m.value, found.largest_m[2].value),
            (2.0, 0.0)
        );
        assert_eq!(found.last, (3.0, DVec3::X));
    }

    #[test]
    fn tracks_without_a_common_time_have_no_difference() {
        let found = body_difference(&body(&[0.0], &[1.0]), &body(&[0.5], &[1.0]));
        assert_eq!(found, None);
        assert_eq!(
            body_difference(&body(&[], &[]), &body(&[0.5], &[1.0])),
            None
        );
    }

    #[test]
    fn tensions_are_compared_segment_by_segment() {
        let track = |tensions_n: &[f64]| TetherTrack {
            name: "line".into(),
            segments: 2,
            times_s: vec![0.0, 1.0],
            tensions_n: tensions_n.to_vec(),
        };
        let (first, second) = (track(&[5.0, 4.0, 6.0, 3.0]), track(&[5.0, 9.0, 5.0, 3.5]));
        let found = tether_difference(&first, &second).unwrap();
        let at = |value_n, time_s, segment| TensionAt {
            value_n,
            time_s,
            segment,
        };
        assert_eq!(found.largest_tension_n, [at(6.0, 1.0, 1), at(9.0, 0.0, 2)]);
        assert_eq!(found.largest_difference_n, at(5.0, 0.0, 2));
        assert_eq!(found.final_difference_n, at(-1.0, 1.0, 1));
    }
}
