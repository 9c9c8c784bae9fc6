//! Built-in channels.
