//! A page that shows runs, in one file that needs nothing outside of itself.

pub mod view;
