//! An entity of a scene that is there more than once.

use bevy_ecs::component::Component;
use glam::DVec3;
use serde::Deserialize;

use crate::scene_component::{FieldReport, SceneComponent};

/// The entity `NAME` stands for `count` entities `NAME/1`, `NAME/2` and so on with its other components.
///
/// In every string of those components, such as the name at the end of a tether, `#` stands for the
/// number of the copy, `#+1` and `#-1` (or any other whole number) for those of its neighbours.
#[derive(Component, Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Copies {
    /// Number of copies.
    pub count: u32,
    /// From each copy to the next, in what places them (`Pose`, `Fixed`, `Moving`, and the `Positions` in
    /// which nodes start), inertial frame, m.
    #[serde(default)]
    pub step_m: DVec3,
}

/// The largest number of copies of an entity.
pub const MOST_COPIES: u32 = 10_000;

impl SceneComponent for Copies {
    const NAME: &'static str = "Copies";

    fn check(&self, report: &mut FieldReport) {
        if !(1..=MOST_COPIES).contains(&self.count) {
            let message = format!(
                "`count` must be from 1 to {MOST_COPIES}, it is {}",
                self.count
            );
            report.add("count", message, "");
        }
        report.finite_vector("step_m", self.step_m);
    }
}

/// `text` for copy `number`: every `#`, `#+1`, `#-1` in it replaced by a number.
///
/// A number below zero stands as it is, and is the name of nothing.
#[must_use]
pub fn numbered(text: &str, number: u32) -> String {
    let mut parts = text.split('#');
    let mut result = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (shift, rest) = leading_shift(part);
        result.push_str(&(i64::from(number) + shift).to_string());
        result.push_str(rest);
    }
    result
}

/// The signed whole number at the start of a text, 0 without one, and what follows it.
fn leading_shift(text: &str) -> (i64, &str) {
    let Some(digits) = text.strip_prefix(['+', '-']) else {
        return (0, text);
    };
    let count = digits.bytes().take_while(u8::is_ascii_digit).count();
    match text[..=count].parse() {
        Ok(shift) => (shift, &digits[count..]),
        Err(_) => (0, text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hash_is_the_number_of_the_copy() {
        assert_eq!(numbered("instrument/#", 7), "instrument/7");
        assert_eq!(numbered("instrument/#+1", 9), "instrument/10");
        assert_eq!(numbered("row/#/mast/#-12/top", 10), "row/10/mast/-2/top");
        assert_eq!(numbered("#-port", 3), "3-port");
        assert_eq!(numbered("plain", 3), "plain");
    }
}
