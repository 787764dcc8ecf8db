//! Places for files that tests write.

use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// A path that nothing is at, in the system's own folder for such; removed at the end.
pub struct Place(pub PathBuf);

impl Place {
    pub fn new(name: &str) -> Self {
        // tests of one binary run beside one another
        static PLACES: AtomicU32 = AtomicU32::new(0);
        let number = PLACES.fetch_add(1, Relaxed);
        let file = format!("palpate-{name}-{}-{number}.journal", std::process::id());
        let place = Self(std::env::temp_dir().join(file));
        let _ = fs::remove_file(&place.0);
        place
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}
