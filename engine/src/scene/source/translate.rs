//! What `ron` and `serde` say, in the words of a scene's author.

use std::ops::Range;

use ron::Error;

use super::diagnostic::Diagnostic;
use super::nearest::{lacks_unit, nearest};
use super::path::{FieldPath, Segment};
use super::shape::wrong_shape;
use super::tree::{Kind, Node, Scalar};
use super::typed::{Place, name_span};

/// A failed parse: the text, the path of the node that was parsed, and the byte at which the
/// parser stopped.
pub(super) struct Failure<'a> {
    pub text: &'a str,
    pub base_path: &'a str,
    pub offset: usize,
}

impl Failure<'_> {
    /// The text of a range.
    pub(super) fn slice(&self, span: Range<usize>) -> &str {
        self.text.get(span).unwrap_or_default()
    }

    pub(super) fn diagnostic(
        &self,
        message: String,
        span: Range<usize>,
        path: &FieldPath,
    ) -> Diagnostic {
        Diagnostic::new(message)
            .at(span)
            .with_path(path.below(self.base_path))
    }

    /// What a node is, in words; a number as it stands.
    pub(super) fn found(&self, node: &Node) -> String {
        match node.kind {
            Kind::Scalar(Scalar::Number) => format!("`{}`", self.slice(node.span.clone())),
            _ => node.describe(self.text),
        }
    }

    pub(super) fn at_node(&self, message: String, (node, path): (&Node, &FieldPath)) -> Diagnostic {
        self.diagnostic(message, node.span.clone(), path)
    }
}

/// Turns an error of `ron` into a diagnostic at its place.
pub(super) fn translate(failure: &Failure<'_>, code: &Error, place: &Place<'_>) -> Diagnostic {
    match code {
        Error::NoSuchStructField {
            expected,
            found,
            outer,
        } => unknown_field(failure, place, found, expected, outer.as_deref()),
        Error::MissingStructField { field, outer } => {
            missing_field(failure, place, field, outer.as_deref())
        }
        Error::DuplicateStructField { field, .. } => {
            let message = format!("the field `{field}` is given twice");
            let span = last_name_span(place.node, field);
            let span = span.unwrap_or_else(|| place.node.opening());
            let path = place.path.join(Segment::Name((*field).to_owned()));
            failure.diagnostic(message, span, &path)
        }
        Error::NoSuchEnumVariant {
            expected,
            found,
            outer,
        } => unknown_variant(failure, place, found, expected, outer.as_deref()),
        Error::ExpectedDifferentStructName { expected, found } => {
            let message = format!("expected `{expected}(..)`, found `{found}`");
            let span = place.node.opening();
            failure.diagnostic(message, span, &place.path)
        }
        Error::InvalidValueForType { expected, found } => {
            let message = format!("expected {expected}, found {found}");
            failure.at_node(message, (place.node, &place.path))
        }
        Error::ExpectedDifferentLength { expected, found } => {
            let message = format!("expected {expected}, found {}", values(*found));
            failure.at_node(message, (place.node, &place.path))
        }
        Error::Message(message) => failure.at_node(message.clone(), (place.node, &place.path)),
        Error::ExceededRecursionLimit => {
            let message = "nested too deeply".to_owned();
            failure.at_node(message, (place.node, &place.path))
        }
        _ => wrong_shape(failure, code, place),
    }
}

/// A count of values in words.
pub(super) fn values(n: usize) -> String {
    match n {
        0 => "no value".to_owned(),
        1 => "one value".to_owned(),
        n => format!("{n} values"),
    }
}

fn quoted_list(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|n| format!("`{n}`")).collect();
    match names.len() {
        1 => quoted.concat(),
        _ => format!("one of {}", quoted.join(", ")),
    }
}

/// The node that holds the one at a place.
fn parent<'a>(place: &Place<'a>) -> Option<&'a Node> {
    let steps = place.path.segments.len().checked_sub(1)?;
    place.root.get(&place.path.head(steps))
}

/// The range of the last of the fields of a name.
fn last_name_span(node: &Node, name: &str) -> Option<Range<usize>> {
    let children = node.children().into_iter().rev();
    let named = |(segment, span, _): (Segment, Option<Range<usize>>, _)| {
        (segment.plain() == name).then_some(span).flatten()
    };
    children.filter_map(named).next()
}

/// What the struct at a place is called: serde's name for it, the name written before it, the
/// name of the field that holds it.
fn struct_name(
    failure: &Failure<'_>,
    node: &Node,
    path: &FieldPath,
    outer: Option<&str>,
) -> String {
    let named = |name: &str| format!("`{name}`");
    (outer.filter(|name| !name.is_empty()).map(named))
        .or_else(|| node.name().map(|span| named(failure.slice(span))))
        .or_else(|| path.segments.last().map(|s| named(&s.plain())))
        .or_else(|| {
            failure
                .base_path
                .rsplit('.')
                .next()
                .filter(|n| !n.is_empty())
                .map(named)
        })
        .unwrap_or_else(|| "the scene".to_owned())
}

/// The help for a name that does not exist.
fn suggestion(found: &str, expected: &[&str]) -> Option<String> {
    let near = nearest(found, expected.iter().copied())?;
    Some(match lacks_unit(found, near) {
        true => format!("quantities carry their unit: `{near}`"),
        false => format!("did you mean `{near}`?"),
    })
}

fn unknown_field(
    failure: &Failure<'_>,
    place: &Place<'_>,
    found: &str,
    expected: &[&str],
    outer: Option<&str>,
) -> Diagnostic {
    let is_last = (place.path.segments.last()).is_some_and(|s| s.plain() == found);
    let holder = parent(place).filter(|_| is_last && place.missing.is_none());
    let (node, path) = match holder {
        Some(node) => (node, place.path.head(place.path.segments.len() - 1)),
        None => (place.node, place.path.clone()),
    };
    let span = name_span(node, found).unwrap_or_else(|| place.stopped.0.span.clone());
    let name = struct_name(failure, node, &path, outer);
    let expected_names = match expected {
        [] => "which has no fields".to_owned(),
        names => format!("expected {}", quoted_list(names)),
    };
    let message = format!("unexpected field `{found}` in {name}, {expected_names}");
    Diagnostic {
        help: suggestion(found, expected),
        ..failure.diagnostic(message, span, &path.join(Segment::Name(found.to_owned())))
    }
}

fn missing_field(
    failure: &Failure<'_>,
    place: &Place<'_>,
    field: &str,
    outer: Option<&str>,
) -> Diagnostic {
    let (node, path) = (place.node, &place.path);
    let name = struct_name(failure, node, path, outer);
    let message = format!("{name} needs the field `{field}`");
    failure.diagnostic(message, node.opening(), path)
}

fn unknown_variant(
    failure: &Failure<'_>,
    place: &Place<'_>,
    found: &str,
    expected: &[&str],
    outer: Option<&str>,
) -> Diagnostic {
    let node = match place.stopped.0.name() {
        Some(span) if failure.slice(span.clone()) == found => place.stopped.0,
        _ => place.node,
    };
    let of = outer.map_or_else(String::new, |name| format!(" for `{name}`"));
    let expected_names = match expected {
        [] => "which has no variants".to_owned(),
        names => format!("expected {}", quoted_list(names)),
    };
    let message = format!("unknown variant `{found}`{of}, {expected_names}");
    Diagnostic {
        help: suggestion(found, expected),
        ..failure.diagnostic(message, node.opening(), &place.path)
    }
}

#[cfg(test)]
mod tests;
