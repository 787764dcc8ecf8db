//! The segments of a session: made, changed, moved, taken back. Points in scene mm (LPS).

use glam::{DAffine3, IVec3};
use palpate_volume::edit::SegmentId;
use palpate_volume::segment::Segment;
use palpate_volume::voxels::{Voxels, VoxelsError};

use super::Session;
use crate::error::SessionError;
use crate::scene::Properties;
use crate::simulation::{SegmentState, Simulation, checked_box};
use crate::touch::{ThresholdRange, TouchFeel};

/// Edits of more voxels than this are built outside the simulation thread.
const SMALL_EDIT: u64 = 1 << 20;

impl Session {
    /// Adds a segment; undo takes it away again where `undoable`.
    ///
    /// # Errors
    /// Where it belongs to another grid, there are 255, or the session has ended.
    pub fn add_segment(
        &self,
        segment: Segment,
        properties: Properties,
        undoable: bool,
    ) -> Result<SegmentId, SessionError> {
        self.ask(move |simulation| simulation.add_segment(segment, properties, undoable))?
    }

    /// Gives a segment other voxels, which are the threshold `range` where there is one.
    ///
    /// # Errors
    /// Where there is no such segment, the voxels belong to another grid, or the session has
    /// ended.
    pub fn replace_segment(
        &self,
        id: SegmentId,
        segment: Segment,
        range: Option<ThresholdRange>,
    ) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.replace_segment(id, segment, range))?
    }

    /// Removes a segment.
    ///
    /// # Errors
    /// Where there is no such segment or the session has ended.
    pub fn remove_segment(&self, id: SegmentId) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.remove_segment(id))?
    }

    /// Makes a segment an obstacle, or no obstacle.
    ///
    /// # Errors
    /// Where there is no such segment or the session has ended.
    pub fn set_touchable(&self, id: SegmentId, touchable: bool) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.set_touchable(id, touchable))?
    }

    /// Makes segments obstacles, or no obstacles, all at once.
    ///
    /// # Errors
    /// Where there is no such segment, and then none is changed; or the session has ended.
    pub fn set_all_touchable(&self, wanted: Vec<(SegmentId, bool)>) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.set_all_touchable(&wanted))?
    }

    /// Moves a segment to a pose [mm, from the scan to the scene]; touch goes there smoothly, and
    /// stops where the probe is pinched.
    ///
    /// # Errors
    /// Where the pose is no rigid motion, there is no such segment, too many are moved, or the
    /// session has ended.
    pub fn move_segment(&self, id: SegmentId, pose: DAffine3) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.move_segment(id, pose))?
    }

    /// Moves a segment a part of the way of a drag, which [`Self::move_segment`] ends: all of it is
    /// one step of undo.
    ///
    /// # Errors
    /// See [`Self::move_segment`].
    pub fn drag_segment(&self, id: SegmentId, pose: DAffine3) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.drag_segment(id, pose))?
    }

    /// Locks the voxels of a segment, or lets them be changed: locked, no tool, threshold, shape or
    /// soft tissue changes them, and it is not removed.
    ///
    /// # Errors
    /// Where there is no such segment or the session has ended.
    pub fn set_locked(&self, id: SegmentId, locked: bool) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.set_locked(id, locked))?
    }

    /// Changes how the surface of a segment feels.
    ///
    /// # Errors
    /// Where a value is out of range, there is no such segment, or the session has ended.
    pub fn set_feel(&self, id: SegmentId, feel: TouchFeel) -> Result<(), SessionError> {
        self.ask(move |simulation| simulation.set_feel(id, feel))?
    }

    /// Makes a segment of all voxels with low <= value <= high, or gives segment `id` these
    /// voxels; gives its number.
    ///
    /// # Errors
    /// Where the range is none, there is no such segment, there are 255, or the session has
    /// ended.
    pub fn threshold(
        &self,
        id: Option<SegmentId>,
        range: ThresholdRange,
    ) -> Result<SegmentId, SessionError> {
        let (low, high) = range;
        if !(low.is_finite() && high.is_finite() && low <= high) {
            return Err(SessionError::Range { low, high });
        }
        let build = move |voxels: &Voxels| Ok(voxels.threshold(low, high));
        self.build_and_commit(build, move |simulation, segment| match id {
            Some(id) => simulation
                .replace_segment(id, segment, Some(range))
                .map(|()| id),
            None => {
                let properties = Properties::of_threshold(true, Some(range));
                simulation.add_segment(segment, properties, true)
            }
        })
    }

    /// Makes all voxels from `low` up to, but without, `high` solid or free in one segment.
    ///
    /// # Errors
    /// Where there is no such segment, the box holds no voxel of the scan, or the session has
    /// ended.
    pub fn fill_box(
        &self,
        id: SegmentId,
        low: IVec3,
        high: IVec3,
        solid: bool,
    ) -> Result<(), SessionError> {
        let grid = self.ask(move |simulation| *simulation.voxels().grid_of(id))?;
        let region = checked_box(low, high, &grid)?;
        if region.voxel_count() <= SMALL_EDIT {
            return self.ask(move |simulation| simulation.fill_box(id, &region, solid))?;
        }
        let build = move |voxels: &Voxels| Ok(voxels.label_edit(id, &region, |_, _| solid)?);
        self.build_and_commit(build, Simulation::apply)
    }

    /// Takes matter away: the voxels of a mask get one stored value, and are in no segment any more that stands where the
    /// scan has it.
    ///
    /// # Errors
    /// Where the mask is of another grid, a locked segment is in it, or the session has ended.
    pub fn remove_matter(&self, mask: Segment, stored: i16) -> Result<(), SessionError> {
        let build = move |voxels: &Voxels| Ok(voxels.removal(&mask, stored)?);
        self.build_and_commit(build, Simulation::remove_matter)
    }

    /// The voxels that a range of values makes of the scan, as edits have left it; see [`Voxels::as_edited`].
    ///
    /// # Errors
    /// Where they are of another grid, or the session has ended.
    pub fn as_edited(
        &self,
        made: &Segment,
        range: ThresholdRange,
    ) -> Result<Segment, SessionError> {
        Ok(self.voxels_at_rest()?.as_edited(made, range.0, range.1)?)
    }

    /// Takes the newest change back; false where there is none.
    ///
    /// # Errors
    /// Where the session has ended.
    pub fn undo(&self) -> Result<bool, SessionError> {
        self.ask(Simulation::undo)?
    }

    /// Does the last undone change again; false where there is none.
    ///
    /// # Errors
    /// Where the session has ended.
    pub fn redo(&self) -> Result<bool, SessionError> {
        self.ask(Simulation::redo)?
    }

    /// The voxels of a segment, soft tissue at rest.
    ///
    /// # Errors
    /// Where there is no such segment or the session has ended.
    pub fn segment(&self, id: SegmentId) -> Result<Segment, SessionError> {
        self.ask(move |simulation| {
            let segment = simulation.voxels_at_rest().segment(id).cloned();
            segment.ok_or(VoxelsError::UnknownSegment(id.0).into())
        })?
    }

    /// All segments, by rising number.
    ///
    /// # Errors
    /// Where the session has ended.
    pub fn segments(&self) -> Result<Vec<SegmentState>, SessionError> {
        self.ask(|simulation| simulation.segments())
    }
}
