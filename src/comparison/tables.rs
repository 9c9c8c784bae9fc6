//! The tables of a comparison. What either run took is in its own folder, so that these have the same
//! bytes for the same scene, seed and version.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::Path;

use aerobot_engine::recording::number::number_text;
use aerobot_engine::run_folder::RunError;

use super::Comparison;
use super::difference::{At, TensionAt};

/// The difference of each body at each time.
const DIFFERENCES: &str = "differences.csv";
/// The largest and the final difference of each body.
const BODIES: &str = "body_differences.csv";
/// The largest tensions and their differences.
const TETHERS: &str = "tether_differences.csv";
/// The work of each run.
const COSTS: &str = "costs.csv";

/// Removes the tables of an earlier comparison from a folder, so that none outlives its runs.
pub(super) fn remove(folder: &Path) -> Result<(), RunError> {
    for file in [DIFFERENCES, BODIES, TETHERS, COSTS] {
        let path = folder.join(file);
        match fs::remove_file(&path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                return Err(RunError::Io(path, error));
            }
            _ => {}
        }
    }
    Ok(())
}

/// Writes all tables into a folder that exists.
pub(super) fn write(comparison: &Comparison, folder: &Path) -> io::Result<()> {
    type Table = fn(&Comparison, &mut dyn Write) -> io::Result<()>;
    let tables: [(&str, Table); 4] = [
        (DIFFERENCES, write_differences),
        (BODIES, write_bodies),
        (TETHERS, write_tethers),
        (COSTS, write_costs),
    ];
    for (file, table) in tables {
        let mut out = BufWriter::new(File::create(folder.join(file))?);
        table(comparison, &mut out)?;
        out.flush()?;
    }
    Ok(())
}

fn write_differences(comparison: &Comparison, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "time_s,entity,x_m,y_m,z_m,distance_m")?;
    let bodies = &comparison.bodies;
    let mut rows: Vec<(f64, usize, usize)> = bodies
        .iter()
        .enumerate()
        .flat_map(|(body, found)| {
            let times = found.differences_m.iter().enumerate();
            times.map(move |(number, (time_s, _))| (*time_s, body, number))
        })
        .collect();
    // By time; bodies stay in the order of the scene.
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (time_s, body, number) in rows {
        let Some(body) = bodies.get(body) else {
            continue;
        };
        let Some((_, difference)) = body.differences_m.get(number) else {
            continue;
        };
        write!(out, "{},{}", number_text(time_s), body.name)?;
        let [x, y, z] = difference.to_array();
        write_numbers(out, &[x, y, z, difference.length()])?;
    }
    Ok(())
}

fn write_bodies(comparison: &Comparison, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "entity,part,largest_m,largest_at_s,final_m,final_at_s")?;
    for body in &comparison.bodies {
        let (last_s, last) = body.last;
        let [x, y, z] = body.largest_m;
        for (part, At { value, time_s }, last_m) in [
            ("x", x, last.x),
            ("y", y, last.y),
            ("z", z, last.z),
            ("distance", body.largest_distance_m, last.length()),
        ] {
            write!(out, "{},{part}", body.name)?;
            write_numbers(out, &[value, time_s, last_m, last_s])?;
        }
    }
    Ok(())
}

fn write_tethers(comparison: &Comparison, out: &mut dyn Write) -> io::Result<()> {
    write!(out, "tether")?;
    let names = comparison
        .runs
        .each_ref()
        .map(|run| run.name.replace('-', "_"));
    for what in names.map(|name| format!("{name}_largest_tension")) {
        write!(out, ",{what}_n,{what}_at_s,{what}_segment")?;
    }
    for what in ["largest_difference", "final_difference"] {
        write!(out, ",{what}_n,{what}_at_s,{what}_segment")?;
    }
    writeln!(out)?;
    for tether in &comparison.tethers {
        write!(out, "{}", tether.name)?;
        let [first, second] = tether.largest_tension_n;
        for TensionAt {
            value_n,
            time_s,
            segment,
        } in [
            first,
            second,
            tether.largest_difference_n,
            tether.final_difference_n,
        ] {
            let (value, time) = (number_text(value_n), number_text(time_s));
            write!(out, ",{value},{time},{segment}")?;
        }
        writeln!(out)?;
    }
    Ok(())
}

fn write_costs(comparison: &Comparison, out: &mut dyn Write) -> io::Result<()> {
    writeln!(
        out,
        "run,integrator,steps,implicit_steps,rejected_steps,evaluations,simulated_s,outcome"
    )?;
    for run in &comparison.runs {
        let summary = &run.summary;
        // Its settings are set off by commas.
        let integrator = summary.integrator.replace('"', "\"\"");
        writeln!(
            out,
            "{},\"{integrator}\",{},{},{},{},{},{}",
            run.name,
            summary.steps,
            summary.implicit_steps,
            summary.rejected_steps,
            summary.evaluations,
            number_text(summary.simulated_s),
            summary.outcome
        )?;
    }
    Ok(())
}

/// Ends a row with numbers.
fn write_numbers(out: &mut dyn Write, numbers: &[f64]) -> io::Result<()> {
    for number in numbers {
        write!(out, ",{}", number_text(*number))?;
    }
    writeln!(out)
}
