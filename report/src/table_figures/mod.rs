//! Figures of tables that studies wrote: of integrators, of cost over size.

mod table;

use std::path::Path;

use crate::figure::{Axis, Figure, Mark, Panel, Series};
use table::Table;

/// A figure of a table.
#[derive(Clone, Copy)]
pub struct TableFigureKind {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it shows, in a few words.
    pub about: &'static str,
    /// The file that it is made of.
    pub file: &'static str,
    make: fn(&Table) -> Result<Figure, String>,
}

/// All of them.
pub const KINDS: [TableFigureKind; 2] = [
    TableFigureKind {
        name: "work-precision",
        about: "cost over error of the integrators (of `docs/` and of the example `work_precision`)",
        file: "work_precision.csv",
        make: work_precision,
    },
    TableFigureKind {
        name: "perf-scaling",
        about: "cost over number of elements and length (of `aerobot reproduce performance`)",
        file: "performance_timing.csv",
        make: perf_scaling,
    },
];

impl TableFigureKind {
    /// The kind of a name.
    #[must_use]
    pub fn of(name: &str) -> Option<Self> {
        KINDS.into_iter().find(|kind| kind.name == name)
    }

    /// The figure of the table in a folder.
    ///
    /// # Errors
    /// The table is not there or not as its study writes it, as a sentence.
    pub fn figure(&self, folder: &Path) -> Result<Figure, String> {
        let table = Table::read(&folder.join(self.file))?;
        let mut figure = (self.make)(&table)?;
        self.name.clone_into(&mut figure.name);
        Ok(figure)
    }
}

fn work_precision(table: &Table) -> Result<Figure, String> {
    let cases = table.column("case")?;
    let methods = table.column("method")?;
    let (errors, costs) = (
        table.numbers("error_bodies_m")?,
        table.numbers("cpu_us_per_simulated_s")?,
    );
    let panels = distinct(&cases).into_iter().map(|case| Panel {
        title: case.to_owned(),
        x: Axis::log("largest error of a body [m]"),
        y: Axis::log("CPU time per simulated second [µs/s]"),
        series: distinct(&methods)
            .into_iter()
            .enumerate()
            .map(|(tone, method)| {
                let rows =
                    (0..cases.len()).filter(|row| cases[*row] == case && methods[*row] == method);
                let points = rows.filter_map(|row| Some((errors[row]?, costs[row]?)));
                Series::line(method, points)
                    .with_mark(Mark::LineAndPoints)
                    .with_tone(tone)
            })
            .collect(),
        ..Panel::default()
    });
    Ok(Figure {
        title: "Work over precision".to_owned(),
        panels: panels.collect(),
        ..Figure::default()
    })
}

fn perf_scaling(table: &Table) -> Result<Figure, String> {
    let studies = table.column("study")?;
    let solvers: Vec<String> = table
        .column("formulation")?
        .iter()
        .zip(table.column("integration")?)
        .map(|(formulation, integration)| format!("{formulation}, {integration}"))
        .collect();
    let solvers: Vec<&str> = solvers.iter().map(String::as_str).collect();
    let costs = table.numbers("cpu_s_per_simulated_s")?;
    let panel = |study: &str, column: &str, label: &str| {
        let sizes = table.numbers(column)?;
        let series = distinct(&solvers)
            .into_iter()
            .enumerate()
            .map(|(tone, solver)| {
                let rows = (0..studies.len())
                    .filter(|row| studies[*row] == study && solvers[*row] == solver);
                let points = rows.filter_map(|row| Some((sizes[row]?, costs[row]?)));
                Series::line(solver, points)
                    .with_mark(Mark::LineAndPoints)
                    .with_tone(tone)
            });
        Ok::<_, String>(Panel {
            x: Axis::log(label),
            y: Axis::log("CPU time per simulated second [s/s]"),
            series: series.filter(|series| !series.x.is_empty()).collect(),
            ..Panel::default()
        })
    };
    Ok(Figure {
        title: "Cost over size".to_owned(),
        panels: vec![
            panel("elements", "elements", "elements of the tether [1]")?,
            panel("length_m", "length_m", "length of the tether [m]")?,
        ],
        ..Figure::default()
    })
}

/// Each once, in the order in which they come.
fn distinct<'a>(names: &[&'a str]) -> Vec<&'a str> {
    let mut found: Vec<&str> = Vec::new();
    for name in names {
        if !found.contains(name) {
            found.push(name);
        }
    }
    found
}
