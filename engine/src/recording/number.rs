//! Numbers as text: the shortest that reads back to the same f64.

use std::io::{self, Write};

/// Writes a finite number: plainly where it has a common size, else with an exponent.
///
/// # Errors
/// As the writer.
pub fn write_number(out: &mut impl Write, value: f64) -> io::Result<()> {
    let size = value.abs();
    if size == 0.0 || (1e-5..1e16).contains(&size) {
        // Minus zero reads as a difference where there is none.
        write!(out, "{}", if value == 0.0 { 0.0 } else { value })
    } else {
        write!(out, "{value:e}")
    }
}

/// A number as [`write_number`] writes it.
#[must_use]
pub fn number_text(value: f64) -> String {
    let mut out = Vec::new();
    // A vector takes everything.
    let _ = write_number(&mut out, value);
    String::from_utf8(out).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back() {
        for (value, text) in [
            (56_000.0, "56000"),
            (-0.0, "0"),
            (1.5e-9, "1.5e-9"),
            (0.1 + 0.2, "0.30000000000000004"),
            (-1e300, "-1e300"),
            (5e-324, "5e-324"),
        ] {
            let written = number_text(value);
            assert_eq!(written, text);
            assert_eq!(written.parse::<f64>().unwrap(), value);
        }
    }
}
