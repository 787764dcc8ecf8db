//! The true state of a session: voxels and what is known of each segment beside its voxels.
//!
//! Every change is a step whose performance gives the inverse step, so that undo and redo go
//! the same way as the change itself.

use std::collections::BTreeMap;

use crate::feel::{Feel, Feels};
use crate::touchable::Part;
use glam::DAffine3;
use palpate_tools::stroke::bytes_of;
use palpate_volume::bits::Bits;
use palpate_volume::edit::{Edit, SegmentId};
use palpate_volume::segment::Segment;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::{Voxels, VoxelsError};

/// Threshold that a segment is, in physical units: low and high, both included.
pub type ThresholdRange = (f64, f64);

/// What is known of a segment beside its voxels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Properties {
    /// Whether it is an obstacle.
    pub touchable: bool,
    /// The threshold that it is; none once its voxels come from elsewhere.
    pub range: Option<ThresholdRange>,
    /// How its surface feels.
    pub feel: Feel,
    /// Where it was moved [mm, from the scan to the scene]; none where the scan has it.
    pub pose: Option<DAffine3>,
}

/// A change of the scene.
#[derive(Debug)]
pub enum Step {
    /// Changes bricks; `ranges` are the thresholds of the changed segments afterwards.
    Edit {
        /// The bricks.
        edit: Edit,
        /// One for each segment of the edit.
        ranges: Vec<(SegmentId, Option<ThresholdRange>)>,
    },
    /// Puts other voxels in the place of a segment's.
    Replace {
        /// Which segment.
        id: SegmentId,
        /// Its voxels.
        segment: Segment,
        /// The threshold that they are.
        range: Option<ThresholdRange>,
    },
    /// Adds a segment.
    Insert {
        /// Its number, not in use.
        id: SegmentId,
        /// Its voxels.
        segment: Segment,
        /// What else is known of it.
        properties: Properties,
    },
    /// Removes a segment.
    Remove {
        /// Which segment.
        id: SegmentId,
    },
    /// Moves a segment.
    Move {
        /// Which segment.
        id: SegmentId,
        /// Where to [mm, from the scan to the scene]; a rigid motion.
        pose: DAffine3,
    },
}

/// What a step changes of the occupancy of touchable segments.
#[derive(Clone, Debug, PartialEq)]
pub enum TouchChange {
    /// Nothing.
    Nothing,
    /// These bricks, by rising place in the directory, each once, of these segments.
    Bricks(Vec<u32>, Vec<SegmentId>),
    /// Anything, of this segment.
    All(SegmentId),
    /// Where this segment stands, which was moved before.
    Pose(SegmentId, DAffine3),
    /// That this segment is moved from now on, and where to.
    FirstPose(SegmentId, DAffine3),
}

impl Step {
    /// An edit after which its segments are no threshold any more.
    #[must_use]
    pub fn of_edit(edit: Edit) -> Self {
        let ranges = edit.segments.iter().map(|(id, _)| (*id, None)).collect();
        Self::Edit { edit, ranges }
    }

    /// The segment whose number the step needs, if it brings one back.
    #[must_use]
    pub fn inserted(&self) -> Option<SegmentId> {
        match self {
            Self::Insert { id, .. } => Some(*id),
            _ => None,
        }
    }

    /// The segment that the step moves, if it does.
    #[must_use]
    pub fn moves(&self) -> Option<SegmentId> {
        match self {
            Self::Move { id, .. } => Some(*id),
            _ => None,
        }
    }

    /// The segment that the step takes away, if it does.
    #[must_use]
    pub fn removed(&self) -> Option<SegmentId> {
        match self {
            Self::Remove { id } => Some(*id),
            _ => None,
        }
    }

    /// Roughly the bytes that the step holds on to.
    #[must_use]
    pub fn bytes(&self) -> usize {
        match self {
            Self::Edit { edit, .. } => bytes_of(edit),
            Self::Replace { segment, .. } | Self::Insert { segment, .. } => segment.memory_bytes(),
            Self::Remove { .. } | Self::Move { .. } => 0,
        }
    }
}

/// Voxels and properties.
#[derive(Debug)]
pub struct Scene {
    voxels: Voxels,
    properties: BTreeMap<SegmentId, Properties>,
}

impl Scene {
    /// A scene of these voxels; `properties` of its segments.
    #[must_use]
    pub fn new(voxels: Voxels) -> Self {
        let properties = voxels
            .segments()
            .map(|(id, _)| (id, Properties::default()))
            .collect();
        Self { voxels, properties }
    }

    /// The voxels.
    #[must_use]
    pub fn voxels(&self) -> &Voxels {
        &self.voxels
    }

    /// All segments with their properties, by rising number.
    pub fn segments(&self) -> impl Iterator<Item = (SegmentId, &Segment, Properties)> {
        self.voxels
            .segments()
            .map(|(id, segment)| (id, segment, self.properties_of(id)))
    }

    /// What is known of a segment beside its voxels.
    #[must_use]
    pub fn properties_of(&self, id: SegmentId) -> Properties {
        self.properties.get(&id).copied().unwrap_or_default()
    }

    /// Changes whether a segment is an obstacle; false where it was so already.
    ///
    /// # Errors
    /// Where there is no such segment.
    pub fn set_touchable(&mut self, id: SegmentId, touchable: bool) -> Result<bool, VoxelsError> {
        let properties = self
            .properties
            .get_mut(&id)
            .ok_or(VoxelsError::UnknownSegment(id.0))?;
        let differs = properties.touchable != touchable;
        properties.touchable = touchable;
        Ok(differs)
    }

    /// How each segment feels, by its number.
    #[must_use]
    pub fn feels(&self) -> Feels {
        let mut feels = Feels::default();
        for (id, properties) in &self.properties {
            feels.set(*id, properties.feel);
        }
        feels
    }

    /// Changes how the surface of a segment feels.
    ///
    /// # Errors
    /// Where there is no such segment.
    pub fn set_feel(&mut self, id: SegmentId, feel: Feel) -> Result<(), VoxelsError> {
        let properties = self
            .properties
            .get_mut(&id)
            .ok_or(VoxelsError::UnknownSegment(id.0))?;
        properties.feel = feel;
        Ok(())
    }

    /// The bits of all obstacles.
    #[must_use]
    pub fn touchable_bits(&self) -> Vec<&Bits> {
        self.segments()
            .filter(|(_, _, properties)| properties.touchable)
            .map(|(_, segment, _)| segment.occupancy())
            .collect()
    }

    /// All obstacles, by rising number.
    #[must_use]
    pub fn touchable_parts(&self) -> Vec<Part> {
        self.segments()
            .filter(|(_, _, properties)| properties.touchable)
            .map(|(id, segment, properties)| Part {
                id,
                bits: segment.occupancy().clone(),
                moved: properties
                    .pose
                    .map(|_| segment.bounding_box().unwrap_or(VoxelBox::EMPTY)),
            })
            .collect()
    }

    /// Performs a step; gives its inverse and what touch must follow.
    ///
    /// # Errors
    /// Where it does not fit; nothing is changed then.
    pub fn perform(&mut self, step: Step) -> Result<(Step, TouchChange), VoxelsError> {
        match step {
            Step::Edit { edit, ranges } => self.edit(edit, ranges),
            Step::Replace { id, segment, range } => self.replace(id, segment, range),
            Step::Insert {
                id,
                segment,
                properties,
            } => self.insert(id, segment, properties),
            Step::Remove { id } => self.remove(id),
            Step::Move { id, pose } => self.move_to(id, pose),
        }
    }

    /// A segment that was moved once stays a body of its own, also where it is taken back.
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
        let touchable = properties.touchable;
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

    /// Number of segments that were moved.
    #[must_use]
    pub fn moved_count(&self) -> usize {
        let poses = self.properties.values().map(|properties| properties.pose);
        poses.flatten().count()
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
        range: Option<ThresholdRange>,
    ) -> Result<(Step, TouchChange), VoxelsError> {
        let segment = self.voxels.replace_segment(id, segment)?;
        let range = self.exchange_range(id, range);
        let change = self.all_to_touch(id);
        Ok((Step::Replace { id, segment, range }, change))
    }

    fn insert(
        &mut self,
        id: SegmentId,
        segment: Segment,
        properties: Properties,
    ) -> Result<(Step, TouchChange), VoxelsError> {
        let replaced = self.voxels.insert_segment(id, segment)?;
        assert!(replaced.is_none(), "segment number {} was in use", id.0);
        self.properties.insert(id, properties);
        Ok((Step::Remove { id }, self.all_to_touch(id)))
    }

    fn remove(&mut self, id: SegmentId) -> Result<(Step, TouchChange), VoxelsError> {
        let segment = self.voxels.remove_segment(id)?;
        let change = self.all_to_touch(id);
        let properties = self.properties.remove(&id).unwrap_or_default();
        let inverse = Step::Insert {
            id,
            segment,
            properties,
        };
        Ok((inverse, change))
    }

    fn exchange_range(
        &mut self,
        id: SegmentId,
        range: Option<ThresholdRange>,
    ) -> Option<ThresholdRange> {
        let properties = self.properties.get_mut(&id)?;
        std::mem::replace(&mut properties.range, range)
    }

    fn all_to_touch(&self, id: SegmentId) -> TouchChange {
        if self.properties_of(id).touchable {
            TouchChange::All(id)
        } else {
            TouchChange::Nothing
        }
    }

    fn bricks_to_touch(&self, edit: &Edit) -> TouchChange {
        let touched = || {
            edit.segments
                .iter()
                .filter(|(id, _)| self.properties_of(*id).touchable)
        };
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
