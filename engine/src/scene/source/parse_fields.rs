//! Everything that is wrong with the fields of a value, not only the first of it.

use std::borrow::Cow;
use std::ops::Range;

use serde::de::DeserializeOwned;

use super::diagnostic::Diagnostic;
use super::lexer::Lexer;
use super::tree::{Kind, Node};
use super::typed::parse_node;

/// Parses as [`parse_node`], and after an error goes on without the field at fault.
///
/// # Errors
/// What does not fit the type. A field that is missing is named only from a struct of which nothing
/// had to be left out: it may be what was left out under a wrong name.
pub fn parse_fields<T: DeserializeOwned>(
    source_text: &str,
    node: &Node,
    base_path: &str,
) -> Result<T, Vec<Diagnostic>> {
    let mut text = Cow::Borrowed(source_text);
    let mut found: Vec<Diagnostic> = Vec::new();
    loop {
        let diagnostic = match parse_node(&text, node, base_path) {
            Ok(value) if found.is_empty() => return Ok(value),
            Ok(_) => return Err(found),
            Err(diagnostic) => diagnostic,
        };
        let field = (diagnostic.span.as_ref()).and_then(|span| field_at(node, span.start));
        if !found.iter().any(|earlier| stands_in(earlier, &diagnostic)) {
            found.push(diagnostic);
        }
        match field {
            Some(field) if !is_blank(&text, &field) => blank(text.to_mut(), field),
            _ => return Err(found),
        }
    }
}

/// True if `inner` is of the same value as `outer`, or of a part of it.
fn stands_in(inner: &Diagnostic, outer: &Diagnostic) -> bool {
    let Some(inner) = &inner.path else {
        return false;
    };
    // Everything is part of the root, which has no path.
    let outer = match outer.path.as_deref() {
        None | Some("") => return true,
        Some(path) => path,
    };
    let below = inner.strip_prefix(outer);
    below.is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
}

/// The innermost field of a struct that covers a byte, its name included.
fn field_at(node: &Node, offset: usize) -> Option<Range<usize>> {
    let parts = node.children().into_iter().map(|(_, name, child)| {
        let start = name.map_or(child.span.start, |name| name.start);
        (start..child.span.end, child)
    });
    let (range, child) = parts
        .into_iter()
        .find(|(range, _)| range.contains(&offset))?;
    let own = matches!(node.kind, Kind::Struct { .. }).then_some(range);
    field_at(child, offset).or(own)
}

fn is_blank(text: &str, range: &Range<usize>) -> bool {
    let part = text.get(range.clone()).unwrap_or_default();
    part.trim().is_empty()
}

/// Puts spaces in the place of a field and of the comma after it, so that all else stays in place.
fn blank(text: &mut String, field: Range<usize>) {
    let mut after = Lexer::new(text);
    after.back_to(field.end);
    let comma =
        (after.skip_space().is_ok() && after.peek() == Some(',')).then(|| after.next_char_span());
    for range in std::iter::once(field).chain(comma) {
        text.replace_range(range.clone(), &" ".repeat(range.len()));
    }
}

#[cfg(test)]
mod tests {
    use super::super::scan;
    use super::*;

    #[derive(Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    #[expect(dead_code, reason = "only read")]
    struct Sail {
        area_m2: f64,
        #[serde(default)]
        angle_rad: f64,
        #[serde(default)]
        name: String,
    }

    fn messages(text: &str) -> Vec<String> {
        let node = scan(text).unwrap();
        let found = parse_fields::<Sail>(text, &node, "sail").unwrap_err();
        found.into_iter().map(|d| d.path.unwrap()).collect()
    }

    #[test]
    fn every_wrong_field_is_found() {
        assert_eq!(
            messages("(area_m2: \"large\", colour: 3 /* , */ , name: 4, angle_rad: 1)"),
            ["sail.area_m2", "sail.colour", "sail.name"]
        );
    }

    #[test]
    fn what_may_have_a_wrong_name_is_not_called_missing() {
        assert_eq!(messages("(area: 2)"), ["sail.area"]);
        assert_eq!(messages("()"), ["sail"]);
    }
}
