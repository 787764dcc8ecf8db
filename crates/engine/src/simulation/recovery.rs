//! The simulation's journal on disk, and how it goes on from one after a crash.
//!
//! Voxels are written down, and which changes are one step. Moves, names and how segments feel
//! are not; whoever keeps them beside the voxels can add notes.

use std::path::Path;

use palpate_tools::journal_entry::{Action, Entry, ScanHash};
use palpate_tools::journal_file::JournalFile;
use palpate_tools::journal_reader::JournalReader;
use palpate_volume::edit::SegmentId;
use palpate_volume::segment::Segment;
use palpate_volume::voxels::Voxels;

use super::Simulation;
use crate::error::SessionError;
use crate::frame::Notice;
use crate::scene::{Properties, Step};

/// What came back from a journal.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Recovered {
    /// Steps that were done, undone or done again.
    pub steps: usize,
    /// Bytes at the end that were not whole.
    pub ignored_bytes: u64,
    /// What was noted beside the voxels, in turn.
    pub notes: Vec<Vec<u8>>,
}

/// What a journal holds, without following it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Kept {
    /// Steps that were done, undone or done again.
    pub steps: usize,
    /// Bytes at the end that are not whole.
    pub ignored_bytes: u64,
}

impl Kept {
    /// Looks into a file; none where there is none.
    ///
    /// # Errors
    /// Where it is no journal of this scan, or another session writes it.
    pub fn at(path: &Path, hash: ScanHash, voxels: &Voxels) -> Result<Option<Self>, SessionError> {
        if !path.exists() {
            return Ok(None);
        }
        let reader = JournalReader::open(path, hash, voxels)?;
        reader.check_unused()?;
        let found = reader.skim()?;
        Ok(Some(Self {
            steps: found.steps + usize::from(found.step_is_open),
            ignored_bytes: found.ignored_bytes,
        }))
    }
}

impl Simulation {
    /// Begins a journal in a new file; what is there now goes into it first. Waits for the disk
    /// once, to have the file's head there.
    ///
    /// # Errors
    /// Where the file exists already, or the disk says no.
    pub fn begin_journal(&mut self, path: &Path, hash: ScanHash) -> Result<(), SessionError> {
        self.end_stroke();
        self.file = Some(JournalFile::create(path, hash, self.voxels())?);
        Ok(())
    }

    /// Does again what a journal of this scan says, step by step, so that undo goes back beyond
    /// the crash, and goes on with that journal. Segments that it does not know stay. To be
    /// called before anything else is changed; takes as long as the journal is.
    ///
    /// # Errors
    /// Where the file is no journal of this scan, or a record cannot be; what came before it
    /// is there then, and the journal does not go on.
    pub fn recover_journal(
        &mut self,
        path: &Path,
        hash: ScanHash,
    ) -> Result<Recovered, SessionError> {
        self.end_stroke();
        self.file = None;
        let mut recovered = Recovered::default();
        let mut reader = JournalReader::open(path, hash, self.voxels())?;
        while let Some(entry) = reader.next(self.voxels())? {
            recovered.notes.extend(self.follow(entry)?);
        }
        self.close_step();
        let found = reader.recovery();
        recovered.steps = found.steps + usize::from(found.step_is_open);
        recovered.ignored_bytes = found.ignored_bytes;
        self.file = Some(JournalFile::resume(path, &found, self.voxels())?);
        self.publish();
        Ok(recovered)
    }

    /// Keeps bytes beside the voxels, where there is a journal.
    pub fn note_in_journal(&mut self, bytes: Vec<u8>) {
        if let Some(file) = &mut self.file {
            file.note(bytes);
        }
    }

    /// Writes what waits and closes the journal.
    pub fn end_journal(&mut self) {
        self.end_stroke();
        self.file = None;
    }

    /// Writes down what was just performed, by its inverse.
    pub(super) fn write_down(&mut self, action: Action, inverse: &Step) {
        let Some(file) = &mut self.file else {
            return;
        };
        let voxels = self.scene.voxels();
        match inverse {
            Step::Edit { edit, .. } => file.edit(action, edit, voxels),
            Step::Replace { id, .. } | Step::Remove { id } => {
                if let Some(segment) = voxels.segment(*id) {
                    file.put(action, *id, segment);
                }
            }
            Step::Insert { id, .. } => file.remove(action, *id),
            Step::Move { .. } => {}
        }
    }

    pub(super) fn tell_of_journal(&mut self) {
        let problem = self.file.as_mut().and_then(JournalFile::take_problem);
        if let Some(problem) = problem {
            self.tell(Notice::warning(problem));
        }
    }

    fn has_same_voxels(&self, id: SegmentId, other: &Segment) -> bool {
        self.voxels().segment(id).is_some_and(|segment| {
            let difference = segment.occupancy().difference(other.occupancy());
            difference.is_empty()
        })
    }

    /// Does what an entry says; gives a note.
    fn follow(&mut self, entry: Entry) -> Result<Option<Vec<u8>>, SessionError> {
        let (action, step) = match entry {
            Entry::Note(bytes) => return Ok(Some(bytes)),
            Entry::StepEnd => {
                self.close_step();
                return Ok(None);
            }
            Entry::Edit(action, edit) => (action, Step::of_edit(edit)),
            Entry::Remove(action, id) => (action, Step::Remove { id }),
            // so that a threshold stays one: a journal does not say what is
            Entry::Put(Action::Start, id, segment) if self.has_same_voxels(id, &segment) => {
                return Ok(None);
            }
            Entry::Put(action, id, segment) => {
                let step = if self.voxels().segment(id).is_some() {
                    Step::Replace {
                        id,
                        segment,
                        range: None,
                        made_by: None,
                    }
                } else {
                    Step::Insert {
                        id,
                        segment,
                        properties: Properties::default(),
                    }
                };
                (action, step)
            }
        };
        let is_edit = matches!(step, Step::Edit { .. });
        if !(is_edit && action == Action::Do) {
            self.close_step();
        }
        let inverse = self.perform(step, action)?;
        let bytes = inverse.bytes();
        match action {
            Action::Start => {}
            // edits up to the end of the step are one stroke
            Action::Do if is_edit => self.stroke.note(inverse),
            Action::Do => self.done(inverse),
            Action::Undo => {
                self.journal.pop_undo();
                self.journal.undone(inverse, bytes);
            }
            Action::Redo => {
                self.journal.pop_redo();
                self.journal.redone(inverse, bytes);
            }
        }
        Ok(None)
    }
}
