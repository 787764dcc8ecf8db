//! What a voxel is: its intensity and its segments.

use crate::segment_set::SegmentSet;

/// The state of one voxel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VoxelState {
    /// Stored intensity, the overlay's where there is one.
    pub stored: i16,
    /// Segments in which the voxel is solid.
    pub segments: SegmentSet,
}
