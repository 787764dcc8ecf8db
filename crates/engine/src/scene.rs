//! The true state of a session: voxels and what is known of each segment beside its voxels.
//!
//! Every change is a step whose performance gives the inverse step, so that undo and redo go
//! the same way as the change itself.

use std::collections::BTreeMap;

use crate::feel::{Feel, Feels};
use crate::kept_surface::SegmentVoxels;
use crate::scan_values::{ScanValues, Threshold};
use crate::touchable::{MovedPart, Part};
use glam::DAffine3;
use palpate_haptics::needle::tissues::Segments;
use palpate_haptics::scene::MAX_OBJECTS;
use palpate_tools::stroke::bytes_of;
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
    /// The threshold that made it, whatever edits did since: touch and surfaces read the scan's
    /// values there.
    pub made_by: Option<ThresholdRange>,
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
        /// The threshold that made them.
        made_by: Option<ThresholdRange>,
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
    /// These, one after the other, as one.
    Several(Vec<Step>),
}

/// What a step changes of the occupancy of touchable segments.
#[derive(Clone, Debug, PartialEq)]
pub enum TouchChange {
    /// Nothing.
    Nothing,
    /// These bricks, by rising place in the directory, each once, of these segments.
    Bricks(Vec<u32>, Vec<SegmentId>),
    /// Anything, of these segments.
    All(Vec<SegmentId>),
    /// Where this segment stands, which was moved before.
    Pose(SegmentId, DAffine3),
    /// That this segment is moved from now on, and where to.
    FirstPose(SegmentId, DAffine3),
}

impl TouchChange {
    /// The segments that it concerns.
    #[must_use]
    pub fn segments(self) -> Vec<SegmentId> {
        match self {
            Self::Nothing => Vec::new(),
            Self::Bricks(_, segments) | Self::All(segments) => segments,
            Self::Pose(id, _) | Self::FirstPose(id, _) => vec![id],
        }
    }
}

impl Properties {
    /// Of an obstacle or none that is a threshold, or whose voxels come from elsewhere.
    #[must_use]
    pub fn of_threshold(touchable: bool, range: Option<ThresholdRange>) -> Self {
        Self {
            touchable,
            range,
            made_by: range,
            ..Self::default()
        }
    }
}

impl Step {
    /// An edit after which its segments are no threshold any more.
    #[must_use]
    pub fn of_edit(edit: Edit) -> Self {
        let ranges = edit.segments.iter().map(|(id, _)| (*id, None)).collect();
        Self::Edit { edit, ranges }
    }

    /// Whether the step would change any voxel or anything beside edits.
    #[must_use]
    pub fn would_change(&self, voxels: &Voxels) -> bool {
        match self {
            Self::Edit { edit, .. } => voxels.would_change(edit),
            _ => true,
        }
    }

    /// Whether the step brings a segment back under this number, or takes it away.
    #[must_use]
    pub fn needs(&self, number: SegmentId) -> bool {
        match self {
            Self::Insert { id, .. } | Self::Remove { id } => *id == number,
            Self::Several(steps) => steps.iter().any(|step| step.needs(number)),
            _ => false,
        }
    }

    /// The segments that the step holds whole.
    #[must_use]
    pub fn segments(&self) -> Vec<&Segment> {
        match self {
            Self::Replace { segment, .. } | Self::Insert { segment, .. } => vec![segment],
            Self::Several(steps) => steps.iter().flat_map(Self::segments).collect(),
            _ => Vec::new(),
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

    /// How many changes it is made of.
    #[must_use]
    pub fn leaves(&self) -> u32 {
        match self {
            Self::Several(steps) => steps.iter().map(Self::leaves).sum(),
            _ => 1,
        }
    }

    /// Roughly the bytes that the step holds on to.
    #[must_use]
    pub fn bytes(&self) -> usize {
        match self {
            Self::Edit { edit, .. } => bytes_of(edit),
            Self::Replace { segment, .. } | Self::Insert { segment, .. } => segment.memory_bytes(),
            Self::Remove { .. } | Self::Move { .. } => 0,
            Self::Several(steps) => steps.iter().map(Self::bytes).sum(),
        }
    }
}

/// Voxels and properties.
#[derive(Debug)]
pub struct Scene {
    voxels: Voxels,
    /// The scan's values as touch reads them.
    values: ScanValues,
    /// Lowest and highest of them.
    value_range: ThresholdRange,
    properties: BTreeMap<SegmentId, Properties>,
    /// The segment that is in the hand: no obstacle meanwhile.
    held: Option<SegmentId>,
    /// Segments that a needle is in.
    punctured: Segments,
}

impl Scene {
    /// A scene of these voxels; `properties` of its segments.
    #[must_use]
    pub fn new(voxels: Voxels) -> Self {
        let properties = voxels
            .segments()
            .map(|(id, _)| (id, Properties::default()))
            .collect();
        let values = ScanValues::of(voxels.intensities());
        Self {
            value_range: voxels.intensities().range(),
            voxels,
            values,
            properties,
            held: None,
            punctured: Segments::NONE,
        }
    }

    /// The scan's values as touch reads them.
    #[must_use]
    pub fn values(&self) -> &ScanValues {
        &self.values
    }

    /// The voxels.
    #[must_use]
    pub fn voxels(&self) -> &Voxels {
        &self.voxels
    }

    /// The voxels of a segment with the threshold that made them. An end that no value of the scan
    /// is beyond is infinite: it limits nothing.
    #[must_use]
    pub fn voxels_of(&self, id: SegmentId) -> Option<SegmentVoxels> {
        self.voxels.segment(id).map(|segment| SegmentVoxels {
            grid: *segment.grid(self.voxels.grid()),
            bits: segment.occupancy().clone(),
            made_by: match segment.own_grid() {
                Some(_) => None,
                None => self
                    .properties_of(id)
                    .made_by
                    .map(|range| self.limiting(range)),
            },
        })
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

    /// Takes what is known of a segment beside its voxels, from elsewhere.
    pub fn know(&mut self, id: SegmentId, properties: Properties) {
        self.properties.insert(id, properties);
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

    /// Whether the probe is stopped by a segment: not by the one in the hand.
    #[must_use]
    pub fn is_obstacle(&self, id: SegmentId) -> bool {
        self.properties_of(id).touchable && self.held != Some(id)
    }

    /// Takes a segment in the hand, or none; gives those that are, or are no more, obstacles by it.
    pub fn hold(&mut self, id: Option<SegmentId>) -> Vec<SegmentId> {
        let before = std::mem::replace(&mut self.held, id);
        let changed = before.into_iter().chain(id);
        changed
            .filter(|id| self.properties_of(*id).touchable)
            .collect()
    }

    /// A needle is in these segments; gives the obstacles that change by it.
    pub fn puncture(&mut self, punctured: Segments) -> Vec<SegmentId> {
        let before = std::mem::replace(&mut self.punctured, punctured);
        let changes = |id: &SegmentId| before.contains(id.0) != punctured.contains(id.0);
        let obstacles = self.obstacles().map(|(id, _, _)| id);
        obstacles.filter(changes).collect()
    }

    /// Whether the probe is stopped by a segment where the scan has it: not where it was moved
    /// or a needle is in it.
    #[must_use]
    pub fn stands(&self, id: SegmentId) -> bool {
        self.properties_of(id).pose.is_none() && !self.punctured.contains(id.0)
    }

    /// All obstacles with their properties, by rising number.
    pub fn obstacles(&self) -> impl Iterator<Item = (SegmentId, &Segment, Properties)> {
        self.segments().filter(|(id, _, _)| self.is_obstacle(*id))
    }

    /// All obstacles, by rising number, with copies of their directories of bricks.
    #[must_use]
    pub fn touchable_parts(&self) -> Vec<Part> {
        self.obstacles()
            .map(|(id, segment, properties)| Part {
                id,
                bits: segment.occupancy().clone(),
                moved: properties.pose.map(|pose| MovedPart {
                    own_grid: segment.own_grid().copied(),
                    bounds: segment.bounding_box().unwrap_or(VoxelBox::EMPTY),
                    pose,
                }),
                threshold: properties
                    .made_by
                    .filter(|_| segment.own_grid().is_none())
                    .map(|range| Threshold {
                        range,
                        values: self.values.clone(),
                    }),
                punctured: properties.pose.is_none() && self.punctured.contains(id.0),
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
            } => self.insert(id, segment, properties),
            Step::Remove { id } => self.remove(id),
            Step::Move { id, pose } => self.move_to(id, pose),
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

    /// Number of segments that are bodies of their own wherever they stand, or stand elsewhere
    /// than the scan has them.
    #[must_use]
    pub fn moved_count(&self) -> usize {
        let bodies = self.segments().filter(|(_, segment, properties)| {
            let stands_there = properties
                .pose
                .is_none_or(|pose| pose == DAffine3::IDENTITY);
            !stands_there || segment.own_grid().is_some()
        });
        bodies.count()
    }

    /// Whether a segment can be moved without one more body of its own than there is now.
    #[must_use]
    pub fn is_moved(&self, id: SegmentId) -> bool {
        let pose = self.properties_of(id).pose;
        pose.is_some_and(|pose| pose != DAffine3::IDENTITY) || self.has_own_grid(id)
    }

    fn has_own_grid(&self, id: SegmentId) -> bool {
        let segment = self.voxels.segment(id);
        segment.is_some_and(|segment| segment.own_grid().is_some())
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
        let change = self.all_to_touch(id);
        let properties = self.properties.remove(&id).unwrap_or_default();
        let inverse = Step::Insert {
            id,
            segment,
            properties,
        };
        Ok((inverse, change))
    }

    /// A threshold without ends that limit nothing.
    fn limiting(&self, (low, high): ThresholdRange) -> ThresholdRange {
        let (lowest, highest) = self.value_range;
        let low = if low <= lowest {
            f64::NEG_INFINITY
        } else {
            low
        };
        let high = if high >= highest { f64::INFINITY } else { high };
        (low, high)
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
