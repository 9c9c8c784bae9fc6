//! The comparison of the formulations as a text and as tables.

use aerobot_engine::recording::number::number_text;
use glam::DVec3;

use super::super::check::{Check, Tolerance, Verdict, largest};
use super::super::flight::{Flight, fields, largest_difference_m, row};
use super::super::{Report, Table};
use super::{BALLOON, ComparisonStudy, FIRST_GUST_S, GONDOLA, TETHER};

const TITLE: &str = "Two formulations of one flight (sec. 4.2, figures 5 and 6)";

const PAPER_SHOWS: &str = "Figures 5 and 6 show x, y and z of balloon and gondola over 100 s in three step gusts, in lumped masses and \
in DeNOC. The text says that the trajectories coincide. Masses, areas and the tether's properties are not given.";

const HEAD: &str = "\
Balloon, 900 m tether of ten masses, gondola; three step gusts; lumped masses and rigid links (paper, sec. 4.2,
figures 5 and 6).

The paper shows the displacements of both bodies and says that the trajectories coincide. It gives neither masses nor the
tether's properties; those of `scenes/paper/comparison_900m.ron` are chosen. Displacements from the start, m:

";

/// Times that the text shows, s.
const SHOWN_S: [f64; 6] = [10.0, 20.0, 35.0, 50.0, 60.0, 100.0];
const BODIES: [&str; 2] = [BALLOON, GONDOLA];

pub(super) fn report(found: &ComparisonStudy) -> Report {
    let checks = checks(found);
    let limit = found.limit.iter().map(|(factor, largest_m)| {
        format!(
            "{:>10} {:>14}\n",
            number_text(*factor),
            format!("{largest_m:.6}")
        )
    });
    let text = [
        HEAD.to_owned(),
        displacements_text(found),
        "\nLargest difference of a displacement as the tether gets stiffer, masses on its nodes: lumped masses less\n\
         rigid links with the same masses at their joints, m.\n\n      EA x     difference\n"
            .to_owned(),
        limit.collect(),
    ]
    .concat();
    let limit_flights = found.references.iter().map(|(_, flight)| flight);
    Report {
        figures: Vec::new(),
        title: TITLE.to_owned(),
        paper_shows: PAPER_SHOWS.to_owned(),
        text,
        verdict: Verdict::of(&checks, sentence(found)),
        checks,
        tables: vec![
            table("comparison_displacement.csv", displacements(found)),
            table("comparison_difference.csv", differences(found)),
            table("comparison_tension.csv", tensions(found)),
            table("comparison_stiffness.csv", stiffness(found)),
        ],
        stopped: [&found.lumped, &found.links]
            .into_iter()
            .chain(limit_flights)
            .filter_map(|flight| {
                flight.stop_of(&format!("comparison: {}", flight.formulation.name()))
            })
            .collect(),
    }
}

fn table(file_name: &'static str, text: String) -> Table {
    Table { file_name, text }
}

fn flights(found: &ComparisonStudy) -> [&Flight; 2] {
    [&found.lumped, &found.links]
}

/// Largest difference of the two flights, m.
fn apart_m(found: &ComparisonStudy) -> f64 {
    largest(BODIES.map(|body| largest_difference_m(&found.lumped, &found.links, body)))
}

/// Largest displacement of a body along an axis, m.
fn moved_m(found: &ComparisonStudy) -> f64 {
    let sizes = BODIES.into_iter().flat_map(|body| {
        let track = found.lumped.displacements(body).into_iter();
        track.map(|(_, moved)| moved.abs().max_element())
    });
    largest(sizes)
}

/// By how much more the gondola hangs below the balloon in lumped masses than in rigid links at the start, m.
fn stretch_m(found: &ComparisonStudy) -> f64 {
    let hangs = |flight: &Flight| {
        let (balloon, gondola) = (flight.start(BALLOON)?, flight.start(GONDOLA)?);
        Some(balloon.z - gondola.z)
    };
    match (hangs(&found.lumped), hangs(&found.links)) {
        (Some(elastic_m), Some(rigid_m)) => elastic_m - rigid_m,
        _ => f64::NAN,
    }
}

fn checks(found: &ComparisonStudy) -> Vec<Check> {
    let mut checks = at_rest(found);
    let flown_s = found.lumped.simulated_s;
    if flown_s > 2.0 * FIRST_GUST_S {
        let part = 100.0 * apart_m(found) / moved_m(found);
        checks.push(
            Check::of(
                "largest difference of the formulations over the largest displacement",
                "%",
                part,
            )
            .paper("the trajectories coincide")
            .as_in_paper("at most 1 %", part <= 1.0),
        );
        checks.extend(limit_checks(found));
    }
    for (reference, flight) in &found.references {
        for (body, expected) in BODIES.into_iter().zip(reference.displaced_m) {
            let at = flight.displacements(body).last().map(|(_, moved)| *moved);
            let error_m = at.map_or(f64::NAN, |moved| (moved - expected).abs().max_element());
            let what = format!(
                "{body} at 100 s from that of a separate program, {}",
                reference.name
            );
            checks.push(Check::of(what, "m", error_m).vanishes(
                1e-5,
                "a separate program (DOP853 at 1e-10, uniform density), to its last digits",
            ));
        }
    }
    checks
}

/// What hangs, before the first gust.
fn at_rest(found: &ComparisonStudy) -> Vec<Check> {
    let hanging = &found.hanging;
    let mut checks = vec![
        Check::of("stretch of the hanging tether", "m", stretch_m(found)).against(
            hanging.stretch_m(),
            Tolerance::Relative(1e-6),
            "the closed form g L (m_p + m_t/2)/EA",
        ),
    ];
    for flight in flights(found) {
        let name = flight.formulation.name();
        let tension = |channel| flight.first(TETHER, channel).unwrap_or(f64::NAN);
        checks.push(
            Check::of(
                format!("force on the balloon at rest, {name}"),
                "N",
                tension("tension_from_n"),
            )
            .against(
                hanging.top_n(),
                Tolerance::Relative(1e-6),
                "the weight of gondola and tether",
            ),
        );
        checks.push(
            Check::of(
                format!("force on the gondola at rest, {name}"),
                "N",
                tension("tension_to_n"),
            )
            .against(
                hanging.bottom_n(),
                Tolerance::Relative(1e-6),
                "the weight of the gondola",
            ),
        );
        let moved = BODIES.into_iter().flat_map(|body| {
            let track = flight.displacements(body).into_iter();
            track.filter(|(time_s, _)| *time_s <= FIRST_GUST_S)
        });
        checks.push(
            Check::of(
                format!("motion before the first gust, {name}"),
                "m",
                largest(moved.map(|(_, moved)| moved.length())),
            )
            .vanishes(1e-6, "rest of what floats in still air"),
        );
    }
    checks
}

/// The difference must vanish as 1/EA.
fn limit_checks(found: &ComparisonStudy) -> Vec<Check> {
    let power = |pair: &[(f64, f64)]| match pair {
        [(less, before_m), (more, after_m)] => {
            libm::log(before_m / after_m) / libm::log(more / less)
        }
        _ => f64::NAN,
    };
    let mut decades: Vec<Check> = found
        .limit
        .windows(2)
        .filter(|pair| matches!(pair, [(less, _), _] if *less >= 10.0))
        .map(|pair| {
            let factors = pair.iter().map(|(factor, _)| number_text(*factor));
            let factors: Vec<String> = factors.collect();
            let what = format!(
                "power of 1/EA in which they approach, EA x {}",
                factors.join(" to ")
            );
            Check::of(what, "", power(pair)).against(
                1.0,
                Tolerance::Absolute(0.1),
                "first order in the stretch, which is as 1/EA",
            )
        })
        .collect();
    if let Some((factor, last_m)) = found.limit.last() {
        let what = format!(
            "difference from inextensible links, EA x {}",
            number_text(*factor)
        );
        decades.push(Check::of(what, "m", *last_m).vanishes(1e-3, "the other formulation"));
    }
    decades
}

fn sentence(found: &ComparisonStudy) -> String {
    let stretch = match (found.limit.first(), found.limit.last()) {
        (Some((_, first_m)), Some((factor, last_m))) => format!(
            " That comes of the stretch, and vanishes as 1/EA: with all masses on nodes {first_m:.3} m at the \
             scene's EA, {last_m:.1e} m at {} times that.",
            number_text(*factor)
        ),
        _ => String::new(),
    };
    format!(
        "As in the paper both formulations fly one trajectory, but they do not coincide: they differ by up to {:.2} m \
         of {:.0} m.{stretch}",
        apart_m(found),
        moved_m(found)
    )
}

fn displacements_text(found: &ComparisonStudy) -> String {
    let mut text = format!(
        "{:>6}  {:<8} {:<12} {:>9} {:>9} {:>9}\n",
        "time_s", "body", "", "x", "y", "z"
    );
    for time_s in SHOWN_S {
        for body in BODIES {
            let [lumped, links] =
                flights(found).map(|flight| at(&flight.displacements(body), time_s));
            let (Some(lumped), Some(links)) = (lumped, links) else {
                continue;
            };
            for (name, moved) in [
                ("lumped-mass", lumped),
                ("denoc", links),
                ("difference", links - lumped),
            ] {
                let [x, y, z] = moved.to_array().map(thousandths);
                text.push_str(&format!(
                    "{time_s:>6}  {body:<8} {name:<12} {x:>9.3} {y:>9.3} {z:>9.3}\n"
                ));
            }
        }
    }
    text
}

/// Rounded to what is printed: a zero that came out negative reads as a difference where there is none.
fn thousandths(value: f64) -> f64 {
    (1000.0 * value).round() / 1000.0 + 0.0
}

fn at(track: &[(f64, DVec3)], time_s: f64) -> Option<DVec3> {
    let found = track.iter().find(|(time, _)| (*time - time_s).abs() < 1e-9);
    found.map(|(_, moved)| *moved)
}

fn displacements(found: &ComparisonStudy) -> String {
    let mut text = "formulation,time_s,entity,x_m,y_m,z_m\n".to_owned();
    for flight in flights(found) {
        for body in BODIES {
            for (time_s, moved) in flight.displacements(body) {
                let [x, y, z] = fields(moved);
                let name = flight.formulation.name().to_owned();
                row(
                    &mut text,
                    &[name, number_text(time_s), body.to_owned(), x, y, z],
                );
            }
        }
    }
    text
}

/// Links less lumped masses.
fn differences(found: &ComparisonStudy) -> String {
    let mut text = "time_s,entity,x_m,y_m,z_m\n".to_owned();
    for body in BODIES {
        let [lumped, links] = flights(found).map(|flight| flight.displacements(body));
        for ((time_s, lumped), (_, links)) in lumped.into_iter().zip(links) {
            let [x, y, z] = fields(links - lumped);
            row(&mut text, &[number_text(time_s), body.to_owned(), x, y, z]);
        }
    }
    text
}

fn tensions(found: &ComparisonStudy) -> String {
    let mut text = "formulation,time_s,tension_from_n,tension_to_n\n".to_owned();
    for flight in flights(found) {
        let of = |channel| flight.results.channel(TETHER, channel);
        for ((time_s, from_n), (_, to_n)) in
            of("tension_from_n").into_iter().zip(of("tension_to_n"))
        {
            let name = flight.formulation.name().to_owned();
            row(
                &mut text,
                &[
                    name,
                    number_text(time_s),
                    number_text(from_n),
                    number_text(to_n),
                ],
            );
        }
    }
    text
}

fn stiffness(found: &ComparisonStudy) -> String {
    let mut text = "stiffness_factor,axial_stiffness_n,largest_difference_m\n".to_owned();
    for (factor, largest_m) in &found.limit {
        let stiffness_n = factor * found.hanging.axial_stiffness_n;
        row(
            &mut text,
            &[*factor, stiffness_n, *largest_m].map(number_text),
        );
    }
    text
}
