//! Reading a journal back, record by record, up to the first one that is not whole.
//!
//! A process that ended while it wrote leaves its last record in part; that one and what
//! follows are passed over. A record that is whole but cannot be is an error.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::{Path, PathBuf};

use palpate_volume::voxels::Voxels;

use crate::journal::entry::{Action, Entry, ScanHash};
use crate::journal::error::JournalError;
use crate::journal::file::{
    HEAD_BYTES, MAGIC, OLDEST_VERSION, VERSION, checksum_after, head, lock,
};
use crate::journal::record::{Counted, Record, counted, decode};

/// What was found in a journal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Recovery {
    /// Steps that were done, undone or redone; one without an end is not counted.
    pub steps: usize,
    /// Bytes up to the end of the last whole record.
    pub valid_bytes: u64,
    /// Bytes after it, which are lost.
    pub ignored_bytes: u64,
    /// Whether the last step has no end: its changes are there.
    pub step_is_open: bool,
    /// Checksum so far, which the next record's continues.
    pub(crate) checksum: u32,
}

/// A journal being read.
#[derive(Debug)]
pub struct JournalReader {
    path: PathBuf,
    file: BufReader<File>,
    file_bytes: u64,
    found: Recovery,
    /// Changes that are still to come of those that belong together.
    together: u32,
}

/// Follows a journal of a scan to its end; `voxels` are then what they were there, whatever
/// their segments and edits before. Where that fails, they stay as they were.
///
/// # Errors
/// Where the file is no journal of this scan, or a record does not fit the voxels.
pub fn recover(path: &Path, hash: ScanHash, voxels: &mut Voxels) -> Result<Recovery, JournalError> {
    let mut reader = JournalReader::open(path, hash, voxels)?;
    let mut recovered = of_scan(voxels)?;
    while let Some(entry) = reader.next(&recovered)? {
        let at = reader.found.valid_bytes;
        let misfit = |source| JournalError::Misfit { at, source };
        match entry {
            Entry::Edit(_, edit) => drop(recovered.apply(edit).map_err(misfit)?),
            Entry::Put(_, id, segment) => {
                drop(recovered.insert_segment(id, segment).map_err(misfit)?);
            }
            Entry::Remove(_, id) => drop(recovered.remove_segment(id).map_err(misfit)?),
            Entry::Move { .. }
            | Entry::Facts(..)
            | Entry::Together(_)
            | Entry::Note(_)
            | Entry::StepEnd => {}
        }
    }
    *voxels = recovered;
    Ok(reader.recovery())
}

/// The scan of some voxels, without segments or edits.
fn of_scan(voxels: &Voxels) -> Result<Voxels, JournalError> {
    let bare = Voxels::new(*voxels.grid(), voxels.intensities().clone());
    bare.map_err(|source| JournalError::Misfit { at: 0, source })
}

impl JournalReader {
    /// Opens a journal of a scan.
    ///
    /// # Errors
    /// Where the file is no journal, one of another scan or of another version.
    pub fn open(path: &Path, hash: ScanHash, voxels: &Voxels) -> Result<Self, JournalError> {
        let disk = JournalError::disk(path);
        let file = File::open(path).map_err(&disk)?;
        let file_bytes = file.metadata().map_err(&disk)?.len();
        let mut file = BufReader::new(file);

        let dimensions = voxels.grid().dimensions();
        let mut found = [0; HEAD_BYTES];
        let is_whole = read_whole(&mut file, &mut found).map_err(&disk)?;
        let (body, sum) = found.split_at(HEAD_BYTES - 4);
        if !is_whole || &found[..8] != MAGIC || crc32fast::hash(body).to_le_bytes() != sum {
            return Err(JournalError::NoJournal(path.to_owned()));
        }
        let given = u32::from_le_bytes([found[8], found[9], found[10], found[11]]);
        if !(OLDEST_VERSION..=VERSION).contains(&given) {
            return Err(JournalError::Version {
                given,
                oldest: OLDEST_VERSION,
                newest: VERSION,
            });
        }
        let (expected, checksum) = head(given, dimensions, hash);
        if found[..] != expected[..] {
            let allowed = dimensions;
            return Err(JournalError::OtherScan { allowed });
        }
        let valid_bytes = HEAD_BYTES as u64;
        Ok(Self {
            path: path.to_owned(),
            file,
            file_bytes,
            together: 0,
            found: Recovery {
                valid_bytes,
                ignored_bytes: file_bytes.saturating_sub(valid_bytes),
                checksum,
                ..Recovery::default()
            },
        })
    }

    /// The next entry, which follows on these voxels: whoever calls applies it before the
    /// next call. None at the end of what is whole.
    ///
    /// # Errors
    /// Where the disk says no, or a whole record cannot be.
    pub fn next(&mut self, voxels: &Voxels) -> Result<Option<Entry>, JournalError> {
        let record = self.record().map_err(JournalError::disk(&self.path))?;
        let Some((kind, bytes)) = record else {
            return Ok(None);
        };
        let at = self.found.valid_bytes;
        let wrong = |what| JournalError::Record { at, what };
        let entry = decode(kind, &bytes, voxels).map_err(wrong)?;
        let count = counted(kind, &bytes).map_err(wrong)?;
        self.pass(kind, &bytes);
        self.count(count);
        Ok(Some(entry))
    }

    /// Makes sure that no session writes the file now.
    ///
    /// # Errors
    /// Where one does.
    pub fn check_unused(&self) -> Result<(), JournalError> {
        let file = self.file.get_ref();
        lock(file, &self.path)?;
        file.unlock().map_err(JournalError::disk(&self.path))
    }

    /// Counts what is whole to the end, without following it.
    ///
    /// # Errors
    /// Where the disk says no, or a whole record cannot be.
    pub fn skim(mut self) -> Result<Recovery, JournalError> {
        while let Some((kind, bytes)) = self.record().map_err(JournalError::disk(&self.path))? {
            let at = self.found.valid_bytes;
            let count = counted(kind, &bytes).map_err(|what| JournalError::Record { at, what })?;
            self.pass(kind, &bytes);
            self.count(count);
        }
        Ok(self.found)
    }

    /// What was found so far.
    #[must_use]
    pub fn recovery(&self) -> Recovery {
        self.found
    }

    /// The next record, if it is whole.
    fn record(&mut self) -> io::Result<Option<Record>> {
        let mut front = [0; 9];
        if !read_whole(&mut self.file, &mut front)? {
            return Ok(None);
        }
        let number = |place: usize| {
            let bytes: [u8; 4] = std::array::from_fn(|i| front[place + i]);
            u32::from_le_bytes(bytes)
        };
        let (length, checksum, kind) = (u64::from(number(0)), number(4), front[8]);
        // memory is taken only for what the file holds
        let left = self.file_bytes.saturating_sub(self.found.valid_bytes + 8);
        if length == 0 || length > left {
            return Ok(None);
        }
        let mut bytes = vec![0; length as usize - 1];
        let is_whole = read_whole(&mut self.file, &mut bytes)?
            && checksum_after(self.found.checksum, kind, &bytes) == checksum;
        Ok(is_whole.then_some((kind, bytes)))
    }

    /// Goes on behind a record that is whole.
    fn pass(&mut self, kind: u8, bytes: &[u8]) {
        let length = bytes.len() as u64 + 9;
        self.found.checksum = checksum_after(self.found.checksum, kind, bytes);
        self.found.valid_bytes += length;
        self.found.ignored_bytes -= length;
    }

    fn count(&mut self, counted: Counted) {
        match counted {
            Counted::Nothing | Counted::Change(Action::Start) => {}
            Counted::Together(count) => self.together = count,
            Counted::Change(Action::Do) => self.found.step_is_open = true,
            Counted::Change(Action::Undo | Action::Redo) => {
                // several that belong together count with the last of them
                self.together = self.together.saturating_sub(1);
                self.found.steps += usize::from(self.together == 0);
            }
            Counted::StepEnd => {
                self.together = 0;
                self.found.steps += usize::from(self.found.step_is_open);
                self.found.step_is_open = false;
            }
        }
    }
}

/// Fills `bytes`; false where the file ends before.
fn read_whole(file: &mut impl Read, bytes: &mut [u8]) -> io::Result<bool> {
    match file.read_exact(bytes) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Ok(false),
        Err(error) => Err(error),
    }
}
