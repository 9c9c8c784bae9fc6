//! The chase as a text and as a table.

use aerobot_engine::recording::number::number_text;

use super::super::check::{Check, Verdict};
use super::super::{Report, Table};
use super::checks::{self, PAPER_SHOWS, TITLE};
use super::{ChaseFlight, DroneAir};

const HEAD: &str = "\
A fixed-wing drone chases a gondola steered by a sail, 2 km below its balloon (paper, sec. 5.4).

Figure 21 of the paper shows the differences of the coordinates of drone and gondola: from an offset
at the start those along y and z go to zero, that along x to a constant, the distance from which a
docking would begin. It has no numbers in the text. The drone is that of the Simulink models the
paper cites (Aerosonde; Beard and McLain 2012); its air, its start and its offset are not given.
";

const HEADER: &str = "air,time_s,x_error_m,y_error_m,z_error_m,gondola_y_m,required_airspeed_m_s,\
    airspeed_m_s,chase_state\n";

/// Times that the text shows, s.
const SHOWN_S: [f64; 7] = [0.0, 10.0, 20.0, 30.0, 50.0, 75.0, 100.0];

/// `more` are checks beside those of the flights.
pub(super) fn report(flights: &[ChaseFlight], more: Vec<Check>) -> Report {
    let stopped = flights.iter().filter_map(|flight| {
        let reason = flight.stopped.as_ref()?;
        Some(format!(
            "the chase in {} stopped: {reason}",
            flight.air.name()
        ))
    });
    let mut checks = checks::checks(flights);
    // Of the flights alone: with short ones there is nothing to judge.
    let mut verdict = Verdict::of(&checks, checks::sentence(flights));
    verdict.holds &= !more.iter().any(Check::fails);
    checks.extend(more);
    Report {
        figures: Vec::new(),
        title: TITLE.to_owned(),
        paper_shows: PAPER_SHOWS.to_owned(),
        text: text(flights),
        verdict,
        checks,
        tables: vec![Table {
            file_name: "chase.csv",
            text: table(flights),
        }],
        stopped: stopped.collect(),
    }
}

fn text(flights: &[ChaseFlight]) -> String {
    let mut text = HEAD.to_owned();
    for flight in flights {
        text.push('\n');
        match flight.air {
            DroneAir::Own => text.push_str(&own(flight)),
            DroneAir::Gondolas | DroneAir::Still => text.push_str(&other(flight)),
        }
    }
    text
}

fn own(flight: &ChaseFlight) -> String {
    let mut text = format!(
        "In a wind of its own, {:.2} m/s: the gondola's steady velocity less 25 m/s along x. Drone less\n\
         gondola, m:\n\n   time_s        x        y        z   gondola y\n",
        flight.gondola_m_s - 25.0
    );
    for row in &flight.rows {
        if SHOWN_S.contains(&row.time_s) {
            let [x, y, z] = row.error_m.to_array().map(hundredths);
            text.push_str(&format!(
                "  {:7.1} {x:8.2} {y:8.2} {z:8.2} {:11.2}\n",
                row.time_s,
                hundredths(row.gondola_y_m)
            ));
        }
    }
    let settled: Vec<String> = ["x", "y", "z"]
        .iter()
        .enumerate()
        .filter_map(|(axis, name)| {
            let time_s = flight.settled_s(axis, 0.5)?;
            Some(format!("{name} at {time_s} s"))
        })
        .collect();
    text.push_str(&format!(
        "\nWithin 0.5 m of their last values for good: {}.\n",
        settled.join(", ")
    ));
    text.push_str(&told(flight));
    text
}

/// Rounded to what is printed: a zero that came out negative reads as a difference where there is none.
fn hundredths(value: f64) -> f64 {
    (100.0 * value).round() / 100.0 + 0.0
}

fn other(flight: &ChaseFlight) -> String {
    let needs = match flight.air {
        DroneAir::Gondolas => format!(
            "In {} the gondola moves at {:.2} m/s through the air",
            flight.air.name(),
            flight.gondola_through_air_m_s
        ),
        _ => format!(
            "In {} the gondola moves at {:.2} m/s",
            flight.air.name(),
            flight.gondola_m_s
        ),
    };
    let last = flight.rows.last().map_or(0.0, |row| row.error_m.x);
    format!(
        "{needs}; the drone flies level from {:.1} to\n{:.1} m/s: it cannot keep a distance, and is {last:.0} m \
         along x from the gondola at the end.\n{}",
        flight.level_m_s.0,
        flight.level_m_s.1,
        told(flight)
    )
}

fn told(flight: &ChaseFlight) -> String {
    flight
        .events
        .iter()
        .map(|(time_s, kind)| format!("  {time_s:7.2} s: {kind}\n"))
        .collect()
}

fn table(flights: &[ChaseFlight]) -> String {
    let mut table = HEADER.to_owned();
    for flight in flights {
        for row in &flight.rows {
            let error = row.error_m;
            let numbers = [
                row.time_s,
                error.x,
                error.y,
                error.z,
                row.gondola_y_m,
                row.required_m_s,
                row.airspeed_m_s,
                row.state,
            ];
            table.push_str(flight.air.name());
            for number in numbers {
                table.push(',');
                table.push_str(&number_text(number));
            }
            table.push('\n');
        }
    }
    table
}
