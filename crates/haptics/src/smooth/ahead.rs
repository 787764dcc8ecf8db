//! Bricks that the next windows will need, worked out before, one a tick.
//!
//! What a ball cannot get into is filled brick by brick (`ball/closing.rs`). A window that comes to
//! new bricks would need up to some twenty at once, all in one tick; in the ticks between there is
//! time for them. Windows are taken to go on the way that they went along each axis. What is worked
//! out here changes no answer, only when the work is done.
//!
//! Frame: grid.

use glam::IVec3;
use palpate_volume::brick_grid::BRICK;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::voxel_box::VoxelBox;

/// Bricks that are looked at in a tick, of which one at most is worked out.
const LOOKED_AT: u32 = 4;

/// The bricks beside a window, on the way that windows go.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ahead {
    /// The first voxel of the last window.
    window: IVec3,
    /// Which way windows went last along each axis: -1, 0 or 1.
    way: IVec3,
    /// Bricks of that window, by their places.
    inside: VoxelBox,
    /// Slabs beside the window along each axis, and which of their bricks were looked at.
    beside: [Slab; 3],
}

/// Bricks of a box, looked at one after the other.
#[derive(Clone, Copy, Debug)]
struct Slab {
    bricks: VoxelBox,
    next: IVec3,
}

impl Ahead {
    /// No window.
    pub(super) const NONE: Self = Self {
        window: IVec3::ZERO,
        way: IVec3::ZERO,
        inside: VoxelBox::EMPTY,
        beside: [Slab::NONE; 3],
    };

    /// A window has been made of these voxels.
    pub(super) fn follow(&mut self, window: VoxelBox) {
        let way = (window.min - self.window).signum();
        let way = IVec3::select(way.cmpeq(IVec3::ZERO), self.way, way);
        let inside = VoxelBox::new(window.min >> 3_i32, ((window.max - 1) >> 3_i32) + 1);
        self.window = window.min;
        // mostly in the same bricks, some of which were looked at
        if (way, inside) == (self.way, self.inside) {
            return;
        }
        (self.way, self.inside) = (way, inside);
        for (axis, slab) in self.beside.iter_mut().enumerate() {
            let (mut min, mut max) = (inside.min, inside.max);
            match way[axis] {
                1 => (min[axis], max[axis]) = (inside.max[axis], inside.max[axis] + 1),
                -1 => (min[axis], max[axis]) = (inside.min[axis] - 1, inside.min[axis]),
                _ => max[axis] = min[axis],
            }
            *slab = Slab::of(VoxelBox::new(min, max));
        }
    }

    /// Works out the next brick that is not known, unless it is far down the list.
    pub(super) fn work(&mut self, occupancy: &(impl Occupancy + ?Sized)) {
        for _ in 0..LOOKED_AT {
            let Some(brick) = self.beside.iter_mut().find_map(Slab::next) else {
                return;
            };
            if occupancy.prepare_smooth_brick(BRICK * brick) {
                return;
            }
        }
    }
}

impl Slab {
    const NONE: Self = Self {
        bricks: VoxelBox::EMPTY,
        next: IVec3::ZERO,
    };

    fn of(bricks: VoxelBox) -> Self {
        if bricks.is_empty() {
            return Self::NONE;
        }
        Self {
            bricks,
            next: bricks.min,
        }
    }

    /// The next one, x before y before z.
    #[inline]
    fn next(&mut self) -> Option<IVec3> {
        let VoxelBox { min, max } = self.bricks;
        let brick = self.next;
        if brick.z >= max.z {
            return None;
        }
        self.next.x += 1;
        if self.next.x == max.x {
            self.next = IVec3::new(min.x, brick.y + 1, brick.z);
        }
        if self.next.y == max.y {
            self.next = IVec3::new(min.x, min.y, brick.z + 1);
        }
        Some(brick)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::RefCell;
    use std::collections::BTreeSet;

    /// Remembers which bricks were worked out.
    #[derive(Default)]
    struct Noted(RefCell<BTreeSet<[i32; 3]>>);

    impl Occupancy for Noted {
        fn is_solid(&self, _voxel: IVec3) -> bool {
            false
        }

        fn prepare_smooth_brick(&self, min: IVec3) -> bool {
            assert_eq!(min & (BRICK - 1), IVec3::ZERO);
            self.0.borrow_mut().insert(min.to_array())
        }
    }

    #[test]
    fn one_brick_a_tick_until_all_are_known_that_windows_come_to() {
        let occupancy = Noted::default();
        let known = || occupancy.0.borrow().len();
        let mut ahead = Ahead::NONE;
        ahead.work(&occupancy);
        assert_eq!(known(), 0);

        // bricks 1 to 3 along x and 0 to 2 along y; the way to it leads up along x and down along y
        let window = VoxelBox::new(IVec3::new(10, 3, 8), IVec3::new(26, 19, 16));
        ahead.window = IVec3::new(9, 4, 8);
        ahead.follow(window);
        for _ in 0..20 {
            let before = known();
            ahead.work(&occupancy);
            assert!(known() <= before + 1);
            // another window in the same bricks begins nothing anew
            ahead.follow(VoxelBox::new(window.min + IVec3::X, window.max + IVec3::X));
        }
        let beside_x = (0..3).map(|y| [32, 8 * y, 8]);
        let beside_y = (1..4).map(|x| [8 * x, -8, 8]);
        let expected: BTreeSet<_> = beside_x.chain(beside_y).collect();
        assert_eq!(*occupancy.0.borrow(), expected);
    }
}
