//! Cells of voxels: what a window is counted in.

use glam::{DVec3, IVec3};
use std::f64::consts::SQRT_2;

/// Cells along each axis of a window.
pub(crate) const CELLS: i32 = 8;
/// Words of 64 voxels in the largest window, of cells of 4×4×1 voxels.
pub(super) const MAX_WORDS: usize = 128;

/// How many voxels a cell has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CellShape {
    /// Along each axis, as a power of two: 0, 1 or 2.
    pub(super) log: [u32; 3],
}

impl CellShape {
    /// One voxel.
    pub(crate) const ONE: Self = Self { log: [0; 3] };

    /// Cells as near to cubes as powers of two get them: two voxels along the finest axis, or
    /// as long as a voxel of the coarsest where that is more. So none has more than 16 voxels.
    pub(crate) fn for_spacing(spacing: DVec3) -> Self {
        let length = spacing.max_element().max(2.0 * spacing.min_element());
        // the power of two next to a ratio, without a logarithm
        let log = |spacing: f64| {
            let ratio = length / spacing;
            u32::from(ratio >= SQRT_2) + u32::from(ratio >= 2.0 * SQRT_2)
        };
        Self {
            log: spacing.to_array().map(log),
        }
    }

    /// Voxels along each axis of a cell.
    pub(crate) fn voxels(self) -> IVec3 {
        IVec3::from_array(self.log.map(|log| 1 << log))
    }

    /// The cell, by its number, that holds a place in half voxels.
    pub(crate) fn cell_of_half(self, halves: IVec3) -> IVec3 {
        let [x, y, z] = self.log;
        IVec3::new(
            halves.x >> (x + 1),
            halves.y >> (y + 1),
            halves.z >> (z + 1),
        )
    }

    /// Voxels of a cell.
    pub(crate) fn volume(self) -> u16 {
        1 << self.log.iter().sum::<u32>()
    }

    /// Voxels along x of a window, as a power of two.
    pub(super) fn log_width(self) -> u32 {
        3 + self.log[0]
    }

    /// Words of a layer.
    pub(super) fn layer(self) -> usize {
        1 << (self.log[0] + self.log[1])
    }

    /// Layers.
    pub(super) fn layers(self) -> usize {
        8 << self.log[2]
    }

    /// Words of a window.
    pub(super) fn words(self) -> usize {
        (self.layer() * self.layers()).min(MAX_WORDS)
    }
}
