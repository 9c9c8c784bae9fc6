//! The tree of a RON text: what stands where, with byte ranges, and nothing about types.

use std::collections::HashMap;
use std::ops::Range;

use super::path::{FieldPath, Segment};

/// A value in the text.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Bytes of the value, its name and its brackets included.
    pub span: Range<usize>,
    /// What it is.
    pub kind: Kind,
}

/// What a value is.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// `(a: 1, ..)`, `Name(a: 1)`; the empty `()` and `Name()` as well.
    Struct {
        /// Range of the name before the parenthesis, if there is one.
        name: Option<Range<usize>>,
        /// The fields, in the order of the text.
        fields: Vec<Field>,
    },
    /// `(1, 2)`, `Name(1, 2)`.
    Tuple {
        /// Range of the name before the parenthesis, if there is one.
        name: Option<Range<usize>>,
        /// The values, in order.
        items: Vec<Node>,
    },
    /// `[1, 2]`.
    List(
        /// The elements, in order.
        Vec<Node>,
    ),
    /// `{ "x": 1 }`.
    Map {
        /// The entries, in the order of the text.
        entries: Vec<Entry>,
    },
    /// A value without brackets.
    Scalar(
        /// Which sort of value it is.
        Scalar,
    ),
}

/// The sorts of values without brackets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scalar {
    /// `1`, `-2.5e3`, `0x1F`, `inf`, `NaN`, `b'a'`.
    Number,
    /// `"text"`, `r"text"`, `r#"text"#`, and byte strings.
    Text,
    /// `'c'`.
    Character,
    /// `true` or `false`.
    Boolean,
    /// A bare name such as `Vira`.
    Word,
}

/// A named field of a struct.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Its name, without the `r#` of a raw identifier.
    pub name: String,
    /// Where the name stands.
    pub name_span: Range<usize>,
    /// Its value.
    pub value: Node,
}

/// An entry of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// The key: a string's contents with escapes resolved, otherwise the text of the key.
    pub name: String,
    /// The key as a node.
    pub key: Node,
    /// The value.
    pub value: Node,
}

/// A field or a key that is given twice.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Duplicate {
    /// Path of the field, its own name included.
    pub path: FieldPath,
    /// The name that is given twice.
    pub name: String,
    /// Where the name first stands.
    pub first: Range<usize>,
    /// Where it stands again.
    pub second: Range<usize>,
}

impl Node {
    /// Range of the name in front of the parentheses (`Name(..)`), or of a bare name.
    #[must_use]
    pub fn name(&self) -> Option<Range<usize>> {
        match &self.kind {
            Kind::Struct { name, .. } | Kind::Tuple { name, .. } => name.clone(),
            Kind::Scalar(Scalar::Word) => Some(self.span.clone()),
            _ => None,
        }
    }

    /// Where the value opens: its name, or its first character.
    #[must_use]
    pub fn opening(&self) -> Range<usize> {
        match &self.kind {
            Kind::Scalar(_) => self.span.clone(),
            _ => self
                .name()
                .unwrap_or(self.span.start..self.span.start.saturating_add(1)),
        }
    }

    /// The direct parts of the value, each with its segment, the range of its name (for a field)
    /// or key (for an entry), and its node.
    #[must_use]
    pub fn children(&self) -> Vec<(Segment, Option<Range<usize>>, &Node)> {
        match &self.kind {
            Kind::Struct { fields, .. } => (fields.iter())
                .map(|f| {
                    (
                        Segment::Name(f.name.clone()),
                        Some(f.name_span.clone()),
                        &f.value,
                    )
                })
                .collect(),
            Kind::Map { entries } => (entries.iter())
                .map(|e| {
                    (
                        Segment::Name(e.name.clone()),
                        Some(e.key.span.clone()),
                        &e.value,
                    )
                })
                .collect(),
            Kind::Tuple { items, .. } | Kind::List(items) => (items.iter().enumerate())
                .map(|(i, item)| (Segment::Index(i), None, item))
                .collect(),
            Kind::Scalar(_) => Vec::new(),
        }
    }

    /// The names of the direct fields or map keys, looking through a tuple of one value.
    #[must_use]
    pub fn names(&self) -> Vec<&str> {
        match &self.kind {
            Kind::Struct { fields, .. } => fields.iter().map(|f| f.name.as_str()).collect(),
            Kind::Map { entries } => entries.iter().map(|e| e.name.as_str()).collect(),
            Kind::Tuple { items, .. } if items.len() == 1 => items[0].names(),
            _ => Vec::new(),
        }
    }

    /// The innermost node whose range contains the byte `offset`, and its path. A map's key is a
    /// node too; it has the path of its entry.
    #[must_use]
    pub fn innermost(&self, offset: usize) -> Option<(&Node, FieldPath)> {
        self.innermost_below(&FieldPath::default(), offset)
    }

    /// As [`Self::innermost`], for a node that has a path itself.
    pub(super) fn innermost_below(
        &self,
        path: &FieldPath,
        offset: usize,
    ) -> Option<(&Node, FieldPath)> {
        if !self.span.contains(&offset) {
            return None;
        }
        if let Kind::Map { entries } = &self.kind {
            let key = entries.iter().find(|e| e.key.span.contains(&offset));
            if let Some(entry) = key {
                let path = path.join(Segment::Name(entry.name.clone()));
                return Some((&entry.key, path));
            }
        }
        let inside = (self.children().into_iter())
            .find(|(_, _, child)| child.span.contains(&offset))
            .and_then(|(segment, _, child)| child.innermost_below(&path.join(segment), offset));
        Some(inside.unwrap_or_else(|| (self, path.clone())))
    }

    /// What the value is, in words for a message: "a string", "a list", "the name `Vira`".
    #[must_use]
    pub fn describe(&self, text: &str) -> String {
        let at = |span: Range<usize>| text.get(span).unwrap_or_default();
        let named = |name: &Option<Range<usize>>| {
            name.clone()
                .map_or_else(String::new, |n| format!("`{}(..)`", at(n)))
        };
        match &self.kind {
            Kind::Struct { name: None, fields } if fields.is_empty() => "`()`".to_owned(),
            Kind::Struct { name: None, .. } => "named fields `(name: value, ..)`".to_owned(),
            Kind::Tuple { name: None, items } => match items.len() {
                1 => "one value in parentheses".to_owned(),
                n => format!("a tuple of {n} values"),
            },
            Kind::Struct { name, .. } | Kind::Tuple { name, .. } => named(name),
            Kind::List(_) => "a list `[..]`".to_owned(),
            Kind::Map { .. } => "a map `{..}`".to_owned(),
            Kind::Scalar(Scalar::Number) => "a number".to_owned(),
            Kind::Scalar(Scalar::Text) => "a string".to_owned(),
            Kind::Scalar(Scalar::Character) => "a character".to_owned(),
            Kind::Scalar(Scalar::Boolean) => format!("`{}`", at(self.span.clone())),
            Kind::Scalar(Scalar::Word) => format!("the name `{}`", at(self.span.clone())),
        }
    }
}

/// Every field and every map key that is given twice, at every level, in the order of the text.
#[must_use]
pub fn duplicates(root: &Node) -> Vec<Duplicate> {
    let mut found = Vec::new();
    collect_duplicates(root, &FieldPath::default(), &mut found);
    found.sort_by_key(|d| d.second.start);
    found
}

fn collect_duplicates(node: &Node, path: &FieldPath, found: &mut Vec<Duplicate>) {
    let mut seen = HashMap::new();
    for (segment, name_span, child) in node.children() {
        let inner = path.join(segment.clone());
        if let (Segment::Name(name), Some(second)) = (segment, name_span) {
            let first = seen.entry(name.clone()).or_insert_with(|| second.clone());
            if *first != second {
                found.push(Duplicate {
                    path: inner.clone(),
                    name,
                    first: first.clone(),
                    second,
                });
            }
        }
        collect_duplicates(child, &inner, found);
    }
}

#[cfg(test)]
mod tests;
