//! CSV as campaigns read and write it: a header, fields in double quotes where they hold commas.

/// Rows of fields below a header.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CommaSeparated {
    /// Names of the columns.
    pub header: Vec<String>,
    /// The line of each row, from 1, and its fields, as many as columns.
    pub rows: Vec<(usize, Vec<String>)>,
}

/// Reads a table; lines that are empty or start with `#` are passed over.
///
/// # Errors
/// What is wrong, with line and column.
pub fn read_comma_separated(text: &str) -> Result<CommaSeparated, String> {
    let mut lines = text
        .lines()
        .enumerate()
        .map(|(index, line)| (index + 1, line.trim_end_matches('\r')))
        .filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
    let Some((number, line)) = lines.next() else {
        return Err("1:1: the table is empty".to_owned());
    };
    let header = fields(number, line.trim_start_matches('\u{feff}'))?;
    let mut rows = Vec::new();
    for (number, line) in lines {
        let row = fields(number, line)?;
        if row.len() != header.len() {
            let (found, wanted) = (row.len(), header.len());
            return Err(format!(
                "{number}:1: the row has {found} fields, the header has {wanted}"
            ));
        }
        rows.push((number, row));
    }
    Ok(CommaSeparated { header, rows })
}

/// The fields of a line, whose number stands in the message.
///
/// # Errors
/// Quotes that are not closed, with line and column.
pub fn fields(number: usize, line: &str) -> Result<Vec<String>, String> {
    let (mut found, mut field) = (Vec::new(), String::new());
    let mut characters = line.chars().enumerate().peekable();
    let mut opened = None;
    while let Some((column, character)) = characters.next() {
        match (character, opened) {
            ('"', None) if field.trim().is_empty() => opened = Some(column + 1),
            ('"', Some(_)) if characters.next_if(|(_, next)| *next == '"').is_some() => {
                field.push('"');
            }
            ('"', Some(_)) => opened = None,
            (',', None) => found.push(std::mem::take(&mut field).trim().to_owned()),
            _ => field.push(character),
        }
    }
    if let Some(column) = opened {
        return Err(format!("{number}:{column}: the quotes are not closed"));
    }
    found.push(field.trim().to_owned());
    Ok(found)
}

/// A field as it is written: in quotes where it has to be.
#[must_use]
pub fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!(
            "\"{}\"",
            field.replace('"', "\"\"").replace(['\n', '\r'], " ")
        )
    } else {
        field.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let fields = ["plain", "Constant(1, 2)", "\"text, too\""];
        let text = format!("a,b,c\n# remark\n{}\n", fields.map(quoted).join(","));
        let table = read_comma_separated(&text).unwrap();
        assert_eq!(table.header, ["a", "b", "c"]);
        assert_eq!(table.rows, [(3, fields.map(str::to_owned).to_vec())]);
    }

    #[test]
    fn faults_have_their_place() {
        assert_eq!(
            read_comma_separated("a,b\n1\n").unwrap_err(),
            "2:1: the row has 1 fields, the header has 2"
        );
        assert_eq!(
            read_comma_separated("a\n 1, \"2\n").unwrap_err(),
            "2:5: the quotes are not closed"
        );
    }
}
