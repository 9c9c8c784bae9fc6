//! From a node of the tree to a typed value, with errors that know their place.

use std::ops::Range;

use ron::extensions::Extensions;
use serde::de::DeserializeOwned;
use serde_path_to_error::{Path, Segment as SerdeSegment};

use super::diagnostic::Diagnostic;
use super::path::{FieldPath, Segment};
use super::translate::{Failure, translate};
use super::tree::{Kind, Node};

/// Parses the part of a text that a node covers. `base_path` is the path of the node, for
/// messages.
///
/// `Some(..)` may be left out, and newtypes are written as what they hold. Extensions that an
/// attribute at the head of the file enables do not reach here.
///
/// # Errors
/// The first thing in this node that does not fit the type: its range in `source_text`, its full
/// path, and the nearest right name.
pub fn parse_node<T: DeserializeOwned>(
    source_text: &str,
    node: &Node,
    base_path: &str,
) -> Result<T, Diagnostic> {
    let slice = source_text.get(node.span.clone()).unwrap_or_default();
    let options = ron::Options::default()
        .with_default_extension(Extensions::IMPLICIT_SOME)
        .with_default_extension(Extensions::UNWRAP_NEWTYPES)
        .with_default_extension(Extensions::UNWRAP_VARIANT_NEWTYPES);
    let failed = |code: ron::Error, path: Option<&Path>, left: usize| {
        let offset = node.span.start + slice.len().saturating_sub(left);
        let place = locate(node, path, offset);
        let failure = Failure {
            text: source_text,
            base_path,
            offset,
        };
        translate(&failure, &code, &place)
    };
    let mut ron = match ron::Deserializer::from_str_with_options(slice, &options) {
        Ok(ron) => ron,
        Err(error) => return Err(failed(error.code, None, slice.len())),
    };
    let value = match serde_path_to_error::deserialize(&mut ron) {
        Ok(value) => value,
        Err(error) => {
            let path = error.path().clone();
            return Err(failed(
                error.into_inner(),
                Some(&path),
                ron.remainder().len(),
            ));
        }
    };
    match ron.end() {
        Ok(()) => Ok(value),
        Err(code) => Err(failed(code, None, ron.remainder().len())),
    }
}

/// Where in the tree an error happened.
pub(super) struct Place<'a> {
    /// The node that was parsed.
    pub root: &'a Node,
    /// The innermost node on the way that the error's path describes.
    pub node: &'a Node,
    /// The way there from the node that was parsed.
    pub path: FieldPath,
    /// The next name on the way, if the node does not have it.
    pub missing: Option<String>,
    /// The innermost node inside `node` at the place where the parser stopped, and the way
    /// there.
    pub stopped: (&'a Node, FieldPath),
}

/// Follows the path of an error through the tree. The path names neither newtypes nor, in every
/// case, variants.
fn locate<'a>(root: &'a Node, path: Option<&Path>, offset: usize) -> Place<'a> {
    let mut node = root;
    let mut way = FieldPath::default();
    let mut missing = None;
    for segment in path.into_iter().flatten() {
        let segment = match segment {
            SerdeSegment::Map { key } => Segment::Name(key.clone()),
            SerdeSegment::Seq { index } => Segment::Index(*index),
            SerdeSegment::Enum { .. } | SerdeSegment::Unknown => continue,
        };
        if let (Kind::Tuple { items, .. }, Segment::Index(_)) = (&node.kind, &segment)
            && let [only] = items.as_slice()
            && matches!(only.kind, Kind::Tuple { .. } | Kind::List(_))
            && offset > only.span.start
        {
            way = way.join(Segment::Index(0));
            node = only;
        }
        let Some(inner) = node.step(&segment) else {
            missing = Some(segment.plain());
            break;
        };
        way = way.join(segment);
        node = inner;
    }
    let stopped = (node.innermost_below(&way, offset)).unwrap_or((node, way.clone()));
    Place {
        root,
        node,
        path: way,
        missing,
        stopped,
    }
}

/// The range of a field's name or a map's key in a node.
pub(super) fn name_span(node: &Node, name: &str) -> Option<Range<usize>> {
    match &node.kind {
        Kind::Tuple { items, .. } if items.len() == 1 => name_span(&items[0], name),
        _ => (node.children().into_iter())
            .find(|(segment, _, _)| segment.plain() == name)
            .and_then(|(_, span, _)| span),
    }
}

#[cfg(test)]
mod tests;
