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
    let [a, b, c, d, e, f, g, h] = bricks.map(|brick| brick.unwrap_or(&BitBrick::EMPTY));
    joined([a, b, c, d], [e, f, g, h], shift)
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
    let lower = four(0);
    let upper = (shift.z > 0).then(|| four(1));
    let upper = upper.as_ref().map_or([&BitBrick::EMPTY; 4], |upper| {
        upper.each_ref().map(Borrow::borrow)
    });
    joined(lower.each_ref().map(Borrow::borrow), upper, shift)
}

/// The voxels from a shift on, from four bricks and the four above them, x before y.
///
/// All layers are joined, also those that are not taken then: so all are shifted by the same, and
/// several go at once.
#[inline(always)]
fn joined(lower: [&BitBrick; 4], upper: [&BitBrick; 4], shift: IVec3) -> BitBrick {
    let mut layers = [0; 16];
    let (low, high) = layers.split_at_mut(8);
    join(lower, shift, low);
    join(upper, shift, high);
    let (first, mut block) = (shift.z as usize & 7, BitBrick::EMPTY);
    block.0.copy_from_slice(&layers[first..first + 8]);
    block
}

/// The layers of four bricks, joined along x and y; x before y.
#[inline(always)]
fn join(bricks: [&BitBrick; 4], shift: IVec3, layers: &mut [u64]) {
    let [a, b, c, d] = bricks.map(|brick| brick.0.as_chunks::<2>().0);
    for (pair, layers) in layers.as_chunks_mut::<2>().0.iter_mut().enumerate() {
        *layers = join_two([a[pair], b[pair], c[pair], d[pair]], shift);
    }
}

/// Two layers, each beside the other in a register: compilers shift words one by one.
#[inline(always)]
#[cfg(target_arch = "x86_64")]
fn join_two(words: [[u64; 2]; 4], shift: IVec3) -> [u64; 2] {
    use std::arch::x86_64::{
        __m128i, _mm_and_si128, _mm_andnot_si128, _mm_cvtsi32_si128, _mm_cvtsi128_si64,
        _mm_or_si128, _mm_set_epi64x, _mm_set1_epi64x, _mm_sll_epi64, _mm_srl_epi64,
        _mm_unpackhi_epi64,
    };
    // SAFETY: every such machine has these instructions
    unsafe {
        let [a, b, c, d] = words.map(|[low, high]| _mm_set_epi64x(high as i64, low as i64));
        let [right, left] = [shift.x, BRICK - shift.x].map(|bits| _mm_cvtsi32_si128(bits));
        let [up, down] = [8 * shift.y, 64 - 8 * shift.y].map(|bits| _mm_cvtsi32_si128(bits));
        let from_first = _mm_set1_epi64x(((0xff >> shift.x) * FIRST_COLUMN) as i64);
        let row = |first: __m128i, second: __m128i| {
            _mm_or_si128(
                _mm_and_si128(from_first, _mm_srl_epi64(first, right)),
                _mm_andnot_si128(from_first, _mm_sll_epi64(second, left)),
            )
        };
        let joined = _mm_or_si128(_mm_srl_epi64(row(a, b), up), _mm_sll_epi64(row(c, d), down));
        let upper = _mm_unpackhi_epi64(joined, joined);
        [joined, upper].map(|half| _mm_cvtsi128_si64(half) as u64)
    }
}

/// Two layers.
#[inline(always)]
#[cfg(not(target_arch = "x86_64"))]
fn join_two([a, b, c, d]: [[u64; 2]; 4], shift: IVec3) -> [u64; 2] {
    let rows = (8 * shift.y as u32) & 63;
    std::array::from_fn(|z| {
        let first = rows_from(a[z], b[z], shift.x);
        let second = rows_from(c[z], d[z], shift.x);
        // in two steps, since none may be by 64
        first >> rows | second << 1 << (63 - rows)
    })
}

/// Rows that begin in one word and end in the next along x.
#[inline(always)]
#[cfg(not(target_arch = "x86_64"))]
fn rows_from(first: u64, second: u64, shift: i32) -> u64 {
    let from_first = (0xff >> shift) * FIRST_COLUMN;
    (first >> shift & from_first) | (second << (BRICK - shift) & !from_first)
}
