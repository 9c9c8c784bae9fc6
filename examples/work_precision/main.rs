//! Error against CPU time of every integrator in six cases:
//! `cargo run --release --example work_precision`.
//!
//! Writes `docs/work_precision.csv`, draws `docs/work_precision.svg`, and prints what each method takes to
//! keep bodies within 1 cm and 1 mm. Some ten minutes of one core. `-- snap towline` takes the cases with
//! these words in their names anew and leaves the others as the table has them; `-- none` only draws.

#![allow(clippy::expect_used, clippy::panic, reason = "a study may fail loudly")]

mod cases;
mod measure;
#[path = "../../benches/scenes/one_km_line.rs"]
mod one_km_line;
mod row;

use std::path::{Path, PathBuf};

use aerobot_report::table_figures::TableFigureKind;
use cases::{Case, cases};
use row::{HEADER, Method, Row, cost_us};

fn main() {
    let docs = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("docs");
    let table = docs.join("work_precision.csv");
    let asked: Vec<String> = std::env::args().skip(1).collect();
    let is_asked =
        |case: &Case| asked.is_empty() || asked.iter().any(|part| case.name.contains(part));
    let mut rows = read(&table);
    for case in cases().iter().filter(|case| is_asked(case)) {
        rows.retain(|row| row.case != case.name);
        rows.extend(measure::study(case));
    }
    rows.sort_by_key(|row| cases().iter().position(|case| case.name == row.case));
    let lines: Vec<String> = rows.iter().map(Row::line).collect();
    let text = format!("{HEADER}\n{}\n", lines.join("\n"));
    std::fs::write(&table, text).expect("the table can be written");
    let panels = by_case(&rows);
    draw(&docs);
    for error_m in [1e-2, 1e-3] {
        print(&panels, "bodies", |row| row.error_bodies_m, error_m);
        print(&panels, "nodes", |row| row.error_nodes_m, error_m);
    }
}

/// Draws the table as `aerobot plot docs work-precision` does.
fn draw(docs: &Path) {
    let kind = TableFigureKind::of("work-precision").expect("a kind of figure");
    let figure = kind.figure(docs).and_then(|figure| figure.svg());
    let picture = figure.unwrap_or_else(|error| panic!("the picture: {error}"));
    std::fs::write(docs.join("work_precision.svg"), picture).expect("the picture can be written");
}

/// The table as it is; empty if there is none.
fn read(table: &Path) -> Vec<Row> {
    let text = std::fs::read_to_string(table).unwrap_or_default();
    let lines = text.lines().skip(1);
    lines
        .map(|line| Row::parse(line).unwrap_or_else(|| panic!("not a row: {line}")))
        .collect()
}

/// Rows of each case, in the order of the table.
fn by_case(rows: &[Row]) -> Vec<Vec<&Row>> {
    let mut panels: Vec<Vec<&Row>> = Vec::new();
    for row in rows {
        match panels.last_mut() {
            Some(panel) if panel[0].case == row.case => panel.push(row),
            _ => panels.push(vec![row]),
        }
    }
    panels
}

/// What each method takes to keep the error `of` a row, that of `whose`, within `error_m`, m, and in times of the least.
fn print(panels: &[Vec<&Row>], whose: &str, of: fn(&Row) -> f64, error_m: f64) {
    println!();
    println!(
        "CPU time of a simulated second (us), and in times of the least: {whose} within {error_m} m"
    );
    println!();
    let names = Method::ALL.map(Method::name).join(" | ");
    println!("| case | {names} |");
    println!("|---|---|---|---|---|");
    for panel in panels {
        let costs = Method::ALL.map(|method| cost_us(panel, method, of, error_m));
        let known = costs.iter().flatten().map(|cost| cost.0);
        let least = known.fold(f64::INFINITY, f64::min);
        let cells = costs.map(|cost| match cost {
            Some((us, at_most)) => {
                let sign = if at_most { "<= " } else { "" };
                format!("{sign}{us:.0} ({:.2})", us / least)
            }
            None => "-".to_owned(),
        });
        println!("| {} | {} |", panel[0].case, cells.join(" | "));
    }
}
