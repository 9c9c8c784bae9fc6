//! `--set PATH=RON`: reading the argument, and editing the scene's text with it.
//!
//! The value at an existing path is replaced where it stands. A last step that does not exist in
//! an existing struct or map is added at its end. Comments and layout stay.

use std::ops::Range;

use super::diagnostic::Diagnostic;
use super::edited::{EditedText, Origin};
use super::lexer::{Lexer, is_name};
use super::nearest::nearest;
use super::path::{FieldPath, Segment};
use super::scan::scan;
use super::tree::{Kind, Node};

/// One `--set PATH=RON`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Override {
    /// What it sets.
    pub path: FieldPath,
    /// The value: one RON value, without the space and comments around it.
    pub value_text: String,
    /// The argument as it was given.
    pub original: String,
    /// Where `value_text` starts in `original`.
    pub value_offset: usize,
}

/// Reads the argument of a `--set`. It is split at the first `=` outside quotes.
///
/// # Errors
/// A message if there is no `=`, if the path has an empty part, or if the value is not one RON
/// value.
pub fn parse_override(argument: &str) -> Result<Override, String> {
    let refused = |why: String| format!("`--set {argument}`: {why}");
    let (mut quoted, mut escaped) = (false, false);
    let split = argument.find(|c| {
        quoted ^= c == '"' && !escaped;
        escaped = c == '\\' && quoted && !escaped;
        c == '=' && !quoted
    });
    let Some(split) = split else {
        return Err(refused("expected `PATH=VALUE`".to_owned()));
    };
    let path = argument[..split].trim().parse().map_err(refused)?;
    let value = &argument[split + 1..];
    let node = scan(value).map_err(|e| refused(format!("in the value: {}", e.message)))?;
    Ok(Override {
        path,
        value_text: value.get(node.span.clone()).unwrap_or_default().to_owned(),
        original: argument.to_owned(),
        value_offset: split + 1 + node.span.start,
    })
}

/// Edits a scene's text with overrides, one after the other.
///
/// # Errors
/// A diagnostic if the text does not scan, or if a path leads nowhere: which part of it does not
/// exist, and the nearest name that does.
pub fn apply(text: &str, overrides: &[Override]) -> Result<EditedText, Diagnostic> {
    let mut edited = EditedText::unedited(text);
    for (i, change) in overrides.iter().enumerate() {
        let root = match scan(edited.text()) {
            Err(error) if i == 0 => return Err(error.into()),
            Err(error) => return Err(refused(change, 0, error.message)),
            Ok(root) => root,
        };
        let (_, reached) = root.reach(&change.path);
        apply_one(&mut edited, &root, change).map_err(|why| refused(change, reached, why))?;
    }
    Ok(edited)
}

/// An override that cannot be applied, for what its path asks for after `reached` steps.
fn refused(change: &Override, reached: usize, why: String) -> Diagnostic {
    Diagnostic {
        argument: Some(Box::new((
            change.original.clone(),
            part_of_argument(change, reached),
        ))),
        ..Diagnostic::new(why)
    }
}

/// Where a step of the path stands in the argument; the whole path if it is spelt in another way.
fn part_of_argument(change: &Override, step: usize) -> Range<usize> {
    let text = &change.original;
    let start = text.len() - text.trim_start().len();
    let mut before = change.path.head(step).to_string();
    if step > 0 {
        before.push('.');
    }
    let part = change.path.segments.get(step).map(ToString::to_string);
    let part = part.unwrap_or_default();
    let at = start + before.len();
    if !part.is_empty() && text[start..].starts_with(&format!("{before}{part}")) {
        at..at + part.len()
    } else {
        start..text.find('=').unwrap_or(text.len())
    }
}

fn apply_one(edited: &mut EditedText, root: &Node, change: &Override) -> Result<(), String> {
    let (node, reached) = root.reach(&change.path);
    match change.path.segments.get(reached..) {
        None | Some([]) => {
            let index = edited.begin(change);
            edited.put_value(index, node.span.clone());
            Ok(())
        }
        Some([last]) => match insertion(node, last, edited.text()) {
            None => Err(no_part(node, change, reached, edited.text())),
            Some(place) => {
                let place = place?;
                let index = edited.begin(change);
                insert(edited, index, &place);
                Ok(())
            }
        },
        Some(missing) => match nested(node, change, reached, missing) {
            Some(whole) => apply_one(edited, root, &whole),
            None => Err(no_part(node, change, reached, edited.text())),
        },
    }
}

/// The same change as that of a whole block which the text leaves to its defaults: `run.record.nodes=x`
/// as `run.record=(nodes: x)`. Only in a struct, whose fields the typed parser will judge, and not
/// where a name that exists is near: that is a slip of the pen.
fn nested(node: &Node, change: &Override, reached: usize, missing: &[Segment]) -> Option<Override> {
    let (first, inner) = missing.split_first()?;
    let is_struct = matches!(node.kind, Kind::Struct { .. });
    if !is_struct || nearest(&first.plain(), node.names()).is_some() {
        return None;
    }
    let mut value_text = change.value_text.clone();
    for segment in inner.iter().rev() {
        let Segment::Name(name) = segment else {
            return None;
        };
        value_text = is_name(name).then(|| format!("({name}: {value_text})"))?;
    }
    let path = change.path.head(reached + 1);
    let original = format!("{path}={value_text}");
    Some(Override {
        value_offset: original.len() - value_text.len(),
        path,
        value_text,
        original,
    })
}

/// Says which part of a path does not exist.
fn no_part(node: &Node, change: &Override, reached: usize, text: &str) -> String {
    let place = match reached {
        0 => "the scene".to_owned(),
        n => format!("`{}`", change.path.head(n)),
    };
    let missing = match change.path.segments.get(reached) {
        Some(segment) => segment.plain(),
        None => String::new(),
    };
    let count = |n: usize| match n {
        1 => "has 1 value, counted from 0".to_owned(),
        n => format!("has {n} values, counted from 0"),
    };
    let reason = match &node.kind {
        Kind::List(items) => count(items.len()),
        Kind::Tuple { items, .. } if node.names().is_empty() => count(items.len()),
        Kind::Scalar(_) => format!("is {} without parts", node.describe(text)),
        _ => String::new(),
    };
    let mut message = format!("there is no `{missing}` in {place}");
    if !reason.is_empty() {
        message.push_str(&format!(", which {reason}"));
    }
    match nearest(&missing, node.names()) {
        Some(near) => message.push_str(&format!("; did you mean `{near}`?")),
        None if !node.names().is_empty() => {
            let names: Vec<String> = node.names().iter().map(|n| format!("`{n}`")).collect();
            message.push_str(&format!("; it has {}", names.join(", ")));
        }
        None => {}
    }
    message
}

/// Where and how a new field or entry goes into a text.
struct Insertion {
    /// The end of the last field, if it lacks the comma that the new one needs.
    comma: Option<usize>,
    /// Where the new one goes.
    at: usize,
    /// What goes before it: a comma, or the indentation of its line.
    before: String,
    /// The name, or the key without its quotes but escaped.
    name: String,
    /// True for a map's key, which is written in quotes.
    quoted: bool,
    /// What goes after its value.
    after: &'static str,
}

/// How a new part is added to a struct or a map; `None` if the node is neither, an error if the
/// name cannot be a field's.
fn insertion(node: &Node, segment: &Segment, text: &str) -> Option<Result<Insertion, String>> {
    let (quoted, last) = match &node.kind {
        Kind::Struct { fields, .. } => {
            let last = fields.last();
            (false, last.map(|f| f.name_span.start..f.value.span.end))
        }
        Kind::Map { entries } => {
            let last = entries.last();
            (true, last.map(|e| e.key.span.start..e.value.span.end))
        }
        Kind::Tuple { items, .. } if items.len() == 1 => {
            return insertion(&items[0], segment, text);
        }
        _ => return None,
    };
    let plain = segment.plain();
    let name = match quoted {
        true => plain.replace('\\', "\\\\").replace('"', "\\\""),
        false if is_name(&plain) => plain,
        false => return Some(Err(format!("`{plain}` cannot be the name of a field"))),
    };
    let (at, before) = match &last {
        None => {
            let from = node.name().map_or(node.span.start, |name| name.end);
            (after_open(text, from), "")
        }
        Some(last) => (last.end, ", "),
    };
    let in_line = Insertion {
        comma: None,
        at,
        before: before.to_owned(),
        name,
        quoted,
        after: "",
    };
    Some(Ok(match last {
        Some(last) => on_own_line(in_line, node, last, text),
        None => in_line,
    }))
}

/// Moves an insertion to a line of its own if the closing bracket stands on one.
fn on_own_line(place: Insertion, node: &Node, last: Range<usize>, text: &str) -> Insertion {
    let close = node.span.end.saturating_sub(1);
    let line = line_start(text, close);
    let alone = text.get(line..close).is_some_and(|t| t.trim().is_empty());
    if !alone || line <= last.end {
        return place;
    }
    let last_line = text.get(line_start(text, last.start)..).unwrap_or_default();
    let indent = last_line.len() - last_line.trim_start_matches([' ', '\t']).len();
    Insertion {
        comma: (!comma_follows(text, last.end)).then_some(last.end),
        at: line,
        before: last_line[..indent].to_owned(),
        after: ",\n",
        ..place
    }
}

fn line_start(text: &str, at: usize) -> usize {
    let before = text.get(..at).unwrap_or_default();
    before.rfind('\n').map_or(0, |newline| newline + 1)
}

/// The place just after the opening bracket that follows `from`.
fn after_open(text: &str, from: usize) -> usize {
    let mut lexer = Lexer::new(text);
    lexer.back_to(from);
    match lexer.skip_space() {
        Ok(()) => lexer.next_char_span().end,
        Err(_) => from,
    }
}

fn comma_follows(text: &str, from: usize) -> bool {
    let mut lexer = Lexer::new(text);
    lexer.back_to(from);
    lexer.skip_space().is_ok() && lexer.peek() == Some(',')
}

fn insert(edited: &mut EditedText, index: usize, place: &Insertion) {
    let glue = Origin::Glue(index);
    let name = (edited.overrides().get(index)).map_or(glue, |change| Origin::Argument {
        index,
        at: last_part_offset(change),
    });
    let quote = if place.quoted { "\"" } else { "" };
    let mut at = place.at;
    if let Some(end) = place.comma {
        edited.splice(end..end, ",", glue);
        at += 1;
    }
    for (part, origin) in [
        (place.before.as_str(), glue),
        (quote, glue),
        (place.name.as_str(), name),
        (quote, glue),
        (": ", glue),
    ] {
        edited.splice(at..at, part, origin);
        at += part.len();
    }
    edited.splice(at..at, place.after, glue);
    edited.put_value(index, at..at);
}

/// Where the last part of the path stands in the argument of an override.
fn last_part_offset(change: &Override) -> usize {
    let before_value = (change.original.get(..change.value_offset)).unwrap_or_default();
    let path = match before_value.rfind('=') {
        Some(equals) => before_value[..equals].trim_end(),
        None => before_value,
    };
    let last = change.path.segments.last().map(ToString::to_string);
    path.len() - last.map_or(0, |l| l.len().min(path.len()))
}

#[cfg(test)]
mod tests;
