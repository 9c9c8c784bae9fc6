//! Diagnostics as text: the message, the line at fault and the place in it.
//!
//! ```text
//! error: unexpected field `mas_kg` in `Body`, expected one of `mass_kg`, `inertia`
//!  --> scenes/chain.ron:4:12  (at entities.gondola.Body.mas_kg)
//!   |
//! 4 |     Body: (mas_kg: 20.0),
//!   |            ^^^^^^
//!   = help: did you mean `mass_kg`?
//! ```

use std::ops::Range;

use super::diagnostic::{Diagnostic, Source};
use super::edited::Origin;
use super::overrides::Override;

/// A line to show and what to point at in it.
struct Excerpt<'a> {
    /// Where it is: `file:line:column`, or the `--set`.
    place: String,
    /// The number before the line; empty for an argument.
    number: String,
    /// What stands before the line but is not part of it.
    lead: &'static str,
    line: &'a str,
    /// Bytes of the line.
    mark: Range<usize>,
}

/// Line and column of an offset, from 1, the column in characters.
pub(super) fn line_column(text: &str, at: usize) -> (usize, usize) {
    let before = text.get(..at.min(text.len())).unwrap_or_default();
    let line = 1 + before.matches('\n').count();
    let column = 1 + before.chars().rev().take_while(|&c| c != '\n').count();
    (line, column)
}

/// The diagnostics in the order of their places, those without a place last, and a line that
/// counts them if there are several.
pub(super) fn render(source: &Source, diagnostics: &[Diagnostic]) -> String {
    let mut sorted: Vec<&Diagnostic> = diagnostics.iter().collect();
    sorted.sort_by_key(|d| match &d.span {
        Some(span) => (false, span.start, span.end),
        None => (true, 0, 0),
    });
    let mut parts: Vec<String> = sorted.iter().map(|d| one(source, d)).collect();
    if parts.len() > 1 {
        let (n, file) = (parts.len(), &source.file_name);
        parts.push(format!("error: {n} problems in {file}\n"));
    }
    parts.join("\n")
}

fn one(source: &Source, diagnostic: &Diagnostic) -> String {
    let mut out = format!("error: {}\n", diagnostic.message);
    let refused = diagnostic.argument.as_deref();
    let found = (diagnostic.span.clone().map(|span| excerpt(source, span)))
        .or_else(|| refused.map(|(text, part)| (shown_argument(text, part.clone()), None)));
    let width = found.as_ref().map_or(1, |(e, _)| e.number.len().max(1));
    let space = " ".repeat(width);
    let place = (found.as_ref()).map_or(source.file_name.as_str(), |(e, _)| &e.place);
    let own_path = found.as_ref().and_then(|(_, change)| change.as_ref());
    let at = match (&diagnostic.path, own_path) {
        (Some(path), Some(change)) if *path == change.path.to_string() => String::new(),
        (Some(path), _) if !path.is_empty() => format!("  (at {path})"),
        _ => String::new(),
    };
    out.push_str(&format!("{space}--> {place}{at}\n"));
    if let Some((excerpt, _)) = &found {
        push_excerpt(&mut out, excerpt, width);
    }
    if let Some(help) = &diagnostic.help {
        out.push_str(&format!("{space} = help: {help}\n"));
    }
    out
}

fn push_excerpt(out: &mut String, excerpt: &Excerpt<'_>, width: usize) {
    let Excerpt { lead, number, .. } = excerpt;
    let line = excerpt.line;
    // a tab is kept under a tab, so that the mark stands right whatever its width
    let under = |c: char| if c == '\t' { '\t' } else { ' ' };
    let before = line.get(..excerpt.mark.start).unwrap_or_default();
    let indent: String = lead.chars().chain(before.chars()).map(under).collect();
    let marked = line.get(excerpt.mark.clone()).unwrap_or_default();
    let carets = "^".repeat(marked.chars().count().max(1));
    let shown: String = (line.chars())
        .map(|c| {
            if c.is_control() && c != '\t' {
                '\u{FFFD}'
            } else {
                c
            }
        })
        .collect();
    out.push_str(&format!("{:width$} |\n", ""));
    out.push_str(format!("{number:>width$} | {lead}{shown}").trim_end());
    out.push_str(&format!("\n{:width$} | {indent}{carets}\n", ""));
}

/// The line to show for a range of the edited text, and the override it came from, if any.
fn excerpt(source: &Source, span: Range<usize>) -> (Excerpt<'_>, Option<&Override>) {
    let (index, at) = match source.edited.origin(span.start) {
        Some(Origin::Argument { index, .. } | Origin::Glue(index)) => (Some(index), 0),
        Some(Origin::File(at)) => (None, at),
        None => (None, source.original.len()),
    };
    let change = index.and_then(|i| Some((i, source.edited.overrides().get(i)?)));
    match change {
        Some((i, change)) => (argument_excerpt(source, span, i, change), Some(change)),
        None => (file_excerpt(source, span, at), None),
    }
}

fn file_excerpt(source: &Source, span: Range<usize>, at: usize) -> Excerpt<'_> {
    let text = source.original.as_str();
    let at = at.min(text.len());
    let in_file = |offset: usize| source.edited.original_offset(offset).filter(|&o| o >= at);
    let end = (span.clone().rev())
        .find_map(in_file)
        .map_or(at, |last| last + 1);
    let (line_range, mark) = line_at(text, at..end);
    let (line, column) = line_column(text, at);
    Excerpt {
        place: format!("{}:{line}:{column}", source.file_name),
        number: line.to_string(),
        lead: "",
        line: &text[line_range],
        mark,
    }
}

fn argument_excerpt<'a>(
    source: &Source,
    span: Range<usize>,
    index: usize,
    change: &'a Override,
) -> Excerpt<'a> {
    let text = change.original.as_str();
    let in_argument = |offset: usize| match source.edited.argument_offset(offset) {
        Some((i, at)) if i == index => Some(at.min(text.len())),
        _ => None,
    };
    let at = in_argument(span.start).unwrap_or(change.value_offset);
    let last = (span.clone().rev()).find_map(in_argument).unwrap_or(at);
    let end = if span.is_empty() { at } else { last + 1 };
    shown_argument(text, at..end.max(at))
}

/// A part of the argument of a `--set`.
fn shown_argument(text: &str, part: Range<usize>) -> Excerpt<'_> {
    let (line_range, mark) = line_at(text, part);
    Excerpt {
        place: format!("--set {}", text.replace('\n', " ")),
        number: String::new(),
        lead: if line_range.start == 0 { "--set " } else { "" },
        line: &text[line_range],
        mark,
    }
}

/// The line of a text in which a range starts, and the part of the range in it, both on
/// character boundaries.
fn line_at(text: &str, range: Range<usize>) -> (Range<usize>, Range<usize>) {
    let start = text.floor_char_boundary(range.start);
    let line_start = text[..start].rfind('\n').map_or(0, |n| n + 1);
    let line_end = text[start..].find('\n').map_or(text.len(), |n| start + n);
    let line = text[line_start..line_end].trim_end_matches('\r').len();
    let end = text.ceil_char_boundary(range.end.max(start)) - line_start;
    let mark = (start - line_start).min(line)..end.min(line);
    (line_start..line_start + line, mark)
}

#[cfg(test)]
mod tests;
