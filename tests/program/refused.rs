//! Files that the program has to refuse.

use std::fs;

use super::{Scratch, aerobot, text};

/// Each `NAME.ron` of a folder is refused by a command with the text of `NAME.txt` and exit code 2, and nothing is
/// written; `AEROBOT_BLESS=1` writes these texts anew. There are at least so many.
pub(crate) fn all_are_refused(folder: &str, command: &[&str], least: usize) {
    let bless = std::env::var_os("AEROBOT_BLESS").is_some();
    let mut wrong = Vec::new();
    let mut count = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "ron") {
            continue;
        }
        count += 1;
        let scratch = Scratch::new();
        let file = path.to_str().unwrap();
        let output = aerobot(&[command, &[file, "--out", scratch.text()]].concat());
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{file}: {said}");
        assert!(!scratch.0.exists() && output.stdout.is_empty(), "{file}");
        let expected = path.with_extension("txt");
        if bless {
            fs::write(&expected, &said).unwrap();
        } else if fs::read_to_string(&expected).unwrap_or_default() != said {
            wrong.push(said);
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(count >= least, "{count}");
}
