//! Segments of the simulation: added, changed, removed, and how they are touched and shown.

use palpate_haptics::scene::ObjectPose;
use palpate_tools::journal::Action;
use palpate_volume::edit::{Edit, SegmentId};
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::VoxelsError;

use glam::DAffine3;

use super::Simulation;
use crate::error::SessionError;
use crate::picture::SceneUpdate;
use crate::scene::{Properties, Step, SurfaceOptions};
use crate::servo::ServoCommand;
use crate::touch::{ThresholdRange, TouchFeel, check_radius};

impl Simulation {
    /// Adds a segment; an undoable one is taken away again by undo.
    ///
    /// # Errors
    /// Where it belongs to another grid, or there are 255, or it has a pose that
    /// [`Self::move_segment`] would refuse.
    pub fn add_segment(
        &mut self,
        segment: Segment,
        properties: Properties,
        undoable: bool,
    ) -> Result<SegmentId, SessionError> {
        self.close_step();
        self.release_tissue();
        let own_grid = segment.own_grid();
        if let Some(grid) = own_grid {
            check_radius(self.settings.probe_radius, grid)?;
        }
        if properties.pose.is_some() || own_grid.is_some() {
            let pose = properties.pose.unwrap_or(DAffine3::IDENTITY);
            ObjectPose::new(
                segment.grid(self.voxels().grid()),
                self.voxels().grid(),
                pose,
            )?;
            self.check_room_for_moved()?;
        }
        let id = self.free_id()?;
        let step = Step::Insert {
            id,
            segment,
            properties: Box::new(properties),
        };
        let action = if undoable { Action::Do } else { Action::Start };
        let inverse = self.perform(step, action)?;
        // its number may have been another one's
        self.publish_feel(id);
        if undoable {
            self.done(inverse);
        }
        self.publish();
        Ok(id)
    }

    /// Gives a segment other voxels.
    ///
    /// # Errors
    /// Where there is no such segment, it is locked, or the voxels belong to another grid.
    pub fn replace_segment(
        &mut self,
        id: SegmentId,
        segment: Segment,
        range: Option<ThresholdRange>,
    ) -> Result<(), SessionError> {
        if segment.own_grid() != self.voxels().segment(id).and_then(Segment::own_grid) {
            return Err(SessionError::OtherGrid(id.0));
        }
        self.check_unlocked(id)?;
        self.change(Step::Replace {
            id,
            segment,
            range,
            made_by: range,
        })
    }

    /// Removes a segment.
    ///
    /// # Errors
    /// Where there is no such segment, or it is locked.
    pub fn remove_segment(&mut self, id: SegmentId) -> Result<(), SessionError> {
        self.check_unlocked(id)?;
        self.let_go();
        self.change(Step::Remove { id })
    }

    /// Makes a segment an obstacle, or no obstacle. This changes no voxel and is not undone.
    ///
    /// # Errors
    /// Where there is no such segment.
    pub fn set_touchable(&mut self, id: SegmentId, touchable: bool) -> Result<(), SessionError> {
        self.set_all_touchable(&[(id, touchable)])
    }

    /// Makes segments obstacles, or no obstacles, all in one change of touch: one alone takes as
    /// long as many.
    ///
    /// # Errors
    /// Where there is no such segment: then none is changed.
    pub fn set_all_touchable(&mut self, wanted: &[(SegmentId, bool)]) -> Result<(), SessionError> {
        for &(id, _) in wanted {
            if self.voxels().segment(id).is_none() {
                return Err(VoxelsError::UnknownSegment(id.0).into());
            }
        }
        let mut changed = Vec::new();
        for &(id, touchable) in wanted {
            if self.scene.set_touchable(id, touchable)? {
                changed.push(id);
            }
        }
        if changed.is_empty() {
            return Ok(());
        }
        self.send_all(changed.clone());
        for id in changed {
            self.write_facts(id);
        }
        self.publish();
        Ok(())
    }

    /// Locks the voxels of a segment, or lets them be changed; a stroke that is on ends. Undo and
    /// redo still reach what was done before. This changes no voxel and is not undone.
    ///
    /// # Errors
    /// Where there is no such segment.
    pub fn set_locked(&mut self, id: SegmentId, locked: bool) -> Result<(), SessionError> {
        if self.scene.set_locked(id, locked)? {
            self.end_stroke();
            // what is locked is rigid
            self.deformation.forget_displacements();
            self.segments_version += 1;
            self.write_facts(id);
            self.publish();
        }
        Ok(())
    }

    /// Refuses a change of what is locked.
    pub(super) fn check_unlocked(&self, id: SegmentId) -> Result<(), SessionError> {
        let locked = self.scene.properties_of(id).locked;
        (!locked).then_some(()).ok_or(SessionError::Locked(id.0))
    }

    /// Changes how the surface of a segment feels. This changes no voxel and is not undone.
    ///
    /// # Errors
    /// Where a value is out of range, or there is no such segment.
    pub fn set_feel(&mut self, id: SegmentId, feel: TouchFeel) -> Result<(), SessionError> {
        feel.check()?;
        self.scene.set_feel(id, feel)?;
        self.segments_version += 1;
        self.publish_feel(id);
        self.write_facts(id);
        self.publish();
        Ok(())
    }

    /// Tells touch how the surface of a segment feels.
    pub(super) fn publish_feel(&mut self, id: SegmentId) {
        let felt = self.scene.properties_of(id).felt();
        self.touch.send(ServoCommand::Feel(id, felt));
    }

    /// Shows a segment as a surface, or as none; this changes no voxel and is not undone.
    ///
    /// # Errors
    /// Where the settings make no surface, or there is no such segment.
    pub fn show_surface(
        &mut self,
        id: SegmentId,
        options: Option<SurfaceOptions>,
    ) -> Result<(), SessionError> {
        if let Some(options) = &options {
            options.settings.check()?;
        }
        let voxels = self.voxels_of(id)?;
        let shown = options.map(|options| (options, voxels));
        self.publish_update(SceneUpdate::Show(id, shown));
        Ok(())
    }

    /// Names the segments that the picture shows by their labels: edits tell of these.
    pub fn set_labelled(&mut self, labelled: Vec<SegmentId>) {
        self.labelled = labelled;
    }

    /// Makes all voxels of a box solid or free in one segment, and in that one only.
    ///
    /// # Errors
    /// Where there is no such segment.
    pub fn fill_box(
        &mut self,
        id: SegmentId,
        region: &VoxelBox,
        solid: bool,
    ) -> Result<(), SessionError> {
        let edit = self.voxels_at_rest().label_edit(id, region, |_, _| solid)?;
        self.apply(edit)
    }

    /// Applies an edit that takes matter away from the scan; segments that were moved keep theirs.
    ///
    /// # Errors
    /// Where it does not fit, or changes a locked segment.
    pub fn remove_matter(&mut self, mut edit: Edit) -> Result<(), SessionError> {
        edit.segments.retain(|(id, _)| !self.scene.is_moved(*id));
        self.apply(edit)
    }

    /// Applies an edit that was built from the present voxels.
    ///
    /// # Errors
    /// Where it does not fit, or changes a locked segment.
    pub fn apply(&mut self, edit: Edit) -> Result<(), SessionError> {
        // what is as wanted already leaves nothing to take back
        if edit.is_empty() {
            return Ok(());
        }
        for (id, _) in &edit.segments {
            self.check_unlocked(*id)?;
        }
        self.change(Step::of_edit(edit))
    }
}
