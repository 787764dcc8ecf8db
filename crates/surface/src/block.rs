//! The blocks into which a grid is parted, and the patches that one of them holds.
//!
//! Blocks are a function of the grid and the step only. A cell stands between eight samples, so
//! the first block along an axis has one more cell: the one before the first sample, which closes
//! the surface at the border.

use glam::{IVec3, UVec3};
use palpate_volume::voxel_box::VoxelBox;

use crate::samples::sample_count;
use crate::settings::{PATCH_CELLS, SurfaceSettings};

/// Which patch of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PatchId {
    /// Number of the block along x, y and z.
    pub block: [u16; 3],
    /// 0 for all of the block, 1 to 8 for its octants.
    pub part: u8,
}

/// Octants of a block.
pub(crate) const PARTS: u8 = 8;

/// The blocks of a grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Blocks {
    samples: IVec3,
    count: IVec3,
}

impl Blocks {
    pub(crate) fn new(dimensions: UVec3, step: i32) -> Self {
        let samples = sample_count(dimensions, step);
        Self {
            samples,
            count: (samples + (PATCH_CELLS - 1)) / PATCH_CELLS,
        }
    }

    /// The blocks whose patches can change with the voxels of a box.
    pub(crate) fn touched_by(&self, dirty: VoxelBox, settings: &SurfaceSettings) -> Vec<IVec3> {
        let step = i32::from(settings.step);
        let grid = VoxelBox::new(IVec3::ZERO, self.samples * step);
        let dirty = dirty.intersect(&grid);
        if dirty.is_empty() {
            return Vec::new();
        }
        // a block sees its own samples, 32 b to 32 b + 32, and so many more on each side
        let reach = settings.reach();
        let size = IVec3::splat(PATCH_CELLS);
        let first = (dirty.min / step - reach - 1).div_euclid(size);
        let last = ((dirty.max - 1) / step + reach).div_euclid(size);
        let all = VoxelBox::new(IVec3::ZERO, self.count);
        VoxelBox::new(first, last + 1)
            .intersect(&all)
            .voxels()
            .collect()
    }

    /// Whether a block or one of its octants can change with the voxels of a box.
    pub(crate) fn is_touched(
        &self,
        block: IVec3,
        part: u8,
        dirty: VoxelBox,
        settings: &SurfaceSettings,
    ) -> bool {
        let Some(own) = self.samples_of(block, part) else {
            return false;
        };
        let (step, seen) = (i32::from(settings.step), own.dilate(settings.reach()));
        let seen = VoxelBox::new(seen.min * step, seen.max * step);
        !seen.intersect(&dirty).is_empty()
    }

    /// The samples between which a block or one of its octants makes the surface; none where an
    /// octant lies beyond the border.
    pub(crate) fn samples_of(&self, block: IVec3, part: u8) -> Option<VoxelBox> {
        let start = block * PATCH_CELLS;
        let end = (start + PATCH_CELLS).min(self.samples);
        let first = start - IVec3::from(block.cmpeq(IVec3::ZERO));
        let (mut cells, middle) = (VoxelBox::new(first, end), start + PATCH_CELLS / 2);
        if let Some(octant) = part.checked_sub(1) {
            for axis in 0..3 {
                if octant >> axis & 1 == 0 {
                    cells.max[axis] = cells.max[axis].min(middle[axis]);
                } else {
                    cells.min[axis] = middle[axis];
                }
            }
        }
        (!cells.is_empty()).then(|| VoxelBox::new(cells.min, cells.max + 1))
    }
}

/// The name of a patch.
pub(crate) fn patch_id(block: IVec3, part: u8) -> PatchId {
    PatchId {
        block: block.to_array().map(|number| number as u16),
        part,
    }
}
