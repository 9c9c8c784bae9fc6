//! `aerobot modes`.

use std::fmt::Write as _;
use std::fs;
use std::process::ExitCode;

use aerobot_engine::modes::{ClosedLoop, Mode, Modes, ModesRequest};
use aerobot_engine::plugin::Simulator;

use super::ModesArguments;
use super::finding::{self, Found};

/// Smaller shares are not printed; they are in the file.
const LEAST_SHARE: f64 = 0.005;

pub(super) fn modes(simulator: &Simulator, arguments: &ModesArguments) -> ExitCode {
    let out = arguments.out.as_deref();
    let found = find_and_write(simulator, arguments).map(|found| Found {
        text: describe(&found),
        warnings: found.trim.warnings,
        written: "all numbers",
    });
    finding::tell(found, &arguments.find, out)
}

fn find_and_write(simulator: &Simulator, arguments: &ModesArguments) -> Result<Modes, String> {
    let out = arguments.out.as_deref();
    let (scene, mut simulation) = finding::build(simulator, &arguments.find, out)?;
    let request = ModesRequest {
        count: arguments.count as usize,
        ..ModesRequest::default()
    };
    let found = simulation
        .modes(&scene, &request)
        .map_err(|error| error.to_string())?;
    if let Some(file) = out {
        fs::write(file, table(&found))
            .map_err(|error| format!("error: cannot write `{}`: {error}", file.display()))?;
    }
    Ok(found)
}

fn describe(found: &Modes) -> String {
    let mut text = String::new();
    for note in found.trim.notes.iter().chain(&found.notes) {
        let _ = writeln!(text, "note: {note}");
    }
    let _ = writeln!(
        text,
        "{} of small motions about the steady state, slowest first; shares of kinetic energy with added mass",
        counted(found.modes.len(), "mode")
    );
    for (index, mode) in found.modes.iter().enumerate() {
        let _ = writeln!(text, "{:3}  {}  {}", index + 1, numbers(mode), mode.name);
        let _ = writeln!(text, "       {}", shares(mode));
    }
    for words in &found.neutral {
        let _ = writeln!(text, "neutral: {words}");
    }
    for closed in &found.closed_loops {
        text.push_str(&closed_loop(closed));
    }
    text
}

/// Slow modes of a closed loop that are printed.
const PRINTED_OF_LOOP: usize = 8;

fn closed_loop(closed: &ClosedLoop) -> String {
    let word = if closed.is_stable() {
        "stable"
    } else {
        "UNSTABLE"
    };
    let mut text = format!(
        "closed loop of `{}` on `{}`, sampled every {} s, nothing cut: {word}\n",
        closed.controller, closed.actuator, closed.period_s
    );
    let margins = &closed.margins;
    let hz = |frequency: f64| significant(frequency / std::f64::consts::TAU, 4);
    let gain = |found: Option<(f64, f64)>| {
        found.map_or_else(
            || "any".to_owned(),
            |(factor, at)| format!("{} (at {} Hz)", significant(factor, 4), hz(at)),
        )
    };
    let phase = margins.phase_rad.map_or_else(
        || "any".to_owned(),
        |(phase, at)| format!("{:.1} deg (at {} Hz)", phase.to_degrees(), hz(at)),
    );
    let _ = writeln!(
        text,
        "     at the command: gain may grow to x {}, fall to x {}; phase margin {phase}; |1 + L| at least {}",
        gain(margins.gain_up),
        margins
            .gain_down
            .map_or_else(|| "0".to_owned(), |found| gain(Some(found))),
        significant(margins.distance, 3)
    );
    for (growth, turn) in closed.modes.iter().take(PRINTED_OF_LOOP) {
        let rate = growth.hypot(*turn);
        let _ = if *turn > 0.0 {
            writeln!(
                text,
                "     {:>10} s  damping {:>9}",
                significant(std::f64::consts::TAU / turn, 5),
                ratio(-growth / rate)
            )
        } else {
            let verb = if *growth > 0.0 { "grows" } else { "decays" };
            writeln!(
                text,
                "     {verb} by a factor e in {} s",
                significant(1.0 / growth.abs(), 5)
            )
        };
    }
    text
}

fn counted(count: usize, what: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {what}{plural}")
}

/// Frequency, period and damping; of a mode that does not oscillate, its time constant.
fn numbers(mode: &Mode) -> String {
    let unstable = if mode.is_unstable() { "  UNSTABLE" } else { "" };
    match mode.period_s() {
        Some(period_s) => format!(
            "{:>11} Hz  {:>10} s  damping {:>9}{unstable}",
            significant(mode.frequency_hz(), 6),
            significant(period_s, 5),
            ratio(mode.damping_ratio()),
        ),
        None => {
            let verb = if mode.is_unstable() {
                "grows"
            } else {
                "decays"
            };
            format!(
                "{:>11}     {verb} by a factor e in {:>9} s{unstable}",
                "-",
                significant(mode.time_constant_s(), 5),
            )
        }
    }
}

fn ratio(value: f64) -> String {
    let text = format!("{value:.6}");
    match text.strip_prefix('-') {
        Some(digits) if digits.chars().all(|c| c == '0' || c == '.') => digits.to_owned(),
        _ => text,
    }
}

/// So many significant digits.
fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let exponent: i32 = format!("{value:e}")
        .rsplit('e')
        .next()
        .and_then(|text| text.parse().ok())
        .unwrap_or(0);
    if !(-5..=6).contains(&exponent) {
        return format!("{value:.*e}", digits - 1);
    }
    let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
    format!("{value:.decimals$}")
}

fn shares(mode: &Mode) -> String {
    let large: Vec<String> = mode
        .shares
        .iter()
        .filter(|share| share.part >= LEAST_SHARE)
        .map(|share| {
            let (part, word) = (100.0 * share.part, share.motion.word());
            format!("`{}` {word} {part:.1} %", share.entity)
        })
        .collect();
    large.join(", ")
}

/// A row for every share of every mode; what does not apply is empty.
fn table(found: &Modes) -> String {
    let mut text = "mode,name,frequency_hz,period_s,damping_ratio,time_constant_s,growth_per_s,\
                    angular_frequency_rad_s,unstable,entity,motion,kinetic_energy_share\n"
        .to_owned();
    for (index, mode) in found.modes.iter().enumerate() {
        let constant = mode.time_constant_s();
        let constant = if constant.is_finite() {
            constant.to_string()
        } else {
            String::new()
        };
        let head = format!(
            "{},\"{}\",{},{},{},{constant},{},{},{}",
            index + 1,
            mode.name.replace('"', "\"\""),
            mode.frequency_hz(),
            mode.period_s().map_or_else(String::new, |s| s.to_string()),
            mode.damping_ratio(),
            mode.growth_per_s,
            mode.angular_frequency_rad_s,
            mode.is_unstable(),
        );
        for share in &mode.shares {
            let (entity, word) = (&share.entity, share.motion.word());
            let _ = writeln!(text, "{head},{entity},{word},{}", share.part);
        }
    }
    text
}
