//! The CSV files that a campaign itself reads: its plan, and numbers that were measured.

use std::collections::BTreeMap;

use super::comma_separated::{CommaSeparated, read_comma_separated};
use super::distributions::Distribution;
use super::plan::PlanTables;
use super::specification::{CampaignSpec, Faults, PlanSpec, entry_path};
use crate::scene::source::{FieldPath, scan};

/// Texts of files by the names that the campaign gives them.
pub(super) type Files = BTreeMap<String, String>;

/// Reads what the campaign names; `read` gives the text of a file, or why there is none.
pub(super) fn read_tables(
    specification: &CampaignSpec,
    read: &dyn Fn(&str) -> Result<String, String>,
    faults: &mut Faults,
) -> (PlanTables, Files) {
    let mut files = Files::new();
    let mut open = |file: &str| -> Result<CommaSeparated, String> {
        let text =
            read(file).map_err(|error| format!("cannot read the table `{file}`: {error}"))?;
        let table = read_comma_separated(&text).map_err(|error| format!("{file}:{error}"))?;
        files.insert(file.to_owned(), text);
        Ok(table)
    };
    let mut tables = PlanTables {
        plan: None,
        measured: Vec::new(),
    };
    if let PlanSpec::Table(file) = &specification.plan {
        let table =
            open(file).and_then(|table| check_plan(file, &table, specification).map(|()| table));
        match table {
            Ok(table) => tables.plan = Some(table),
            Err(error) => faults.0.add("plan", error, ""),
        }
    }
    for (path, distribution) in &specification.vary.0 {
        let Distribution::Measured { file, column } = distribution else {
            continue;
        };
        match open(file).and_then(|table| numbers(file, &table, column)) {
            Ok(numbers) => tables.measured.push(numbers),
            Err(error) => faults.0.add(&entry_path("vary", path), error, ""),
        }
    }
    (tables, files)
}

/// Columns must be paths of fields that are not given otherwise, and cells values of the scene language.
fn check_plan(file: &str, table: &CommaSeparated, campaign: &CampaignSpec) -> Result<(), String> {
    if table.rows.is_empty() {
        return Err(format!("{file}:1: the plan has no row below its header"));
    }
    for (place, name) in table.header.iter().enumerate() {
        let at = format!("{file}:1: column {}", place + 1);
        if let Err(why) = name.parse::<FieldPath>() {
            return Err(format!("{at}: {why}"));
        }
        if table.header[..place].contains(name) {
            return Err(format!("{at}: `{name}` is given twice"));
        }
        let set = campaign.set.0.iter().map(|(path, _)| path);
        let mut given = set.chain(campaign.vary.0.iter().map(|(path, _)| path));
        if given.any(|path| path == name) {
            return Err(format!("{at}: `{name}` is also given in the campaign file"));
        }
    }
    for (line, row) in &table.rows {
        for (name, cell) in table.header.iter().zip(row) {
            if let Err(error) = scan(cell) {
                return Err(format!(
                    "{file}:{line}: `{name}`: `{cell}`: {}",
                    error.message
                ));
            }
        }
    }
    Ok(())
}

/// The numbers of a column, sorted.
fn numbers(file: &str, table: &CommaSeparated, column: &str) -> Result<Vec<f64>, String> {
    let Some(place) = table.header.iter().position(|name| name == column) else {
        let names: Vec<String> = table
            .header
            .iter()
            .map(|name| format!("`{name}`"))
            .collect();
        let has = names.join(", ");
        return Err(format!(
            "{file}:1: there is no column `{column}`; it has {has}"
        ));
    };
    let number = |(line, row): &(usize, Vec<String>)| {
        let value = row[place]
            .parse::<f64>()
            .ok()
            .filter(|value| value.is_finite());
        value.ok_or_else(|| {
            let cell = &row[place];
            format!("{file}:{line}: `{column}`: `{cell}` is not a finite number")
        })
    };
    let mut found = table
        .rows
        .iter()
        .map(number)
        .collect::<Result<Vec<_>, _>>()?;
    if found.is_empty() {
        return Err(format!("{file}:1: the column `{column}` has no numbers"));
    }
    found.sort_by(f64::total_cmp);
    Ok(found)
}
