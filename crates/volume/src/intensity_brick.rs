//! 8×8×8 stored values: the unit in which an overlay keeps what voxel edits changed.
//!
//! Memory: i16, x fastest, then y, then z; 1 KiB. Values beyond the border of a grid are 0.

use glam::IVec3;

use crate::brick_grid::BRICK;

/// One stored value per voxel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IntensityBrick(pub [i16; 512]);

impl IntensityBrick {
    /// Every value is 0.
    pub const ZERO: Self = Self([0; 512]);

    /// Stored value of a voxel; only the low three bits of each number count, so grid
    /// voxels may be given as they are.
    #[inline]
    pub fn stored(&self, voxel: IVec3) -> i16 {
        self.0[place(voxel)]
    }

    /// Writes a stored value; see [`Self::stored`] for which voxel is meant.
    #[inline]
    pub fn set(&mut self, voxel: IVec3, stored: i16) {
        self.0[place(voxel)] = stored;
    }
}

#[inline]
fn place(voxel: IVec3) -> usize {
    let [x, y, z] = (voxel & (BRICK - 1)).to_array();
    (((z << 3) | y) << 3 | x) as usize
}
