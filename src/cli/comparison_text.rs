//! A comparison as a text to read.

use crate::comparison::difference::{BodyDifference, TensionAt, TetherDifference};
use crate::comparison::{ComparedRun, Comparison};

/// Width of a column of numbers.
const WIDTH: usize = 12;

/// The differences of bodies and tethers, and the costs.
pub(super) fn describe(comparison: &Comparison) -> String {
    let [first, second] = comparison.runs.each_ref().map(|run| run.name);
    let mut text = format!("{}: {second} less {first}", comparison.scene);
    if let Some(time_s) = comparison.compared_until_s() {
        text.push_str(&format!(", up to {time_s} s"));
    }
    text.push('\n');
    for missing in &comparison.missing {
        text.push_str(&format!("note: {missing}\n"));
    }
    if !comparison.bodies.is_empty() {
        text.push_str(&bodies(&comparison.bodies));
    }
    if !comparison.tethers.is_empty() {
        text.push_str(&tethers(&comparison.tethers, [first, second]));
    }
    text.push_str(&costs(&comparison.runs));
    text
}

/// A line of a table: names to the left, numbers to the right.
fn line(name: &str, part: &str, fields: &[String]) -> String {
    let mut line = format!("{name:<16} {part:<20}");
    for field in fields {
        line.push_str(&format!(" {field:>WIDTH$}"));
    }
    format!("{}\n", line.trim_end())
}

fn words(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| (*word).to_owned()).collect()
}

fn bodies(bodies: &[BodyDifference]) -> String {
    let mut text = line("\nbody", "", &words(&["largest", "at", "final"]));
    text.push_str(&line("", "", &words(&["m", "s", "m"])));
    for body in bodies {
        let last = body.last.1;
        let [x, y, z] = body.largest_m;
        for (index, (part, largest, last_m)) in [
            ("x", x, last.x),
            ("y", y, last.y),
            ("z", z, last.z),
            ("distance", body.largest_distance_m, last.length()),
        ]
        .into_iter()
        .enumerate()
        {
            let name = if index == 0 { &*body.name } else { "" };
            let fields = [
                readable(largest.value),
                seconds(largest.time_s),
                readable(last_m),
            ];
            text.push_str(&line(name, part, &fields));
        }
    }
    text
}

fn tethers(tethers: &[TetherDifference], names: [&str; 2]) -> String {
    let mut text = line("\ntether", "", &words(&["tension", "at", "segment"]));
    text.push_str(&line("", "", &words(&["N", "s"])));
    for tether in tethers {
        let [first, second] = tether.largest_tension_n;
        let [first_name, second_name] = names;
        for (index, (part, tension)) in [
            (first_name, first),
            (second_name, second),
            ("largest difference", tether.largest_difference_n),
            ("final difference", tether.final_difference_n),
        ]
        .into_iter()
        .enumerate()
        {
            let name = if index == 0 { &*tether.name } else { "" };
            text.push_str(&line(name, part, &tension_fields(tension)));
        }
    }
    text
}

fn tension_fields(tension: TensionAt) -> [String; 3] {
    [
        readable(tension.value_n),
        seconds(tension.time_s),
        tension.segment.to_string(),
    ]
}

fn costs(runs: &[ComparedRun; 2]) -> String {
    let row = |name: &str, number: fn(&ComparedRun) -> String| {
        line(name, "", &runs.each_ref().map(number))
    };
    let mut text = row("\ncost", |run| run.name.to_owned());
    text.push_str(&row("steps", |run| run.summary.steps.to_string()));
    text.push_str(&row("rejected", |run| {
        run.summary.rejected_steps.to_string()
    }));
    text.push_str(&row("evaluations", |run| {
        run.summary.evaluations.to_string()
    }));
    text.push_str(&row("simulated, s", |run| seconds(run.summary.simulated_s)));
    text.push_str(&row("CPU time, s", |run| readable(run.timing.cpu_s)));
    text.push_str(&row("simulated s per CPU s", |run| {
        format!("{:.0}", run.timing.simulated_s_per_cpu_s)
    }));
    for run in runs {
        text.push_str(&format!(
            "integrator of {}: {}\n",
            run.name, run.summary.integrator
        ));
    }
    text
}

/// A number with five digits, plainly where it has a common size.
fn readable(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let size = value.abs();
    if !(1e-4..1e7).contains(&size) {
        return format!("{value:.4e}");
    }
    let digits_before = size.log10().floor() as i32 + 1;
    let decimals = usize::try_from(5 - digits_before).unwrap_or(0);
    without_zeros(format!("{value:.decimals$}"))
}

/// A time with its microseconds.
fn seconds(time_s: f64) -> String {
    without_zeros(format!("{time_s:.6}"))
}

/// A number without the zeros that end its decimals.
fn without_zeros(number: String) -> String {
    if !number.contains('.') {
        return number;
    }
    number
        .trim_end_matches('0')
        .trim_end_matches('.')
        .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_cut_to_what_is_read() {
        for (value, text) in [
            (0.0, "0"),
            (100.0, "100"),
            (123_456.7, "123457"),
            (-0.012_345_678, "-0.012346"),
            (1.5, "1.5"),
            (-3.25e-9, "-3.2500e-9"),
        ] {
            assert_eq!(readable(value), text);
        }
        assert_eq!(seconds(0.1 + 0.2), "0.3");
        assert_eq!(seconds(12_345.678_9), "12345.6789");
    }
}
