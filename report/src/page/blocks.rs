//! What pages are made of.

use crate::animation::Animation;
use crate::figure::Figure;

/// A part of a page with a heading.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// Its heading.
    pub title: String,
    /// What links to it, where that is not its heading.
    pub name: Option<String>,
    /// What it holds.
    pub blocks: Vec<Block>,
}

/// Something in a section.
#[derive(Clone, Debug)]
pub enum Block {
    /// A paragraph.
    Text(String),
    /// A finding: whether it is as it should be, and a sentence.
    Verdict {
        /// Whether it is.
        holds: bool,
        /// What is found.
        sentence: String,
    },
    /// A table.
    Table(TextTable),
    /// A figure.
    Figure(Box<Figure>),
    /// One run or several that play in time, with their labels.
    View(Vec<(String, Animation)>),
    /// Text as it stands, behind a line to click on.
    Folded {
        /// The line.
        summary: String,
        /// The text.
        text: String,
    },
    /// A link to a file beside the page.
    Link {
        /// What it is.
        text: String,
        /// Its place from the page.
        to: String,
    },
    /// A command to be copied.
    Command(String),
}

/// A table of text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TextTable {
    /// Headings of the columns; empty: none.
    pub head: Vec<String>,
    /// Rows.
    pub rows: Vec<Row>,
}

/// A row of a table.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Row {
    /// Its fields; the first is its name.
    pub fields: Vec<String>,
    /// Whether what it says is as it should be, if it can be otherwise.
    pub holds: Option<bool>,
}

impl TextTable {
    /// A table of names and what they are.
    #[must_use]
    pub fn of_facts(facts: impl IntoIterator<Item = (String, String)>) -> Self {
        let row = |(name, value)| Row {
            fields: vec![name, value],
            holds: None,
        };
        Self {
            head: Vec::new(),
            rows: facts.into_iter().map(row).collect(),
        }
    }
}

impl Section {
    /// A section.
    #[must_use]
    pub fn new(title: impl Into<String>, blocks: Vec<Block>) -> Self {
        Self {
            title: title.into(),
            name: None,
            blocks,
        }
    }

    /// With a shorter name for links to it.
    #[must_use]
    pub fn named(self, name: impl Into<String>) -> Self {
        Self {
            name: Some(name.into()),
            ..self
        }
    }
}
