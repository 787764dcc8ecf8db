//! The 8×8×8 voxels at any place, put together from the bricks that they lie in.
//!
//! Contact models look around a point thousands of times a second; reading a word per
//! layer costs some 30 ns where 512 single questions cost a microsecond.
//!
//! Frame: grid. Memory: as in `bit_brick.rs`, counted from the block's own corner.

use std::borrow::Borrow;

use glam::IVec3;

use crate::bit_brick::{BitBrick, FIRST_COLUMN};
use crate::bits::Bits;
use crate::brick_grid::BRICK;
use crate::grid::is_inside;

/// The voxels from `min` on; nothing is solid outside the grid.
pub(crate) fn block_of_bits(bits: &Bits, min: IVec3) -> BitBrick {
    block_of_bricks(min, |corner| brick_at(bits, corner))
}

/// The voxels from `min` on, from bricks that are asked for by the first of their voxels.
#[inline]
pub fn block_of_bricks<B: Borrow<BitBrick>>(min: IVec3, brick: impl Fn(IVec3) -> B) -> BitBrick {
    let corner = min & !(BRICK - 1);
    let shift = min - corner;
    let brick = |x, y, z| brick(corner + BRICK * IVec3::new(x, y, z));
    if shift == IVec3::ZERO {
        return *brick(0, 0, 0).borrow();
    }

    // along z, words come from the lower bricks first, then from the upper ones
    let four = |z| [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, y)| brick(x, y, z));
    let mut layers = [0; 16];
    let (low, high) = layers.split_at_mut(8);
    join(&four(0), shift, low);
    if shift.z > 0 {
        join(&four(1), shift, high);
    }
    let first = shift.z as usize & 7;
    BitBrick(std::array::from_fn(|z| layers[first + z]))
}

/// A brick by the first of its voxels.
#[inline]
fn brick_at(bits: &Bits, corner: IVec3) -> &BitBrick {
    if !is_inside(bits.dimensions(), corner) {
        return &BitBrick::EMPTY;
    }
    bits.bricks().at(corner).unwrap_or(&BitBrick::EMPTY)
}

/// The layers of four bricks joined along x and y; x before y.
#[inline]
fn join<B: Borrow<BitBrick>>(bricks: &[B; 4], shift: IVec3, layers: &mut [u64]) {
    let [a, b, c, d] = bricks.each_ref().map(|brick| &brick.borrow().0);
    let rows = 8 * shift.y as u32;
    for (z, layer) in layers.iter_mut().enumerate().take(8) {
        let first = rows_from(a[z], b[z], shift.x);
        let second = rows_from(c[z], d[z], shift.x);
        // in two steps, since none may be by 64
        *layer = first >> rows | second << 1 << (63 - rows);
    }
}

/// Rows that begin in one word and end in the next along x.
#[inline]
fn rows_from(first: u64, second: u64, shift: i32) -> u64 {
    let from_first = (0xff >> shift) * FIRST_COLUMN;
    (first >> shift & from_first) | (second << (BRICK - shift) & !from_first)
}
