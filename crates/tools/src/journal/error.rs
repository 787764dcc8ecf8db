//! What can be wrong with a journal on disk.

use std::io;
use std::path::{Path, PathBuf};

use glam::UVec3;
use palpate_volume::voxels::VoxelsError;
use thiserror::Error;

/// A journal that cannot be made, read or followed.
#[derive(Debug, Error)]
pub enum JournalError {
    /// The disk says no.
    #[error("journal {path}: {source}")]
    Disk {
        /// Which file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// There is one already.
    #[error("journal {0} exists already; allowed: a new file, or recovering this one first")]
    Exists(PathBuf),
    /// Another session writes it.
    #[error("journal {0} is in use by another session; allowed: one session per journal")]
    InUse(PathBuf),
    /// The file begins otherwise.
    #[error("{0} is no journal, or its head is damaged")]
    NoJournal(PathBuf),
    /// Written by another version of this program.
    #[error("journal of version {given} given; allowed: {oldest} to {newest}")]
    Version {
        /// Version that the file states.
        given: u32,
        /// The oldest that this program reads.
        oldest: u32,
        /// What this program writes.
        newest: u32,
    },
    /// The journal belongs to another scan.
    #[error("a journal of another scan given; allowed: one of this scan of {allowed} voxels")]
    OtherScan {
        /// Voxels along each axis.
        allowed: UVec3,
    },
    /// A record is whole, but says what cannot be.
    #[error("journal record at byte {at}: {what}")]
    Record {
        /// Offset in the file [bytes].
        at: u64,
        /// What is wrong.
        what: &'static str,
    },
    /// A record does not fit the voxels.
    #[error("journal record at byte {at}: {source}")]
    Misfit {
        /// Offset in the file [bytes].
        at: u64,
        /// Why.
        source: VoxelsError,
    },
}

impl JournalError {
    pub(crate) fn disk(path: &Path) -> impl Fn(io::Error) -> Self {
        |source| Self::Disk {
            path: path.to_owned(),
            source,
        }
    }
}
