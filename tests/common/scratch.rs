//! Files for a while.

use std::fs;
use std::path::PathBuf;

/// A file that goes with the value.
pub struct Scratch(pub PathBuf);

impl Scratch {
    /// A file of these bytes. Tests that run at the same time give different names.
    pub fn new(name: &str, bytes: &[u8]) -> Self {
        let path = std::env::temp_dir().join(format!("stickslip-scratch-{}-{name}", std::process::id()));
        fs::write(&path, bytes).unwrap();
        Scratch(path)
    }

    pub fn path(&self) -> &str {
        self.0.to_str().unwrap()
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}
