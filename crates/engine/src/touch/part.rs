//! A segment as touch is given it: its voxels, where it stands, and what is known of its surface.
//!
//! Frame: the grid of the scan, or one of its own.

use std::sync::Arc;

use glam::DAffine3;
use palpate_volume::bits::Bits;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::occupancy_fractions::OccupancyFractions;
use palpate_volume::voxel_box::VoxelBox;

use crate::touch::scan_values::Threshold;

/// A segment that can be touched.
#[derive(Clone, Debug)]
pub struct Part {
    /// Which segment.
    pub id: SegmentId,
    /// Its voxels.
    pub bits: Bits,
    /// Where it was moved; none where it stands in the scan.
    pub moved: Option<MovedPart>,
    /// The threshold that made them, whatever edits did since; none where they come from
    /// elsewhere.
    pub threshold: Option<Threshold>,
    /// How much of its voxels at the surface is solid, as far as that was worked out from them.
    pub fractions: Option<Arc<OccupancyFractions>>,
    /// Whether a needle is in it: then it is no obstacle.
    pub punctured: bool,
    /// Where it is rigid although it is deformable; none where it is deformable everywhere.
    pub rigid: Option<Bits>,
}

/// Where a segment stands that was moved, or that has a grid of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovedPart {
    /// The grid of its voxels, where it is not the scan's.
    pub own_grid: Option<Grid>,
    /// A box that holds its voxels.
    pub bounds: VoxelBox,
    /// From the scan to the scene [mm], a rigid motion that was checked.
    pub pose: DAffine3,
}

impl MovedPart {
    /// The grid of its voxels.
    #[must_use]
    pub fn grid<'a>(&'a self, scan: &'a Grid) -> &'a Grid {
        self.own_grid.as_ref().unwrap_or(scan)
    }
}
