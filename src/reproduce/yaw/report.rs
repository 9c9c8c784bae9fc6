//! The yaw case as a text and as tables.

use aerobot_engine::recording::number::number_text;

use super::super::check::Verdict;
use super::super::{Report, Table};
use super::checks::{self, PAPER_SHOWS, TITLE};
use super::inertia::{bin_of_table, bin_with, range_of_table};
use super::{CrossingFrequency, LengthResult, MultifilarPendulum, PAPER_RECORD_S, YawFlight};

const HEAD: &str = "\
The yaw of a body of 20 kg on a ring of tethers, turning at 0.1 rad/s at the start (paper, sec. 4.4.1,
figures 13 and 14, table 1).

The frequencies of the paper's table, its own and those of Project Chrono, are multiples of 1/15 Hz
with the last digits cut off: bins of a transform of 15 s, which tells 10 m from 20 m and 20 m from
50 m by no more than the bin. Here the frequency is the mean between upward zero crossings of the
heading, beside that of the multifilar pendulum, in closed form; and the bin in which 15 s of the same
run show. Links are faster than the pendulum by what the tethers weigh, which tightens them; masses on
elastic tethers are slower than links by half of what the tethers stretch.
";

const WIDE_HEADER: &str = "length_m,tethers,nodes,formulation,frequency_hz,spread_hz,periods,\
    amplitude_rad,bin_of_15_s,pendulum_frequency_hz,pendulum_small_frequency_hz,\
    pendulum_amplitude_rad,paper_hz,paper_bin,transverse_wave_s\n";
const HEADINGS_HEADER: &str = "length_m,formulation,time_s,heading_rad\n";

/// The slip that the table speaks for: a minus between the squares of the radii, which are the scene's.
const SLIP: (f64, f64) = (2.1, 1.3);

pub(super) fn report(results: &[LengthResult]) -> Report {
    let mut text = HEAD.to_owned();
    text.push_str(&frequencies(results));
    text.push_str(&amplitudes(results));
    text.push_str(&inertia(results));
    text.push_str(&waves(results));
    let checks = checks::checks(results);
    Report {
        title: TITLE.to_owned(),
        paper_shows: PAPER_SHOWS.to_owned(),
        text,
        verdict: Verdict::of(&checks, checks::sentence(results)),
        checks,
        tables: vec![
            Table {
                file_name: "yaw.csv",
                text: wide(results),
            },
            Table {
                file_name: "yaw_headings.csv",
                text: headings(results),
            },
        ],
        stopped: results.iter().flat_map(stopped).collect(),
    }
}

fn flights(result: &LengthResult) -> [&YawFlight; 2] {
    [&result.lumped, &result.links]
}

fn stopped(result: &LengthResult) -> Vec<String> {
    let flights = flights(result).into_iter();
    flights
        .filter_map(|flight| {
            let reason = flight.stopped.as_ref()?;
            let time_s = flight.headings.last().map_or(0.0, |(time_s, _)| *time_s);
            Some(format!(
                "yaw: {}, {} m stopped at {time_s} s: {reason}",
                flight.formulation.name(),
                result.pendulum.length_m
            ))
        })
        .collect()
}

/// A line of the text: what, and a field for each length.
fn line(what: &str, results: &[LengthResult], field: impl Fn(&LengthResult) -> String) -> String {
    let mut text = format!("{what:<46}");
    for result in results {
        text.push_str(&format!(" {:>12}", field(result)));
    }
    text.push('\n');
    text
}

fn lengths(what: &str, results: &[LengthResult]) -> String {
    line(what, results, |result| {
        format!("{} m", result.pendulum.length_m)
    })
}

/// A number with so many decimals, or a dash.
fn decimals(value: Option<f64>, count: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.count$}"))
}

fn bin(found: Option<usize>) -> String {
    found.map_or_else(|| "-".to_owned(), |bin| format!("{bin}/15"))
}

fn hz(found: Option<CrossingFrequency>) -> String {
    decimals(found.map(|found| found.hz), 6)
}

fn spread(found: Option<CrossingFrequency>) -> String {
    let told = found.filter(|found| found.periods > 1);
    told.map_or_else(
        || "-".to_owned(),
        |found| format!("{:.0e}", found.spread_hz),
    )
}

fn frequencies(results: &[LengthResult]) -> String {
    let by_pendulum = |result: &LengthResult| decimals(result.pendulum.frequency_hz(), 6);
    let small = |result: &LengthResult| decimals(Some(result.pendulum.small_frequency_hz()), 6);
    let first = results.first();
    let masses = first.map_or_else(String::new, |result| {
        format!("{} tethers of {} masses", result.tethers, result.nodes)
    });
    let integrator = first.map_or("", |result| result.lumped.integrator.as_str());
    let mut text = format!("\n{masses}, {integrator}; Hz.\n\n");
    for part in [
        lengths("frequency", results),
        line("lumped masses, elastic", results, |result| {
            hz(result.lumped.frequency())
        }),
        line("  single periods, to either side", results, |result| {
            spread(result.lumped.frequency())
        }),
        line("rigid links, inextensible", results, |result| {
            hz(result.links.frequency())
        }),
        line("  single periods, to either side", results, |result| {
            spread(result.links.frequency())
        }),
        line(
            "multifilar pendulum, massless tethers",
            results,
            by_pendulum,
        ),
        line(
            "  of small angles, sqrt(m g a b/(L I))/(2 pi)",
            results,
            small,
        ),
        line("the paper, lumped masses and Chrono", results, |result| {
            result.paper_hz.to_string()
        }),
        "\n".to_owned(),
        lengths("largest bin of the first 15 s, Hz", results),
        line("lumped masses", results, |result| {
            bin(result.lumped.paper_bin())
        }),
        line("rigid links", results, |result| {
            bin(result.links.paper_bin())
        }),
        line("the paper", results, |result| {
            bin(Some(bin_of_table(result.paper_hz)))
        }),
    ] {
        text.push_str(&part);
    }
    text
}

fn amplitudes(results: &[LengthResult]) -> String {
    let degrees = |radians: f64| decimals(Some(radians.to_degrees()), 3);
    let of_pendulum =
        |result: &LengthResult| decimals(result.pendulum.amplitude_rad().map(f64::to_degrees), 3);
    [
        "\n".to_owned(),
        lengths("amplitude, deg", results),
        line("lumped masses, elastic", results, |result| {
            degrees(result.lumped.amplitude_rad())
        }),
        line("rigid links, inextensible", results, |result| {
            degrees(result.links.amplitude_rad())
        }),
        line("multifilar pendulum", results, of_pendulum),
    ]
    .concat()
}

fn inertia(results: &[LengthResult]) -> String {
    let Some(first) = results.first() else {
        return String::new();
    };
    let MultifilarPendulum {
        mass_kg,
        moment_kg_m2,
        ..
    } = first.pendulum;
    let slip = 0.5 * mass_kg * (SLIP.0 * SLIP.0 - SLIP.1 * SLIP.1);
    let bins = |moment: f64| {
        let bins = results.iter().map(|r| bin(bin_with(&r.pendulum, moment)));
        bins.collect::<Vec<_>>().join(", ")
    };
    let range = range_of_table(results, slip).map_or_else(
        || "No moment of inertia near that gives the table.".to_owned(),
        |(least, most)| {
            format!(
                "The table comes out with any moment of inertia from {least:.1} to {most:.1} kg m2."
            )
        },
    );
    format!(
        "
A hollow cylinder has the moment of inertia m/2 (r_ext^2 + r_int^2) = {moment_kg_m2:.1} kg m2, with which 15 s of
the pendulum show at {} Hz. {range}
A minus between the squares would make it {slip:.1} kg m2, and the bins {} Hz: the likeliest slip.
",
        bins(moment_kg_m2),
        bins(slip)
    )
}

fn waves(results: &[LengthResult]) -> String {
    let mut text = format!(
        "
The paper has the period grow because the rotation takes longer to travel along the tethers. What
travels is a transverse wave, and the period is that of the pendulum; a record of {PAPER_RECORD_S} s is what
resolves it to {:.3} Hz and no better.

",
        1.0 / PAPER_RECORD_S
    );
    text.push_str(&lengths("from end to end, s", results));
    text.push_str(&line(
        "a transverse wave, L sqrt(mu/T)",
        results,
        |result| decimals(Some(result.wave_s), 3),
    ));
    text.push_str(&line("a period of the pendulum", results, |result| {
        decimals(result.pendulum.frequency_hz().map(f64::recip), 3)
    }));
    text
}

fn row(text: &mut String, fields: &[String]) {
    text.push_str(&fields.join(","));
    text.push('\n');
}

/// A number, or an empty field where there is none.
fn field(value: Option<f64>) -> String {
    value.map_or_else(String::new, number_text)
}

fn wide(results: &[LengthResult]) -> String {
    let mut text = WIDE_HEADER.to_owned();
    for result in results {
        let pendulum = &result.pendulum;
        for flight in flights(result) {
            let frequency = flight.frequency();
            let bin = flight.paper_bin();
            let fields = [
                number_text(pendulum.length_m),
                result.tethers.to_string(),
                result.nodes.to_string(),
                flight.formulation.name().to_owned(),
                field(frequency.map(|found| found.hz)),
                field(frequency.map(|found| found.spread_hz)),
                frequency.map_or(0, |found| found.periods).to_string(),
                number_text(flight.amplitude_rad()),
                bin.map_or_else(String::new, |bin| bin.to_string()),
                field(pendulum.frequency_hz()),
                number_text(pendulum.small_frequency_hz()),
                field(pendulum.amplitude_rad()),
                number_text(result.paper_hz),
                bin_of_table(result.paper_hz).to_string(),
                number_text(result.wave_s),
            ];
            row(&mut text, &fields);
        }
    }
    text
}

fn headings(results: &[LengthResult]) -> String {
    let mut text = HEADINGS_HEADER.to_owned();
    for result in results {
        for flight in flights(result) {
            for (time_s, heading_rad) in &flight.headings {
                let fields = [
                    number_text(result.pendulum.length_m),
                    flight.formulation.name().to_owned(),
                    number_text(*time_s),
                    number_text(*heading_rad),
                ];
                row(&mut text, &fields);
            }
        }
    }
    text
}
