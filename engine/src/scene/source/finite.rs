//! Numbers that are not finite, which RON allows and a scene must not hold.

use std::ops::Range;

use super::lexer::value_of;
use super::tree::{Kind, Node, Scalar};

/// The ranges of all numbers in a tree that are infinite or not a number: `inf`, `-inf`, `NaN`,
/// and decimal numbers beyond the largest f64 such as `1e999`. `text` is the text of the tree.
#[must_use]
pub fn non_finite(root: &Node, text: &str) -> Vec<Range<usize>> {
    let mut found = Vec::new();
    collect(root, text, &mut found);
    found
}

fn collect(node: &Node, text: &str, found: &mut Vec<Range<usize>>) {
    if node.kind == Kind::Scalar(Scalar::Number) {
        let number = text.get(node.span.clone()).unwrap_or_default();
        if value_of(number).is_some_and(|v| !v.is_finite()) {
            found.push(node.span.clone());
        }
    }
    if let Kind::Map { entries } = &node.kind {
        for entry in entries {
            collect(&entry.key, text, found);
            collect(&entry.value, text, found);
        }
    } else {
        for (_, _, child) in node.children() {
            collect(child, text, found);
        }
    }
}

#[cfg(test)]
mod tests;
