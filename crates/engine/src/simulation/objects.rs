//! Segments as objects: in the hand, and parted.

use glam::{DAffine3, DVec3};
use palpate_haptics::scene::{MAX_OBJECTS, ObjectPose};
use palpate_tools::journal::Action;
use palpate_volume::edit::SegmentId;
use palpate_volume::segment::Segment;
use palpate_volume::voxels::VoxelsError;

use super::Simulation;
use crate::error::SessionError;
use crate::scene::{Properties, Step, TouchChange};
use crate::simulation::grip::Grip;
use crate::touch::CurrentPoses;

impl Simulation {
    /// Moves a segment; touch goes there smoothly. One step of undo, with all that it was dragged
    /// since its last move.
    ///
    /// # Errors
    /// Where the pose is no rigid motion, there is no such segment, or too many are moved.
    pub fn move_segment(&mut self, id: SegmentId, pose: DAffine3) -> Result<(), SessionError> {
        self.drag_segment(id, pose)?;
        self.dragged = None;
        Ok(())
    }

    /// Moves a segment a part of the way of a drag, which [`Self::move_segment`] ends; see there.
    ///
    /// # Errors
    /// See [`Self::move_segment`].
    pub fn drag_segment(&mut self, id: SegmentId, pose: DAffine3) -> Result<(), SessionError> {
        ObjectPose::new(self.voxels().grid_of(id), self.voxels().grid(), pose)?;
        self.let_go();
        if !self.scene.is_moved(id) {
            self.check_room_for_moved()?;
        }
        self.close_step();
        // whatever came in between ends a drag
        let goes_on = self.dragged == Some(id)
            && self.journal.newest().and_then(Step::moves) == Some(id)
            && !self.journal.can_redo();
        let inverse = self.perform_part(Step::Move { id, pose }, Action::Do, goes_on)?;
        if !goes_on {
            self.done(inverse);
        }
        self.dragged = Some(id);
        self.publish();
        Ok(())
    }

    /// Takes a segment in the hand, or lets go of the one that is: it follows the probe, and is
    /// no obstacle meanwhile. Where `collides` it stops at other obstacles.
    ///
    /// # Errors
    /// Where there is no such segment, or too many are moved.
    pub fn grab(&mut self, id: Option<SegmentId>, collides: bool) -> Result<(), SessionError> {
        self.close_step();
        self.let_go();
        let Some(id) = id else {
            return Ok(());
        };
        let segment = self.voxels().segment(id);
        let segment = segment.ok_or(VoxelsError::UnknownSegment(id.0))?.clone();
        if !self.scene.is_moved(id) {
            self.check_room_for_moved()?;
        }
        // from where it is by now, which is not always where it was to go
        let pose = self.current_pose(id).unwrap_or(DAffine3::IDENTITY);
        let grid = *segment.grid(self.voxels().grid());
        self.grip = Some(Grip::new(id, pose, collides.then_some((&segment, &grid))));
        let changed = self.scene.hold(Some(id));
        self.send_all(changed);
        self.publish();
        Ok(())
    }

    /// Turns the segment in the hand about the probe by a rotation vector [rad]; nothing where
    /// none is.
    pub fn turn_grabbed(&mut self, rotation: DVec3) {
        let status = *self.touch.status();
        if let Some(grip) = &mut self.grip {
            grip.turn(rotation, &status);
        }
    }

    /// Gives a segment the voxels behind a cut, and a new one, which looks and stands alike, those
    /// before it; one step of undo. Gives the new one's number.
    ///
    /// # Errors
    /// Where there is no such segment, it is locked, or there is no room for one more.
    pub fn part_segment(
        &mut self,
        id: SegmentId,
        (behind, before): (Segment, Segment),
    ) -> Result<SegmentId, SessionError> {
        self.check_unlocked(id)?;
        self.let_go();
        let properties = self.scene.properties_of(id);
        if self.scene.is_moved(id) {
            self.check_room_for_moved()?;
        }
        let new_id = self.free_id()?;
        let replaced = Step::Replace {
            id,
            segment: behind,
            range: None,
            made_by: properties.made_by,
        };
        let inserted = Step::Insert {
            id: new_id,
            segment: before,
            properties: Box::new(Properties {
                range: None,
                ..properties
            }),
        };
        self.change(Step::Several(vec![replaced, inserted]))?;
        // the new one feels alike
        self.publish_feel(new_id);
        Ok(new_id)
    }

    /// Where a segment stands by now; none where the scan has it.
    #[must_use]
    pub fn current_pose(&self, id: SegmentId) -> Option<DAffine3> {
        let asked = self.scene.properties_of(id).pose?;
        let by_servo = self.touch.poses();
        let followed = by_servo
            .iter()
            .flatten()
            .find(|(other, _)| *other == id.0 && self.scene.is_obstacle(id));
        Some(followed.map_or(asked, |(_, pose)| *pose))
    }

    /// Where all moved segments stand by now.
    pub(super) fn current_poses(&self) -> CurrentPoses {
        let mut poses = CurrentPoses::default();
        let moved = self
            .scene
            .segments()
            .filter_map(|(id, _, _)| Some((id.0, self.current_pose(id)?)));
        for (place, moved) in poses.iter_mut().zip(moved.take(MAX_OBJECTS)) {
            *place = Some(moved);
        }
        poses
    }

    /// Lets go of the segment in the hand: it is an obstacle again as soon as the probe is free.
    pub(super) fn let_go(&mut self) {
        if self.grip.take().is_some() {
            let changed = self.scene.hold(None);
            self.segments_version += 1;
            self.send_all(changed);
        }
    }

    /// Has the segment in the hand follow the probe.
    pub(super) fn advance_grip(&mut self) {
        let Some(mut grip) = self.grip.take() else {
            return;
        };
        if self.touch.is_pending(grip.id()) {
            // still an obstacle: as it goes, the probe comes up to the device
            grip.pause();
        } else {
            grip.follow(self.touch.status());
            if grip.advance(&self.scene) {
                self.move_held(&mut grip);
            }
        }
        self.grip = Some(grip);
    }

    fn move_held(&mut self, grip: &mut Grip) {
        let step = Step::Move {
            id: grip.id(),
            pose: grip.pose(),
        };
        // what touches nothing is told to nobody but the picture, which asks for poses
        let Ok((inverse, _)) = self.scene.perform(step) else {
            return;
        };
        let goes_on = grip.noted
            && self.journal.newest().and_then(Step::moves) == Some(grip.id())
            && !self.journal.can_redo();
        self.write_down(Action::Do, &inverse, goes_on);
        if !goes_on {
            grip.noted = true;
            self.segments_version += 1;
            self.done(inverse);
        }
    }

    pub(super) fn send_all(&mut self, segments: Vec<SegmentId>) {
        if !segments.is_empty() {
            let change = TouchChange::All(segments);
            self.send_change(&change);
        }
    }

    /// Refuses one moved segment more than can be touched. Undo and redo need no such question:
    /// where they lead there were no more.
    pub(super) fn check_room_for_moved(&self) -> Result<(), SessionError> {
        if self.scene.moved_count() >= MAX_OBJECTS {
            return Err(SessionError::TooManyMoved);
        }
        Ok(())
    }
}
