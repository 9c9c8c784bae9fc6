//! The chains as a text and as tables.

use aerobot_engine::recording::number::number_text;

use super::super::check::{Verdict, largest};
use super::super::flight::{Flight, fields, largest_difference_m, row};
use super::super::{Report, Table};
use super::{ChainResult, GONDOLA, checks};

const TITLE: &str = "Several tethers and a flight chain (sec. 4.3.1, figures 9 and 10)";

const PAPER_SHOWS: &str = "Figure 9 shows a gondola on several tethers, figure 10 a flight chain with instruments on single and double \
lines below it, as examples of what can be simulated. There are no numbers. The text has closed loops in lumped masses \
alone, since the toolkit of the paper moves trees only.";

const HEAD: &str = "\
A gondola on three tethers, and the same with instruments below it on a single and a double line (paper, sec. 4.3.1,
figures 9 and 10), in the three gusts of the comparison case.

The paper shows both as pictures, without numbers, and moves closed loops in lumped masses only: its toolkit for rigid links
knows trees. Here both formulations close loops. Values are chosen in `scenes/paper/multi_tether.ron` and `flight_chain.ron`.
";

/// Times whose shapes are in the table, s: at rest, in each gust, and at the end.
const SHAPES_S: [f64; 6] = [0.0, 15.0, 25.0, 50.5, 55.0, 100.0];

pub(super) fn report(results: &[ChainResult]) -> Report {
    let checks = checks::checks(results);
    let mut text = HEAD.to_owned();
    for result in results {
        text.push_str(&architecture(result));
    }
    let stopped = results.iter().flat_map(|result| {
        result.flights().into_iter().filter_map(|flight| {
            let (scene, formulation) = (result.architecture.name(), flight.formulation.name());
            flight.stop_of(&format!("chains: {scene}, {formulation}"))
        })
    });
    Report {
        figures: Vec::new(),
        title: TITLE.to_owned(),
        paper_shows: PAPER_SHOWS.to_owned(),
        text,
        verdict: Verdict::of(&checks, sentence(results)),
        checks,
        tables: vec![
            table("chains_displacement.csv", displacements(results)),
            table("chains_tension.csv", tensions(results)),
            table("chains_angles.csv", angles(results)),
            table("chains_shapes.csv", shapes(results)),
            table("chains_stiffness.csv", stiffness(results)),
        ],
        stopped: stopped.collect(),
    }
}

fn table(file_name: &'static str, text: String) -> Table {
    Table { file_name, text }
}

fn sentence(results: &[ChainResult]) -> String {
    let apart: Vec<String> = results
        .iter()
        .map(|result| {
            let bodies = result.architecture.bodies().iter();
            let apart =
                bodies.map(|body| largest_difference_m(&result.lumped, &result.links, body));
            format!("{:.3} m ({})", largest(apart), result.architecture.name())
        })
        .collect();
    format!(
        "Both architectures of the paper fly, and in both formulations, where the paper has lumped masses alone: they differ \
         by up to {}, which falls as 1/EA. The paper has no numbers to agree with.",
        apart.join(" and ")
    )
}

fn architecture(result: &ChainResult) -> String {
    let mut text = format!(
        "\n{}\n\n{:<34} {:>12} {:>12}\n",
        result.architecture.name(),
        "",
        "lumped",
        "links"
    );
    let mut line = |what: &str, of: &dyn Fn(&Flight) -> f64, decimals: usize| {
        let [lumped, links] = result.flights().map(of);
        text.push_str(&format!(
            "{what:<34} {lumped:>12.decimals$} {links:>12.decimals$}\n"
        ));
    };
    for load in &result.loads {
        for tether in &load.tethers {
            let rest = |flight: &Flight| flight.first(tether, "tension_from_n").unwrap_or(f64::NAN);
            line(&format!("{tether}, at rest, above, N"), &rest, 2);
            let most = |flight: &Flight| {
                let found = flight.largest(tether, "tension_from_n", f64::INFINITY);
                found.unwrap_or(f64::NAN)
            };
            line(&format!("{tether}, largest, above, N"), &most, 2);
        }
    }
    let degrees = |channel: &'static str| {
        move |flight: &Flight| {
            let found = flight.largest(GONDOLA, channel, f64::INFINITY);
            found.unwrap_or(f64::NAN).to_degrees()
        }
    };
    line(
        "largest swing of the gondola, deg",
        &degrees("swing_rad"),
        3,
    );
    line(
        "largest heading of the gondola, deg",
        &degrees("heading_rad"),
        3,
    );
    text.push_str("\nEA x, largest difference from links with the same masses at their joints, m:");
    for (factor, largest_m) in &result.limit {
        text.push_str(&format!("  {}: {largest_m:.6}", number_text(*factor)));
    }
    text.push('\n');
    text
}

/// What stands first in every row.
fn names(result: &ChainResult, flight: &Flight) -> [String; 2] {
    [result.architecture.name(), flight.formulation.name()].map(str::to_owned)
}

fn displacements(results: &[ChainResult]) -> String {
    let mut text = "architecture,formulation,time_s,entity,x_m,y_m,z_m\n".to_owned();
    for result in results {
        for flight in result.flights() {
            for body in result.architecture.bodies() {
                for (time_s, moved) in flight.displacements(body) {
                    let [scene, name] = names(result, flight);
                    let [x, y, z] = fields(moved);
                    let body = (*body).to_owned();
                    row(
                        &mut text,
                        &[scene, name, number_text(time_s), body, x, y, z],
                    );
                }
            }
        }
    }
    text
}

fn tensions(results: &[ChainResult]) -> String {
    let mut text =
        "architecture,formulation,time_s,tether,tension_from_n,tension_to_n\n".to_owned();
    for result in results {
        for flight in result.flights() {
            for tether in result.loads.iter().flat_map(|load| &load.tethers) {
                let of = |channel| flight.results.channel(tether, channel);
                for ((time_s, from_n), (_, to_n)) in
                    of("tension_from_n").into_iter().zip(of("tension_to_n"))
                {
                    let [scene, name] = names(result, flight);
                    let [time, from, to] = [time_s, from_n, to_n].map(number_text);
                    row(&mut text, &[scene, name, time, tether.clone(), from, to]);
                }
            }
        }
    }
    text
}

/// Swing and heading of all bodies that have them.
fn angles(results: &[ChainResult]) -> String {
    let mut text = "architecture,formulation,time_s,entity,channel,angle_rad\n".to_owned();
    for result in results {
        for flight in result.flights() {
            for body in result.architecture.bodies() {
                for channel in ["swing_rad", "heading_rad"] {
                    for (time_s, angle) in flight.results.channel(body, channel) {
                        let [scene, name] = names(result, flight);
                        let (body, channel) = ((*body).to_owned(), channel.to_owned());
                        let [time, angle] = [time_s, angle].map(number_text);
                        row(&mut text, &[scene, name, time, body, channel, angle]);
                    }
                }
            }
        }
    }
    text
}

/// Bodies and nodes at some times, from the centre of the balloon at the start.
fn shapes(results: &[ChainResult]) -> String {
    let mut text = "architecture,formulation,time_s,entity,x_m,y_m,z_m\n".to_owned();
    for result in results {
        for flight in result.flights() {
            let Some(start) = flight.start(super::BALLOON) else {
                continue;
            };
            for frame in SHAPES_S
                .into_iter()
                .filter_map(|time_s| flight.frame(time_s))
            {
                for state in &frame.states {
                    let [scene, name] = names(result, flight);
                    let [x, y, z] = fields(state.position_m - start);
                    let entity = state.entity.to_string();
                    row(
                        &mut text,
                        &[scene, name, number_text(frame.time_s), entity, x, y, z],
                    );
                }
            }
        }
    }
    text
}

fn stiffness(results: &[ChainResult]) -> String {
    let mut text = "architecture,stiffness_factor,largest_difference_m\n".to_owned();
    for result in results {
        for (factor, largest_m) in &result.limit {
            let [factor, largest] = [*factor, *largest_m].map(number_text);
            row(
                &mut text,
                &[result.architecture.name().to_owned(), factor, largest],
            );
        }
    }
    text
}
