//! 8×8×8 voxels as bits: the unit in which segments are stored, shared and swapped.
//!
//! Memory: one word per z, bit y·8 + x, so a brick is one cache line of 64 bytes. Bits
//! beyond the border of a grid are always clear. Bricks are never changed once shared.

use std::sync::{Arc, LazyLock};

use glam::{IVec3, UVec3};

use crate::brick_grid::BRICK;
use crate::voxel_box::VoxelBox;

/// One bit per voxel, set where solid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(align(64))]
pub struct BitBrick(pub [u64; 8]);

/// The one full brick that all segments share.
static FULL: LazyLock<Arc<BitBrick>> = LazyLock::new(|| Arc::new(BitBrick::FULL));

/// Bit x = 0 of every row.
pub(crate) const FIRST_COLUMN: u64 = 0x0101_0101_0101_0101;

/// Solid voxels on each of the eight planes of a brick, per axis.
pub(crate) type PlaneCounts = [[u8; 8]; 3];

impl BitBrick {
    /// A brick without solid voxels.
    pub const EMPTY: Self = Self([0; 8]);

    /// Every voxel is solid.
    pub const FULL: Self = Self([!0; 8]);

    /// Solid in the corner of `size` voxels, each 1 to 8: a full brick cut by the border.
    pub fn filled(size: UVec3) -> Self {
        Self::from_fn(size, |_| true)
    }

    /// Asks for each voxel of the corner of `size` voxels, given from the brick's corner.
    pub fn from_fn(size: UVec3, mut solid: impl FnMut(IVec3) -> bool) -> Self {
        let mut brick = Self::EMPTY;
        for offset in VoxelBox::of_dimensions(size).voxels() {
            brick.set(offset, solid(offset));
        }
        brick
    }

    /// Whether the voxel is solid; only the low three bits of each number count, so grid
    /// voxels may be given as they are.
    #[inline]
    pub fn contains(&self, voxel: IVec3) -> bool {
        self.0[(voxel.z & 7) as usize] >> bit(voxel) & 1 != 0
    }

    /// Makes the voxel solid or free; see [`Self::contains`] for which one is meant.
    #[inline]
    pub fn set(&mut self, voxel: IVec3, solid: bool) {
        let word = &mut self.0[(voxel.z & 7) as usize];
        *word = *word & !(1 << bit(voxel)) | u64::from(solid) << bit(voxel);
    }

    /// Number of solid voxels.
    pub fn count(&self) -> u32 {
        self.0.iter().map(|word| word.count_ones()).sum()
    }

    /// The brick as a directory keeps it: none where empty, the shared one where full.
    pub fn shared(self) -> Option<Arc<Self>> {
        match self {
            Self::EMPTY => None,
            Self::FULL => Some(Arc::clone(&FULL)),
            _ => Some(Arc::new(self)),
        }
    }

    /// Whether this is the shared full brick, which costs a segment no memory.
    pub fn is_shared_full(brick: &Arc<Self>) -> bool {
        Arc::ptr_eq(brick, &FULL)
    }

    /// The smallest box, from the brick's corner, of all voxels that differ.
    pub fn difference(&self, other: &Self) -> VoxelBox {
        let words: [u64; 8] = std::array::from_fn(|z| self.0[z] ^ other.0[z]);
        let plane = words.iter().fold(0, |all, word| all | word);
        if plane == 0 {
            return VoxelBox::EMPTY;
        }
        let row = (0..8).fold(0, |all, y| all | (plane >> (8 * y)) as u8);
        let layers = (0..8).fold(0u8, |all, z| all | u8::from(words[z] != 0) << z);
        VoxelBox::new(
            IVec3::new(
                row.trailing_zeros() as i32,
                plane.trailing_zeros() as i32 / BRICK,
                layers.trailing_zeros() as i32,
            ),
            IVec3::new(
                BRICK - row.leading_zeros() as i32,
                BRICK - plane.leading_zeros() as i32 / BRICK,
                BRICK - layers.leading_zeros() as i32,
            ),
        )
    }

    /// Solid voxels per plane of each axis.
    pub(crate) fn plane_counts(&self) -> PlaneCounts {
        // rows of eight bits are counted side by side, at most 64 in a byte
        let rows = self.0.map(ones_per_byte);
        let y = rows.iter().sum::<u64>().to_le_bytes();
        let z = rows.map(sum_of_bytes);
        let x = std::array::from_fn(|x| {
            let column = self.0.iter().map(|word| word >> x & FIRST_COLUMN);
            sum_of_bytes(column.sum())
        });
        [x, y, z]
    }
}

/// Place of a voxel in its word.
#[inline]
fn bit(voxel: IVec3) -> u32 {
    ((voxel.y & 7) << 3 | voxel.x & 7) as u32
}

/// Set bits of each byte, in that byte (Warren, "Hacker's Delight", 2nd ed. (2012), 5-1).
fn ones_per_byte(word: u64) -> u64 {
    let pairs = word - (word >> 1 & 0x5555_5555_5555_5555);
    let fours = (pairs & 0x3333_3333_3333_3333) + (pairs >> 2 & 0x3333_3333_3333_3333);
    (fours + (fours >> 4)) & 0x0f0f_0f0f_0f0f_0f0f
}

/// Sum of all bytes; it must stay below 256.
fn sum_of_bytes(word: u64) -> u8 {
    (word.wrapping_mul(FIRST_COLUMN) >> 56) as u8
}
