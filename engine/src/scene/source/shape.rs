//! Values of another shape than their type, in the words of a scene's author.

use std::ops::Range;

use ron::Error;

use super::diagnostic::Diagnostic;
use super::path::Segment;
use super::translate::{Failure, values};
use super::tree::{Kind, Scalar};
use super::typed::Place;

/// Errors that say which token `ron` expected: the value has another shape than its type.
pub(super) fn wrong_shape(failure: &Failure<'_>, code: &Error, place: &Place<'_>) -> Diagnostic {
    match code {
        Error::IntegerOutOfBounds => {
            let text = failure.slice(place.node.span.clone());
            let message = format!("the integer `{text}` is out of range");
            failure.at_node(message, (place.node, &place.path))
        }
        Error::ExpectedComma
        | Error::ExpectedStructLikeEnd
        | Error::ExpectedOptionEnd
        | Error::ExpectedArrayEnd
        | Error::ExpectedMapEnd
        | Error::TrailingCharacters => left_over(failure, code, place),
        Error::ExpectedIdentifier | Error::SuggestRawIdentifier(_) => no_name(failure, place),
        Error::ExpectedStructLike => no_parentheses(failure, "", place),
        Error::ExpectedNamedStructLike(name) => no_parentheses(failure, name, place),
        _ => wrong_type(failure, code, place),
    }
}

/// What a code says was expected, in words.
fn wanted(code: &Error) -> Option<&'static str> {
    Some(match code {
        Error::ExpectedFloat | Error::FloatUnderscore | Error::UnderscoreAtBeginning => "a number",
        Error::ExpectedInteger | Error::InvalidIntegerDigit { .. } => "an integer",
        Error::ExpectedBoolean => "`true` or `false`",
        Error::ExpectedString | Error::ExpectedStringEnd => "a string",
        Error::ExpectedByteString => "a byte string",
        Error::ExpectedChar | Error::ExpectedByteLiteral => "a character",
        Error::ExpectedArray => "a list `[..]`",
        Error::ExpectedMap => "a map `{..}`",
        Error::ExpectedUnit => "`()`",
        _ => return None,
    })
}

fn wrong_type(failure: &Failure<'_>, code: &Error, place: &Place<'_>) -> Diagnostic {
    let Some(wanted) = wanted(code) else {
        return failure.at_node(plain(code), (place.stopped.0, &place.stopped.1));
    };
    if place.missing.is_some() {
        let found = failure.found(place.node);
        let message = format!("expected values without names, found {found}");
        return failure.at_node(message, (place.node, &place.path));
    }
    let (node, path) = (place.stopped.0, &place.stopped.1);
    let text = failure.slice(node.span.clone());
    let message = format!("expected {wanted}, found {}", failure.found(node));
    let quotes = *code == Error::ExpectedString && node.kind == Kind::Scalar(Scalar::Word);
    Diagnostic {
        help: quotes.then(|| format!("write it in quotes: `\"{text}\"`")),
        ..failure.at_node(message, (node, path))
    }
}

/// Parentheses were expected.
fn no_parentheses(failure: &Failure<'_>, name: &str, place: &Place<'_>) -> Diagnostic {
    let read = failure.text.get(..failure.offset).unwrap_or_default();
    let last = read.trim_end().len();
    let word = (last.checked_sub(1))
        .and_then(|at| place.node.innermost_below(&place.path, at))
        .filter(|(node, _)| node.kind == Kind::Scalar(Scalar::Word) && node.span.end == last);
    if let Some((node, path)) = word {
        let word = failure.slice(node.span.clone());
        let message = format!("`{word}` needs its values in parentheses: `{word}(..)`");
        return failure.at_node(message, (node, &path));
    }
    let (node, path) = (place.stopped.0, &place.stopped.1);
    let found = failure.found(node);
    let message = match name {
        "" => format!("expected values in parentheses, found {found}"),
        "DVec3" => format!("expected three numbers `(x, y, z)`, found {found}"),
        name => format!("expected the fields of `{name}` in parentheses, found {found}"),
    };
    failure.at_node(message, (node, path))
}

/// A name was expected, of a field or of a variant.
fn no_name(failure: &Failure<'_>, place: &Place<'_>) -> Diagnostic {
    let node = place.node;
    let found = failure.found(node);
    let message = match &node.kind {
        Kind::Tuple {
            name: Some(name), ..
        } => {
            let name = failure.slice(name.clone());
            format!("the values of `{name}` need their names: `{name}(name: value, ..)`")
        }
        Kind::Tuple { .. } => format!("expected named fields `(name: value, ..)`, found {found}"),
        Kind::Struct { name: None, fields } if !fields.is_empty() => {
            format!("a choice begins with its name, as `Name(name: value, ..)`; found {found}")
        }
        _ => format!("expected a name, found {found}"),
    };
    failure.at_node(message, (node, &place.path))
}

/// The type was content before the value ended.
fn left_over(failure: &Failure<'_>, code: &Error, place: &Place<'_>) -> Diagnostic {
    let (node, path) = (place.stopped.0, &place.stopped.1);
    let before_parens = |name: &Range<usize>| {
        let between = failure.text.get(name.end..failure.offset);
        between.is_some_and(|t| t.trim().is_empty())
    };
    match &node.kind {
        Kind::Scalar(Scalar::Number) if failure.offset > node.span.start => {
            let message = format!("expected an integer, found {}", failure.found(node));
            failure.at_node(message, (node, path))
        }
        Kind::Struct { name: Some(n), .. } | Kind::Tuple { name: Some(n), .. }
            if before_parens(n) =>
        {
            let name = failure.slice(n.clone());
            let message = format!("`{name}` takes no values: write `{name}` alone");
            failure.at_node(message, (node, path))
        }
        _ => match path.segments.last() {
            Some(Segment::Index(index)) => {
                let holder = path.head(path.segments.len() - 1);
                let message = format!("too many values: expected {}", values(*index));
                failure.diagnostic(message, node.span.clone(), &holder)
            }
            _ => failure.at_node(plain(code), (node, path)),
        },
    }
}

/// A message of `ron` as it is, but for its capital.
fn plain(code: &Error) -> String {
    let message = code.to_string();
    let mut chars = message.chars();
    match chars.next() {
        Some(first) => first.to_lowercase().chain(chars).collect(),
        None => message,
    }
}

#[cfg(test)]
mod tests;
