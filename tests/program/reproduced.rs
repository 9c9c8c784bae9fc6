//! What every case of `aerobot reproduce` does with its folder and with what makes no sense.

use std::fs;

use super::{Scratch, aerobot, text};

/// Tables must have so many rows below their header, columns in all of them, and nothing but numbers.
pub(crate) fn assert_tables(scratch: &Scratch, tables: &[(&str, usize)]) {
    for (file, rows) in tables {
        let table = fs::read_to_string(scratch.path(file)).unwrap();
        let lines: Vec<&str> = table.lines().collect();
        let columns = lines[0].split(',').count();
        assert_eq!(lines.len(), rows + 1, "{file}");
        assert!(lines.iter().all(|line| line.split(',').count() == columns));
        assert!(!table.contains("NaN") && !table.contains("inf"), "{file}");
    }
}

/// The folder of a case that has been run must be kept unless `--force` is given; then nothing is printed where
/// `--quiet` asks for it.
pub(crate) fn assert_kept(arguments: &[&str], out: &str) {
    let again = aerobot(&[arguments, &["--out", out]].concat());
    assert_eq!(again.status.code(), Some(2));
    assert!(text(&again.stderr).contains("--force"));
    let quiet = aerobot(&[arguments, &["--out", out, "--force", "--quiet"]].concat());
    assert_eq!(quiet.status.code(), Some(0));
    assert!(quiet.stdout.is_empty() && quiet.stderr.is_empty());
}

/// Arguments of `reproduce` must be refused with these messages, and nothing be written.
pub(crate) fn assert_refused(cases: &[(&[&str], &str)]) {
    let scratch = Scratch::new();
    for (arguments, message) in cases {
        let output = aerobot(&[&["reproduce", "--out", scratch.text()], *arguments].concat());
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(message), "{arguments:?}: {said}");
        assert!(!scratch.0.exists(), "{arguments:?}");
    }
}

/// The list of cases must have this one.
pub(crate) fn assert_listed(case: &str) {
    let listed = text(&aerobot(&["reproduce", "--list"]).stdout);
    let is_it = |line: &str| line.split(' ').next() == Some(case);
    assert!(listed.lines().any(is_it), "{listed}");
}
