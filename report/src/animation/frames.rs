//! Which instants of a run become frames.

use crate::record::Record;

/// Times of the frames, s: those at which bodies were recorded, thinned evenly; the nearest to what happens
/// at one instant stay.
pub(super) fn times_s(record: &Record, most: usize) -> Vec<f64> {
    let mut times_s: Vec<f64> = record
        .tables
        .bodies()
        .map(|track| &track.times_s)
        .max_by_key(|times| times.len())
        .cloned()
        .unwrap_or_default();
    let moments = record.summary.events.iter().map(|event| event.time_s);
    let largest = record.summary.largest_tension.as_ref();
    let moments: Vec<f64> = moments
        .chain(largest.map(|largest| largest.time_s))
        .collect();
    // With a node whose record ends earlier there is nothing to show of the line.
    let end_s = record
        .tables
        .bodies()
        .filter_map(|track| track.times_s.last())
        .fold(f64::INFINITY, |end: f64, last| end.min(*last));
    times_s.retain(|time_s| *time_s <= end_s);
    keep(&times_s, most.max(2), &moments)
}

/// At most about `most` of the times: evenly by their number, with the first, the last and those nearest to
/// the moments.
fn keep(times_s: &[f64], most: usize, moments: &[f64]) -> Vec<f64> {
    let count = times_s.len();
    if count <= most {
        return times_s.to_vec();
    }
    let mut kept = vec![false; count];
    for index in 0..most {
        kept[index * (count - 1) / (most - 1)] = true;
    }
    for moment in moments.iter().take(most) {
        let after = times_s.partition_point(|time_s| time_s < moment);
        let before = after.saturating_sub(1);
        let after = after.min(count - 1);
        let nearest = if moment - times_s[before] < times_s[after] - moment {
            before
        } else {
            after
        };
        kept[nearest] = true;
    }
    let chosen = times_s.iter().zip(kept);
    chosen
        .filter(|(_, kept)| *kept)
        .map(|(time, _)| *time)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_and_moments_stay() {
        let times_s: Vec<f64> = (0..1001).map(f64::from).collect();
        let kept = keep(&times_s, 11, &[333.4, 999.9]);
        assert_eq!(kept.first(), Some(&0.0));
        assert_eq!(kept.last(), Some(&1000.0));
        assert!(kept.contains(&333.0));
        assert_eq!(kept.len(), 12);
        assert_eq!(keep(&times_s, 2000, &[]), times_s);
    }
}
