//! Which moments of inertia would give the paper's table, by the multifilar pendulum and the transform of its
//! first 15 s.

use super::{LengthResult, MultifilarPendulum, PAPER_RECORD_S, largest_bin};

/// Interval of the records that are transformed, s.
const INTERVAL_S: f64 = 0.1;
/// Beyond these no edge is looked for, kg m^2.
const LEAST_KG_M2: f64 = 1.0;
const MOST_KG_M2: f64 = 1000.0;
/// Halvings of an interval with an edge in it.
const HALVINGS: u32 = 30;

/// The bin of 1/15 Hz in which the table of the paper has a length.
#[must_use]
pub(super) fn bin_of_table(paper_hz: f64) -> usize {
    // The table cuts its digits off: 0.133 and 0.066.
    libm::round(paper_hz * PAPER_RECORD_S) as usize
}

/// The bin in which a pendulum shows, with another moment of inertia.
pub(super) fn bin_with(pendulum: &MultifilarPendulum, moment_kg_m2: f64) -> Option<usize> {
    let pendulum = MultifilarPendulum {
        moment_kg_m2,
        ..*pendulum
    };
    let count = libm::round(PAPER_RECORD_S / INTERVAL_S) as usize;
    largest_bin(&pendulum.record_rad(INTERVAL_S, count))
}

/// The least and the largest moment of inertia about `within` with which every length shows in the bin of
/// the table, kg m^2; nothing if it does not with `within`.
pub(super) fn range_of_table(results: &[LengthResult], within_kg_m2: f64) -> Option<(f64, f64)> {
    let comes_out = |moment_kg_m2: f64| {
        results.iter().all(|result| {
            bin_with(&result.pendulum, moment_kg_m2) == Some(bin_of_table(result.paper_hz))
        })
    };
    let edge = |outside: f64| {
        let (mut inside, mut outside) = (within_kg_m2, outside);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            if comes_out(middle) {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        inside
    };
    comes_out(within_kg_m2).then(|| (edge(LEAST_KG_M2), edge(MOST_KG_M2)))
}
