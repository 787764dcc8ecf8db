//! The cells of a level around the surface, numbered, each with its neighbours.

use glam::IVec3;

use super::faces::AXES;
use crate::voxel_box::VoxelBox;

/// No cell.
pub(super) const NONE: u32 = u32::MAX;

/// Cells in a box.
#[derive(Clone, Debug)]
pub(super) struct Band {
    region: VoxelBox,
    /// The number of each cell of the box, x fastest.
    numbers: Vec<u32>,
    /// The cells by their number.
    pub(super) cells: Vec<IVec3>,
    /// For each cell the numbers of those before and after it along x, y and z.
    pub(super) neighbours: Vec<[u32; 6]>,
}

impl Band {
    /// All cells of a box that are these or touch one of them, at a corner too.
    pub(super) fn around(region: VoxelBox, cells: impl Iterator<Item = IVec3>) -> Self {
        let mut band = Self {
            region,
            numbers: vec![NONE; region.voxel_count() as usize],
            cells: Vec::new(),
            neighbours: Vec::new(),
        };
        let mut last = IVec3::MAX;
        for cell in cells {
            // faces of one cell come one after the other
            if cell != last {
                band.mark_around(cell);
                last = cell;
            }
        }
        for (place, cell) in region.voxels().enumerate() {
            if band.numbers[place] != NONE {
                band.numbers[place] = band.cells.len() as u32;
                band.cells.push(cell);
            }
        }
        let beside = |&cell: &IVec3| {
            let [x, y, z] = AXES.map(|axis| [band.number(cell - axis), band.number(cell + axis)]);
            [x[0], x[1], y[0], y[1], z[0], z[1]]
        };
        band.neighbours = band.cells.iter().map(beside).collect();
        band
    }

    /// The number of a cell, or [`NONE`].
    #[inline]
    pub(super) fn number(&self, cell: IVec3) -> u32 {
        if !self.region.contains(cell) {
            return NONE;
        }
        self.numbers[self.place(cell)]
    }

    fn mark_around(&mut self, cell: IVec3) {
        let near = VoxelBox::of_voxel(cell).dilate(1).intersect(&self.region);
        for cell in near.voxels() {
            let place = self.place(cell);
            self.numbers[place] = 0;
        }
    }

    #[inline]
    fn place(&self, cell: IVec3) -> usize {
        let at = (cell - self.region.min).as_uvec3().as_usizevec3();
        let size = self.region.size().as_usizevec3();
        (at.z * size.y + at.y) * size.x + at.x
    }
}
