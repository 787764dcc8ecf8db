//! An edit: the one way to change voxels.
//!
//! Bricks are never changed once shared. An edit holds the new ones; applied, it holds those
//! that were there, and so is its own inverse.

use crate::bit_brick::BitBrick;
use crate::brick_grid::BrickSwap;
use crate::intensity_brick::IntensityBrick;
use crate::voxel_box::VoxelBox;

/// Number of a segment within its scan, 1 to 255; 0 stands for no segment in label images.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SegmentId(pub u8);

/// What an edit may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EditKind {
    /// Bits of one segment: correcting a mask never touches the picture of the scan.
    Label,
    /// Bits of all segments and intensities: what the scan shows was removed, added or moved.
    Voxel,
}

/// Bricks to exchange and the voxels that differ by it.
#[derive(Clone, Debug)]
pub struct Edit {
    /// Kind of the edit: what it may change.
    pub kind: EditKind,
    /// The smallest box of all voxels that it changes, in bits or intensity; of the grid that
    /// its segments stand on, which is the scan's in a voxel edit.
    pub dirty: VoxelBox,
    /// New bricks of segments, by rising number of the segment, each brick once.
    pub segments: Vec<(SegmentId, Vec<BrickSwap<BitBrick>>)>,
    /// New bricks of the overlay, each once; none in a label edit.
    pub intensities: Vec<BrickSwap<IntensityBrick>>,
}

impl Edit {
    /// An edit that changes nothing.
    pub fn empty(kind: EditKind) -> Self {
        Self {
            kind,
            dirty: VoxelBox::EMPTY,
            segments: Vec::new(),
            intensities: Vec::new(),
        }
    }

    /// Whether it changes nothing.
    pub fn is_empty(&self) -> bool {
        self.dirty.is_empty()
    }
}
