//! The command line `aerobot`. A program with plugins of its own has the same ten lines.

use std::process::ExitCode;

fn main() -> ExitCode {
    aerobot::cli::main(&[])
}
