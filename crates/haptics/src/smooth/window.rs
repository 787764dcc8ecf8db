//! The voxels around the proxy as bits, seen from its side.
//!
//! A window holds 8×8×8 *cells* of 1, 2 or 4 voxels along each axis. Of its free voxels only
//! those count that the proxy reaches face to face inside the window; all others, such as the
//! far side of a thin wall or a pore inside a body, are filled. So a wall of one voxel is as
//! solid for the blur as a thick one, and what is behind it cannot be felt.
//!
//! Frame: grid. Memory: layers of rows along x, packed in words (`rows.rs`).

use super::cell_shape::{CELLS, CellShape, MAX_WORDS};
use super::rows::CellRows;
use crate::contact::flood::flood;
use glam::IVec3;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::simd_dispatch;

/// Calls a method with the logarithm of a row's bits and the words of a layer, as they are for a
/// shape, so that both are known when it is compiled.
macro_rules! of_layers {
    ($shape:expr, $window:ident.$method:ident($argument:expr)) => {
        match ($shape.log[0], $shape.log[1]) {
            (0, 0) => $window.$method::<3, 1>($argument),
            (0, 1) => $window.$method::<3, 2>($argument),
            (0, _) => $window.$method::<3, 4>($argument),
            (1, 0) => $window.$method::<4, 2>($argument),
            (1, 1) => $window.$method::<4, 4>($argument),
            (1, _) => $window.$method::<4, 8>($argument),
            (_, 0) => $window.$method::<5, 4>($argument),
            (_, 1) => $window.$method::<5, 8>($argument),
            _ => $window.$method::<5, 16>($argument),
        }
    };
}
pub(super) use of_layers;

/// Which voxels of a window are reached from the proxy's.
#[derive(Clone, Debug)]
pub(crate) struct Window {
    pub(super) shape: CellShape,
    /// The first cell, by its number.
    first: IVec3,
    /// Where the flood began; none where there is no window.
    seed: Option<IVec3>,
    /// Whether it came to its end, so that each voxel reached would have led to the same.
    complete: bool,
    pub(super) free: [u64; MAX_WORDS],
    pub(super) reached: [u64; MAX_WORDS],
}

impl Window {
    /// No window.
    pub(crate) const NONE: Self = Self {
        shape: CellShape::ONE,
        first: IVec3::ZERO,
        seed: None,
        complete: false,
        free: [0; MAX_WORDS],
        reached: [0; MAX_WORDS],
    };

    /// The first cell, by its number.
    pub(crate) fn first(&self) -> IVec3 {
        self.first
    }

    /// Whether the window has this shape and stands at this voxel.
    #[inline]
    pub(crate) fn is_at(&self, shape: CellShape, first: IVec3) -> bool {
        self.first == first && self.shape == shape
    }

    /// Whether reading it again from this seed would give the same.
    #[inline]
    pub(crate) fn is_from(&self, seed: IVec3) -> bool {
        let is_same = |old| old == seed || self.complete && self.is_reached(seed);
        self.seed.is_some_and(is_same)
    }

    /// Reads the window from cell `first` on, where all that `seed` does not reach through
    /// faces is solid; false where every voxel of the window is free, and where the seed itself
    /// is solid.
    #[inline(always)]
    pub(crate) fn read(
        &mut self,
        occupancy: &(impl Occupancy + ?Sized),
        shape: CellShape,
        first: IVec3,
        seed: IVec3,
    ) -> bool {
        (self.shape, self.first, self.seed) = (shape, first, Some(seed));
        let words = shape.words();
        let (free, reached) = (&mut self.free[..words], &mut self.reached[..words]);
        let any_solid = read_free(occupancy, shape, first * shape.voxels(), free);
        if !any_solid {
            reached.copy_from_slice(free);
            self.complete = true;
            return false;
        }
        reached.fill(0);
        self.complete = false;
        let Some((word, bit)) = self.place_of(seed) else {
            return false;
        };
        if self.free[word] & bit == 0 {
            return false;
        }
        self.reached[word] = bit;
        self.complete = flood_from(self, word / shape.layer());
        true
    }

    #[inline(always)]
    fn flood_plainly(&mut self, layer: usize) -> bool {
        of_layers!(self.shape, self.flood_of(layer))
    }

    #[inline(always)]
    fn flood_of<const LOG: u32, const WORDS: usize>(&mut self, layer: usize) -> bool {
        let words = self.shape.words();
        let (free, _) = self.free[..words].as_chunks::<WORDS>();
        let (reached, _) = self.reached[..words].as_chunks_mut::<WORDS>();
        flood::<LOG, WORDS>(layer, free, reached)
    }

    #[inline(always)]
    fn counts_plainly(&self) -> [u64; 64] {
        match self.shape.log_width() {
            3 => self.counts_of::<3>(),
            4 => self.counts_of::<4>(),
            _ => self.counts_of::<5>(),
        }
    }

    #[inline(always)]
    fn counts_of<const LOG: u32>(&self) -> [u64; 64] {
        match self.shape.log[1] {
            0 => self.count::<LOG, 1>(),
            1 => self.count::<LOG, 2>(),
            _ => self.count::<LOG, 4>(),
        }
    }

    /// The counts of cells that have `HEIGHT` voxels along y.
    #[inline(always)]
    fn count<const LOG: u32, const HEIGHT: usize>(&self) -> [u64; 64] {
        let log_z = self.shape.log[2];
        let layers = self.reached[..self.shape.words()].chunks_exact(self.shape.layer());
        let mut counts = [0_u64; 64];
        // a layer has 32 rows of voxels at most
        let mut rows = [0_u64; 32];
        for (z, layer) in layers.enumerate() {
            let in_words = rows.chunks_exact_mut(CellRows::<LOG>::ROWS);
            for (rows, reached) in in_words.zip(layer) {
                for (row, clear) in rows.iter_mut().enumerate() {
                    *clear = CellRows::<LOG>::clear_in_row(reached >> (row << LOG));
                }
            }
            let in_cells = rows.as_chunks::<HEIGHT>().0;
            let first = (8 * (z >> log_z)) & 56;
            for (count, rows) in counts[first..].iter_mut().zip(in_cells).take(8) {
                *count += rows.iter().sum::<u64>();
            }
        }
        counts
    }

    /// Whether a voxel is reached; none outside is.
    pub(super) fn is_reached(&self, voxel: IVec3) -> bool {
        self.place_of(voxel)
            .is_some_and(|(word, bit)| self.reached[word] & bit != 0)
    }

    /// Word and bit of a voxel of the grid; none outside.
    fn place_of(&self, voxel: IVec3) -> Option<(usize, u64)> {
        let size = CELLS * self.shape.voxels();
        let offset = voxel - self.first * self.shape.voxels();
        let inside = offset.cmpge(IVec3::ZERO).all() && offset.cmplt(size).all();
        let bit = (offset.y << self.shape.log_width() | offset.x) as usize;
        let word = offset.z as usize * self.shape.layer() + bit / 64;
        (inside && word < MAX_WORDS).then_some((word, 1 << (bit % 64)))
    }
}

simd_dispatch! {
    /// Voxels of a window that are not reached in each cell: a word for each row of cells, a byte
    /// for each.
    pub(super) fn counts(window: &Window) -> [u64; 64] = [avx2] Window::counts_plainly
}

simd_dispatch! {
    /// Grows what is reached of a layer, as far as it goes; whether that came to its end.
    fn flood_from(window: &mut Window, layer: usize) -> bool = [avx2] Window::flood_plainly
}

/// Reads the free voxels; false where all are.
#[inline(always)]
fn read_free(
    occupancy: &(impl Occupancy + ?Sized),
    shape: CellShape,
    min: IVec3,
    free: &mut [u64],
) -> bool {
    match shape.log[0] {
        0 => read_free_of::<1>(occupancy, shape, min, free),
        1 => read_free_of::<2>(occupancy, shape, min, free),
        _ => read_free_of::<4>(occupancy, shape, min, free),
    }
}

/// Reads the free voxels of windows that are `BLOCKS` blocks wide.
#[inline(always)]
fn read_free_of<const BLOCKS: usize>(
    occupancy: &(impl Occupancy + ?Sized),
    shape: CellShape,
    min: IVec3,
    free: &mut [u64],
) -> bool {
    let [_, my, mz] = shape.voxels().to_array();
    let (words, _) = free.as_chunks_mut::<BLOCKS>();
    let mut any_solid = 0;
    for block_z in 0..mz {
        for block_y in 0..my {
            let blocks: [_; BLOCKS] = std::array::from_fn(|x| {
                occupancy.smooth_block(min + 8 * IVec3::new(x as i32, block_y, block_z))
            });
            for z in 0..8 {
                let mut rows = [0; BLOCKS];
                for (rows, block) in rows.iter_mut().zip(&blocks) {
                    any_solid |= block.0[z];
                    *rows = !block.0[z];
                }
                let place = (8 * block_z as usize + z) * my as usize + block_y as usize;
                if let Some(words) = words.get_mut(place) {
                    *words = side_by_side(rows);
                }
            }
        }
    }
    any_solid != 0
}

/// The eight rows of each of some words, put side by side: the first of each, then the next.
#[inline(always)]
fn side_by_side<const WORDS: usize>(words: [u64; WORDS]) -> [u64; WORDS] {
    let mut rows = words;
    match WORDS {
        2 => [rows[0], rows[1]] = mixed_bytes(words[0], words[1]),
        4 => {
            let [first, second] = [[0, 1], [2, 3]].map(|[a, b]| mixed_bytes(words[a], words[b]));
            [rows[0], rows[1]] = mixed_pairs(first[0], second[0]);
            [rows[2], rows[3]] = mixed_pairs(first[1], second[1]);
        }
        _ => {}
    }
    rows
}

/// The bytes of two words, one of each by turns.
#[inline(always)]
fn mixed_bytes(a: u64, b: u64) -> [u64; 2] {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_mm_cvtsi64_si128, _mm_unpacklo_epi8};
        // SAFETY: every such machine has these instructions
        let mixed = unsafe {
            let [a, b] = [a, b].map(|word| _mm_cvtsi64_si128(word as i64));
            _mm_unpacklo_epi8(a, b)
        };
        halves(mixed)
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        let apart = |word: u64| (word | word << 8) & 0x00ff_00ff_00ff_00ff;
        mixed(a, b, 8, |four| {
            apart((four | four << 16) & 0x0000_ffff_0000_ffff)
        })
    }
}

/// The pairs of bytes of two words.
#[inline(always)]
fn mixed_pairs(a: u64, b: u64) -> [u64; 2] {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_mm_cvtsi64_si128, _mm_unpacklo_epi16};
        // SAFETY: every such machine has these instructions
        let mixed = unsafe {
            let [a, b] = [a, b].map(|word| _mm_cvtsi64_si128(word as i64));
            _mm_unpacklo_epi16(a, b)
        };
        halves(mixed)
    }
    #[cfg(not(target_arch = "x86_64"))]
    mixed(a, b, 16, |four| (four | four << 16) & 0x0000_ffff_0000_ffff)
}

/// The two words of a register.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn halves(register: std::arch::x86_64::__m128i) -> [u64; 2] {
    use std::arch::x86_64::{_mm_cvtsi128_si64, _mm_unpackhi_epi64};
    // SAFETY: every such machine has these instructions
    unsafe {
        let upper = _mm_unpackhi_epi64(register, register);
        [register, upper].map(|half| _mm_cvtsi128_si64(half) as u64)
    }
}

/// The lower halves of two words, then the upper ones; each taken apart by so many bits.
#[cfg(not(target_arch = "x86_64"))]
#[inline(always)]
fn mixed(a: u64, b: u64, bits: u32, apart: impl Fn(u64) -> u64) -> [u64; 2] {
    [0, 32].map(|half| {
        let [a, b] = [a, b].map(|word| apart(word >> half & 0xffff_ffff));
        a | b << bits
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_several_blocks_stand_side_by_side() {
        fn check<const WORDS: usize>(words: [u64; WORDS]) {
            let rows: Vec<u8> = (0..8)
                .flat_map(|row| words.map(|word| word.to_le_bytes()[row]))
                .collect();
            let plain = rows.chunks(8).map(|bytes| {
                let bytes = bytes.try_into().expect("eight rows each");
                u64::from_le_bytes(bytes)
            });
            assert!(side_by_side(words).into_iter().eq(plain), "{words:x?}");
        }
        let mut random = oorandom::Rand64::new(2);
        for _ in 0..100 {
            let words = [(); 4].map(|()| random.rand_u64());
            let [a, b, ..] = words;
            check([a]);
            check([a, b]);
            check(words);
        }
    }
}
