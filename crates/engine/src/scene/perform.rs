//! Performs steps on the scene; each gives its inverse and what touch must follow.

use glam::DAffine3;
use palpate_deform::material::MaterialLaw;
use palpate_haptics::scene::MAX_OBJECTS;
use palpate_volume::edit::{Edit, SegmentId};
use palpate_volume::segment::Segment;
use palpate_volume::voxels::VoxelsError;

use super::{Properties, Scene, Step, TouchChange};
use crate::touch::ThresholdRange;

impl Scene {
    /// Performs a step; gives its inverse and what touch must follow.
    ///
    /// # Errors
    /// Where it does not fit; nothing is changed then.
    pub fn perform(&mut self, step: Step) -> Result<(Step, TouchChange), VoxelsError> {
        match step {
            Step::Edit { edit, ranges } => self.edit(edit, ranges),
            Step::Replace {
                id,
                segment,
                range,
                made_by,
            } => self.replace(id, segment, (range, made_by)),
            Step::Insert {
                id,
                segment,
                properties,
            } => self.insert(id, segment, *properties),
            Step::Remove { id } => self.remove(id),
            Step::Move { id, pose } => self.move_to(id, pose),
            Step::Material { id, law } => self.make_of(id, law),
            Step::Model(choice) => {
                let before = std::mem::replace(&mut self.model, choice);
                Ok((Step::Model(before), TouchChange::Nothing))
            }
            Step::Several(steps) => self.several(steps),
        }
    }

    /// Performs steps in turn; where one does not fit, those before it are taken back.
    fn several(&mut self, steps: Vec<Step>) -> Result<(Step, TouchChange), VoxelsError> {
        let mut inverses = Vec::with_capacity(steps.len());
        let mut changed = Vec::new();
        for step in steps {
            match self.perform(step) {
                Ok((inverse, change)) => {
                    inverses.push(inverse);
                    changed.extend(change.segments());
                }
                Err(error) => {
                    for inverse in inverses.into_iter().rev() {
                        self.perform(inverse)?;
                    }
                    return Err(error);
                }
            }
        }
        inverses.reverse();
        let change = if changed.is_empty() {
            TouchChange::Nothing
        } else {
            TouchChange::All(changed)
        };
        Ok((Step::Several(inverses), change))
    }

    /// A segment that was moved once stays a body of its own, also where it is taken back, as
    /// long as there is room for it.
    fn move_to(
        &mut self,
        id: SegmentId,
        pose: DAffine3,
    ) -> Result<(Step, TouchChange), VoxelsError> {
        let properties = self
            .properties
            .get_mut(&id)
            .ok_or(VoxelsError::UnknownSegment(id.0))?;
        let before = properties.pose.replace(pose);
        let touchable = self.is_obstacle(id);
        if before.is_none() {
            self.make_room_for_moved(id);
        }
        let inverse = Step::Move {
            id,
            pose: before.unwrap_or(DAffine3::IDENTITY),
        };
        let change = match before {
            _ if !touchable => TouchChange::Nothing,
            None => TouchChange::FirstPose(id, pose),
            Some(_) => TouchChange::Pose(id, pose),
        };
        Ok((inverse, change))
    }

    /// Where one more segment is a body of its own than can be touched, makes those that were
    /// taken back to the scan parts of it again.
    fn make_room_for_moved(&mut self, newest: SegmentId) {
        let own = |properties: &&Properties| properties.pose.is_some();
        if self.properties.values().filter(own).count() <= MAX_OBJECTS {
            return;
        }
        for (id, properties) in &mut self.properties {
            let segment = self.voxels.segment(*id);
            let has_own = segment.is_some_and(|segment| segment.own_grid().is_some());
            if *id != newest && !has_own && properties.pose == Some(DAffine3::IDENTITY) {
                properties.pose = None;
            }
        }
    }

    fn edit(
        &mut self,
        edit: Edit,
        ranges: Vec<(SegmentId, Option<ThresholdRange>)>,
    ) -> Result<(Step, TouchChange), VoxelsError> {
        let edit = self.voxels.apply(edit)?;
        let ranges = ranges
            .into_iter()
            .map(|(id, range)| (id, self.exchange_range(id, range)))
            .collect();
        let change = self.bricks_to_touch(&edit);
        Ok((Step::Edit { edit, ranges }, change))
    }

    fn replace(
        &mut self,
        id: SegmentId,
        segment: Segment,
        (range, made_by): (Option<ThresholdRange>, Option<ThresholdRange>),
    ) -> Result<(Step, TouchChange), VoxelsError> {
        let own_grid = segment.own_grid().is_some();
        let segment = self.voxels.replace_segment(id, segment)?;
        let range = self.exchange_range(id, range);
        let properties = self.properties.entry(id).or_default();
        let made_by = std::mem::replace(&mut properties.made_by, made_by);
        if own_grid {
            properties.pose.get_or_insert(DAffine3::IDENTITY);
        }
        let change = self.all_to_touch(id);
        let inverse = Step::Replace {
            id,
            segment,
            range,
            made_by,
        };
        Ok((inverse, change))
    }

    fn insert(
        &mut self,
        id: SegmentId,
        segment: Segment,
        mut properties: Properties,
    ) -> Result<(Step, TouchChange), VoxelsError> {
        if segment.own_grid().is_some() {
            // no part of the scan: a body of its own from the start
            properties.pose.get_or_insert(DAffine3::IDENTITY);
        }
        let replaced = self.voxels.insert_segment(id, segment)?;
        assert!(replaced.is_none(), "segment number {} was in use", id.0);
        self.properties.insert(id, properties);
        self.make_room_for_moved(id);
        Ok((Step::Remove { id }, self.all_to_touch(id)))
    }

    fn remove(&mut self, id: SegmentId) -> Result<(Step, TouchChange), VoxelsError> {
        let segment = self.voxels.remove_segment(id)?;
        self.rigid.remove(&id);
        self.left.remove(&id);
        let change = self.all_to_touch(id);
        let properties = self.properties.remove(&id).unwrap_or_default();
        let inverse = Step::Insert {
            id,
            segment,
            properties: Box::new(properties),
        };
        Ok((inverse, change))
    }

    fn make_of(
        &mut self,
        id: SegmentId,
        law: Option<MaterialLaw>,
    ) -> Result<(Step, TouchChange), VoxelsError> {
        let properties = self
            .properties
            .get_mut(&id)
            .ok_or(VoxelsError::UnknownSegment(id.0))?;
        let law = std::mem::replace(&mut properties.law, law);
        Ok((Step::Material { id, law }, TouchChange::Nothing))
    }

    /// Takes the threshold that a segment is from now on, and gives that of before.
    pub fn exchange_range(
        &mut self,
        id: SegmentId,
        range: Option<ThresholdRange>,
    ) -> Option<ThresholdRange> {
        let properties = self.properties.get_mut(&id)?;
        std::mem::replace(&mut properties.range, range)
    }

    fn all_to_touch(&self, id: SegmentId) -> TouchChange {
        if self.is_obstacle(id) {
            TouchChange::All(vec![id])
        } else {
            TouchChange::Nothing
        }
    }

    fn bricks_to_touch(&self, edit: &Edit) -> TouchChange {
        let touched = || edit.segments.iter().filter(|(id, _)| self.is_obstacle(*id));
        let mut bricks: Vec<u32> = touched()
            .flat_map(|(_, swaps)| swaps.iter().map(|swap| swap.index))
            .collect();
        bricks.sort_unstable();
        bricks.dedup();
        if bricks.is_empty() {
            return TouchChange::Nothing;
        }
        TouchChange::Bricks(bricks, touched().map(|(id, _)| *id).collect())
    }
}
