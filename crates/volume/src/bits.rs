//! Which voxels of a segment are solid, and nothing else: what the servo reads and swaps.
//!
//! Memory: see `brick_grid.rs` and `bit_brick.rs`. Empty bricks are not stored, full ones
//! are one shared brick.

use std::sync::Arc;

use glam::{IVec3, UVec3};
use rayon::prelude::*;

use crate::bit_brick::{BitBrick, FIRST_COLUMN};
use crate::brick_grid::{BRICK, BrickGrid, BrickSwap};
use crate::grid::{check_dimensions, is_inside};
use crate::voxel_box::VoxelBox;

/// One bit per voxel of a grid.
#[derive(Clone, Debug)]
pub struct Bits {
    dimensions: UVec3,
    bricks: BrickGrid<BitBrick>,
}

impl Bits {
    /// Bits without solid voxels.
    pub fn empty(dimensions: UVec3) -> Self {
        let dimensions = checked(dimensions);
        Self {
            dimensions,
            bricks: BrickGrid::empty(dimensions),
        }
    }

    /// Makes every brick from its voxels, cut at the border, in parallel.
    pub fn from_bricks(dimensions: UVec3, make: impl Fn(VoxelBox) -> BitBrick + Sync) -> Self {
        let bounds = VoxelBox::of_dimensions(checked(dimensions));
        Self {
            dimensions,
            bricks: BrickGrid::from_fn(dimensions, |voxels| {
                make(voxels.intersect(&bounds)).shared()
            }),
        }
    }

    /// The same grid with other bricks in the place of those that there are, made in parallel from
    /// each and its voxels, which may reach beyond the border.
    #[must_use]
    pub fn with_bricks(
        &self,
        make: impl Fn(&Arc<BitBrick>, &VoxelBox) -> Option<Arc<BitBrick>> + Sync,
    ) -> Self {
        Self {
            dimensions: self.dimensions,
            bricks: self.bricks.with_bricks(make),
        }
    }

    /// Voxels along x, y and z.
    pub fn dimensions(&self) -> UVec3 {
        self.dimensions
    }

    /// The bricks.
    pub fn bricks(&self) -> &BrickGrid<BitBrick> {
        &self.bricks
    }

    /// Whether a voxel is solid; outside the grid none is.
    #[inline]
    pub fn is_solid(&self, voxel: IVec3) -> bool {
        // near a surface, half of the bricks do not exist: reading an empty one instead is
        // quicker than a branch that the processor cannot guess
        is_inside(self.dimensions, voxel)
            && self
                .bricks
                .at(voxel)
                .unwrap_or(&BitBrick::EMPTY)
                .contains(voxel)
    }

    /// Whether no voxel is solid of those from `low` to `high`, both among them; both must lie in the
    /// grid.
    #[inline]
    pub fn is_free(&self, low: IVec3, high: IVec3) -> bool {
        let [first, last] = [low >> 3_i32, high >> 3_i32];
        for z in first.z..=last.z {
            let layers = ends(z, low.z, high.z);
            for y in first.y..=last.y {
                let rows = span(8, ends(y, low.y, high.y));
                for x in first.x..=last.x {
                    let Some(brick) = self.bricks.at(BRICK * IVec3::new(x, y, z)) else {
                        continue;
                    };
                    let columns = span(1, ends(x, low.x, high.x)) * FIRST_COLUMN;
                    let words = brick.0[layers[0]..=layers[1]].iter();
                    if words.fold(0, |all, word| all | word) & rows & columns != 0 {
                        return false;
                    }
                }
            }
        }
        true
    }

    /// Exchanges one brick; see [`BrickGrid::swap`].
    #[inline]
    pub fn swap(&mut self, swap: &mut BrickSwap<BitBrick>) {
        self.bricks.swap(swap);
    }

    /// The bytes that this object holds, shared bricks included, the one full brick not.
    pub fn memory_bytes(&self) -> usize {
        // a brick's two counters fill a cache line of their own
        const BRICK_BYTES: usize = 2 * size_of::<BitBrick>();
        let directory = size_of_val(self.bricks.entries());
        let own = self
            .bricks
            .entries()
            .par_iter()
            .flatten()
            .filter(|brick| !BitBrick::is_shared_full(brick))
            .count();
        directory + own * BRICK_BYTES
    }

    /// A box that holds all voxels that differ from `other`, cut at the border.
    pub fn difference(&self, other: &Self) -> VoxelBox {
        assert_eq!(self.dimensions, other.dimensions, "bits of two grids");
        (0..self.bricks.len() as u32)
            .into_par_iter()
            .map(|index| {
                let [ours, theirs] = [self, other].map(|bits| bits.bricks.get(index));
                let same = match (ours, theirs) {
                    (Some(ours), Some(theirs)) => Arc::ptr_eq(ours, theirs),
                    (ours, theirs) => ours.is_none() && theirs.is_none(),
                };
                if same {
                    return VoxelBox::EMPTY;
                }
                let [ours, theirs] =
                    [ours, theirs].map(|brick| brick.map_or(BitBrick::EMPTY, |brick| **brick));
                moved(ours.difference(&theirs), self.bricks.box_of(index).min)
            })
            .reduce(|| VoxelBox::EMPTY, |a, b| a.union(&b))
    }
}

/// The first and the last voxel along one axis of what a brick has of `low` to `high`, 0..=7.
#[inline]
fn ends(brick: i32, low: i32, high: i32) -> [usize; 2] {
    let inside = |voxel: i32| (voxel - BRICK * brick).clamp(0, BRICK - 1) as usize;
    [inside(low), inside(high)]
}

/// The bits of a word in such groups, from the first to the last of them.
#[inline]
fn span(group: usize, [first, last]: [usize; 2]) -> u64 {
    let whole = !0_u64 >> (64 - 8 * group);
    let up_to_last = whole >> (group * (7 - last));
    up_to_last >> (group * first) << (group * first)
}

/// A box moved by `by`; an empty one stays where it is.
pub(crate) fn moved(voxels: VoxelBox, by: IVec3) -> VoxelBox {
    if voxels.is_empty() {
        return VoxelBox::EMPTY;
    }
    VoxelBox::new(voxels.min + by, voxels.max + by)
}

/// Dimensions come from a `Grid`, which has refused all others.
fn checked(dimensions: UVec3) -> UVec3 {
    assert_eq!(check_dimensions(dimensions), Ok(()), "not those of a grid");
    dimensions
}
