//! A text with some of it replaced, which still knows where every byte came from.

use std::ops::Range;

use super::overrides::Override;

/// A scene's text after its overrides.
///
/// The text is a row of pieces, each from the original file or from an override's argument, so
/// that a place in it can be shown where the user wrote it.
#[derive(Clone, Debug, PartialEq)]
pub struct EditedText {
    text: String,
    pieces: Vec<Piece>,
    overrides: Vec<Override>,
    value_ranges: Vec<Option<Range<usize>>>,
}

/// Where a byte of the edited text came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Origin {
    /// From this offset of the original file.
    File(usize),
    /// From this offset of the argument of the override with this number.
    Argument {
        /// Number of the override, from 0.
        index: usize,
        /// Offset in its argument.
        at: usize,
    },
    /// A comma, colon or space that the override with this number brought with it.
    Glue(usize),
}

impl Origin {
    fn advanced(self, by: usize) -> Self {
        match self {
            Self::File(at) => Self::File(at + by),
            Self::Argument { index, at } => Self::Argument { index, at: at + by },
            Self::Glue(index) => Self::Glue(index),
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
struct Piece {
    range: Range<usize>,
    origin: Origin,
}

impl EditedText {
    /// The text of a file as it is.
    #[must_use]
    pub fn unedited(original: &str) -> Self {
        Self {
            text: original.to_owned(),
            pieces: vec![Piece {
                range: 0..original.len(),
                origin: Origin::File(0),
            }],
            overrides: Vec::new(),
            value_ranges: Vec::new(),
        }
    }

    /// The text as edited.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The overrides, in the order in which they were applied.
    #[must_use]
    pub fn overrides(&self) -> &[Override] {
        &self.overrides
    }

    /// Where the value of an override stands in the edited text; `None` if a later override
    /// replaced it.
    #[must_use]
    pub fn value_range(&self, index: usize) -> Option<Range<usize>> {
        self.value_ranges.get(index).cloned().flatten()
    }

    /// The offset in the original file of an offset in the edited text; `None` for text that an
    /// override brought. The end of the text is the end of the file.
    #[must_use]
    pub fn original_offset(&self, offset: usize) -> Option<usize> {
        match self.origin(offset)? {
            Origin::File(at) => Some(at),
            _ => None,
        }
    }

    /// The override from which the text at an offset came, and the place in its argument; the
    /// punctuation around a value counts as the start of the value.
    #[must_use]
    pub fn argument_offset(&self, offset: usize) -> Option<(usize, usize)> {
        match self.origin(offset)? {
            Origin::File(_) => None,
            Origin::Argument { index, at } => Some((index, at)),
            Origin::Glue(index) => Some((index, self.overrides.get(index)?.value_offset)),
        }
    }

    pub(super) fn origin(&self, offset: usize) -> Option<Origin> {
        let inside = self.pieces.iter().find(|p| p.range.contains(&offset));
        let at_end = || (self.pieces.iter()).rfind(|p| p.range.end == offset);
        let piece = inside.or_else(at_end)?;
        Some(piece.origin.advanced(offset - piece.range.start))
    }

    /// Registers an override that is about to be applied, and gives its number.
    pub(super) fn begin(&mut self, change: &Override) -> usize {
        self.overrides.push(change.clone());
        self.value_ranges.push(None);
        self.overrides.len() - 1
    }

    /// Puts an override's value in the place of a range of the text.
    pub(super) fn put_value(&mut self, index: usize, range: Range<usize>) {
        let Some(change) = self.overrides.get(index) else {
            return;
        };
        let value = change.value_text.clone();
        let at = change.value_offset;
        let start = range.start;
        self.splice(range, &value, Origin::Argument { index, at });
        if let Some(slot) = self.value_ranges.get_mut(index) {
            *slot = Some(start..start + value.len());
        }
    }

    /// Replaces a range of the text; every range that is kept moves with it.
    pub(super) fn splice(&mut self, range: Range<usize>, new: &str, origin: Origin) {
        self.text.replace_range(range.clone(), new);
        let moved = |at: usize| at - range.len() + new.len();
        let mut pieces = Vec::with_capacity(self.pieces.len() + 2);
        let before = |p: &Piece| p.range.start..p.range.end.min(range.start);
        for p in &self.pieces {
            if !before(p).is_empty() {
                pieces.push(Piece {
                    range: before(p),
                    origin: p.origin,
                });
            }
        }
        if !new.is_empty() {
            let range = range.start..range.start + new.len();
            pieces.push(Piece { range, origin });
        }
        for p in self.pieces.iter().filter(|p| p.range.end > range.end) {
            let start = p.range.start.max(range.end);
            pieces.push(Piece {
                range: moved(start)..moved(p.range.end),
                origin: p.origin.advanced(start - p.range.start),
            });
        }
        self.pieces = pieces;
        for slot in &mut self.value_ranges {
            *slot = slot.take().and_then(|v| shifted(v, &range, new.len()));
        }
    }
}

/// A range after another range became `len` bytes; `None` if it lay inside what was replaced.
fn shifted(value: Range<usize>, replaced: &Range<usize>, len: usize) -> Option<Range<usize>> {
    let moved = |at: usize| at - replaced.len() + len;
    if value.end <= replaced.start {
        Some(value)
    } else if replaced.end <= value.start {
        Some(moved(value.start)..moved(value.end))
    } else if value.start <= replaced.start && replaced.end <= value.end && value != *replaced {
        Some(value.start..moved(value.end))
    } else {
        None
    }
}

#[cfg(test)]
mod tests;
