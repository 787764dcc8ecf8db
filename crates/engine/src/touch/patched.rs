//! Voxels as they would be with some bricks exchanged.
//!
//! Frame: grid.

use glam::IVec3;
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::block::block_of_bricks;
use palpate_volume::brick_grid::{BRICK, BrickSwap};
use palpate_volume::occupancy::Occupancy;

/// Bits, and bricks that stand in the place of theirs.
#[derive(Clone, Copy, Debug)]
pub struct Patched<'a> {
    base: &'a Bits,
    /// By rising index.
    swaps: &'a [BrickSwap<BitBrick>],
}

impl<'a> Patched<'a> {
    /// These bits with these bricks, by rising index.
    #[must_use]
    pub fn new(base: &'a Bits, swaps: &'a [BrickSwap<BitBrick>]) -> Self {
        Self { base, swaps }
    }

    /// The brick that holds a voxel; none where nothing of it is solid.
    fn brick(&self, voxel: IVec3) -> Option<&'a BitBrick> {
        let dimensions = self.base.dimensions().as_ivec3();
        if voxel.cmplt(IVec3::ZERO).any() || voxel.cmpge(dimensions).any() {
            return None;
        }
        let place = place_of(self.swaps, brick_index(self.base, voxel));
        match place.and_then(|place| self.swaps.get(place)) {
            Some(swap) => swap.brick.as_deref(),
            None => self.base.bricks().at(voxel),
        }
    }
}

impl Occupancy for Patched<'_> {
    fn is_solid(&self, voxel: IVec3) -> bool {
        self.brick(voxel).is_some_and(|brick| brick.contains(voxel))
    }

    fn block(&self, min: IVec3) -> BitBrick {
        block_of_bricks(min, |corner| {
            self.brick(corner).copied().unwrap_or(BitBrick::EMPTY)
        })
    }
}

/// Where the brick of this index is among swaps by rising index.
#[must_use]
pub fn place_of<B>(swaps: &[BrickSwap<B>], index: u32) -> Option<usize> {
    swaps.binary_search_by_key(&index, |swap| swap.index).ok()
}

/// Place in the directory of the brick that holds a voxel of the grid.
fn brick_index(bits: &Bits, voxel: IVec3) -> u32 {
    let size = bits.bricks().size();
    let brick = (voxel / BRICK).as_uvec3();
    (brick.z * size.y + brick.y) * size.x + brick.x
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::UVec3;

    use super::*;

    #[test]
    fn blocks_of_a_patch_hold_what_single_questions_find() {
        // dimensions that are no multiples of a brick
        let base = Bits::from_bricks(UVec3::new(21, 17, 13), |voxels| {
            BitBrick::from_fn(voxels.size(), |v| (v.x * 5 + v.y * 3 + v.z * 7) % 4 == 0)
        });
        let swap = |index, brick| BrickSwap { index, brick };
        let swaps = [
            swap(0, None),
            swap(4, Some(Arc::new(BitBrick([0x1234_5678_9abc_def0; 8])))),
        ];
        let patched = Patched::new(&base, &swaps);
        assert_ne!(patched.block(IVec3::ZERO), base.block(IVec3::ZERO));
        for min in [IVec3::splat(-3), IVec3::new(5, 2, 1), IVec3::new(8, 8, 0)] {
            let plainly =
                BitBrick::from_fn(UVec3::splat(8), |offset| patched.is_solid(min + offset));
            assert_eq!(patched.block(min), plainly);
        }
    }
}
