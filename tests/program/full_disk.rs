//! A disk that is full.

use std::process::Command;

use super::text;

/// Runs the program where no file may have more than so many KiB, which stands in for a full disk: it ends with exit
/// code 3, and says what is kept.
pub(crate) fn ends_on_a_full_disk(kibibytes: u32, arguments: &[&str]) {
    let program = env!("CARGO_BIN_EXE_aerobot");
    let limited = format!("trap '' XFSZ; ulimit -f {kibibytes}; exec \"$0\" \"$@\"");
    let output = Command::new("bash")
        .args(["-c", &limited, program])
        .args(arguments)
        .output()
        .unwrap();
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(
        said.contains("cannot write") && said.contains("finished runs are kept"),
        "{said}"
    );
}
