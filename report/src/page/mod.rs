//! A page: one HTML file with everything in it, which opens without a network.

mod blocks;
pub mod campaign_page;
mod document;
mod escape;
pub mod run_page;
pub mod search_page;
pub mod view;

pub use blocks::{Block, Row, Section, TextTable};
pub use document::{Page, is_page};
pub use escape::{json_in_html, text_in_html};
