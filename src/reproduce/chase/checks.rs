//! What the chase is held against, and what it comes to.

use super::super::check::{Check, Tolerance};
use super::{ChaseFlight, DroneAir};

pub(super) const TITLE: &str = "A drone chases the gondola (sec. 5.4, figure 21)";

pub(super) const PAPER_SHOWS: &str = "Figure 21 shows the differences of the coordinates of drone and gondola while a sail steers the gondola by a rudder of \
1 deg from 10 to 50 s: from an offset at the start those along y and z go to zero, that along x to a constant. There are \
no numbers in the text, and the drone's air is not given.";

/// Shorter flights have not settled, s.
const SETTLED_S: f64 = 100.0;
/// Where the scene has the station, m along x from the gondola, and the airspeed to keep it there, m/s.
const STATION_M: f64 = -30.0;
const AIRSPEED_M_S: f64 = 25.0;

pub(super) fn checks(flights: &[ChaseFlight]) -> Vec<Check> {
    let settled = |flight: &&ChaseFlight| {
        flight
            .rows
            .last()
            .is_some_and(|row| row.time_s >= SETTLED_S)
    };
    let mut checks = Vec::new();
    for flight in flights.iter().filter(settled) {
        match flight.air {
            DroneAir::Own => checks.extend(own(flight)),
            DroneAir::Gondolas | DroneAir::Still => checks.extend(falls_away(flight)),
        }
    }
    checks
}

fn own(flight: &ChaseFlight) -> Vec<Check> {
    let (Some(first), Some(last)) = (flight.rows.first(), flight.rows.last()) else {
        return Vec::new();
    };
    let at_end = |what: &str, ours: f64, expected: f64, paper: &str| {
        Check::of(format!("{what} at the end, own wind"), "m", ours)
            .paper(paper)
            .against(
                expected,
                Tolerance::Absolute(0.5),
                "the station that is asked for",
            )
    };
    vec![
        at_end(
            "x of drone less gondola",
            last.error_m.x,
            STATION_M,
            "a constant",
        ),
        at_end("y of drone less gondola", last.error_m.y, 0.0, "0"),
        at_end("z of drone less gondola", last.error_m.z, 0.0, "0"),
        Check::of(
            "airspeed that keeps up with the gondola, own wind",
            "m/s",
            first.required_m_s,
        )
        .against(
            AIRSPEED_M_S,
            Tolerance::Absolute(0.02),
            "the difference of gondola's velocity and wind",
        ),
    ]
}

/// The drone cannot keep a distance: it falls away as its speed and the gondola's differ.
fn falls_away(flight: &ChaseFlight) -> Vec<Check> {
    let name = flight.air.name();
    let (least, most) = flight.level_m_s;
    let needed_m_s = match flight.air {
        DroneAir::Gondolas => flight.gondola_through_air_m_s,
        DroneAir::Own | DroneAir::Still => flight.gondola_m_s,
    };
    let can = (least..=most).contains(&needed_m_s);
    let told = flight
        .events
        .iter()
        .any(|(_, kind)| kind.contains("unreachable"));
    let word = |reached: bool| if reached { "in reach" } else { "out of reach" };
    let mut checks = vec![
        Check::of(
            format!("the gondola for the drone, {name}"),
            "",
            word(!told),
        )
        .paper("in reach")
        .as_said(
            word(can),
            can != told,
            "the range of level flight against the gondola's speed",
        ),
    ];
    // Over the second half, in which the drone flies on steadily.
    let middle = flight.rows.len() / 2;
    if let (Some(from), Some(to)) = (flight.rows.get(middle), flight.rows.last())
        && flight.air == DroneAir::Still
    {
        let rows = &flight.rows[middle..];
        let mean = rows.iter().map(|row| row.airspeed_m_s).sum::<f64>() / rows.len() as f64;
        let rate_m_s = (to.error_m.x - from.error_m.x) / (to.time_s - from.time_s);
        checks.push(
            Check::of(
                format!("rate at which it falls behind along x, {name}"),
                "m/s",
                rate_m_s,
            )
            .against(
                mean - flight.gondola_m_s,
                Tolerance::Relative(0.02),
                "its airspeed less the gondola's speed at the start",
            ),
        );
    }
    checks
}

pub(super) fn sentence(flights: &[ChaseFlight]) -> String {
    let Some(gondola) = flights
        .iter()
        .find(|flight| flight.air == DroneAir::Gondolas)
    else {
        return String::new();
    };
    format!(
        "The figure comes out as in the paper (y and z to zero, x to a constant) only if the drone has an air of its own, \
         which the paper does not say: the gondola moves through its air at {:.1} m/s and in the inertial frame at {:.0} \
         m/s, and the drone flies level from {:.0} to {:.0} m/s, so that in one wind it can keep no distance.",
        gondola.gondola_through_air_m_s,
        gondola.gondola_m_s,
        gondola.level_m_s.0,
        gondola.level_m_s.1
    )
}
