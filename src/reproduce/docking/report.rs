//! The docking as a text and as tables.

use aerobot_components::docking::DockingPhase;
use aerobot_engine::recording::number::number_text;

use super::super::check::{Check, Tolerance, Verdict};
use super::super::flight::{fields, row};
use super::super::{Report, Table};
use super::{Approach, Craft, DockingStudy};

const TITLE: &str = "Docking with the gondola (contribution 4; sec. 5.4 leaves it out)";

const PAPER_SHOWS: &str = "The introduction lists the demonstration of rendezvous and docking of a small drone with the gondola among the \
contributions. Section 5.4 ends where the docking would begin and says that it is not considered in this study: there is \
no figure and no number.";

const HEAD: &str = "\
A rotorcraft docks with the gondola that hangs 2 km below its balloon, in one wind field with gusts of 1 m/s (paper,
contribution 4; `scenes/mav_dock.ron`).

The paper names docking among its contributions and leaves it out in sec. 5.4, so that there is nothing to compare with.
Its fixed-wing drone stalls at 14 m/s, and the gondola moves through the air at 4 m/s; a rotorcraft can stand before it.
Each seed has gusts and errors of navigation of its own.

  seed  station-keeping, s  contact, s  docked, s  contact speed, m/s  momentum exchanged  and lost, kg m/s  power closing in, W
";

/// The phases in order, without the first, which is no event.
const PHASES: [DockingPhase; 4] = [
    DockingPhase::Approach,
    DockingPhase::StationKeeping,
    DockingPhase::Contact,
    DockingPhase::Docked,
];

/// Time between rows of the table of approaches, s.
const ROW_EVERY_S: f64 = 0.1;

/// As long as docking may take, s: shorter flights tell nothing.
const ENOUGH_S: f64 = 120.0;

pub(super) fn report(found: &DockingStudy) -> Report {
    let checks = checks(found);
    let mut text = HEAD.to_owned();
    for approach in &found.approaches {
        text.push_str(&line(approach, &found.craft));
    }
    text.push_str(&format!(
        "\nHover at that place takes {:.0} W by momentum theory (Glauert 1926).\n",
        found.craft.hover_power_w()
    ));
    Report {
        figures: Vec::new(),
        title: TITLE.to_owned(),
        paper_shows: PAPER_SHOWS.to_owned(),
        text,
        verdict: Verdict::of(&checks, sentence(found)),
        checks,
        tables: vec![
            Table {
                file_name: "docking.csv",
                text: summary(found),
            },
            Table {
                file_name: "docking_approach.csv",
                text: approaches(found),
            },
            Table {
                file_name: "docking_phases.csv",
                text: phases(found),
            },
        ],
        stopped: found
            .approaches
            .iter()
            .filter_map(|approach| {
                approach
                    .flight
                    .stop_of(&format!("docking: seed {}", approach.seed))
            })
            .collect(),
    }
}

fn sentence(found: &DockingStudy) -> String {
    let docked: Vec<f64> = found
        .approaches
        .iter()
        .filter_map(Approach::docked_s)
        .collect();
    let (first, last) = docked
        .iter()
        .fold((f64::INFINITY, 0.0_f64), |(first, last), time_s| {
            (first.min(*time_s), last.max(*time_s))
        });
    let times = if docked.is_empty() {
        String::new()
    } else {
        format!(", after {first:.1} to {last:.1} s")
    };
    format!(
        "The paper promises docking and does not show it. Here a rotorcraft docks in {} of {} flights{times}: not the \
         paper's fixed-wing drone, which cannot fly as slowly as the gondola moves through the air.",
        docked.len(),
        found.approaches.len()
    )
}

fn checks(found: &DockingStudy) -> Vec<Check> {
    let long = |approach: &&Approach| approach.flight.simulated_s >= ENOUGH_S;
    let mut checks = Vec::new();
    for approach in found.approaches.iter().filter(long) {
        let seed = approach.seed;
        let kinds: Vec<&str> = approach
            .phases
            .iter()
            .map(|(_, kind)| kind.as_str())
            .collect();
        let expected = PHASES.map(DockingPhase::name);
        checks.push(
            Check::of(format!("phases, seed {seed}"), "", kinds.join(", "))
                .paper("\"demonstration of rendezvous and docking\", not shown")
                .as_in_paper(
                    format!("{}, within {ENOUGH_S} s", expected.join(", ")),
                    kinds == expected,
                ),
        );
        if let Some([thrust_n, airspeed_m_s, power_w]) = approach.closing_means() {
            checks.push(
                Check::of(
                    format!("mean shaft power closing in, seed {seed}"),
                    "W",
                    power_w,
                )
                .against(
                    found.craft.level_power_w(thrust_n, airspeed_m_s),
                    Tolerance::Relative(0.02),
                    "momentum theory (Glauert 1926) of mean thrust and airspeed",
                ),
            );
        }
        checks.extend(of_impact(approach, &found.craft));
    }
    checks
}

fn of_impact(approach: &Approach, craft: &Craft) -> Vec<Check> {
    let (Some(impact), seed) = (&approach.impact, approach.seed) else {
        return Vec::new();
    };
    vec![
        Check::of(
            format!("speed of contact, seed {seed}"),
            "m/s",
            impact.recorded_m_s,
        )
        .against(
            impact.ports_m_s,
            Tolerance::Absolute(0.01),
            "the ports' motion before it",
        ),
        Check::of(
            format!("speed of contact against the latch's limit, seed {seed}"),
            "m/s",
            impact.recorded_m_s,
        )
        .at_most(craft.latch_m_s, "the limit of the latch"),
        Check::of(
            format!(
                "horizontal momentum lost as the latch closes, over what drone and gondola exchange, seed {seed}"
            ),
            "%",
            100.0 * impact.change_kg_m_s() / impact.exchanged_kg_m_s(craft),
        )
        .vanishes(1.0, "the conservation of momentum"),
    ]
}

fn line(approach: &Approach, craft: &Craft) -> String {
    let begun = |phase: DockingPhase| {
        let mut own = approach
            .phases
            .iter()
            .filter(|(_, kind)| kind == phase.name());
        own.next()
            .map_or_else(|| "-".to_owned(), |(time_s, _)| format!("{time_s:.2}"))
    };
    let of_impact = |of: &dyn Fn(&super::Impact) -> f64| {
        let found = approach.impact.as_ref().map(of);
        found.map_or_else(|| "-".to_owned(), |value| format!("{value:.3}"))
    };
    let power = approach
        .closing_means()
        .map_or_else(|| "-".to_owned(), |[.., power_w]| format!("{power_w:.0}"));
    format!(
        "{:>6} {:>19} {:>11} {:>10} {:>19} {:>19} {:>17} {power:>21}\n",
        approach.seed,
        begun(DockingPhase::StationKeeping),
        begun(DockingPhase::Contact),
        begun(DockingPhase::Docked),
        of_impact(&|impact| impact.recorded_m_s),
        of_impact(&|impact| impact.exchanged_kg_m_s(craft)),
        of_impact(&super::Impact::change_kg_m_s),
    )
}

/// A number, or an empty field where there is none.
fn field(value: Option<f64>) -> String {
    value.map_or_else(String::new, number_text)
}

fn summary(found: &DockingStudy) -> String {
    let mut text = "seed,docked_s,contact_speed_m_s,exchanged_kg_m_s,lost_kg_m_s,closing_thrust_n,closing_airspeed_m_s,\
                    closing_power_w\n"
        .to_owned();
    for approach in &found.approaches {
        let impact = approach.impact.as_ref();
        let means = approach.closing_means();
        let numbers = [
            approach.docked_s(),
            impact.map(|impact| impact.recorded_m_s),
            impact.map(|impact| impact.exchanged_kg_m_s(&found.craft)),
            impact.map(super::Impact::change_kg_m_s),
            means.map(|means| means[0]),
            means.map(|means| means[1]),
            means.map(|means| means[2]),
        ];
        let mut fields = vec![approach.seed.to_string()];
        fields.extend(numbers.map(field));
        row(&mut text, &fields);
    }
    text
}

fn approaches(found: &DockingStudy) -> String {
    let mut text = "seed,time_s,x_m,y_m,z_m,distance_m,lateral_error_m,docking_phase,airspeed_m_s,thrust_n,power_w\n".to_owned();
    for approach in &found.approaches {
        let mut due_s = 0.0;
        for own in &approach.rows {
            if own.time_s < due_s - 1e-9 {
                continue;
            }
            due_s += ROW_EVERY_S;
            let mut all = vec![approach.seed.to_string(), number_text(own.time_s)];
            all.extend(fields(own.path_m));
            all.extend(
                [
                    own.distance_m,
                    own.lateral_error_m,
                    own.phase,
                    own.airspeed_m_s,
                    own.thrust_n,
                    own.power_w,
                ]
                .map(number_text),
            );
            row(&mut text, &all);
        }
    }
    text
}

fn phases(found: &DockingStudy) -> String {
    let mut text = "seed,time_s,phase\n".to_owned();
    for approach in &found.approaches {
        for (time_s, kind) in &approach.phases {
            // Reasons may have commas.
            let kind = kind.replace(',', ";");
            row(
                &mut text,
                &[approach.seed.to_string(), number_text(*time_s), kind],
            );
        }
    }
    text
}
