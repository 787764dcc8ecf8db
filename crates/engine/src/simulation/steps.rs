//! Steps of the simulation: performed, written down, taken back and done again.

use palpate_tools::journal::Action;
use palpate_volume::edit::{Edit, SegmentId};
use palpate_volume::voxels::VoxelsError;

use super::Simulation;
use crate::error::SessionError;
use crate::picture::SceneUpdate;
use crate::scene::Step;

impl Simulation {
    /// Takes the newest change back; false where there is none.
    ///
    /// # Errors
    /// Never, unless the journal is wrong.
    pub fn undo(&mut self) -> Result<bool, SessionError> {
        self.let_go();
        self.close_step();
        self.release_tissue();
        self.forget_deformation();
        let Some(step) = self.journal.pop_undo() else {
            return Ok(false);
        };
        let inverse = self.perform(step, Action::Undo)?;
        let bytes = inverse.bytes();
        self.journal.undone(inverse, bytes);
        self.publish();
        Ok(true)
    }

    /// Does the last undone change again; false where there is none.
    ///
    /// # Errors
    /// Never, unless the journal is wrong.
    pub fn redo(&mut self) -> Result<bool, SessionError> {
        self.let_go();
        self.close_step();
        self.release_tissue();
        self.forget_deformation();
        let Some(step) = self.journal.pop_redo() else {
            return Ok(false);
        };
        let inverse = self.perform(step, Action::Redo)?;
        let bytes = inverse.bytes();
        self.journal.redone(inverse, bytes);
        self.publish();
        Ok(true)
    }

    pub(super) fn change(&mut self, step: Step) -> Result<(), SessionError> {
        self.close_step();
        self.release_tissue();
        let inverse = self.perform(step, Action::Do)?;
        self.done(inverse);
        self.publish();
        Ok(())
    }

    pub(super) fn perform(&mut self, step: Step, action: Action) -> Result<Step, SessionError> {
        self.perform_part(step, action, false)
    }

    /// Performs a step, or a part of one that `goes_on` with the step before.
    pub(super) fn perform_part(
        &mut self,
        step: Step,
        action: Action,
        goes_on: bool,
    ) -> Result<Step, SessionError> {
        let (inverse, updates) = self.perform_unpublished(step, action, goes_on)?;
        // a model moves nothing that is rigid, and what it does is performed elsewhere
        self.follow_shared_regions();
        for updates in updates {
            self.publish_update(updates);
        }
        Ok(inverse)
    }

    /// Performs a step, or a part of one that `goes_on` with the step before, and gives its inverse, as
    /// soft tissue is at rest, and what the picture is to be told of it.
    pub(super) fn perform_unpublished(
        &mut self,
        step: Step,
        action: Action,
        goes_on: bool,
    ) -> Result<(Step, Vec<SceneUpdate>), SessionError> {
        let before = match &step {
            Step::Edit { edit, .. } => self.unpressed.before(edit.dirty, self.scene.voxels()),
            _ => None,
        };
        let (inverse, updates) = self.perform_unnoted(step)?;
        let inverse = match (before, inverse) {
            (Some(before), Step::Edit { edit, ranges }) => {
                let at_rest = self.unpressed.follow_edit(&before, self.scene.voxels());
                let edit = at_rest.unwrap_or_else(|| Edit::empty(edit.kind));
                Step::Edit { edit, ranges }
            }
            (_, inverse) => inverse,
        };
        self.write_down(action, &inverse, goes_on);
        Ok((inverse, updates))
    }

    /// Performs a step that is not written down, and gives its inverse and what the picture is to be
    /// told of it.
    pub(super) fn perform_unnoted(
        &mut self,
        step: Step,
    ) -> Result<(Step, Vec<SceneUpdate>), SessionError> {
        let (inverse, change) = self.scene.perform(step)?;
        self.send_change(&change);
        self.follow_deformable_segments(&inverse);
        self.note_shared(&inverse);
        self.segments_version += 1;
        let updates = SceneUpdate::of(&inverse, &self.scene, &self.labelled);
        let anew = updates
            .iter()
            .filter(|updates| updates.needs_labels())
            .count();
        self.voxels_version += anew as u64;
        Ok((inverse, updates))
    }

    /// Notes the inverse of a whole step.
    pub(super) fn done(&mut self, inverse: Step) {
        let bytes = inverse.bytes();
        self.journal.done(inverse, bytes);
        if let Some(file) = &mut self.file {
            file.end_step();
        }
    }

    /// The lowest number that no segment has and no undo or redo would bring back.
    pub(super) fn free_id(&self) -> Result<SegmentId, VoxelsError> {
        let returns = |id: SegmentId| self.journal.steps().any(|step| step.needs(id));
        let is_new = |id: &SegmentId| self.voxels().segment(*id).is_none();
        let ids = || (1..=u8::MAX).map(SegmentId).filter(is_new);
        ids()
            .find(|id| !returns(*id))
            .ok_or(VoxelsError::TooManySegments)
    }
}
