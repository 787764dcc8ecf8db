//! A journal of all changes on disk, so that a crash loses nothing: written as they are made,
//! and read back.

mod entry;
mod error;
mod file;
mod reader;
mod record;

pub use entry::{Action, Entry, Facts, ScanHash};
pub use error::JournalError;
pub use file::{JournalFile, OLDEST_VERSION, Storage, VERSION};
pub use reader::{JournalReader, Recovery, recover};
