//! Dilated bricks that were needed lately: a fixed number, filled when asked for.
//!
//! A brick has one slot, by the low bits of its place, so bricks that stand near one another
//! never take each other's slot: [`SLOTS_PER_AXIS`] of them fit beside each other along each
//! axis. What a slot holds is either what a new computation would give, or of another epoch
//! and not used: answers never depend on what was asked before.
//!
//! Frame: grid; places of bricks are voxels divided by 8. Reads need no `&mut`, as those of an
//! occupancy have none: slots are cells. Nothing is allocated after construction.

use std::cell::Cell;

use glam::IVec3;
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::brick_grid::BRICK;
use palpate_volume::voxel_box::VoxelBox;

/// Slots along each axis, 64 voxels wide.
const SLOTS_PER_AXIS: i32 = 8;
const SLOTS: usize = SLOTS_PER_AXIS.pow(3) as usize;

/// An epoch in which no slot is filled.
const NEVER: u64 = 0;

/// One brick, if it is of this epoch.
#[derive(Debug)]
#[repr(align(64))]
struct Slot {
    words: [Cell<u64>; 8],
    place: Cell<IVec3>,
    epoch: Cell<u64>,
}

/// The bricks.
#[derive(Debug)]
pub(crate) struct BallCache {
    slots: Box<[Slot]>,
    epoch: u64,
}

impl BallCache {
    pub(crate) fn new() -> Self {
        let empty = |_| Slot {
            words: Default::default(),
            place: Cell::new(IVec3::ZERO),
            epoch: Cell::new(NEVER),
        };
        Self {
            slots: (0..SLOTS).map(empty).collect(),
            epoch: NEVER + 1,
        }
    }

    /// Forgets everything, at once.
    pub(crate) fn invalidate(&mut self) {
        self.epoch += 1;
    }

    /// Forgets the bricks that hold a cell of the box.
    pub(crate) fn invalidate_box(&mut self, cells: &VoxelBox) {
        if cells.is_empty() {
            return;
        }
        let bricks = VoxelBox::new(cells.min >> 3, ((cells.max - 1) >> 3) + 1);
        if bricks.voxel_count() > SLOTS as u64 {
            self.invalidate();
            return;
        }
        for place in bricks.voxels() {
            if let Some(slot) = self.slots.get(slot_of(place))
                && slot.place.get() == place
            {
                slot.epoch.set(NEVER);
            }
        }
    }

    /// Whether a cell is blocked; `fill` computes the brick at a place.
    #[inline]
    pub(crate) fn is_blocked(&self, cell: IVec3, fill: impl FnOnce(IVec3) -> BitBrick) -> bool {
        let place = cell >> 3_i32;
        let Some(slot) = self.slots.get(slot_of(place)) else {
            return true;
        };
        self.make_current(slot, place, fill);
        let local = cell & (BRICK - 1);
        let word = slot.words[(local.z & 7) as usize].get();
        word >> (local.y << 3 | local.x) & 1 != 0
    }

    /// Whether the brick at a place need not be computed.
    #[inline]
    pub(crate) fn knows(&self, place: IVec3) -> bool {
        let slot = self.slots.get(slot_of(place));
        slot.is_none_or(|slot| self.is_current(slot, place))
    }

    /// The brick at a place; `fill` computes it.
    #[inline]
    pub(crate) fn brick(&self, place: IVec3, fill: impl FnOnce(IVec3) -> BitBrick) -> BitBrick {
        let Some(slot) = self.slots.get(slot_of(place)) else {
            return BitBrick::FULL;
        };
        self.make_current(slot, place, fill);
        BitBrick(std::array::from_fn(|z| slot.words[z].get()))
    }

    #[inline]
    fn is_current(&self, slot: &Slot, place: IVec3) -> bool {
        slot.epoch.get() == self.epoch && slot.place.get() == place
    }

    #[inline]
    fn make_current(&self, slot: &Slot, place: IVec3, fill: impl FnOnce(IVec3) -> BitBrick) {
        if !self.is_current(slot, place) {
            let brick = fill(place);
            for (cell, word) in slot.words.iter().zip(brick.0) {
                cell.set(word);
            }
            slot.place.set(place);
            slot.epoch.set(self.epoch);
        }
    }
}

/// Where a brick is kept.
#[inline]
fn slot_of(place: IVec3) -> usize {
    let IVec3 { x, y, z } = place & (SLOTS_PER_AXIS - 1);
    ((z * SLOTS_PER_AXIS + y) * SLOTS_PER_AXIS + x) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A brick that tells its place.
    fn brick_of(place: IVec3) -> BitBrick {
        let number = ((place.z as u64) << 40) ^ ((place.y as u64) << 20) ^ place.x as u64;
        BitBrick([number; 8])
    }

    #[test]
    fn a_brick_is_computed_once_until_it_is_forgotten_or_its_slot_taken() {
        let mut cache = BallCache::new();
        let fills = Cell::new(0);
        let fill = |place| {
            fills.set(fills.get() + 1);
            brick_of(place)
        };
        let ask = |cache: &BallCache, place| {
            let before = fills.get();
            assert_eq!(cache.brick(place, fill), brick_of(place));
            fills.get() - before
        };
        let [here, beside] = [IVec3::new(-3, 5, 9), IVec3::new(-4, 5, 9)];
        assert_eq!(ask(&cache, here) + ask(&cache, beside), 2);
        assert_eq!(ask(&cache, here) + ask(&cache, beside), 0);

        // one voxel of the first
        cache.invalidate_box(&VoxelBox::of_voxel(here * BRICK + 7));
        assert_eq!([ask(&cache, here), ask(&cache, beside)], [1, 0]);
        // a place that shares its slot, then the first again
        assert_eq!([ask(&cache, here + 8), ask(&cache, here)], [1, 1]);
        // what the slot no longer holds is not forgotten in it
        cache.invalidate_box(&VoxelBox::of_voxel((here + 8) * BRICK));
        assert_eq!(ask(&cache, here), 0);

        cache.invalidate_box(&VoxelBox::EMPTY);
        assert_eq!(ask(&cache, here), 0);
        cache.invalidate_box(&VoxelBox::new(IVec3::splat(-900), IVec3::splat(900)));
        assert_eq!([ask(&cache, here), ask(&cache, beside)], [1, 1]);
        cache.invalidate();
        assert_eq!([ask(&cache, here), ask(&cache, beside)], [1, 1]);
    }
}
