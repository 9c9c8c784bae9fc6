//! A bar of the part that is done, for commands of several runs.

use std::io::IsTerminal;

use indicatif::{ProgressBar, ProgressStyle};

/// Steps of the bar.
const LENGTH: f64 = 1e4;

/// A bar on a terminal, nothing elsewhere.
pub(super) struct PartBar(ProgressBar);

impl PartBar {
    pub(super) fn new(quiet: bool) -> Self {
        if quiet || !std::io::stderr().is_terminal() {
            return Self(ProgressBar::hidden());
        }
        let bar = ProgressBar::new(LENGTH as u64);
        if let Ok(style) =
            ProgressStyle::with_template("{bar:40} {percent:>3} %, {msg}, {eta} left")
        {
            bar.set_style(style);
        }
        Self(bar)
    }

    /// Shows what is under way and what part of the whole is done, 0 to 1.
    pub(super) fn show(&self, what: &str, part: f64) {
        // A step is not worth a string.
        if self.0.is_hidden() {
            return;
        }
        if self.0.message() != what {
            self.0.set_message(what.to_owned());
        }
        self.0.set_position((part * LENGTH) as u64);
    }

    /// Does what prints lines of its own.
    pub(super) fn above<T>(&self, print: impl FnOnce() -> T) -> T {
        self.0.suspend(print)
    }

    pub(super) fn clear(&self) {
        self.0.finish_and_clear();
    }
}
