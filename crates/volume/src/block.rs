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
#[inline(always)]
pub(crate) fn block_of_bits(bits: &Bits, min: IVec3) -> BitBrick {
    let shift = min & (BRICK - 1);
    if shift == IVec3::ZERO {
        let there = is_inside(bits.dimensions(), min).then(|| bits.bricks().at(min));
        return *there.flatten().unwrap_or(&BitBrick::EMPTY);
    }
    let bricks = bits.bricks().eight_from(min);
    let [a, b, c, d, rest @ ..] = bricks.map(|brick| brick.unwrap_or(&BitBrick::EMPTY));
    joined(&[a, b, c, d], shift, || rest)
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
    let four = |z| [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, y)| brick(x, y, z));
    joined(&four(0), shift, || four(1))
}

/// The voxels from a shift on, from four bricks and the four above them, x before y.
#[inline(always)]
fn joined<B: Borrow<BitBrick>>(
    lower: &[B; 4],
    shift: IVec3,
    upper: impl FnOnce() -> [B; 4],
) -> BitBrick {
    // along z, words come from the lower bricks first, then from the upper ones
    let mut layers = [0; 8];
    let (low, high) = layers.split_at_mut(8 - (shift.z as usize & 7));
    join(lower, shift, shift.z as usize, low);
    if shift.z > 0 {
        join(&upper(), shift, 0, high);
    }
    BitBrick(layers)
}

/// The layers of four bricks from one on, joined along x and y; x before y.
#[inline(always)]
fn join<B: Borrow<BitBrick>>(bricks: &[B; 4], shift: IVec3, from: usize, layers: &mut [u64]) {
    let words = bricks.each_ref().map(|brick| &brick.borrow().0[from & 7..]);
    let [a, b, c, d] = words;
    let rows = 8 * shift.y as u32;
    for ((((layer, a), b), c), d) in layers.iter_mut().zip(a).zip(b).zip(c).zip(d) {
        let first = rows_from(*a, *b, shift.x);
        let second = rows_from(*c, *d, shift.x);
        // in two steps, since none may be by 64
        *layer = first >> rows | second << 1 << (63 - rows);
    }
}

/// Rows that begin in one word and end in the next along x.
#[inline(always)]
fn rows_from(first: u64, second: u64, shift: i32) -> u64 {
    let from_first = (0xff >> shift) * FIRST_COLUMN;
    (first >> shift & from_first) | (second << (BRICK - shift) & !from_first)
}
