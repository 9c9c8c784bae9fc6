//! Atmosphere tables and wind profiles from CSV text.
//!
//! No equation: a grammar. The first line that is neither blank nor a comment (`#`) names the
//! columns, in any order; each further one is a row of numbers, separated by commas.
//!
//! | column | meaning | unit | |
//! |---|---|---|---|
//! | `altitude_m` | altitude, strictly increasing | m | both |
//! | `density_kg_m3` | density, positive | kg/m3 | atmosphere |
//! | `pressure_pa` | pressure, positive | Pa | atmosphere, optional |
//! | `temperature_k` | temperature, positive | K | atmosphere, optional |
//! | `zonal_m_s` | velocity of the air along x | m/s | wind |
//! | `meridional_m_s` | velocity of the air along y | m/s | wind, optional |
//! | `vertical_m_s` | velocity of the air along z | m/s | wind, optional |
//! | `speed_m_s` | one velocity of a sample | m/s | sample |
//!
//! Source: RFC 4180 (Shafranovich 2005), of which it is a subset.
//!
//! Assumptions: a point as decimal mark; numbers need no quotes, but one pair around a field is
//! taken off. The first fault found is reported, at its line and column.

use super::atmosphere_table::AtmosphereTable;
use super::knots::{ColumnError, InterpolationError};
use super::viscosity::Gas;
use super::wind_profile::WindProfile;
use aerobot_components::gust::MOST_SPEED_M_S;
use thiserror::Error;

/// What is wrong in a table, and where.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("line {line}, column {column}: {message}")]
pub struct TableError {
    /// Line in the text, from 1.
    pub line: usize,
    /// Character in the line, from 1; 1 where the fault is in no single field.
    pub column: usize,
    /// The fault, and what would be right.
    pub message: String,
}

/// Reads an atmosphere of `gas` from CSV text with the columns `altitude_m`, `density_kg_m3`, and
/// optionally `pressure_pa` and `temperature_k`.
///
/// # Errors
/// At its line and column: an unknown, missing or repeated column, a row with too few or too many
/// fields, text that is no number, a number that is not finite, not positive or (altitude) not
/// increasing, and fewer than two rows.
pub fn read_atmosphere(text: &str, gas: Gas) -> Result<AtmosphereTable, TableError> {
    let table = Table::read(text, &ATMOSPHERE_COLUMNS)?;
    AtmosphereTable::new(
        gas,
        table.values("altitude_m").unwrap_or_default(),
        table.values("density_kg_m3").unwrap_or_default(),
        table.values("pressure_pa"),
        table.values("temperature_k"),
    )
    .map_err(|error| table.locate(&error))
}

/// Reads a wind profile from CSV text with the columns `altitude_m`, `zonal_m_s` (along x), and
/// optionally `meridional_m_s` (along y) and `vertical_m_s` (along z).
///
/// # Errors
/// As [`read_atmosphere`], except that velocities may have any sign.
pub fn read_wind_profile(text: &str) -> Result<WindProfile, TableError> {
    let table = Table::read(text, &WIND_COLUMNS)?;
    WindProfile::new(
        table.values("altitude_m").unwrap_or_default(),
        table.values("zonal_m_s").unwrap_or_default(),
        table.values("meridional_m_s"),
        table.values("vertical_m_s"),
    )
    .map_err(|error| table.locate(&error))
}

/// Reads a sample of velocities, m/s, from CSV text with the column `speed_m_s`, in any order.
///
/// # Errors
/// As [`read_atmosphere`], except that velocities may have any sign; a sample of one value only, and a speed
/// that no wind has.
pub fn read_sample(text: &str) -> Result<Vec<f64>, TableError> {
    let table = Table::read(text, &[rule("speed_m_s", true)])?;
    let sample = table.values("speed_m_s").unwrap_or_default().to_vec();
    let too_fast = sample.iter().position(|speed| speed.abs() > MOST_SPEED_M_S);
    if let Some(row) = too_fast {
        let (line, column) = (table.lines[row], table.columns[0].places[row]);
        let message = format!(
            "`speed_m_s` must not exceed {MOST_SPEED_M_S:e}: {:e}",
            sample[row]
        );
        return Err(fault(line, column, message));
    }
    if sample.iter().all(|value| *value == sample[0]) {
        let message = "a distribution needs at least 2 values that differ".into();
        return Err(fault(table.header_line, 1, message));
    }
    Ok(sample)
}

/// A column that a table may have.
struct ColumnRule {
    name: &'static str,
    required: bool,
}

const fn rule(name: &'static str, required: bool) -> ColumnRule {
    ColumnRule { name, required }
}

const ATMOSPHERE_COLUMNS: [ColumnRule; 4] = [
    rule("altitude_m", true),
    rule("temperature_k", false),
    rule("pressure_pa", false),
    rule("density_kg_m3", true),
];

const WIND_COLUMNS: [ColumnRule; 4] = [
    rule("altitude_m", true),
    rule("zonal_m_s", true),
    rule("meridional_m_s", false),
    rule("vertical_m_s", false),
];

/// A field of a line, without blanks and quotes, and the character it begins at, from 1.
pub(crate) struct Field<'a> {
    pub(crate) text: &'a str,
    pub(crate) column: usize,
}

/// One column as read, with the place of each value.
struct Column {
    name: &'static str,
    values: Vec<f64>,
    /// The character each value begins at, from 1.
    places: Vec<usize>,
}

/// All columns as read.
struct Table {
    columns: Vec<Column>,
    header_line: usize,
    /// The line of each row, from 1.
    lines: Vec<usize>,
}

impl Table {
    fn read(text: &str, rules: &[ColumnRule]) -> Result<Self, TableError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut lines = text
            .lines()
            .enumerate()
            .map(|(index, line)| (index + 1, line))
            .filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#'));
        let Some((header_line, header)) = lines.next() else {
            let message = format!("no header; expected the columns {}", names(rules));
            return Err(fault(1, 1, message));
        };
        let mut table = Self {
            columns: read_header(header_line, header, rules)?,
            header_line,
            lines: Vec::new(),
        };
        for (line, row) in lines {
            table.read_row(line, row)?;
        }
        if table.lines.is_empty() {
            return Err(fault(header_line, 1, "no rows below the header".into()));
        }
        Ok(table)
    }

    fn read_row(&mut self, line: usize, row: &str) -> Result<(), TableError> {
        let fields = fields(row);
        if fields.len() != self.columns.len() {
            let message = format!(
                "{} fields, but the header has {} columns",
                fields.len(),
                self.columns.len()
            );
            return Err(fault(line, 1, message));
        }
        for (column, field) in self.columns.iter_mut().zip(&fields) {
            column.values.push(read_number(line, field, column.name)?);
            column.places.push(field.column);
        }
        self.lines.push(line);
        Ok(())
    }

    fn values(&self, name: &str) -> Option<&[f64]> {
        let column = self.columns.iter().find(|column| column.name == name);
        column.map(|column| column.values.as_slice())
    }

    /// Turns the row of an error into its line and column in the text.
    fn locate(&self, error: &ColumnError) -> TableError {
        let name = error.column;
        let index = error.error.row().map(|row| row - 1);
        let line = index.and_then(|index| self.lines.get(index).copied());
        let column = self.columns.iter().find(|column| column.name == name);
        let place = column
            .zip(index)
            .and_then(|(column, index)| column.places.get(index).copied());
        let line_before = index
            .and_then(|index| self.lines.get(index.checked_sub(1)?).copied())
            .unwrap_or(self.header_line);
        let message = match error.error {
            InterpolationError::NotIncreasing {
                previous, value, ..
            } => format!(
                "`{name}` must increase from row to row: {value} does not exceed {previous} of \
                 line {line_before}"
            ),
            InterpolationError::NotPositive { value, .. } => {
                format!("`{name}` must be positive: {value}")
            }
            InterpolationError::TooFewRows { rows } => {
                format!("at least 2 rows are needed, there are {rows}")
            }
            InterpolationError::Overflow { .. } => {
                format!("`{name}`: the step from line {line_before} exceeds the range of numbers")
            }
            // Ruled out while reading.
            InterpolationError::NotFinite { .. } | InterpolationError::UnequalLengths { .. } => {
                error.to_string()
            }
        };
        let line = line.unwrap_or(self.header_line);
        fault(line, place.unwrap_or(1), message)
    }
}

fn read_header(line: usize, header: &str, rules: &[ColumnRule]) -> Result<Vec<Column>, TableError> {
    let mut columns: Vec<Column> = Vec::new();
    for field in fields(header) {
        let Some(rule) = rules.iter().find(|rule| rule.name == field.text) else {
            let message = format!(
                "unknown column `{}`; allowed are {}",
                field.text,
                names(rules)
            );
            return Err(fault(line, field.column, message));
        };
        if columns.iter().any(|column| column.name == rule.name) {
            let message = format!("column `{}` is given twice", rule.name);
            return Err(fault(line, field.column, message));
        }
        columns.push(Column {
            name: rule.name,
            values: Vec::new(),
            places: Vec::new(),
        });
    }
    let given = |name| columns.iter().any(|column| column.name == name);
    match rules.iter().find(|rule| rule.required && !given(rule.name)) {
        Some(rule) => Err(fault(line, 1, format!("column `{}` is missing", rule.name))),
        None => Ok(columns),
    }
}

fn read_number(line: usize, field: &Field, name: &str) -> Result<f64, TableError> {
    let value: f64 = field.text.parse().map_err(|_| {
        let message = match field.text {
            "" => format!("`{name}` is empty; a number is needed"),
            text => format!("`{name}` must be a number: `{text}`"),
        };
        fault(line, field.column, message)
    })?;
    if value.is_finite() {
        Ok(value)
    } else {
        let message = format!("`{name}` must be finite: `{}`", field.text);
        Err(fault(line, field.column, message))
    }
}

/// The fields of a line with their places.
pub(crate) fn fields(line: &str) -> Vec<Field<'_>> {
    let mut next_column = 1;
    line.split(',')
        .map(|raw| {
            let blanks = raw.chars().take_while(|c| c.is_whitespace()).count();
            let column = next_column + blanks;
            next_column += raw.chars().count() + 1;
            let text = raw.trim();
            let quoted = text.strip_prefix('"').and_then(|t| t.strip_suffix('"'));
            Field {
                text: quoted.unwrap_or(text),
                column,
            }
        })
        .collect()
}

fn names(rules: &[ColumnRule]) -> String {
    let names: Vec<String> = rules
        .iter()
        .map(|rule| match rule.required {
            true => format!("`{}`", rule.name),
            false => format!("`{}` (optional)", rule.name),
        })
        .collect();
    names.join(", ")
}

pub(crate) fn fault(line: usize, column: usize, message: String) -> TableError {
    TableError {
        line,
        column,
        message,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn air_error(text: &str) -> String {
        read_atmosphere(text, Gas::Air).unwrap_err().to_string()
    }

    fn wind_error(text: &str) -> String {
        read_wind_profile(text).unwrap_err().to_string()
    }

    #[test]
    fn columns_come_in_any_order_between_comments_and_blank_lines() {
        let text = "# a comment\n\ndensity_kg_m3, altitude_m,\"temperature_k\"\r\n1.5,0,300\n\n\
                    # another\n  0.5 , 1000 ,280\n";
        let table = read_atmosphere(text, Gas::CarbonDioxide).unwrap();
        assert_eq!((table.lowest_m(), table.highest_m()), (0.0, 1000.0));
        assert_eq!(table.gas(), Gas::CarbonDioxide);
        assert!((table.density_kg_m3(1000.0).unwrap() - 0.5).abs() < 1e-15);
        assert_eq!(table.temperature_k(0.0), Some(Some(300.0)));
        assert_eq!(table.pressure_pa(0.0), Some(None));
        let text = "\u{feff}vertical_m_s,altitude_m,zonal_m_s\n1,0,-2\n1,10,4";
        let wind = read_wind_profile(text).unwrap();
        assert_eq!(wind.velocity_m_s(0.0), Some(DVec3::new(-2.0, 0.0, 1.0)));
    }

    #[test]
    fn a_bad_header_is_refused_at_its_column() {
        assert_eq!(
            air_error("#\naltitude_m, rho\n0,1\n"),
            "line 2, column 13: unknown column `rho`; allowed are `altitude_m`, `temperature_k` \
             (optional), `pressure_pa` (optional), `density_kg_m3`"
        );
        assert_eq!(
            wind_error("altitude_m,meridional_m_s\n0,1\n"),
            "line 1, column 1: column `zonal_m_s` is missing"
        );
        assert_eq!(
            wind_error("altitude_m,zonal_m_s,altitude_m\n0,1\n"),
            "line 1, column 22: column `altitude_m` is given twice"
        );
        assert!(air_error("# nothing\n").starts_with("line 1, column 1: no header; expected"));
    }

    #[test]
    fn a_bad_row_is_refused_at_its_line_and_column() {
        for (rows, expected) in [
            ("", "line 1, column 1: no rows below the header"),
            (
                "0,1",
                "line 1, column 1: at least 2 rows are needed, there are 1",
            ),
            (
                "0,1\n1",
                "line 3, column 1: 1 fields, but the header has 2 columns",
            ),
            (
                "0,1\n1,2,3",
                "line 3, column 1: 3 fields, but the header has 2 columns",
            ),
            (
                "0,1\n1, 2x",
                "line 3, column 4: `density_kg_m3` must be a number: `2x`",
            ),
            (
                "0,\n",
                "line 2, column 3: `density_kg_m3` is empty; a number is needed",
            ),
            (
                "0,1\n\n#\n1,NaN",
                "line 5, column 3: `density_kg_m3` must be finite: `NaN`",
            ),
            (
                "0,1\n1,1e999",
                "line 3, column 3: `density_kg_m3` must be finite: `1e999`",
            ),
            (
                "0,1\n10,-2",
                "line 3, column 4: `density_kg_m3` must be positive: -2",
            ),
            (
                "0,1\n5,1\n# between\n4,1",
                "line 5, column 1: `altitude_m` must increase from row to row: 4 does not exceed 5 \
                 of line 3",
            ),
        ] {
            assert_eq!(
                air_error(&format!("altitude_m,density_kg_m3\n{rows}")),
                expected
            );
        }
    }

    #[test]
    fn a_sample_is_one_column_in_any_order() {
        assert_eq!(
            read_sample("speed_m_s\n3\n-1\n2\n"),
            Ok(vec![3.0, -1.0, 2.0])
        );
        let fast = read_sample("speed_m_s\n3\n -1e200\n").unwrap_err();
        assert_eq!(
            fast.to_string(),
            "line 3, column 2: `speed_m_s` must not exceed 1e6: -1e200"
        );
        let constant = read_sample("# none\nspeed_m_s\n3\n3\n").unwrap_err();
        assert_eq!(
            constant.to_string(),
            "line 2, column 1: a distribution needs at least 2 values that differ"
        );
    }

    #[test]
    fn pressure_and_temperature_must_be_positive_and_wind_need_not() {
        assert_eq!(
            air_error("temperature_k,pressure_pa,density_kg_m3,altitude_m\n1,1,1,0\n0,1,1,1\n"),
            "line 3, column 1: `temperature_k` must be positive: 0"
        );
        assert_eq!(
            air_error("altitude_m,pressure_pa,density_kg_m3\n0,0,1\n1,1,1\n"),
            "line 2, column 3: `pressure_pa` must be positive: 0"
        );
        assert!(read_wind_profile("altitude_m,zonal_m_s\n0,-1\n1,0\n").is_ok());
        assert_eq!(
            wind_error("altitude_m,zonal_m_s\n0,-1e308\n1,1e308\n"),
            "line 3, column 3: `zonal_m_s`: the step from line 2 exceeds the range of numbers"
        );
    }
}
