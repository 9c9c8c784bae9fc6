//! The address of a value in a scene: `entities.tether.Tether.nodes`.
//!
//! A path names fields, map keys and positions. The name of an enum variant is not part of it:
//! in `radius: Equilibrium(altitude_m: 56_000)` the altitude is `radius.altitude_m`, and in
//! `gravity: Constant(8.87)` the number is `gravity.0`. A tuple of one value is looked through
//! when a name is asked of it.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

use super::tree::{Kind, Node};

/// One step of a path.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Segment {
    /// A field's name or a map's key.
    Name(String),
    /// The position in a list or a tuple, from 0. In a struct or a map it is read as a name.
    Index(usize),
}

/// The address of a value: segments separated by dots. A segment that itself holds a dot, a
/// quote, an equals sign or a space is written in double quotes.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct FieldPath {
    /// The steps, from the root.
    pub segments: Vec<Segment>,
}

impl FieldPath {
    /// This path with one more step.
    #[must_use]
    pub fn join(&self, segment: Segment) -> Self {
        let mut longer = self.clone();
        longer.segments.push(segment);
        longer
    }

    /// The first `n` steps of this path.
    #[must_use]
    pub fn head(&self, n: usize) -> Self {
        Self {
            segments: self.segments.iter().take(n).cloned().collect(),
        }
    }

    /// This path below another one, given as text.
    #[must_use]
    pub fn below(&self, base: &str) -> String {
        match (base.is_empty(), self.segments.is_empty()) {
            (true, _) => self.to_string(),
            (false, true) => base.to_owned(),
            (false, false) => format!("{base}.{self}"),
        }
    }
}

impl Segment {
    fn from_plain(text: &str) -> Self {
        match text.parse::<usize>() {
            Ok(index) if index.to_string() == text => Self::Index(index),
            _ => Self::Name(text.to_owned()),
        }
    }

    /// The segment without quotes: the name, or the digits of the index.
    #[must_use]
    pub fn plain(&self) -> String {
        match self {
            Self::Name(name) => name.clone(),
            Self::Index(index) => index.to_string(),
        }
    }
}

impl fmt::Display for Segment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let needs_quotes = |c: char| matches!(c, '.' | '"' | '=' | '\\') || c.is_whitespace();
        match self {
            Self::Index(index) => write!(f, "{index}"),
            Self::Name(name) if name.is_empty() || name.contains(needs_quotes) => {
                write!(f, "\"{}\"", name.replace('\\', "\\\\").replace('"', "\\\""))
            }
            Self::Name(name) => f.write_str(name),
        }
    }
}

impl fmt::Display for FieldPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, segment) in self.segments.iter().enumerate() {
            let dot = if i == 0 { "" } else { "." };
            write!(f, "{dot}{segment}")?;
        }
        Ok(())
    }
}

impl FromStr for FieldPath {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut segments = Vec::new();
        let mut rest = text;
        loop {
            let (segment, after) = if let Some(quoted) = rest.strip_prefix('"') {
                quoted_segment(text, quoted)?
            } else {
                let end = rest.find('.').unwrap_or(rest.len());
                if end == 0 {
                    return Err(format!("the path `{text}` has an empty part"));
                }
                (Segment::from_plain(&rest[..end]), &rest[end..])
            };
            segments.push(segment);
            match after.strip_prefix('.') {
                Some(more) => rest = more,
                None if after.is_empty() => return Ok(Self { segments }),
                None => {
                    return Err(format!("the path `{text}` lacks a `.` after a quoted part"));
                }
            }
        }
    }
}

/// The segment that starts after a double quote, and what follows its closing quote.
fn quoted_segment<'a>(text: &str, quoted: &'a str) -> Result<(Segment, &'a str), String> {
    let mut name = String::new();
    let mut chars = quoted.char_indices();
    while let Some((i, c)) = chars.next() {
        match c {
            '"' => return Ok((Segment::Name(name), &quoted[i + 1..])),
            '\\' => name.extend(chars.next().map(|(_, escaped)| escaped)),
            _ => name.push(c),
        }
    }
    Err(format!("the path `{text}` has an unclosed quote"))
}

impl Node {
    /// The part of this value that one step of a path leads to.
    #[must_use]
    pub fn step(&self, segment: &Segment) -> Option<&Node> {
        match (&self.kind, segment) {
            (Kind::Struct { fields, .. }, _) => {
                let name = segment.plain();
                fields.iter().find(|f| f.name == name).map(|f| &f.value)
            }
            (Kind::Map { entries }, _) => {
                let name = segment.plain();
                entries.iter().find(|e| e.name == name).map(|e| &e.value)
            }
            (Kind::Tuple { items, .. } | Kind::List(items), Segment::Index(i)) => items.get(*i),
            (Kind::Tuple { items, .. }, Segment::Name(_)) if items.len() == 1 => {
                items[0].step(segment)
            }
            _ => None,
        }
    }

    /// The value at a path.
    #[must_use]
    pub fn get(&self, path: &FieldPath) -> Option<&Node> {
        (path.segments.iter()).try_fold(self, |node, segment| node.step(segment))
    }

    /// The range of the name or key under which the value at a path stands; `None` for one that has
    /// none, such as an element of a list.
    #[must_use]
    pub fn name_span(&self, path: &FieldPath) -> Option<Range<usize>> {
        let (last, before) = path.segments.split_last()?;
        let holder = self.get(&path.head(before.len()))?;
        let children = holder.children().into_iter();
        let mut named = children.filter(|(segment, ..)| segment.plain() == last.plain());
        named.next().and_then(|(_, span, _)| span)
    }

    /// The innermost value that a path reaches, and how many of its steps lead there.
    #[must_use]
    pub fn reach(&self, path: &FieldPath) -> (&Node, usize) {
        let mut node = self;
        for (i, segment) in path.segments.iter().enumerate() {
            match node.step(segment) {
                Some(inner) => node = inner,
                None => return (node, i),
            }
        }
        (node, path.segments.len())
    }
}

#[cfg(test)]
mod tests;
