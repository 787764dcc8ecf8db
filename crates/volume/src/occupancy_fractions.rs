//! How much of each voxel at the surface of a segment is solid, where that is known.
//!
//! Bits tell which voxels are solid; where the surface goes through them, fractions tell. They are
//! stored in sparse bricks of bytes, like bits, and are touched only together with them: a fraction
//! that disagrees with the bit of its voxel is no fraction.
//!
//! Memory: a byte for each voxel, x fastest; 0 where nothing is known, else 1 + 252 times the
//! fraction, so that quarters are whole. Frame: grid.

use glam::{IVec3, UVec3};

use crate::brick_grid::{BRICK, BrickGrid, BrickSwap};
use crate::grid::is_inside;

/// Bytes of a fraction of 0 and of one of 1.
const LEAST: f32 = 1.0;
const STEPS: f32 = 252.0;
/// The byte of one half: solid voxels have no less, free ones no more.
const HALF: u8 = 127;

/// Occupancy fractions of 8×8×8 voxels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FractionBrick(pub [u8; 512]);

impl FractionBrick {
    /// A brick in which no fraction is known.
    pub const UNKNOWN: Self = Self([0; 512]);

    /// The byte of a voxel; only the low three bits of each number count.
    #[inline]
    pub fn byte(&self, voxel: IVec3) -> u8 {
        self.0[place(voxel)]
    }

    /// Writes the byte of a voxel.
    #[inline]
    pub fn set(&mut self, voxel: IVec3, byte: u8) {
        self.0[place(voxel)] = byte;
    }
}

/// A fraction as it is stored, of a voxel that is solid or free: at least ½ or at most ½.
#[inline]
pub fn byte_of(fraction: f32, solid: bool) -> u8 {
    let byte = (LEAST + STEPS * fraction.clamp(0.0, 1.0)).round() as u8;
    if solid {
        byte.max(HALF)
    } else {
        byte.min(HALF)
    }
}

/// The fraction that is stored, if it agrees with what the voxel is.
#[inline]
pub fn fraction_of(byte: u8, solid: bool) -> Option<f32> {
    let agrees = if solid { byte >= HALF } else { byte <= HALF };
    (byte != 0 && agrees).then_some((f32::from(byte) - LEAST) * (1.0 / STEPS))
}

/// The fractions of a segment.
#[derive(Clone, Debug)]
pub struct OccupancyFractions {
    dimensions: UVec3,
    bricks: BrickGrid<FractionBrick>,
}

impl OccupancyFractions {
    /// No fraction is known, in a grid of these dimensions.
    pub fn unknown(dimensions: UVec3) -> Self {
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
    pub fn bricks(&self) -> &BrickGrid<FractionBrick> {
        &self.bricks
    }

    /// The byte of a voxel; 0 outside the grid.
    #[inline]
    pub fn byte(&self, voxel: IVec3) -> u8 {
        if !is_inside(self.dimensions, voxel) {
            return 0;
        }
        self.bricks.at(voxel).map_or(0, |brick| brick.byte(voxel))
    }

    /// The fraction of a voxel that is solid or free; none where it is not known.
    #[inline]
    pub fn fraction(&self, voxel: IVec3, solid: bool) -> Option<f32> {
        fraction_of(self.byte(voxel), solid)
    }

    /// The fraction of a voxel, whatever it is; none where it is not known.
    pub fn any_fraction(&self, voxel: IVec3) -> Option<f32> {
        let byte = self.byte(voxel);
        fraction_of(byte, byte >= HALF)
    }

    /// Exchanges one brick; see [`BrickGrid::swap`].
    #[inline]
    pub fn swap(&mut self, swap: &mut BrickSwap<FractionBrick>) {
        self.bricks.swap(swap);
    }

    /// The bytes that this object holds, shared bricks included.
    pub fn memory_bytes(&self) -> usize {
        let entries = self.bricks.entries();
        let own = entries.iter().flatten().count();
        size_of_val(entries) + own * (size_of::<FractionBrick>() + 2 * size_of::<usize>())
    }
}

#[inline]
fn place(voxel: IVec3) -> usize {
    let [x, y, z] = (voxel & (BRICK - 1)).to_array();
    (((z << 3) | y) << 3 | x) as usize
}
