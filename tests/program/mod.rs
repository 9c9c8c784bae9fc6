//! Calls the program as a user does, for the tests of this folder.

#![allow(dead_code, reason = "every test file uses its own part")]

pub(crate) mod full_disk;
pub(crate) mod refused;
pub(crate) mod reproduced;
pub(crate) mod searches;

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};
use std::sync::atomic::{AtomicU32, Ordering};

/// Runs the program in the root of the repository, so that the names of files in messages stay.
pub(crate) fn aerobot(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_aerobot"))
        .args(arguments)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap()
}

/// What the program has printed, which is never a panic.
pub(crate) fn text(bytes: &[u8]) -> String {
    let text = String::from_utf8(bytes.to_vec()).unwrap();
    assert!(!text.contains("panicked"), "{text}");
    text
}

/// A path in the folder for temporary files that is removed at the end.
pub(crate) struct Scratch(pub(crate) PathBuf);

impl Scratch {
    /// A path where nothing is yet.
    pub(crate) fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("aerobot-test-{}-{number}", std::process::id());
        let path = std::env::temp_dir().join(name);
        assert!(!path.exists(), "{} exists", path.display());
        Self(path)
    }

    /// An empty folder.
    pub(crate) fn folder() -> Self {
        let scratch = Self::new();
        fs::create_dir(&scratch.0).unwrap();
        scratch
    }

    /// The path itself.
    pub(crate) fn text(&self) -> &str {
        self.0.to_str().unwrap()
    }

    /// The path of a file below it.
    pub(crate) fn path(&self, name: &str) -> String {
        self.0.join(name).to_str().unwrap().to_owned()
    }

    /// Puts a file below it and gives its path.
    pub(crate) fn file(&self, name: &str, text: &str) -> String {
        let path = self.0.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}
