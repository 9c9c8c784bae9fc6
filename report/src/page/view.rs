//! The view that plays.

use crate::animation::Animation;

/// Style of the view.
pub const STYLE: &str = "";
/// Script of the view.
pub const SCRIPT: &str = "";

/// The view of runs with their labels.
#[must_use]
pub fn view(_runs: &[(&str, &Animation)]) -> String {
    String::new()
}
