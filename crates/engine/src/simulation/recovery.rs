//! The simulation's journal on disk, and how it goes on from one after a crash.
//!
//! Voxels and moves are written down, which changes are one step, and what else is known of each
//! segment. Names and looks are not; whoever keeps them beside the voxels can add notes.

use std::path::Path;

use glam::DAffine3;
use palpate_haptics::scene::{MAX_OBJECTS, ObjectPose};
use palpate_tools::journal::{
    Action, Entry, Facts, JournalFile, JournalReader, Recovery, ScanHash,
};
use palpate_volume::edit::SegmentId;
use palpate_volume::segment::Segment;
use palpate_volume::voxels::{Voxels, VoxelsError};

use super::Simulation;
use crate::error::SessionError;
use crate::notice::Notice;
use crate::scene::{Properties, Step, TouchChange};
use crate::servo::ServoCommand;
use crate::touch::TouchFeel;

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
        self.file = Some(JournalFile::create(path, hash, self.voxels_at_rest())?);
        let ids: Vec<_> = self.voxels().segments().map(|(id, _)| id).collect();
        for id in ids {
            self.write_facts(id);
        }
        Ok(())
    }

    /// Writes what is there now into a new file, as the head of a journal without steps; a journal
    /// that runs goes on. Waits until all of it is written.
    ///
    /// # Errors
    /// Where the file exists already, or the disk says no.
    pub fn keep_state(&mut self, path: &Path, hash: ScanHash) -> Result<(), SessionError> {
        self.end_stroke();
        self.close_step();
        let running = self.file.take();
        let written = self.begin_journal(path, hash);
        // what is closed is written
        self.file = running;
        written
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
        let followed = self.follow_all(path, hash);
        self.touch_all();
        let (found, notes) = followed?;
        self.file = Some(JournalFile::resume(path, &found, self.voxels())?);
        self.publish();
        Ok(Recovered {
            steps: found.steps + usize::from(found.step_is_open),
            ignored_bytes: found.ignored_bytes,
            notes,
        })
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
        self.close_step();
        self.file = None;
    }

    /// Writes down what was just performed, by its inverse; a move that `goes_on` belongs to the
    /// step before.
    pub(super) fn write_down(&mut self, action: Action, inverse: &Step, goes_on: bool) {
        if let Step::Several(inverses) = inverse {
            if let Some(file) = &mut self.file {
                file.together(inverse.leaves());
            }
            // inverses stand the other way round
            for inverse in inverses.iter().rev() {
                self.write_down(action, inverse, false);
            }
            return;
        }
        let Some(file) = &mut self.file else {
            return;
        };
        let voxels = self.unpressed.voxels(self.scene.voxels());
        let known_anew = match inverse {
            Step::Edit { edit, .. } => {
                file.edit(action, edit, voxels);
                // taken back, a segment may be a threshold again
                let ids = edit.segments.iter().map(|(id, _)| *id);
                ids.filter(|_| action != Action::Do).collect()
            }
            Step::Replace { id, .. } | Step::Remove { id } => {
                if let Some(segment) = voxels.segment(*id) {
                    file.put(action, *id, segment);
                }
                vec![*id]
            }
            Step::Insert { id, .. } => {
                file.remove(action, *id);
                Vec::new()
            }
            Step::Move { id, .. } => {
                let pose = self.scene.properties_of(*id).pose.unwrap_or_default();
                file.moved(action, *id, pose, goes_on);
                Vec::new()
            }
            // no journal tells of matter
            Step::Material { .. } | Step::Model(_) | Step::Several(_) => Vec::new(),
        };
        for id in known_anew {
            self.write_facts(id);
        }
    }

    /// Writes down what is known of a segment beside its voxels.
    pub(super) fn write_facts(&mut self, id: SegmentId) {
        let properties = self.scene.properties_of(id);
        if let Some(file) = &mut self.file {
            file.facts(id, facts_of(&properties));
        }
    }

    pub(super) fn report_journal(&mut self) {
        let problem = self.file.as_mut().and_then(JournalFile::take_problem);
        if let Some(problem) = problem {
            self.report(Notice::warning(problem));
        }
    }

    /// Follows a journal to its end; gives what was found, and the notes.
    fn follow_all(
        &mut self,
        path: &Path,
        hash: ScanHash,
    ) -> Result<(Recovery, Vec<Vec<u8>>), SessionError> {
        let mut reader = JournalReader::open(path, hash, self.voxels())?;
        let mut group = Group::default();
        let mut notes = Vec::new();
        while let Some(entry) = reader.next(self.voxels())? {
            self.follow(entry, &mut group, &mut notes)?;
        }
        self.end_group(&mut group)?;
        self.close_step();
        Ok((reader.recovery(), notes))
    }

    /// Does what an entry says.
    fn follow(
        &mut self,
        entry: Entry,
        group: &mut Group,
        notes: &mut Vec<Vec<u8>>,
    ) -> Result<(), SessionError> {
        let (action, step) = match entry {
            Entry::Note(bytes) => {
                notes.push(bytes);
                return Ok(());
            }
            Entry::StepEnd => {
                self.end_group(group)?;
                self.close_step();
                return Ok(());
            }
            Entry::Together(count) => {
                self.end_group(group)?;
                group.wanted = Some(count as usize);
                return Ok(());
            }
            Entry::Facts(id, facts) => return self.know(id, &facts),
            Entry::Edit(action, edit) => (action, Step::of_edit(edit)),
            Entry::Remove(action, id) => (action, Step::Remove { id }),
            Entry::Move {
                action,
                id,
                pose,
                goes_on,
            } => {
                self.check_moved(id, pose)?;
                if goes_on {
                    // the step before leads here now; its inverse stays the same
                    self.end_group(group)?;
                    self.perform(Step::Move { id, pose }, action)?;
                    return Ok(());
                }
                (action, Step::Move { id, pose })
            }
            // so that a threshold stays one: a journal of version 1 does not say what is
            Entry::Put(Action::Start, id, segment) if self.has_same_voxels(id, &segment) => {
                return Ok(());
            }
            Entry::Put(action, id, segment) => (action, self.put(id, segment)?),
        };
        self.follow_step(action, step, group)
    }

    /// Performs a step, and notes it for undo as it was noted then.
    fn follow_step(
        &mut self,
        action: Action,
        step: Step,
        group: &mut Group,
    ) -> Result<(), SessionError> {
        let is_edit = matches!(step, Step::Edit { .. });
        if group.action.is_some_and(|before| before != action) {
            self.end_group(group)?;
        }
        if !(is_edit && action == Action::Do) {
            self.close_step();
        }
        let inverse = self.perform(step, action)?;
        match action {
            Action::Start => {}
            // edits up to the end of the step are one stroke
            Action::Do if is_edit => self.stroke.note(inverse),
            Action::Do => {
                group.action = Some(action);
                group.inverses.push(inverse);
            }
            Action::Undo | Action::Redo => {
                group.action = Some(action);
                group.inverses.push(inverse);
                // version 1 does not say how many belong together, but does them all again
                let newest = match action {
                    Action::Undo => self.journal.newest(),
                    _ => self.journal.newest_undone(),
                };
                let wanted = newest.map_or(1, |step| step.leaves() as usize);
                if group.inverses.len() >= group.wanted.unwrap_or(wanted) {
                    self.end_group(group)?;
                }
            }
        }
        Ok(())
    }

    /// Makes one step of what belongs together; where some of it is missing, takes it back.
    fn end_group(&mut self, group: &mut Group) -> Result<(), SessionError> {
        let Group {
            wanted,
            action,
            mut inverses,
        } = std::mem::take(group);
        let Some(action) = action else {
            return Ok(());
        };
        if wanted.is_some_and(|wanted| inverses.len() < wanted) {
            for inverse in inverses.into_iter().rev() {
                self.perform(inverse, Action::Start)?;
            }
            return Ok(());
        }
        inverses.reverse();
        let inverse = match inverses.len() {
            1 => inverses.remove(0),
            _ => Step::Several(inverses),
        };
        let bytes = inverse.bytes();
        match action {
            Action::Start => {}
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
        Ok(())
    }

    /// The step that gives a segment these voxels.
    fn put(&self, id: SegmentId, segment: Segment) -> Result<Step, SessionError> {
        if self.voxels().segment(id).is_some() {
            return Ok(Step::Replace {
                id,
                segment,
                range: None,
                made_by: None,
            });
        }
        if let Some(grid) = segment.own_grid() {
            super::check_radius(self.settings.probe_radius, grid)?;
            ObjectPose::new(grid, self.voxels().grid(), DAffine3::IDENTITY)?;
            self.check_room_for_moved()?;
        }
        Ok(Step::Insert {
            id,
            segment,
            properties: Box::default(),
        })
    }

    /// Takes what a journal says of a segment beside its voxels.
    fn know(&mut self, id: SegmentId, facts: &Facts) -> Result<(), SessionError> {
        if self.voxels().segment(id).is_none() {
            return Err(VoxelsError::UnknownSegment(id.0).into());
        }
        if let Some(pose) = facts.pose {
            self.check_moved(id, pose)?;
        }
        let properties = Properties {
            // no journal tells of it
            law: self.scene.properties_of(id).law,
            ..properties_of(facts)
        };
        properties.feel.check()?;
        for (low, high) in [facts.range, facts.made_by].into_iter().flatten() {
            if low > high {
                return Err(SessionError::Range { low, high });
            }
        }
        self.scene.know(id, properties);
        self.segments_version += 1;
        Ok(())
    }

    /// Refuses a pose that no session has.
    fn check_moved(&self, id: SegmentId, pose: DAffine3) -> Result<(), SessionError> {
        ObjectPose::new(self.voxels().grid_of(id), self.voxels().grid(), pose)?;
        let stays = pose == DAffine3::IDENTITY || self.scene.is_moved(id);
        if !stays && self.scene.moved_count() >= MAX_OBJECTS {
            return Err(SessionError::TooManyMoved);
        }
        Ok(())
    }

    fn has_same_voxels(&self, id: SegmentId, other: &Segment) -> bool {
        self.voxels().segment(id).is_some_and(|segment| {
            let same_grid = segment.own_grid() == other.own_grid();
            same_grid && {
                let difference = segment.occupancy().difference(other.occupancy());
                difference.is_empty()
            }
        })
    }

    /// Tells touch of all that a journal may have changed.
    fn touch_all(&mut self) {
        let segments: Vec<_> = self
            .scene
            .segments()
            .map(|(id, _, properties)| (id, properties))
            .collect();
        let ids = segments.iter().map(|(id, _)| *id).collect();
        self.send_change(&TouchChange::All(ids));
        for (id, properties) in segments {
            self.publish_feel(id);
            if let Some(pose) = properties.pose.filter(|_| properties.touchable) {
                self.touch.send(ServoCommand::Pose(id, pose));
            }
        }
    }
}

/// Changes of a journal that belong together, as far as they were followed.
#[derive(Debug, Default)]
struct Group {
    /// How many there are to be; none where the end of the step says it.
    wanted: Option<usize>,
    action: Option<Action>,
    /// Their inverses, in the order of the changes.
    inverses: Vec<Step>,
}

fn facts_of(properties: &Properties) -> Facts {
    let TouchFeel {
        stiffness,
        friction_static,
        friction_kinetic,
    } = properties.feel;
    Facts {
        touchable: properties.touchable,
        range: properties.range,
        made_by: properties.made_by,
        feel: [stiffness, friction_static, friction_kinetic],
        pose: properties.pose,
        locked: properties.locked,
    }
}

fn properties_of(facts: &Facts) -> Properties {
    let [stiffness, friction_static, friction_kinetic] = facts.feel;
    Properties {
        touchable: facts.touchable,
        range: facts.range,
        made_by: facts.made_by,
        feel: TouchFeel {
            stiffness,
            friction_static,
            friction_kinetic,
        },
        pose: facts.pose,
        law: None,
        locked: facts.locked,
    }
}
