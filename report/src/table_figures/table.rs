//! A small table of comma-separated fields, by the names of its columns.

use std::fs;
use std::path::{Path, PathBuf};

/// A table.
pub(super) struct Table {
    file: PathBuf,
    head: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    pub(super) fn read(file: &Path) -> Result<Self, String> {
        let text = fs::read_to_string(file)
            .map_err(|error| format!("cannot read `{}`: {error}", file.display()))?;
        let mut lines = text
            .lines()
            .map(|line| line.split(',').map(str::to_owned).collect());
        let head: Vec<String> = lines.next().unwrap_or_default();
        let rows: Vec<Vec<String>> = lines.collect();
        match rows.iter().position(|row| row.len() != head.len()) {
            None => Ok(Self {
                file: file.to_owned(),
                head,
                rows,
            }),
            Some(row) => Err(format!(
                "{}:{}: a row has {} fields, the header {}",
                file.display(),
                row + 2,
                rows[row].len(),
                head.len()
            )),
        }
    }

    /// The fields of a column.
    pub(super) fn column(&self, name: &str) -> Result<Vec<&str>, String> {
        let place = self.head.iter().position(|head| head == name);
        let place = place
            .ok_or_else(|| format!("{}:1: there is no column `{name}`", self.file.display()))?;
        Ok(self.rows.iter().map(|row| row[place].as_str()).collect())
    }

    /// The numbers of a column; nothing where a field is empty.
    pub(super) fn numbers(&self, name: &str) -> Result<Vec<Option<f64>>, String> {
        let fields = self.column(name)?;
        let number = |(row, field): (usize, &&str)| match field.parse() {
            Ok(number) => Ok(Some(number)),
            Err(_) if field.is_empty() => Ok(None),
            Err(_) => Err(format!(
                "{}:{}: `{field}` in the column `{name}` is not a number",
                self.file.display(),
                row + 2
            )),
        };
        fields.iter().enumerate().map(number).collect()
    }
}
