//! A small session: voxels, tools, undo and a journal, as the engine has them.

use glam::DVec3;
use palpate_tools::factory::{ToolKind, ToolSettings};
use palpate_tools::journal::{Action, JournalFile};
use palpate_tools::stroke::{Stroke, bytes_of};
use palpate_tools::tool::ToolInput;
use palpate_tools::undo::UndoJournal;
use palpate_volume::edit::{Edit, SegmentId};
use palpate_volume::segment::Segment;
use palpate_volume::voxels::Voxels;

use super::{Random, free_move};

/// A step, or the inverse of one.
#[derive(Debug)]
pub enum Change {
    Edit(Edit),
    Put(SegmentId, Segment),
    Remove(SegmentId),
}

/// Voxels that tools change.
#[derive(Debug)]
pub struct Session {
    pub voxels: Voxels,
    pub undo: UndoJournal<Change>,
    pub file: Option<JournalFile>,
}

impl Session {
    pub fn new(voxels: Voxels, file: Option<JournalFile>) -> Self {
        Self {
            voxels,
            undo: UndoJournal::default(),
            file,
        }
    }

    /// Performs a change, notes it, and gives its inverse.
    fn perform(&mut self, action: Action, change: Change) -> Change {
        match change {
            Change::Edit(edit) => {
                let inverse = self.voxels.apply(edit).expect("it fits");
                if let Some(file) = &mut self.file {
                    file.edit(action, &inverse, &self.voxels);
                }
                Change::Edit(inverse)
            }
            Change::Put(id, segment) => {
                if let Some(file) = &mut self.file {
                    file.put(action, id, &segment);
                }
                let old = self.voxels.insert_segment(id, segment).expect("its grid");
                old.map_or(Change::Remove(id), |old| Change::Put(id, old))
            }
            Change::Remove(id) => {
                if let Some(file) = &mut self.file {
                    file.remove(action, id);
                }
                let old = self.voxels.remove_segment(id).expect("it exists");
                Change::Put(id, old)
            }
        }
    }

    fn done(&mut self, inverse: Change) {
        let bytes = match &inverse {
            Change::Edit(edit) => bytes_of(edit),
            Change::Put(_, segment) => segment.memory_bytes(),
            Change::Remove(_) => 0,
        };
        self.undo.done(inverse, bytes);
        if let Some(file) = &mut self.file {
            file.end_step();
        }
    }

    pub fn change(&mut self, change: Change) {
        let inverse = self.perform(Action::Do, change);
        self.done(inverse);
    }

    /// A stroke over some random points; false where it changed nothing.
    pub fn random_stroke(&mut self, random: &mut Random) -> bool {
        let grid = *self.voxels.grid();
        let kind = ToolKind::ALL[random.integer(0, 3) as usize];
        let ids: Vec<_> = self.voxels.segments().map(|(id, _)| id).collect();
        let chosen = ids.iter().copied().filter(|_| random.chance(0.7)).collect();
        let settings = ToolSettings::new(kind, random.number(0.5, 4.0), chosen);
        let Ok(mut tool) = settings.build(&grid) else {
            return false;
        };
        let mut stroke = Stroke::default();
        let mut from = random.point(&grid, 1.0);
        for _ in 0..random.integer(1, 8) {
            let to = from.lerp(random.point(&grid, 1.0), 0.3);
            let input = ToolInput {
                force: 90.0,
                contact_normal: DVec3::new(0.1, -0.2, 1.0),
                dt: 0.1,
                body_radius: random.chance(0.5).then_some(0.5),
                ..free_move(from, to)
            };
            if let Some(edit) = tool.advance(&self.voxels, &input).expect("they exist") {
                match self.perform(Action::Do, Change::Edit(edit)) {
                    Change::Edit(inverse) => stroke.add(inverse),
                    other => panic!("{other:?} undoes an edit"),
                }
            }
            from = to;
        }
        tool.release();
        let changed = !stroke.is_empty();
        if changed {
            self.done(Change::Edit(stroke.into_inverse()));
        }
        changed
    }

    pub fn undo(&mut self) -> bool {
        let Some(step) = self.undo.pop_undo() else {
            return false;
        };
        let inverse = self.perform(Action::Undo, step);
        self.undo.undone(inverse, 100);
        true
    }

    pub fn redo(&mut self) -> bool {
        let Some(step) = self.undo.pop_redo() else {
            return false;
        };
        let inverse = self.perform(Action::Redo, step);
        self.undo.redone(inverse, 100);
        true
    }

    /// Anything that a person may do; false where nothing changed.
    pub fn random_step(&mut self, random: &mut Random) -> bool {
        match random.integer(0, 12) {
            0..6 => self.random_stroke(random),
            6..8 => self.undo(),
            8..10 => self.redo(),
            10 => {
                let id = SegmentId(random.integer(1, 5) as u8);
                let dimensions = self.voxels.grid().dimensions();
                let modulus = random.integer(1, 6) as i32;
                let solid = |voxel: glam::IVec3| (voxel.x + 2 * voxel.z) % modulus == 0;
                self.change(Change::Put(id, Segment::from_fn(dimensions, solid)));
                true
            }
            _ => {
                let id = SegmentId(random.integer(1, 5) as u8);
                let exists = self.voxels.segment(id).is_some();
                if exists {
                    self.change(Change::Remove(id));
                }
                exists
            }
        }
    }
}
