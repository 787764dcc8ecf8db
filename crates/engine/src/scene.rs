//! The true state of a session: voxels and what is known of each segment beside its voxels.
//!
//! Every change is a step whose performance gives the inverse step, so that undo and redo go
//! the same way as the change itself.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::touch::{
    FractionalBits, MovedPart, Part, ScanValues, Threshold, ThresholdRange, TouchFeel, TouchFeels,
};
use glam::DAffine3;
use palpate_deform::material::MaterialLaw;
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::clip::Clip;
use palpate_volume::edit::SegmentId;
use palpate_volume::occupancy_fractions::OccupancyFractions;
use palpate_volume::segment::Segment;
use palpate_volume::segment_set::SegmentSet;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::{Voxels, VoxelsError};

mod clip;
mod cut;
mod gap;
mod gap_bodies;
mod incremental_surface;
mod mask_fractions;
mod perform;
mod point_tree;
mod step;
mod tool_status;

pub use cut::{LineCut, MOST_POINTS, Painted, Plane};
pub use gap::{Gap, GapBody};
pub use gap_bodies::{GapBodies, Measured, gap_surface_options};
pub use incremental_surface::{IncrementalSurface, SegmentVoxels, SurfaceOptions, SurfaceSource};
pub use mask_fractions::{FractionLoop, MaskFractions};
pub use step::{ModelChoice, Step, TouchChange};
pub use tool_status::ToolStatus;

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
    /// How its surface feels, as a person has set it.
    pub feel: TouchFeel,
    /// Where it was moved [mm, from the scan to the scene]; none where the scan has it.
    pub pose: Option<DAffine3>,
    /// What it is made of; none where it is rigid.
    pub law: Option<MaterialLaw>,
    /// Whether its voxels stay as they are, but for undo and redo.
    pub locked: bool,
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

    /// How its surface feels, with the friction of what it is made of.
    #[must_use]
    pub fn felt(&self) -> TouchFeel {
        self.feel.of_material(self.law.as_ref())
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
    punctured: SegmentSet,
    /// Where deformable segments are hard.
    rigid: BTreeMap<SegmentId, Bits>,
    /// What of the scene is cut away from touch.
    clip: Clip,
    /// What it leaves of obstacles, of those that it cuts.
    left: BTreeMap<SegmentId, Bits>,
    /// What was worked out of the occupancy fractions of masks.
    fractions: BTreeMap<SegmentId, Arc<OccupancyFractions>>,
    /// The model of soft tissue.
    model: Option<ModelChoice>,
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
            punctured: SegmentSet::EMPTY,
            rigid: BTreeMap::new(),
            clip: Clip::default(),
            left: BTreeMap::new(),
            fractions: BTreeMap::new(),
            model: None,
        }
    }

    /// The model of soft tissue; none where all is rigid.
    #[must_use]
    pub fn model(&self) -> Option<ModelChoice> {
        self.model
    }

    /// Takes the choice of a model from elsewhere.
    pub fn set_known_model(&mut self, model: Option<ModelChoice>) {
        self.model = model;
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

    /// Locks the voxels of a segment, or lets them be changed; false where it was so already.
    ///
    /// # Errors
    /// Where there is no such segment.
    pub fn set_locked(&mut self, id: SegmentId, locked: bool) -> Result<bool, VoxelsError> {
        let properties = self
            .properties
            .get_mut(&id)
            .ok_or(VoxelsError::UnknownSegment(id.0))?;
        Ok(std::mem::replace(&mut properties.locked, locked) != locked)
    }

    /// How each segment feels, by its number.
    #[must_use]
    pub fn feels(&self) -> TouchFeels {
        let mut feels = TouchFeels::default();
        for (id, properties) in &self.properties {
            feels.set(*id, properties.felt());
        }
        feels
    }

    /// Changes how the surface of a segment feels.
    ///
    /// # Errors
    /// Where there is no such segment.
    pub fn set_feel(&mut self, id: SegmentId, feel: TouchFeel) -> Result<(), VoxelsError> {
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
    pub fn puncture(&mut self, punctured: SegmentSet) -> Vec<SegmentId> {
        let before = std::mem::replace(&mut self.punctured, punctured);
        let changes = |id: &SegmentId| before.contains(*id) != punctured.contains(*id);
        let obstacles = self.obstacles().map(|(id, _, _)| id);
        obstacles.filter(changes).collect()
    }

    /// A deformable segment is hard where this mask is, or nowhere; whether that is new.
    pub fn set_rigid(&mut self, id: SegmentId, rigid: Option<Bits>) -> bool {
        let is_same = match (self.rigid.get(&id), &rigid) {
            (Some(known), Some(rigid)) => known.difference(rigid).is_empty(),
            (known, rigid) => known.is_none() && rigid.is_none(),
        };
        match rigid {
            Some(rigid) => drop(self.rigid.insert(id, rigid)),
            None => drop(self.rigid.remove(&id)),
        }
        !is_same
    }

    /// Puts bricks of where a deformable segment is hard in the place of those that were there.
    pub fn change_rigid(&mut self, id: SegmentId, mut swaps: Vec<BrickSwap<BitBrick>>) {
        if let Some(rigid) = self.rigid.get_mut(&id) {
            for swap in &mut swaps {
                rigid.swap(swap);
            }
        }
    }

    /// Where a deformable segment is hard; none where it is so nowhere.
    #[must_use]
    pub fn rigid(&self, id: SegmentId) -> Option<&Bits> {
        self.rigid.get(&id)
    }

    /// Whether the probe is stopped by a segment where the scan has it: not where it was moved
    /// or a needle is in it.
    #[must_use]
    pub fn stands(&self, id: SegmentId) -> bool {
        self.properties_of(id).pose.is_none() && !self.punctured.contains(id)
    }

    /// Takes what was worked out of the occupancy fractions of a mask, or forgets it.
    pub fn set_fractions(&mut self, id: SegmentId, fractions: Option<Arc<OccupancyFractions>>) {
        match fractions {
            Some(fractions) => self.fractions.insert(id, fractions),
            None => self.fractions.remove(&id),
        };
    }

    /// What was worked out of the occupancy fractions of a segment; none of one that a threshold
    /// made.
    #[must_use]
    pub fn fractions_of(&self, id: SegmentId) -> Option<&Arc<OccupancyFractions>> {
        self.fractions.get(&id).filter(|_| self.is_mask(id))
    }

    /// Whether touch knows of a segment no more than its bits: no threshold on the scan made it.
    #[must_use]
    pub fn is_mask(&self, id: SegmentId) -> bool {
        self.properties_of(id).made_by.is_none() || self.has_own_grid(id)
    }

    /// Voxels and occupancy fractions of all obstacles that are where the scan has them.
    #[must_use]
    pub fn standing(&self) -> Vec<FractionalBits<'_>> {
        self.obstacles()
            .filter(|(id, _, _)| self.stands(*id))
            .map(|(id, segment, _)| FractionalBits {
                bits: self.touched(id, segment),
                fractions: self.fractions_of(id).map(|fractions| &**fractions),
            })
            .collect()
    }

    /// All obstacles with their properties, by rising number.
    pub fn obstacles(&self) -> impl Iterator<Item = (SegmentId, &Segment, Properties)> {
        self.segments().filter(|(id, _, _)| self.is_obstacle(*id))
    }

    /// All obstacles, by rising number, with copies of their directories of bricks. A threshold's end
    /// that no value of the scan is beyond is infinite: it limits nothing.
    #[must_use]
    pub fn touchable_parts(&self) -> Vec<Part> {
        self.obstacles()
            .map(|(id, segment, properties)| Part {
                id,
                bits: self.touched(id, segment).clone(),
                moved: properties.pose.map(|pose| MovedPart {
                    own_grid: segment.own_grid().copied(),
                    bounds: segment.bounding_box().unwrap_or(VoxelBox::EMPTY),
                    pose,
                }),
                threshold: properties
                    .made_by
                    .filter(|_| segment.own_grid().is_none())
                    .map(|range| Threshold {
                        range: self.limiting(range),
                        values: self.values.clone(),
                    }),
                fractions: self.fractions_of(id).cloned(),
                punctured: self.punctured.contains(id),
                rigid: self.rigid.get(&id).cloned(),
            })
            .collect()
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
}
