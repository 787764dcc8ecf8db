//! The true state of a scan: its values, what edits put over them, and its segments.
//!
//! Edits are built from a state (or a snapshot: a clone shares all bricks) and applied to
//! it; every change raises the edit number, by which others know what they show.
//! Frame: grid.

use std::collections::{BTreeMap, BTreeSet};

use glam::{IVec3, UVec3};
use thiserror::Error;

use crate::bit_brick::BitBrick;
use crate::bits::Bits;
use crate::brick_grid::BrickSwap;
use crate::edit::{Edit, SegmentId};
use crate::edit_builder;
use crate::grid::Grid;
use crate::intensities::Intensities;
use crate::intensity_brick::IntensityBrick;
use crate::overlay::Overlay;
use crate::segment::Segment;
use crate::segment_set::SegmentSet;
use crate::threshold::{stored_range, threshold};
use crate::voxel_box::VoxelBox;
use crate::voxel_state::VoxelState;

/// A change that does not fit the state.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum VoxelsError {
    /// Values or segments of another grid.
    #[error("dimensions {given} given; allowed: those of the scan, {allowed}")]
    Dimensions {
        /// Voxels of what was given.
        given: UVec3,
        /// Voxels of the scan.
        allowed: UVec3,
    },
    /// There is no such segment.
    #[error("segment {0} given; allowed: a segment that exists")]
    UnknownSegment(u8),
    /// They stand on different grids.
    #[error("segments {0} and {1} given, which stand on different grids; allowed: of one grid")]
    DifferentGrids(u8, u8),
    /// All 255 numbers of segments are taken.
    #[error("a 256th segment given; allowed: 255")]
    TooManySegments,
    /// The edit was made for another grid.
    #[error("brick {given} given; allowed: below {allowed}, the bricks of this scan")]
    UnknownBrick {
        /// Place in the directory.
        given: u32,
        /// Entries of the directory.
        allowed: usize,
    },
}

/// All voxels of a scan and their segments.
#[derive(Clone, Debug)]
pub struct Voxels {
    grid: Grid,
    intensities: Intensities,
    overlay: Overlay,
    segments: BTreeMap<SegmentId, Segment>,
    edit_number: u64,
}

impl Voxels {
    /// A scan without segments.
    ///
    /// # Errors
    /// Where grid and intensities have different dimensions.
    pub fn new(grid: Grid, intensities: Intensities) -> Result<Self, VoxelsError> {
        check_dimensions(intensities.dimensions(), grid.dimensions())?;
        Ok(Self {
            grid,
            overlay: Overlay::empty(grid.dimensions()),
            intensities,
            segments: BTreeMap::new(),
            edit_number: 0,
        })
    }

    /// Where the voxels stand.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The scan's own values.
    pub fn intensities(&self) -> &Intensities {
        &self.intensities
    }

    /// What voxel edits put over them.
    pub fn overlay(&self) -> &Overlay {
        &self.overlay
    }

    /// Number of changes so far.
    pub fn edit_number(&self) -> u64 {
        self.edit_number
    }

    /// Stored value of a voxel, edits included; none outside the grid.
    pub fn stored(&self, voxel: IVec3) -> Option<i16> {
        self.overlay.stored(&self.intensities, voxel)
    }

    /// Intensity and segments of a voxel, edits included; none outside the grid. Segments on a grid of
    /// their own hold no voxel of it.
    pub fn state(&self, voxel: IVec3) -> Option<VoxelState> {
        let stored = self.stored(voxel)?;
        let holds = |segment: &Segment| segment.own_grid().is_none() && segment.contains(voxel);
        let ids = self.segments().filter(|(_, segment)| holds(segment));
        Some(VoxelState {
            stored,
            segments: ids.map(|(id, _)| id).collect(),
        })
    }

    /// Physical value of a voxel, edits included; none outside the grid.
    pub fn value(&self, voxel: IVec3) -> Option<f64> {
        let stored = self.stored(voxel)?;
        Some(self.intensities.physical(stored))
    }

    /// The voxels from `low` to `high` in physical units, edits included; see [`threshold`].
    pub fn threshold(&self, low: f64, high: f64) -> Segment {
        threshold(&self.intensities, Some(&self.overlay), low, high)
    }

    /// Stored values of a box, edits included, x fastest; the box must lie in the grid.
    pub fn stored_in(&self, region: &VoxelBox) -> Vec<i16> {
        let stored = |voxel| self.stored(voxel).unwrap_or_default();
        region.voxels().map(stored).collect()
    }

    /// For each voxel of a box, x fastest, the last of these segments that has it; else 0.
    pub fn labels_in(&self, region: &VoxelBox, labelled: &[SegmentId]) -> Vec<u8> {
        let mut labels = vec![0; region.voxel_count() as usize];
        for &id in labelled {
            let Some(segment) = self.segment(id) else {
                continue;
            };
            // one with a grid of its own has no voxels of the scan
            if segment.own_grid().is_some() {
                continue;
            }
            if segment
                .bounding_box()
                .unwrap_or(VoxelBox::EMPTY)
                .intersect(region)
                .is_empty()
            {
                continue;
            }
            for (label, voxel) in labels.iter_mut().zip(region.voxels()) {
                if segment.contains(voxel) {
                    *label = id.0;
                }
            }
        }
        labels
    }

    /// All segments, by rising number.
    pub fn segments(&self) -> impl Iterator<Item = (SegmentId, &Segment)> {
        self.segments.iter().map(|(&id, segment)| (id, segment))
    }

    /// One segment.
    pub fn segment(&self, id: SegmentId) -> Option<&Segment> {
        self.segments.get(&id)
    }

    /// The grid that a segment stands on; the scan's where there is no such segment.
    pub fn grid_of(&self, id: SegmentId) -> &Grid {
        let segment = self.segments.get(&id);
        segment.map_or(&self.grid, |segment| segment.grid(&self.grid))
    }

    /// Adds a segment under the lowest free number.
    ///
    /// # Errors
    /// Where it belongs to another scan, or all numbers are taken.
    pub fn add_segment(&mut self, segment: Segment) -> Result<SegmentId, VoxelsError> {
        self.check_grid(&segment)?;
        let id = (1..=u8::MAX)
            .map(SegmentId)
            .find(|id| !self.segments.contains_key(id))
            .ok_or(VoxelsError::TooManySegments)?;
        self.segments.insert(id, segment);
        self.edit_number += 1;
        Ok(id)
    }

    /// Adds a segment under a given number, for undo, and returns the one that was there.
    ///
    /// # Errors
    /// Where it belongs to another scan.
    pub fn insert_segment(
        &mut self,
        id: SegmentId,
        segment: Segment,
    ) -> Result<Option<Segment>, VoxelsError> {
        self.check_grid(&segment)?;
        self.edit_number += 1;
        Ok(self.segments.insert(id, segment))
    }

    /// Puts a segment in the place of another and returns that, for undo.
    ///
    /// # Errors
    /// Where there is no such segment, or the new one belongs to another scan.
    pub fn replace_segment(
        &mut self,
        id: SegmentId,
        segment: Segment,
    ) -> Result<Segment, VoxelsError> {
        self.check_grid(&segment)?;
        let place = self
            .segments
            .get_mut(&id)
            .ok_or(VoxelsError::UnknownSegment(id.0))?;
        self.edit_number += 1;
        Ok(std::mem::replace(place, segment))
    }

    /// Takes a segment away and returns it.
    ///
    /// # Errors
    /// Where there is no such segment.
    pub fn remove_segment(&mut self, id: SegmentId) -> Result<Segment, VoxelsError> {
        let removed = self
            .segments
            .remove(&id)
            .ok_or(VoxelsError::UnknownSegment(id.0))?;
        self.edit_number += 1;
        Ok(removed)
    }

    /// Builds a change of one segment: `solid(voxel, was_solid)` is asked for each voxel of
    /// the region inside its grid. Nothing changes before [`Self::apply`].
    ///
    /// # Errors
    /// Where there is no such segment.
    pub fn label_edit(
        &self,
        id: SegmentId,
        region: &VoxelBox,
        solid: impl Fn(IVec3, bool) -> bool + Sync,
    ) -> Result<Edit, VoxelsError> {
        self.label_edit_of(&[id], &[*region], |_, voxel, was| solid(voxel, was))
    }

    /// Builds a change of some segments at once: `solid(segment, voxel, was_solid)` is asked
    /// for each voxel of the boxes inside their grid, and maybe for others in the bricks that
    /// the boxes meet; boxes may overlap, numbers may come twice. Nothing changes before
    /// [`Self::apply`].
    ///
    /// # Errors
    /// Where one of the segments does not exist, or they stand on different grids.
    pub fn label_edit_of(
        &self,
        ids: &[SegmentId],
        boxes: &[VoxelBox],
        solid: impl Fn(SegmentId, IVec3, bool) -> bool + Sync,
    ) -> Result<Edit, VoxelsError> {
        let ids = ids.iter().copied().collect::<BTreeSet<_>>();
        let find = |id: SegmentId| {
            let segment = self.segment(id).ok_or(VoxelsError::UnknownSegment(id.0))?;
            Ok((id, segment))
        };
        let segments = ids.into_iter().map(find).collect::<Result<Vec<_>, _>>()?;
        if let Some((first, rest)) = segments.split_first()
            && let Some(other) = rest
                .iter()
                .find(|other| other.1.own_grid() != first.1.own_grid())
        {
            return Err(VoxelsError::DifferentGrids(first.0.0, other.0.0));
        }
        let grid = segments
            .first()
            .map_or(&self.grid, |first| first.1.grid(&self.grid));
        let bounds = grid.bounds();
        let boxes: Vec<_> = boxes
            .iter()
            .map(|region| region.intersect(&bounds))
            .collect();
        Ok(edit_builder::label_edit(&segments, &boxes, solid))
    }

    /// Builds a change of intensities and all segments of the scan: `change(voxel, was)` is asked
    /// for each voxel of the region inside the grid. Segments that do not exist are passed over,
    /// as are those that have a grid of their own.
    /// Nothing changes before [`Self::apply`].
    pub fn voxel_edit(
        &self,
        region: &VoxelBox,
        change: impl Fn(IVec3, VoxelState) -> VoxelState + Sync,
    ) -> Edit {
        let region = region.intersect(&self.grid.bounds());
        edit_builder::voxel_edit(self, &region, change)
    }

    /// Builds a change by which the voxels of a mask have one stored value and are in no segment that stands on the
    /// scan's grid. Nothing changes before [`Self::apply`].
    ///
    /// # Errors
    /// Where the mask is of another grid.
    pub fn removal(&self, mask: &Segment, stored: i16) -> Result<Edit, VoxelsError> {
        check_dimensions(mask.dimensions(), self.grid.dimensions())?;
        let region = mask.bounding_box().unwrap_or(VoxelBox::EMPTY);
        Ok(self.voxel_edit(&region, |voxel, was| {
            if mask.contains(voxel) {
                VoxelState {
                    stored,
                    segments: SegmentSet::EMPTY,
                }
            } else {
                was
            }
        }))
    }

    /// The voxels that a range of values makes of the scan, but those of another value by now where that is from `low` to
    /// `high` in physical units.
    ///
    /// # Errors
    /// Where they are of another grid.
    pub fn as_edited(&self, made: &Segment, low: f64, high: f64) -> Result<Segment, VoxelsError> {
        check_dimensions(made.dimensions(), self.grid.dimensions())?;
        if self.overlay.bricks().is_empty() {
            return Ok(made.clone());
        }
        let range = stored_range(&self.intensities, low, high);
        let is_in_range = |stored| range.as_ref().is_some_and(|range| range.contains(&stored));
        let occupancy = Bits::from_bricks(self.grid.dimensions(), |voxels| {
            let bits = made.occupancy().bricks().at(voxels.min);
            let mut bits = bits.map_or(BitBrick::EMPTY, BitBrick::clone);
            if let Some(edited) = self.overlay.bricks().at(voxels.min) {
                for voxel in voxels.voxels() {
                    let stored = edited.stored(voxel);
                    if self.intensities.stored(voxel) != Some(stored) {
                        bits.set(voxel, is_in_range(stored));
                    }
                }
            }
            bits
        });
        Ok(Segment::from_bits(occupancy))
    }

    /// Applies an edit and returns its inverse, which is to be applied to the state that
    /// this one leaves.
    ///
    /// # Errors
    /// Where it does not fit; nothing is changed then.
    pub fn apply(&mut self, mut edit: Edit) -> Result<Edit, VoxelsError> {
        self.check(&edit)?;
        for (id, swaps) in &mut edit.segments {
            if let Some(segment) = self.segments.get_mut(id) {
                segment.swap(swaps);
            }
        }
        for swap in &mut edit.intensities {
            self.overlay.swap(swap);
        }
        self.edit_number += 1;
        Ok(edit)
    }

    /// Whether an edit would change any voxel; bricks that read the same as those that are there
    /// change none.
    pub fn would_change(&self, edit: &Edit) -> bool {
        let bits = |(id, swaps): &(SegmentId, Vec<BrickSwap<BitBrick>>)| {
            let bricks = self
                .segment(*id)
                .map(|segment| segment.occupancy().bricks());
            swaps.iter().any(|swap| {
                let now = bricks.and_then(|bricks| bricks.get(swap.index));
                now.map_or(&BitBrick::EMPTY, AsRef::as_ref)
                    != swap.brick.as_deref().unwrap_or(&BitBrick::EMPTY)
            })
        };
        let values = |swap: &BrickSwap<IntensityBrick>| {
            let bounds = self.overlay.bricks().box_of(swap.index);
            let mut voxels = bounds.intersect(&self.grid.bounds()).voxels();
            let then = |voxel| match &swap.brick {
                Some(brick) => Some(brick.stored(voxel)),
                None => self.intensities.stored(voxel),
            };
            voxels.any(|voxel| self.stored(voxel) != then(voxel))
        };
        edit.segments.iter().any(bits) || edit.intensities.iter().any(values)
    }

    /// Refuses an edit of other segments or of another grid.
    fn check(&self, edit: &Edit) -> Result<(), VoxelsError> {
        let unknown = |id: &SegmentId| !self.segments.contains_key(id);
        if let Some(id) = edit
            .segments
            .iter()
            .map(|(id, _)| id)
            .find(|id| unknown(id))
        {
            return Err(VoxelsError::UnknownSegment(id.0));
        }
        let bits = edit.segments.iter().flat_map(|(id, swaps)| {
            let bricks = self.segments[id].occupancy().bricks().len();
            swaps.iter().map(move |swap| (swap.index, bricks))
        });
        let bricks = self.overlay.bricks().len();
        let values = edit.intensities.iter().map(|swap| (swap.index, bricks));
        let beyond = |&(given, allowed): &(u32, usize)| given as usize >= allowed;
        match bits.chain(values).find(beyond) {
            Some((given, allowed)) => Err(VoxelsError::UnknownBrick { given, allowed }),
            None => Ok(()),
        }
    }

    /// Refuses a segment of another scan; one with a grid of its own fits any.
    fn check_grid(&self, segment: &Segment) -> Result<(), VoxelsError> {
        match segment.own_grid() {
            Some(_) => Ok(()),
            None => check_dimensions(segment.dimensions(), self.grid.dimensions()),
        }
    }
}

fn check_dimensions(given: UVec3, allowed: UVec3) -> Result<(), VoxelsError> {
    (given == allowed)
        .then_some(())
        .ok_or(VoxelsError::Dimensions { given, allowed })
}
