//! `aerobot wind fit`.

use std::fmt::Write as _;
use std::fs;
use std::process::ExitCode;

use aerobot_engine::trim::scene_file::check_target;
use aerobot_systems::gust_fit::candidate::Kind;
use aerobot_systems::gust_fit::series::{Series, read_series};
use aerobot_systems::gust_fit::{Estimate, GustFit, fit as fit_gust};

use super::{AxisName, FitArguments, MarginalName};
use crate::cli::finding::{Found, tell_found, write_whole};

/// In a record of fewer correlation times, intervals are too narrow.
const LEAST_CORRELATION_TIMES: f64 = 30.0;
/// Digits of fitted numbers.
const DIGITS: usize = 6;

pub(super) fn fit(arguments: &FitArguments) -> ExitCode {
    let out = arguments.out.as_deref();
    tell_found(find_and_write(arguments), arguments.quiet, out)
}

fn find_and_write(arguments: &FitArguments) -> Result<Found, String> {
    if let Some(file) = &arguments.out {
        check_target(file, arguments.force).map_err(|error| error.to_string())?;
    }
    let name = arguments.file.display().to_string();
    let text = fs::read_to_string(&arguments.file)
        .map_err(|error| format!("error: cannot read `{name}`: {error}"))?;
    let series = read_series(&text, arguments.column.as_deref()).map_err(|error| {
        format!(
            "error: {name}:{}:{}: {}",
            error.line, error.column, error.message
        )
    })?;
    let kinds = kinds(arguments.marginal, &series)
        .map_err(|message| format!("error: {name}: {message}"))?;
    let found = fit_gust(&series, &kinds).ok_or_else(|| {
        format!(
            "error: {name}: the likelihood of `{}` has no maximum\n  = help: the record may be too short \
             for its correlation, or no gust with one decay and one frequency",
            series.column
        )
    })?;
    let block = block(&found, &series, &name, arguments.axis);
    if let Some(file) = &arguments.out {
        write_whole(file, |out| out.write_all(block.as_bytes()))?;
    }
    Ok(Found {
        text: format!("{}\n{block}", describe(&found, &series, &name)),
        warnings: warnings(&found, &series),
        written: "the gust, for `environment.wind` of a scene",
    })
}

/// The marginals to try.
fn kinds(wanted: Option<MarginalName>, series: &Series) -> Result<Vec<Kind>, String> {
    let Some(wanted) = wanted else {
        return Ok(Kind::ALL.to_vec());
    };
    let kind = match wanted {
        MarginalName::Normal => Kind::Normal,
        MarginalName::Lognormal => Kind::Lognormal,
        MarginalName::Weibull => Kind::Weibull,
    };
    let below = series.speeds_m_s.iter().find(|speed| **speed <= 0.0);
    match below {
        Some(speed) if kind.is_of_positive() => Err(format!(
            "a {} distribution is of velocities above zero, and `{}` has {speed} m/s",
            kind.name(),
            series.column
        )),
        _ => Ok(vec![kind]),
    }
}

fn span_s(series: &Series) -> f64 {
    series
        .times_s
        .last()
        .zip(series.times_s.first())
        .map_or(0.0, |(last, first)| last - first)
}

fn describe(found: &GustFit, series: &Series, name: &str) -> String {
    let mut text = String::new();
    let _ = writeln!(
        text,
        "{name}: `{}`, {} velocities in {} s, {} marked as missing; 95 % intervals in brackets",
        series.column,
        series.speeds_m_s.len(),
        number(span_s(series)),
        series.gaps
    );
    let others: Vec<String> = found
        .log_likelihoods
        .iter()
        .map(|(kind, value)| format!("{} {value:.2}", kind.name()))
        .collect();
    let _ = writeln!(
        text,
        "  {:<24} {} (ln likelihood: {})",
        "marginal",
        found.kind.name(),
        others.join(", ")
    );
    let [a, b] = found.kind.fields();
    let mut rows = vec![(a, &found.marginal[0]), (b, &found.marginal[1])];
    if found.kind.is_of_positive() {
        rows.push(("mean, m/s", &found.mean_m_s));
    }
    rows.push(("decay_per_s", &found.decay_per_s));
    rows.push(("frequency_rad_s", &found.frequency_rad_s));
    for (field, estimate) in rows {
        let _ = writeln!(text, "  {field:<24} {}", interval(estimate));
    }
    if found.frequency_rad_s.low == 0.0 {
        text.push_str("note: the frequency cannot be told from zero\n");
    }
    text
}

fn warnings(found: &GustFit, series: &Series) -> Vec<String> {
    let times = span_s(series) * found.decay_per_s.value;
    if times >= LEAST_CORRELATION_TIMES {
        return Vec::new();
    }
    vec![format!(
        "the record is {} correlation times long: intervals may be too narrow below {LEAST_CORRELATION_TIMES}",
        number(times)
    )]
}

/// The gust as a scene has it.
fn block(found: &GustFit, series: &Series, name: &str, axis: AxisName) -> String {
    let axis = match axis {
        AxisName::Zonal => "zonal",
        AxisName::Meridional => "meridional",
        AxisName::Vertical => "vertical",
    };
    let [a, b] = &found.marginal;
    let [first, second] = found.kind.fields();
    let (mean, marginal) = match found.kind {
        Kind::Normal => (
            format!("        mean_m_s: {}, // {}\n", number(a.value), range(a)),
            format!("Normal({second}: {}), // {}", number(b.value), range(b)),
        ),
        Kind::Lognormal | Kind::Weibull => {
            let word = if found.kind == Kind::Weibull {
                "Weibull"
            } else {
                "Lognormal"
            };
            let numbers = format!(
                "{first}: {}, {second}: {}",
                number(a.value),
                number(b.value)
            );
            (
                String::new(),
                format!("{word}({numbers}), // {}; {}", range(a), range(b)),
            )
        }
    };
    let (decay, frequency) = (&found.decay_per_s, &found.frequency_rad_s);
    // A line break in a name would end the comment.
    let from = format!("`{}` of `{name}`", series.column).replace(['\n', '\r'], " ");
    format!(
        "// Fitted to {from}, 95 % intervals behind the values.\nGust(\n    {axis}: (\n        \
         decay_per_s: {}, // {}\n        frequency_rad_s: {}, // {}\n{mean}        marginal: \
         {marginal}\n    ),\n),\n",
        number(decay.value),
        range(decay),
        number(frequency.value),
        range(frequency),
    )
}

fn interval(estimate: &Estimate) -> String {
    format!(
        "{:<12} [{}, {}]",
        number(estimate.value),
        number(estimate.low),
        number(estimate.high)
    )
}

fn range(estimate: &Estimate) -> String {
    format!("{} to {}", number(estimate.low), number(estimate.high))
}

/// A number with as many digits as a fit is worth.
fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value);
    aerobot_engine::recording::number::number_text(rounded)
}
