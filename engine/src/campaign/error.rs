//! Why a campaign does not go on.

use std::fmt;
use std::io;
use std::path::Path;

use crate::scene::SceneError;

/// Why a campaign does not go on, ready to be printed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CampaignError {
    /// The message.
    pub text: String,
    /// Whether it had begun: then finished runs are kept. Otherwise nothing was written.
    pub begun: bool,
}

impl CampaignError {
    /// Refused, with what to do about it (may be empty).
    #[must_use]
    pub fn refused(message: impl fmt::Display, help: &str) -> Self {
        let mut text = format!("error: {message}");
        if !help.is_empty() {
            text.push_str(&format!("\n  = help: {help}"));
        }
        Self { text, begun: false }
    }

    /// What the file system refused before anything was run.
    #[must_use]
    pub fn unreadable(path: &Path, error: &io::Error) -> Self {
        Self::refused(
            format_args!("cannot read `{}`: {error}", path.display()),
            "",
        )
    }

    /// What the file system refused while results were written.
    #[must_use]
    pub fn unwritten(path: &Path, error: &io::Error) -> Self {
        let text = format!(
            "error: cannot write `{}`: {error}\n  = note: finished runs are kept; the same command goes on \
             from there",
            path.display()
        );
        Self { text, begun: true }
    }
}

impl From<SceneError> for CampaignError {
    fn from(error: SceneError) -> Self {
        Self {
            text: error.text,
            begun: false,
        }
    }
}

impl fmt::Display for CampaignError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.text)
    }
}

impl std::error::Error for CampaignError {}
