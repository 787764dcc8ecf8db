//! A segment: the voxels of one structure, with their count and bounding box.
//!
//! The occupancy is separable, so that the servo can keep a clone of it and swap bricks
//! there without counting. Most segments are parts of a scan and stand on its grid; one that was
//! made of a mesh may have a grid of its own, finer than the scan's and beyond its border.
//! Frame: the segment's grid.

use glam::{IVec3, UVec3};
use rayon::prelude::*;
use thiserror::Error;

use crate::bit_brick::BitBrick;
use crate::bits::Bits;
use crate::brick_grid::{BRICK, BrickSwap};
use crate::grid::{Grid, GridError, check_dimensions, voxel_count, voxel_index};
use crate::statistics::Statistics;
use crate::voxel_box::VoxelBox;

/// A mask that is no segment.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum SegmentError {
    /// Not one byte per voxel.
    #[error("{given} mask values given for a grid of {dimensions}; allowed: {allowed}")]
    MaskLength {
        /// Values in the mask.
        given: usize,
        /// Voxels of the grid.
        allowed: usize,
        /// Voxels along each axis.
        dimensions: UVec3,
    },
    /// The dimensions are those of no grid.
    #[error(transparent)]
    Grid(#[from] GridError),
}

/// What is known of a box of voxels without asking for each of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coverage {
    /// No voxel is solid.
    Empty,
    /// All voxels are solid.
    Full,
    /// Some voxels are solid: each must be asked for.
    Mixed,
}

/// The solid voxels of one structure. A clone shares the bricks.
#[derive(Clone, Debug)]
pub struct Segment {
    occupancy: Bits,
    statistics: Statistics,
    own_grid: Option<Box<Grid>>,
}

impl Segment {
    /// A segment without solid voxels.
    pub fn empty(dimensions: UVec3) -> Self {
        Self::from_bits(Bits::empty(dimensions))
    }

    /// Counts bits that are there already.
    pub fn from_bits(occupancy: Bits) -> Self {
        let statistics = Statistics::of_bricks(occupancy.bricks());
        Self {
            occupancy,
            statistics,
            own_grid: None,
        }
    }

    /// The same voxels on a grid of their own instead of a scan's.
    ///
    /// # Panics
    /// Where the grid has other dimensions.
    #[must_use]
    pub fn on_grid(self, grid: Grid) -> Self {
        assert_eq!(
            grid.dimensions(),
            self.dimensions(),
            "voxels of another grid"
        );
        Self {
            own_grid: Some(Box::new(grid)),
            ..self
        }
    }

    /// The grid of its own, if it has one.
    pub fn own_grid(&self) -> Option<&Grid> {
        self.own_grid.as_deref()
    }

    /// The grid that it stands on: its own, or that of its scan.
    pub fn grid<'a>(&'a self, scan: &'a Grid) -> &'a Grid {
        self.own_grid.as_deref().unwrap_or(scan)
    }

    /// The voxels that `wanted` accepts, on the same grid; asked in parallel.
    #[must_use]
    pub fn part(&self, wanted: impl Fn(IVec3) -> bool + Sync) -> Self {
        let solid = |voxel| self.contains(voxel) && wanted(voxel);
        Self {
            own_grid: self.own_grid.clone(),
            ..Self::from_fn(self.dimensions(), solid)
        }
    }

    /// Asks for every voxel, in parallel.
    pub fn from_fn(dimensions: UVec3, solid: impl Fn(IVec3) -> bool + Sync) -> Self {
        Self::from_bounds(dimensions, |_| Coverage::Mixed, solid)
    }

    /// Asks brick by brick, in parallel, and for single voxels only where a brick is mixed.
    pub fn from_bounds(
        dimensions: UVec3,
        coverage: impl Fn(VoxelBox) -> Coverage + Sync,
        solid: impl Fn(IVec3) -> bool + Sync,
    ) -> Self {
        Self::from_bits(Bits::from_bricks(dimensions, |voxels| {
            match coverage(voxels) {
                Coverage::Empty => BitBrick::EMPTY,
                Coverage::Full => BitBrick::filled(voxels.size()),
                Coverage::Mixed => {
                    BitBrick::from_fn(voxels.size(), |offset| solid(voxels.min + offset))
                }
            }
        }))
    }

    /// Takes a mask, x fastest, solid where not zero.
    ///
    /// # Errors
    /// Where the mask does not have one value per voxel.
    pub fn from_mask(dimensions: UVec3, mask: &[u8]) -> Result<Self, SegmentError> {
        check_dimensions(dimensions)?;
        let allowed = voxel_count(dimensions);
        if mask.len() != allowed {
            return Err(SegmentError::MaskLength {
                given: mask.len(),
                allowed,
                dimensions,
            });
        }
        Ok(Self::from_fn(dimensions, |voxel| {
            mask[voxel_index(dimensions, voxel)] != 0
        }))
    }

    /// Voxels along x, y and z.
    pub fn dimensions(&self) -> UVec3 {
        self.occupancy.dimensions()
    }

    /// The bits alone, for touch.
    pub fn occupancy(&self) -> &Bits {
        &self.occupancy
    }

    /// Whether a voxel is solid; outside the grid none is.
    #[inline]
    pub fn contains(&self, voxel: IVec3) -> bool {
        self.occupancy.is_solid(voxel)
    }

    /// Solid voxels.
    pub fn count(&self) -> u64 {
        self.statistics.count()
    }

    /// The smallest box that holds every solid voxel; none where nothing is solid.
    pub fn bounding_box(&self) -> Option<VoxelBox> {
        self.statistics.bounding_box()
    }

    /// The bytes that it holds, including bricks that clones share.
    pub fn memory_bytes(&self) -> usize {
        self.occupancy.memory_bytes() + self.statistics.memory_bytes()
    }

    /// Exchanges bricks and follows them with count and box; `swaps` then hold the inverse.
    pub fn swap(&mut self, swaps: &mut [BrickSwap<BitBrick>]) {
        for swap in swaps {
            let bricks = self.occupancy.bricks();
            let old = bricks.get(swap.index).map(|brick| **brick);
            let corner = bricks.box_of(swap.index).min;
            self.statistics
                .exchange(corner, old.as_ref(), swap.brick.as_deref());
            self.occupancy.swap(swap);
        }
    }

    /// One byte per voxel, x fastest: 1 where solid.
    pub fn mask(&self) -> Vec<u8> {
        let mut mask = vec![0; voxel_count(self.dimensions())];
        self.paint(&mut mask, 1);
        mask
    }

    /// Writes `value` wherever this segment is solid into one byte per voxel, x fastest.
    ///
    /// # Panics
    /// Where `labels` does not have one byte per voxel.
    pub fn paint(&self, labels: &mut [u8], value: u8) {
        let dimensions = self.dimensions();
        assert_eq!(
            labels.len(),
            voxel_count(dimensions),
            "labels of another grid"
        );
        let bricks = self.occupancy.bricks();
        let bounds = VoxelBox::of_dimensions(dimensions);
        let layer = voxel_count(UVec3::new(dimensions.x, dimensions.y, BRICK as u32));
        labels
            .par_chunks_mut(layer)
            .enumerate()
            .for_each(|(layer, labels)| {
                let first = layer as i32 * BRICK;
                let slab = VoxelBox::new(
                    IVec3::new(0, 0, first),
                    dimensions.as_ivec3().with_z(first + BRICK),
                );
                for index in bricks.indices_in(&slab) {
                    let Some(brick) = bricks.get(index) else {
                        continue;
                    };
                    for voxel in bricks.box_of(index).intersect(&bounds).voxels() {
                        if brick.contains(voxel) {
                            let place = voxel - IVec3::new(0, 0, first);
                            labels[voxel_index(dimensions, place)] = value;
                        }
                    }
                }
            });
    }
}
