//! Tensions over time and along tethers.

use super::{instant_name, instants_s, nothing};
use crate::figure::{Axis, Figure, Panel, Series};
use crate::record::{Record, SegmentTrack, TetherTrack};

/// More tethers than this are not shown one by one.
const MOST_PANELS: usize = 6;

/// Tension at the higher end, at the lower end and the largest of each tether over time.
pub(super) fn histories(record: &Record) -> Result<Figure, String> {
    let names = ["top", "bottom", "largest"];
    let mut panels = names.map(|name| Panel {
        x: Axis::time(),
        y: Axis::new(format!("tension, {name} [N]")),
        ..Panel::default()
    });
    for (place, tether) in record.tables.tethers.iter().enumerate() {
        let rows = rows(tether);
        let is_upside = is_from_higher(record, tether);
        let ends = rows.iter().map(|row| (row.time_s, row.first_n, row.last_n));
        let ends: Vec<(f64, f64, f64)> = ends
            .map(|(time_s, first, last)| match is_upside {
                true => (time_s, first, last),
                false => (time_s, last, first),
            })
            .collect();
        let lines = [
            ends.iter().map(|row| (row.0, row.1)).collect::<Vec<_>>(),
            ends.iter().map(|row| (row.0, row.2)).collect(),
            rows.iter().map(|row| (row.time_s, row.largest_n)).collect(),
        ];
        for (panel, line) in panels.iter_mut().zip(lines) {
            panel
                .series
                .push(Series::line(&tether.name, line).with_tone(place));
        }
    }
    if panels[0].series.is_empty() {
        return nothing("no tether was recorded");
    }
    Ok(Figure {
        title: "Tension of the tethers".to_owned(),
        caption:
            "Of the segment at the higher end, of that at the lower end, and of the one with most."
                .to_owned(),
        panels: panels.into(),
        ..Figure::default()
    })
}

/// Tensions of a tether at one time.
struct Row {
    time_s: f64,
    first_n: f64,
    last_n: f64,
    largest_n: f64,
}

/// The tensions of a tether at every time at which any segment was recorded.
fn rows(tether: &TetherTrack) -> Vec<Row> {
    let mut times_s: Vec<f64> = tether
        .segments
        .iter()
        .flat_map(|segment| segment.times_s.iter().copied())
        .collect();
    times_s.sort_unstable_by(f64::total_cmp);
    times_s.dedup();
    let mut places = vec![0; tether.segments.len()];
    times_s
        .into_iter()
        .map(|time_s| {
            let mut row = Row {
                time_s,
                first_n: f64::NAN,
                last_n: f64::NAN,
                largest_n: f64::NAN,
            };
            for (segment, place) in tether.segments.iter().zip(&mut places) {
                if segment.times_s.get(*place) != Some(&time_s) {
                    continue;
                }
                let tension_n = segment.tensions_n[*place];
                *place += 1;
                if row.first_n.is_nan() {
                    row.first_n = tension_n;
                }
                row.last_n = tension_n;
                row.largest_n = row.largest_n.max(tension_n);
            }
            row
        })
        .collect()
}

/// Whether the end `from` begins the run above the other.
fn is_from_higher(record: &Record, tether: &TetherTrack) -> bool {
    let Some([from, to]) = record.geometry.tether_ends.get(&tether.name) else {
        return true;
    };
    let height_m = |end: &aerobot_engine::geometry::TetherEndPlace| {
        let carrier = record.tables.state(&end.carrier)?;
        let (attitude, _) = carrier.rotations.first()?;
        Some((carrier.positions_m.first()?.z) + (*attitude * end.offset_m).z)
    };
    height_m(from) >= height_m(to)
}

/// Tension along each tether at some instants.
pub(super) fn profile(record: &Record) -> Result<Figure, String> {
    let all = &record.tables.tethers;
    let long = all.iter().filter(|tether| tether.segments.len() > 1);
    let long: Vec<&TetherTrack> = long.collect();
    if long.is_empty() {
        return nothing("no tether has more than one segment");
    }
    let instants = instants_s(record);
    let panels = long.iter().take(MOST_PANELS).map(|tether| Panel {
        title: match all.len() {
            1 => String::new(),
            _ => tether.name.clone(),
        },
        x: Axis::new("distance along the tether from its first end [m]"),
        y: Axis::new("tension [N]"),
        series: instants
            .iter()
            .enumerate()
            .map(|(index, time_s)| {
                Series::line(instant_name(*time_s), along(tether, *time_s)).with_tone(index)
            })
            .collect(),
        ..Panel::default()
    });
    Ok(Figure {
        title: "Tension along the tethers".to_owned(),
        caption: if long.len() > MOST_PANELS {
            format!("The first {MOST_PANELS} of {} tethers.", long.len())
        } else {
            String::new()
        },
        panels: panels.collect(),
        ..Figure::default()
    })
}

/// Middle of each segment and its tension.
fn along(tether: &TetherTrack, time_s: f64) -> Vec<(f64, f64)> {
    let mut distance_m = 0.0;
    let mut points = Vec::new();
    for segment in &tether.segments {
        let Some((tension_n, length_m)) = nearest(segment, time_s) else {
            continue;
        };
        points.push((distance_m + 0.5 * length_m, tension_n));
        distance_m += length_m;
    }
    points
}

/// Tension and length of a segment at its record at or before a time, if it is there then.
fn nearest(segment: &SegmentTrack, time_s: f64) -> Option<(f64, f64)> {
    segment.tension_at_n(time_s)?;
    let after = segment.times_s.partition_point(|other| *other <= time_s);
    let place = after.checked_sub(1)?;
    Some((segment.tensions_n[place], segment.lengths_m[place]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_segment_that_goes_is_a_gap_and_not_an_end() {
        let segment = |times: &[f64], tension: f64| SegmentTrack {
            times_s: times.to_vec(),
            tensions_n: vec![tension; times.len()],
            lengths_m: vec![2.0; times.len()],
        };
        let tether = TetherTrack {
            name: "line".into(),
            segments: vec![segment(&[0.0, 1.0, 2.0], 3.0), segment(&[0.0, 1.0], 5.0)],
        };
        let rows = rows(&tether);
        let largest: Vec<f64> = rows.iter().map(|row| row.largest_n).collect();
        assert_eq!(largest, [5.0, 5.0, 3.0]);
        assert_eq!(rows[2].last_n, 3.0);
        assert_eq!(along(&tether, 0.5), [(1.0, 3.0), (3.0, 5.0)]);
        assert_eq!(along(&tether, 1.5), [(1.0, 3.0)]);
    }
}
