//! Changes of the scene, and what each of them changes for touch.

use glam::DAffine3;
use palpate_deform::material::MaterialLaw;
use palpate_deform::registry::ModelOptions;
use palpate_tools::stroke::bytes_of;
use palpate_volume::edit::{Edit, SegmentId};
use palpate_volume::segment::Segment;
use palpate_volume::voxels::Voxels;

use super::Properties;
use crate::touch::ThresholdRange;

/// A model of soft tissue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelChoice {
    /// Its name, one of the registered.
    pub name: &'static str,
    /// What of it is not as usual.
    pub options: ModelOptions,
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
        properties: Box<Properties>,
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
    /// Tells what a segment is made of.
    Material {
        /// Which segment.
        id: SegmentId,
        /// Of what; none where it is hard.
        law: Option<MaterialLaw>,
    },
    /// Chooses the model of soft tissue, or none.
    Model(Option<ModelChoice>),
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

impl Step {
    /// An edit after which its segments are no threshold any more.
    #[must_use]
    pub fn of_edit(edit: Edit) -> Self {
        let ranges = edit.segments.iter().map(|(id, _)| (*id, None)).collect();
        Self::Edit { edit, ranges }
    }

    /// An edit that comes back: what its segments are made by stays known.
    #[must_use]
    pub fn of_elastic_edit(
        edit: Edit,
        range_of: impl Fn(SegmentId) -> Option<ThresholdRange>,
    ) -> Self {
        let ids = edit.segments.iter().map(|(id, _)| *id);
        let ranges = ids.map(|id| (id, range_of(id))).collect();
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
            Self::Remove { .. } | Self::Move { .. } | Self::Material { .. } | Self::Model(_) => 0,
            Self::Several(steps) => steps.iter().map(Self::bytes).sum(),
        }
    }
}
