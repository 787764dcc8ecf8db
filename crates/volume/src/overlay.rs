//! Stored values that voxel edits have put over those of the scan.
//!
//! Memory: see `brick_grid.rs`; a brick holds all of its voxels, changed or not. Where
//! there is none, the scan shows through.

use glam::{IVec3, UVec3};

use crate::brick_grid::{BrickGrid, BrickSwap};
use crate::grid::is_inside;
use crate::intensities::Intensities;
use crate::intensity_brick::IntensityBrick;
use crate::voxel_box::VoxelBox;

/// Sparse values over a scan. A clone shares the bricks.
#[derive(Clone, Debug)]
pub struct Overlay {
    dimensions: UVec3,
    bricks: BrickGrid<IntensityBrick>,
}

impl Overlay {
    /// An overlay that changes nothing.
    pub fn empty(dimensions: UVec3) -> Self {
        Self {
            dimensions,
            bricks: BrickGrid::empty(dimensions),
        }
    }

    /// Voxels along x, y and z.
    pub fn dimensions(&self) -> UVec3 {
        self.dimensions
    }

    /// The bricks.
    pub fn bricks(&self) -> &BrickGrid<IntensityBrick> {
        &self.bricks
    }

    /// Stored value over `scan`; none outside the grid.
    pub fn stored(&self, scan: &Intensities, voxel: IVec3) -> Option<i16> {
        if !is_inside(self.dimensions, voxel) {
            return None;
        }
        match self.bricks.at(voxel) {
            Some(brick) => Some(brick.stored(voxel)),
            None => scan.stored(voxel),
        }
    }

    /// A copy of one brick as it shows, from the overlay or from the scan.
    pub fn brick(&self, scan: &Intensities, index: u32) -> IntensityBrick {
        if let Some(brick) = self.bricks.get(index) {
            return IntensityBrick::clone(brick);
        }
        let bounds = VoxelBox::of_dimensions(self.dimensions);
        let mut brick = IntensityBrick::ZERO;
        for voxel in self.bricks.box_of(index).intersect(&bounds).voxels() {
            brick.set(voxel, scan.stored(voxel).unwrap_or_default());
        }
        brick
    }

    /// Exchanges one brick; see [`BrickGrid::swap`].
    pub fn swap(&mut self, swap: &mut BrickSwap<IntensityBrick>) {
        self.bricks.swap(swap);
    }

    /// The bytes that it holds, including bricks that clones share.
    pub fn memory_bytes(&self) -> usize {
        // a brick is kept with two counters
        const BRICK_BYTES: usize = size_of::<IntensityBrick>() + 2 * size_of::<usize>();
        let own = self.bricks.entries().iter().flatten().count();
        size_of_val(self.bricks.entries()) + own * BRICK_BYTES
    }
}
