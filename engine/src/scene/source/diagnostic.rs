//! What is wrong with a scene, and the source it is shown against.

use std::ops::Range;

use super::edited::EditedText;
use super::lexer::SyntaxError;
use super::overrides::{Override, apply};
use super::render;
use super::tree::Duplicate;

/// One thing that is wrong with a scene.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Diagnostic {
    /// What is wrong, in words that stand alone.
    pub message: String,
    /// The bytes at fault in the text after the overrides, if they are known.
    pub span: Option<Range<usize>>,
    /// The path of the value at fault, as `--set` would write it.
    pub path: Option<String>,
    /// What to do about it.
    pub help: Option<String>,
    /// The `--set` at fault and the bytes of its argument, if it could not be applied.
    pub argument: Option<Box<(String, Range<usize>)>>,
}

impl Diagnostic {
    /// A diagnostic with a message and nothing else.
    #[must_use]
    pub fn new(message: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            ..Self::default()
        }
    }

    /// The same at a range of the text.
    #[must_use]
    pub fn at(self, span: Range<usize>) -> Self {
        Self {
            span: Some(span),
            ..self
        }
    }

    /// The same with the path of the value at fault.
    #[must_use]
    pub fn with_path(self, path: impl Into<String>) -> Self {
        Self {
            path: Some(path.into()),
            ..self
        }
    }

    /// The same with what to do about it.
    #[must_use]
    pub fn with_help(self, help: impl Into<String>) -> Self {
        Self {
            help: Some(help.into()),
            ..self
        }
    }
}

impl From<SyntaxError> for Diagnostic {
    fn from(error: SyntaxError) -> Self {
        Self::new(error.message).at(error.span)
    }
}

impl From<&Duplicate> for Diagnostic {
    fn from(duplicate: &Duplicate) -> Self {
        Self::new(format!("`{}` is given twice", duplicate.name))
            .at(duplicate.second.clone())
            .with_path(duplicate.path.to_string())
    }
}

/// A scene file as read and as edited by the overrides.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// The name of the file, for messages.
    pub file_name: String,
    /// Its text as read.
    pub original: String,
    /// Its text after the overrides: what is scanned and parsed.
    pub edited: EditedText,
}

impl Source {
    /// A file without overrides.
    #[must_use]
    pub fn new(file_name: impl Into<String>, original: impl Into<String>) -> Self {
        let original = original.into();
        Self {
            file_name: file_name.into(),
            edited: EditedText::unedited(&original),
            original,
        }
    }

    /// The same file, edited by overrides.
    ///
    /// # Errors
    /// As [`apply`]; the diagnostic can be rendered against the source without overrides.
    pub fn with_overrides(&self, overrides: &[Override]) -> Result<Self, Diagnostic> {
        Ok(Self {
            file_name: self.file_name.clone(),
            original: self.original.clone(),
            edited: apply(&self.original, overrides)?,
        })
    }

    /// The text that is scanned and parsed, after the overrides.
    #[must_use]
    pub fn text(&self) -> &str {
        self.edited.text()
    }

    /// Line and column in the file, from 1, the column in characters, of an offset in the edited
    /// text; `None` if an override brought the text there.
    #[must_use]
    pub fn line_column(&self, offset: usize) -> Option<(usize, usize)> {
        let at = self.edited.original_offset(offset)?;
        Some(render::line_column(&self.original, at))
    }

    /// The diagnostics as text for a terminal, in the order of the file, each shown against the
    /// file or against the `--set` from which the text at fault came.
    #[must_use]
    pub fn render(&self, diagnostics: &[Diagnostic]) -> String {
        render::render(self, diagnostics)
    }
}

#[cfg(test)]
mod tests;
