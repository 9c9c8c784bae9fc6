//! A measured series from CSV text: times and one column of velocities, with gaps.
//!
//! No equation: a grammar. The first line that is neither blank nor a comment (`#`) names the columns, of
//! which `time_s` is one; each further one is a row. A field that is empty or `NaN` is a gap, and so is a row
//! that is not there: times need not be even, only increasing.
//!
//! Source: RFC 4180 (Shafranovich 2005), of which it is a subset.

use crate::environment::table_csv::{Field, TableError, fault, fields};

/// Fewer velocities than this tell nothing of five parameters.
const LEAST_COUNT: usize = 20;

/// Velocities at increasing times, without gaps: what was not measured is not there.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// The column they were read from.
    pub column: String,
    /// Times, s, strictly increasing.
    pub times_s: Vec<f64>,
    /// Velocities, m/s.
    pub speeds_m_s: Vec<f64>,
    /// Rows in which the velocity was a gap.
    pub gaps: usize,
}

/// Reads a series from CSV text: the velocities of `column`, or of the only one beside `time_s`.
///
/// # Errors
/// At its line and column: what is wrong with the table, and a series of which nothing can be learned.
pub fn read_series(text: &str, column: Option<&str>) -> Result<Series, TableError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let lines = text.lines().enumerate();
    let mut lines = lines
        .map(|(index, line)| (index + 1, line))
        .filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#'));
    let Some((header_line, header)) = lines.next() else {
        let message = "no header; expected `time_s` and a column of velocities".to_owned();
        return Err(fault(1, 1, message));
    };
    let names = fields(header);
    let (time_index, speed_index) = choose(header_line, &names, column)?;
    let mut series = Series {
        column: names[speed_index].text.to_owned(),
        times_s: Vec::new(),
        speeds_m_s: Vec::new(),
        gaps: 0,
    };
    let mut last_s = f64::NEG_INFINITY;
    for (line, row) in lines {
        let row = fields(row);
        if row.len() != names.len() {
            let (found, expected) = (row.len(), names.len());
            let message = format!("{found} fields, but the header has {expected} columns");
            return Err(fault(line, 1, message));
        }
        let time_s = number(line, &row[time_index], "time_s")?;
        let Some(time_s) = time_s else {
            let message = "a row needs its time; leave out rows without one".to_owned();
            return Err(fault(line, row[time_index].column, message));
        };
        if time_s <= last_s {
            let message =
                format!("`time_s` must increase from row to row: {time_s} follows {last_s}");
            return Err(fault(line, row[time_index].column, message));
        }
        last_s = time_s;
        match number(line, &row[speed_index], &series.column)? {
            Some(speed_m_s) => {
                series.times_s.push(time_s);
                series.speeds_m_s.push(speed_m_s);
            }
            None => series.gaps += 1,
        }
    }
    check(&series, header_line, names[speed_index].column)?;
    Ok(series)
}

fn check(series: &Series, line: usize, column: usize) -> Result<(), TableError> {
    let count = series.speeds_m_s.len();
    if count < LEAST_COUNT {
        let name = &series.column;
        let message = format!("`{name}` has {count} velocities; at least {LEAST_COUNT} are needed");
        return Err(fault(line, column, message));
    }
    if series
        .speeds_m_s
        .iter()
        .all(|speed| *speed == series.speeds_m_s[0])
    {
        let message = format!("`{}` never changes: there is no gust in it", series.column);
        return Err(fault(line, column, message));
    }
    Ok(())
}

/// The places of the columns of times and of velocities.
fn choose(
    line: usize,
    names: &[Field],
    column: Option<&str>,
) -> Result<(usize, usize), TableError> {
    let place = |wanted: &str| names.iter().position(|name| name.text == wanted);
    let listed = || {
        let names: Vec<String> = names
            .iter()
            .map(|name| format!("`{}`", name.text))
            .collect();
        names.join(", ")
    };
    let Some(time) = place("time_s") else {
        let message = format!("column `time_s` is missing; there are {}", listed());
        return Err(fault(line, 1, message));
    };
    if let Some(column) = column {
        return match place(column) {
            Some(speed) if speed != time => Ok((time, speed)),
            Some(_) => Err(fault(line, 1, "`time_s` is not a velocity".to_owned())),
            None => {
                let message = format!("there is no column `{column}`; there are {}", listed());
                Err(fault(line, 1, message))
            }
        };
    }
    let mut others = (0..names.len()).filter(|index| *index != time);
    match (others.next(), others.next()) {
        (Some(speed), None) => Ok((time, speed)),
        (None, _) => Err(fault(
            line,
            1,
            "there is no column beside `time_s`".to_owned(),
        )),
        (Some(_), Some(_)) => {
            let message = format!("which column? `--column` chooses one of {}", listed());
            Err(fault(line, 1, message))
        }
    }
}

/// A number, or `None` for a gap.
fn number(line: usize, field: &Field, name: &str) -> Result<Option<f64>, TableError> {
    if field.text.is_empty() || field.text.eq_ignore_ascii_case("nan") {
        return Ok(None);
    }
    match field.text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(Some(value)),
        Ok(_) => {
            let message = format!("`{name}` must be finite: `{}`", field.text);
            Err(fault(line, field.column, message))
        }
        Err(_) => {
            let message = format!("`{name}` must be a number or empty: `{}`", field.text);
            Err(fault(line, field.column, message))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(from: usize) -> String {
        (from..40).map(|k| format!("{k},{},0\n", k % 7)).collect()
    }

    #[test]
    fn gaps_are_left_out() {
        let text = format!(
            "# wind\ntime_s,u_m_s,v_m_s\n0,1,0\n1,,0\n2, NaN,1\n3,4,\n{}",
            rows(5)
        );
        let series = read_series(&text, Some("u_m_s")).unwrap();
        assert_eq!((series.gaps, series.times_s.len()), (2, 37));
        assert_eq!((series.times_s[1], series.speeds_m_s[1]), (3.0, 4.0));
    }

    #[test]
    fn what_is_wrong_is_said_at_its_place() {
        let head = "time_s,u_m_s,v_m_s\n";
        for (text, column, expected) in [
            (
                format!("{head}0,1,2"),
                None,
                "line 1, column 1: which column? `--column` chooses one of `time_s`, `u_m_s`, `v_m_s`",
            ),
            (
                format!("{head}0,1,2"),
                Some("w"),
                "line 1, column 1: there is no column `w`; there are `time_s`, `u_m_s`, `v_m_s`",
            ),
            (
                format!("{head}0,1,2\n0,2,2"),
                Some("u_m_s"),
                "line 3, column 1: `time_s` must increase from row to row: 0 follows 0",
            ),
            (
                format!("{head}0,1,2\n1,fast,2"),
                Some("u_m_s"),
                "line 3, column 3: `u_m_s` must be a number or empty: `fast`",
            ),
            (
                format!("{head}0,1,2\n1,inf,2"),
                Some("u_m_s"),
                "line 3, column 3: `u_m_s` must be finite: `inf`",
            ),
            (
                format!("{head}0,1,2\n,1,2"),
                Some("u_m_s"),
                "line 3, column 1: a row needs its time; leave out rows without one",
            ),
            (
                format!("{head}0,1\n"),
                Some("u_m_s"),
                "line 2, column 1: 2 fields, but the header has 3 columns",
            ),
            (
                format!("{head}0,1,2\n"),
                Some("u_m_s"),
                "line 1, column 8: `u_m_s` has 1 velocities; at least 20 are needed",
            ),
            (
                format!("{head}{}", rows(0)),
                Some("v_m_s"),
                "line 1, column 14: `v_m_s` never changes: there is no gust in it",
            ),
            (
                "t,u\n0,1\n".to_owned(),
                None,
                "line 1, column 1: column `time_s` is missing; there are `t`, `u`",
            ),
        ] {
            let error = read_series(&text, column).unwrap_err();
            assert_eq!(error.to_string(), expected);
        }
    }
}
