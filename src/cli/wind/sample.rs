//! `aerobot wind sample`.

use std::fmt::Write as _;
use std::io::{self, BufWriter, Write};
use std::process::ExitCode;

use aerobot_engine::builtin::environment::environment_model;
use aerobot_engine::builtin::gusts::describe;
use aerobot_engine::plugin::Simulator;
use aerobot_engine::recording::number::write_number;
use aerobot_engine::scene::Scene;
use aerobot_engine::trim::scene_file::check_target;
use aerobot_systems::environment::gust::GustAxis;
use aerobot_systems::environment::gust::statistics::statistics;
use aerobot_systems::environment::wind::{OutsideWindProfile, Wind};

use super::SampleArguments;
use crate::cli::finding::{Found, tell_found, write_whole};

/// More rows, or knots of one gust, than this are a slip of the pen.
const MOST_ROWS: f64 = 2e7;
/// In a record of fewer correlation times, the errors that are printed are no more than a hint.
const LEAST_CORRELATION_TIMES: f64 = 10.0;

pub(super) fn sample(simulator: &Simulator, arguments: &SampleArguments) -> ExitCode {
    let out = arguments.out.as_deref();
    tell_found(find_and_write(simulator, arguments), arguments.quiet, out)
}

fn find_and_write(simulator: &Simulator, arguments: &SampleArguments) -> Result<Found, String> {
    if let Some(file) = &arguments.out {
        check_target(file, arguments.force).map_err(|error| error.to_string())?;
    }
    let mut overrides = arguments.set.clone();
    overrides.extend(arguments.seed.map(|seed| format!("run.seed={seed}")));
    let scene = simulator
        .load(&arguments.scene, &overrides)
        .map_err(|error| error.to_string())?;
    let model = environment_model(&scene).map_err(|error| scene.refuse(error).to_string())?;
    let mut wind = model.wind;
    let sampling = Sampling::of(arguments, &scene, &wind)?;
    if let Some(file) = &arguments.out {
        sampling
            .check_altitudes(&wind)
            .map_err(|error| format!("error: {error}"))?;
        write_whole(file, |out| sampling.write(&mut wind, out))?;
    }
    let gusts: Vec<&GustAxis> = wind.gusts().collect();
    let mut found = Found {
        text: String::new(),
        warnings: Vec::new(),
        written: "the wind",
    };
    for (gust, line) in gusts.iter().zip(describe(&gusts)) {
        let _ = writeln!(found.text, "{line}");
        found
            .text
            .push_str(&table(gust, scene.run.seed, sampling.duration_s));
        let times = sampling.duration_s * gust.design().parameters.process.decay_per_s;
        if times < LEAST_CORRELATION_TIMES {
            found.warnings.push(format!(
                "the realisation is {times:.2} correlation times long: errors hold for long ones"
            ));
        }
    }
    found.warnings.dedup();
    Ok(found)
}

/// What is drawn, and where.
struct Sampling {
    duration_s: f64,
    every_s: f64,
    /// Empty where the wind does not depend on altitude.
    altitudes_m: Vec<f64>,
}

impl Sampling {
    fn of(arguments: &SampleArguments, scene: &Scene, wind: &Wind) -> Result<Self, String> {
        let finest = wind.gusts().map(|gust| gust.design().grid_s);
        let Some(finest_s) = finest.min_by(f64::total_cmp) else {
            return Err(format!(
                "error: the wind of `{}` has no stochastic gust\n  = help: add a `Gust(..)` to \
                 `environment.wind`; `aerobot wind fit` makes one of a measured series",
                scene.name
            ));
        };
        let duration_s = arguments.duration.unwrap_or(scene.run.duration_s);
        let every_s = arguments.every.unwrap_or(finest_s);
        for (option, value) in [("--duration", duration_s), ("--every", every_s)] {
            if !value.is_finite() || value <= 0.0 {
                return Err(format!(
                    "error: `{option}` must be above zero, it is {value}"
                ));
            }
        }
        let altitudes_m = altitudes(arguments, wind)?;
        let rows = duration_s / every_s.min(finest_s) * altitudes_m.len().max(1) as f64;
        if rows > MOST_ROWS {
            return Err(format!(
                "error: {duration_s} s in steps of {} s are more than {MOST_ROWS:e} rows",
                every_s.min(finest_s)
            ));
        }
        Ok(Self {
            duration_s,
            every_s,
            altitudes_m,
        })
    }

    /// The wind must be known at all altitudes before anything is written.
    fn check_altitudes(&self, wind: &Wind) -> Result<(), OutsideWindProfile> {
        let mut altitudes = self.altitudes_m.iter();
        altitudes.try_for_each(|altitude_m| wind.velocity_m_s(*altitude_m).map(|_| ()))
    }

    fn write(&self, wind: &mut Wind, out: &mut dyn Write) -> io::Result<()> {
        let mut out = BufWriter::new(out);
        let is_layered = !self.altitudes_m.is_empty();
        let altitude = if is_layered { "altitude_m," } else { "" };
        writeln!(
            out,
            "time_s,{altitude}zonal_m_s,meridional_m_s,vertical_m_s"
        )?;
        let anywhere = [0.0];
        let altitudes_m = if is_layered {
            &self.altitudes_m[..]
        } else {
            &anywhere
        };
        // The last row stands at the end even if a step is lost to round-off.
        let count = (self.duration_s / self.every_s + 1e-9) as u64;
        for row in 0..=count {
            let time_s = row as f64 * self.every_s;
            wind.begin_interval(time_s);
            wind.advance_gusts(time_s);
            for altitude_m in altitudes_m {
                write_number(&mut out, time_s)?;
                if is_layered {
                    write!(out, ",")?;
                    write_number(&mut out, *altitude_m)?;
                }
                let velocity = wind.velocity_m_s(*altitude_m).map_err(io::Error::other)?;
                for part in velocity.to_array() {
                    write!(out, ",")?;
                    write_number(&mut out, part)?;
                }
                writeln!(out)?;
            }
        }
        out.flush()
    }
}

/// The altitudes of the file.
fn altitudes(arguments: &SampleArguments, wind: &Wind) -> Result<Vec<f64>, String> {
    if !wind.depends_on_altitude() {
        return Ok(Vec::new());
    }
    if !arguments.altitude.is_empty() || arguments.out.is_none() {
        return Ok(arguments.altitude.clone());
    }
    let levels = wind.gusts().find_map(|gust| gust.design().levels.as_ref());
    match levels {
        Some(levels) => {
            let (low, high) = (levels.lowest_m, levels.highest_m);
            Ok(vec![low, 0.5 * (low + high), high])
        }
        None => Err(
            "error: the wind depends on altitude\n  = help: say where it is to be drawn: \
                     `--altitude 56000`, once or more often"
                .to_owned(),
        ),
    }
}

fn table(gust: &GustAxis, seed: u64, duration_s: f64) -> String {
    let design = gust.design();
    let mut text = format!(
        "  {:<42} {:>11} {:>11} {:>11} {:>8}\n",
        format!("{} s", duration_s),
        "found",
        "theory",
        "error",
        "off by"
    );
    for row in statistics(design, seed, duration_s, &design.telling_lags_s()) {
        let off = if row.error > 0.0 {
            format!("{:.2}", (row.found - row.theory) / row.error)
        } else {
            "-".to_owned()
        };
        let _ = writeln!(
            text,
            "  {:<42} {:>11.5} {:>11.5} {:>11.5} {off:>8}",
            row.name,
            row.found,
            // Minus zero reads as a difference where there is none.
            row.theory + 0.0,
            row.error
        );
    }
    text
}
