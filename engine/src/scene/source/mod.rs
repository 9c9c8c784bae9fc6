//! The text of a scene file: where everything stands, how `--set` edits it, and how an error
//! is shown.
//!
//! Values are parsed by `ron` and `serde`, which lose positions, keep the last of two equal
//! fields without a word, and stop at the first error. This module stands beside them. [`scan`]
//! turns the text into a [`Node`] tree with byte ranges and finds what is wrong with the
//! brackets; [`duplicates`] and [`non_finite`] find what `ron` would let through; [`apply`]
//! edits the text for each `--set PATH=RON`, keeping comments and layout; [`parse_node`] parses
//! one node at a time, so that a scene's errors can be collected instead of stopping at the
//! first, and turns each into a [`Diagnostic`] with the exact range of the text at fault;
//! [`Source`] renders them, each against the file or against the `--set` it came from.
//!
//! The way of a scene file: [`parse_override`] each argument, [`Source::with_overrides`], then
//! [`scan`] the edited text, [`duplicates`], [`non_finite`], [`parse_node`] for each component,
//! and [`Source::render`] whatever was found.

mod diagnostic;
mod edited;
mod finite;
mod lexer;
mod nearest;
mod overrides;
mod parse_fields;
mod path;
mod render;
mod scan;
mod shape;
mod translate;
mod tree;
mod typed;

#[cfg(test)]
mod fixture;

pub use diagnostic::{Diagnostic, Source};
pub use edited::EditedText;
pub use finite::non_finite;
pub use lexer::SyntaxError;
pub use nearest::{lacks_unit, nearest};
pub use overrides::{Override, apply, parse_override};
pub use parse_fields::parse_fields;
pub use path::{FieldPath, Segment};
pub use scan::scan;
pub use tree::{Duplicate, Entry, Field, Kind, Node, Scalar, duplicates};
pub use typed::parse_node;
