//! A journal on disk: every change is appended as it is made, so that a crash loses nothing.
//!
//! A thread of the journal's own encodes and writes; whoever makes changes hands over shared
//! bricks and never waits. Each record goes to the system at once, so that the end of the
//! process loses none; the disk is asked to keep them once a second, so that a power cut
//! loses what is younger. Where the disk is full, gone or too slow, the journal stops, says
//! so once, and the session goes on; the file then holds everything up to that change.
//!
//! ```text
//! head     "PALPATEJ", version u32, dimensions 3 × u32, hash of the scan 32 × u8, CRC-32 u32
//! record   length u32, CRC-32 u32, kind u8, bytes; the length is that of kind and bytes
//! ```
//!
//! Each record's CRC-32 goes on from that of the one before, so none can be missing or out of
//! turn. What the bytes are stands in `journal_record.rs`.

use std::fmt;
use std::fs::File;
use std::io::{self, Seek, Write};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, OnceLock};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use glam::{DAffine3, UVec3};
use palpate_volume::edit::{Edit, SegmentId};
use palpate_volume::intensities::Intensities;
use palpate_volume::segment::Segment;
use palpate_volume::voxels::Voxels;

use crate::journal::entry::{Action, Delta, Facts, ScanHash, Written, start_of};
use crate::journal::error::JournalError;
use crate::journal::reader::Recovery;
use crate::journal::record::{Record, encode};

/// The format that is written. Older ones are read too: version 1 knows neither moves nor what is known
/// of segments beside their voxels, version 2 not which of them are locked.
pub const VERSION: u32 = 3;
/// The oldest format that is read.
pub const OLDEST_VERSION: u32 = 1;
/// First bytes of a journal.
pub(crate) const MAGIC: &[u8; 8] = b"PALPATEJ";
/// Bytes before the first record.
pub(crate) const HEAD_BYTES: usize = 60;

/// Changes that wait for the disk at most; at 100 a second, those of 10 s.
const QUEUE: usize = 1024;
/// Longest time until a written record is synced to disk.
const SYNC_EVERY: Duration = Duration::from_secs(1);

/// Where a journal is written to.
pub trait Storage: Write + Send {
    /// Waits until what was written would survive a power cut.
    ///
    /// # Errors
    /// Where the disk says no.
    fn sync(&mut self) -> io::Result<()>;
}

impl Storage for File {
    fn sync(&mut self) -> io::Result<()> {
        self.sync_data()
    }
}

/// What the writing thread tells.
#[derive(Debug, Default)]
struct Told {
    bytes: AtomicU64,
    problem: OnceLock<String>,
}

/// A journal that is being written. Dropped, it writes what waits and closes the file.
pub struct JournalFile {
    sender: Option<SyncSender<Written>>,
    told: Arc<Told>,
    writer: Option<JoinHandle<()>>,
    problem_was_taken: bool,
}

impl fmt::Debug for JournalFile {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter
            .debug_struct("JournalFile")
            .field("told", &self.told)
            .finish_non_exhaustive()
    }
}

impl JournalFile {
    /// Begins a new file for these voxels, as they are now: their segments and what edits
    /// made of the scan so far go into it first, so that the scan alone is needed beside it.
    ///
    /// # Errors
    /// Where the file exists already, or the disk says no.
    pub fn create(path: &Path, hash: ScanHash, voxels: &Voxels) -> Result<Self, JournalError> {
        let disk = JournalError::disk(path);
        let file = File::create_new(path).map_err(|error| match error.kind() {
            io::ErrorKind::AlreadyExists => JournalError::Exists(path.to_owned()),
            _ => disk(error),
        })?;
        lock(&file, path)?;
        sync_folder_of(path).map_err(&disk)?;
        Self::begin(file, hash, voxels).map_err(|error| {
            // a file without its whole head would only be in the way
            let _ = std::fs::remove_file(path);
            disk(error)
        })
    }

    /// Goes on with a file that was recovered; what was damaged at its end is cut off.
    ///
    /// # Errors
    /// Where another session uses it, or the disk says no.
    pub fn resume(path: &Path, recovery: &Recovery, voxels: &Voxels) -> Result<Self, JournalError> {
        let disk = JournalError::disk(path);
        let mut file = File::options().write(true).open(path).map_err(&disk)?;
        lock(&file, path)?;
        file.set_len(recovery.valid_bytes).map_err(&disk)?;
        file.seek(io::SeekFrom::End(0)).map_err(&disk)?;
        let journal = Self::start(file, recovery.checksum, recovery.valid_bytes, voxels);
        let mut journal = journal.map_err(&disk)?;
        if recovery.step_is_open {
            journal.end_step();
        }
        Ok(journal)
    }

    /// Begins a journal on any storage.
    ///
    /// # Errors
    /// Where the storage does not take the head.
    pub fn begin(
        mut storage: impl Storage + 'static,
        hash: ScanHash,
        voxels: &Voxels,
    ) -> io::Result<Self> {
        let (head, checksum) = head(VERSION, voxels.grid().dimensions(), hash);
        storage.write_all(&head)?;
        storage.sync()?;
        let mut journal = Self::start(storage, checksum, head.len() as u64, voxels)?;
        for entry in start_of(voxels) {
            journal.send(entry);
        }
        Ok(journal)
    }

    fn start(
        storage: impl Storage + 'static,
        checksum: u32,
        bytes: u64,
        voxels: &Voxels,
    ) -> io::Result<Self> {
        let (sender, receiver) = sync_channel(QUEUE);
        let told = Arc::new(Told::default());
        told.bytes.store(bytes, Ordering::Relaxed);
        let mut writer = Writer {
            storage,
            checksum,
            scan: voxels.intensities().clone(),
            told: Arc::clone(&told),
        };
        let writer = thread::Builder::new()
            .name("journal".to_owned())
            .spawn(move || writer.run(&receiver))?;
        Ok(Self {
            sender: Some(sender),
            told,
            writer: Some(writer),
            problem_was_taken: false,
        })
    }

    /// Notes an edit that was applied: its inverse, and the voxels as it left them.
    pub fn edit(&mut self, action: Action, inverse: &Edit, voxels: &Voxels) {
        self.send(Written::Edit(action, Delta::of_applied(inverse, voxels)));
    }

    /// Notes a segment that was added, or whose voxels were all replaced.
    pub fn put(&mut self, action: Action, id: SegmentId, segment: &Segment) {
        self.send(Written::Put(action, id, segment.clone()));
    }

    /// Notes that a segment was removed.
    pub fn remove(&mut self, action: Action, id: SegmentId) {
        self.send(Written::Remove(action, id));
    }

    /// Notes that a segment was moved; where it `goes_on`, as a part of the step before.
    pub fn moved(&mut self, action: Action, id: SegmentId, pose: DAffine3, goes_on: bool) {
        self.send(Written::Move(action, id, pose, goes_on));
    }

    /// Notes what is known of a segment from now on, which is no step.
    pub fn facts(&mut self, id: SegmentId, facts: Facts) {
        self.send(Written::Facts(id, facts));
    }

    /// Says that so many of the next changes belong together, so that none comes back alone.
    pub fn together(&mut self, count: u32) {
        self.send(Written::Together(count));
    }

    /// Notes what the caller keeps beside voxels.
    pub fn note(&mut self, bytes: Vec<u8>) {
        self.send(Written::Note(bytes));
    }

    /// Says that what was done since the last end is one step for undo.
    pub fn end_step(&mut self) {
        self.send(Written::StepEnd);
    }

    /// Bytes of the file so far.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.told.bytes.load(Ordering::Relaxed)
    }

    /// Why the journal stopped, once; none as long as it goes on.
    pub fn take_problem(&mut self) -> Option<String> {
        if self.problem_was_taken {
            return None;
        }
        let ended = self.writer.as_ref().is_none_or(JoinHandle::is_finished);
        if ended && self.sender.is_some() {
            self.writer_failed();
        }
        let problem = self.told.problem.get()?.clone();
        self.problem_was_taken = true;
        Some(problem)
    }

    /// Hands over without waiting. A record that is lost ends the journal, since all that
    /// follow rest on it.
    fn send(&mut self, entry: Written) {
        let Some(sender) = &self.sender else {
            return;
        };
        match sender.try_send(entry) {
            Ok(()) => {}
            Err(TrySendError::Full(_)) => {
                let problem = format!(
                    "The disk is too slow: {QUEUE} changes wait for it. The journal ends here; \
                     changes from now on are lost in a crash."
                );
                // where the writer has told of a problem already, that one holds
                let _ = self.told.problem.set(problem);
                self.sender = None;
            }
            Err(TrySendError::Disconnected(_)) => self.writer_failed(),
        }
    }

    /// The writer is gone, and has said why unless it panicked.
    fn writer_failed(&mut self) {
        let problem = "The writer of the journal has failed. It ends here; changes from now on are \
                       lost in a crash.";
        // a problem with the disk was told of before
        let _ = self.told.problem.set(problem.to_owned());
        self.sender = None;
    }
}

impl Drop for JournalFile {
    fn drop(&mut self) {
        self.sender = None;
        if let Some(writer) = self.writer.take() {
            // a writer that panicked has nothing left to write
            let _ = writer.join();
        }
    }
}

/// Waits until a new file would survive a power cut under its name: its folder is written too.
fn sync_folder_of(path: &Path) -> io::Result<()> {
    // elsewhere folders cannot be opened, and names are written with the file
    if cfg!(unix) {
        let folder = path.parent().filter(|folder| *folder != Path::new(""));
        File::open(folder.unwrap_or(Path::new(".")))?.sync_all()?;
    }
    Ok(())
}

/// Makes sure that no other session writes the file; the system lets go when a process ends.
pub(crate) fn lock(file: &File, path: &Path) -> Result<(), JournalError> {
    file.try_lock().map_err(|error| match error {
        std::fs::TryLockError::WouldBlock => JournalError::InUse(path.to_owned()),
        std::fs::TryLockError::Error(source) => JournalError::disk(path)(source),
    })
}

/// How a journal of a scan begins, and the checksum from which its records go on.
pub(crate) fn head(version: u32, dimensions: UVec3, hash: ScanHash) -> (Vec<u8>, u32) {
    let mut head = MAGIC.to_vec();
    head.extend(version.to_le_bytes());
    head.extend(dimensions.to_array().iter().flat_map(|n| n.to_le_bytes()));
    head.extend(hash.0);
    let checksum = crc32fast::hash(&head);
    head.extend(checksum.to_le_bytes());
    (head, checksum)
}

/// The checksum of a record after others.
pub(crate) fn checksum_after(before: u32, kind: u8, bytes: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new_with_initial(before);
    hasher.update(&[kind]);
    hasher.update(bytes);
    hasher.finalize()
}

/// The writing thread.
struct Writer<S> {
    storage: S,
    checksum: u32,
    scan: Intensities,
    told: Arc<Told>,
}

impl<S: Storage> Writer<S> {
    fn run(&mut self, entries: &Receiver<Written>) {
        if let Err(error) = self.write_all(entries) {
            let problem = format!(
                "The journal cannot be written ({error}). It ends here; changes from now on are \
                 lost in a crash."
            );
            // a full queue may have been told of before
            let _ = self.told.problem.set(problem);
        }
    }

    fn write_all(&mut self, entries: &Receiver<Written>) -> io::Result<()> {
        let mut unsynced_since = None;
        loop {
            match entries.recv_timeout(SYNC_EVERY) {
                Ok(entry) => {
                    self.write(encode(&entry, &self.scan))?;
                    unsynced_since.get_or_insert_with(Instant::now);
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return self.storage.sync(),
            }
            if unsynced_since.is_some_and(|since| since.elapsed() >= SYNC_EVERY) {
                self.storage.sync()?;
                unsynced_since = None;
            }
        }
    }

    fn write(&mut self, (kind, bytes): Record) -> io::Result<()> {
        let length = u32::try_from(bytes.len() + 1)
            .map_err(|_| io::Error::other("a change of more than 4 GiB"))?;
        self.checksum = checksum_after(self.checksum, kind, &bytes);
        let mut record = Vec::with_capacity(bytes.len() + 9);
        record.extend(length.to_le_bytes());
        record.extend(self.checksum.to_le_bytes());
        record.push(kind);
        record.extend(bytes);
        // one call, so that a crash in between leaves at most one record in part
        self.storage.write_all(&record)?;
        self.told
            .bytes
            .fetch_add(record.len() as u64, Ordering::Relaxed);
        Ok(())
    }
}
