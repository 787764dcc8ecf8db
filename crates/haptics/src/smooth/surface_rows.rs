//! The voxels of a window on either side of the surface, by rows of cells.
//!
//! Only what is inside the window is right, without its outermost cells: those hardly count.
//!
//! Memory: a row of cells has as many rows of voxels as a cell, z by z; they stand one after the
//! other, x from the lowest bit on, as they do in the words of a window.

use super::cell_shape::{CELLS, CellShape, MAX_WORDS};
use super::window::{Window, of_layers};
use glam::IVec3;
use palpate_volume::simd_dispatch;

/// Words of the largest layer of cells.
const MAX_CELL_LAYER: usize = MAX_WORDS / CELLS as usize;

/// The voxels of eight cells along x on either side of the surface, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct SurfaceRow {
    /// Voxels that are reached, next to those that are not.
    free: [u64; 2],
    /// Solid ones next to those that are reached.
    solid: [u64; 2],
}

impl SurfaceRow {
    /// No voxel.
    pub(super) const NONE: Self = Self {
        free: [0; 2],
        solid: [0; 2],
    };

    /// Those of the cells so many places on, and none where there were none.
    pub(super) fn moved(self, shape: CellShape, cells: i32) -> Self {
        if cells.abs() >= CELLS {
            return Self::NONE;
        }
        let [log_x, ..] = shape.log;
        let row = (1_u64 << (CELLS << log_x)) - 1;
        let away = cells.unsigned_abs() << log_x;
        // nothing goes from one row of voxels to the next
        let (left, right, kept) = match cells >= 0 {
            true => (0, away, row >> away),
            false => (away, 0, row << away & row),
        };
        let kept = in_each_row(shape, kept);
        let moved = |word: u64| word << left >> right & kept;
        Self {
            free: self.free.map(moved),
            solid: self.solid.map(moved),
        }
    }

    /// The cells that have other voxels.
    #[inline]
    pub(super) fn differing(self, other: Self, shape: CellShape) -> CellsOfRow {
        let [log_x, ..] = shape.log;
        let differ = |a: [u64; 2], b: [u64; 2]| (a[0] ^ b[0]) | (a[1] ^ b[1]);
        let mut bits = differ(self.free, other.free) | differ(self.solid, other.solid);
        // the rows of voxels on one another
        bits |= bits >> 32;
        bits |= if log_x < 2 { bits >> 16 } else { 0 };
        bits |= if log_x < 1 { bits >> 8 } else { 0 };
        let mut cells = bits & ((1 << (CELLS << log_x)) - 1);
        // all columns of a cell where there is one
        if log_x > 1 {
            cells |= cells >> 2 & 0x3333_3333 | (cells & 0x3333_3333) << 2;
        }
        if log_x > 0 {
            cells |= cells >> 1 & 0x5555_5555 | (cells & 0x5555_5555) << 1;
        }
        CellsOfRow(cells)
    }

    /// Tells the voxels of some cells with the place of their cell, and whether they are solid,
    /// z by z and row by row, where the row has its first cell at a number.
    #[inline]
    pub(super) fn visit(
        self,
        shape: CellShape,
        first: IVec3,
        cells: CellsOfRow,
        mut tell: impl FnMut(usize, IVec3, bool),
    ) {
        let min = first * shape.voxels();
        let [log_x, log_y, _] = shape.log;
        let [last_x, last_y] = [(CELLS << log_x) - 1, (1 << log_y) - 1];
        let cells = in_each_row(shape, cells.0);
        for (half, (free, solid)) in (0..).zip(self.free.into_iter().zip(self.solid)) {
            let mut left = (free | solid) & cells;
            while left != 0 {
                let place = left.trailing_zeros();
                left &= left - 1;
                let bit = 64 * half + place as i32;
                let (x, row) = (bit & last_x, bit >> (3 + log_x));
                let voxel = min + IVec3::new(x, row & last_y, row >> log_y);
                tell((x >> log_x) as usize, voxel, solid >> place & 1 == 1);
            }
        }
    }
}

/// Some cells of a row: all their bits in a row of voxels.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellsOfRow(u64);

impl CellsOfRow {
    /// No cell.
    pub(super) const NONE: Self = Self(0);

    /// Their places in the row.
    pub(super) fn places(self, shape: CellShape) -> impl Iterator<Item = u32> {
        let [log_x, ..] = shape.log;
        let mut left = self.0;
        std::iter::from_fn(move || {
            let cell = (left != 0).then(|| left.trailing_zeros() >> log_x)?;
            left &= !of_cell(shape, cell);
            Some(cell)
        })
    }
}

/// The bits of a cell in a row of voxels.
#[inline]
fn of_cell(shape: CellShape, cell: u32) -> u64 {
    let [log_x, ..] = shape.log;
    ((1 << (1 << log_x)) - 1) << (cell << log_x)
}

/// The same bits in each row of voxels of a row of cells.
#[inline]
fn in_each_row(shape: CellShape, row: u64) -> u64 {
    row * match shape.log {
        [0, ..] => 0x0101_0101_0101_0101,
        [1, ..] => 0x0001_0001_0001_0001,
        _ => 0x0000_0001_0000_0001,
    }
}

/// Voxels at the surface, one bit each.
#[derive(Clone, Copy, Debug, Default)]
struct Surface {
    /// Reached ones next to others.
    free: u64,
    /// Solid ones next to those that are reached.
    solid: u64,
}

simd_dispatch! {
    /// Finds the rows of cells of a window, y before z, eight of each, with voxels that are reached
    /// next to others, or solid ones next to those that are reached. One bit each in the answer.
    pub(super) fn find_surface(window: &Window, rows: &mut [SurfaceRow; 64]) -> u64
        = [avx2] Window::find_surface_plainly
}

impl Window {
    #[inline(always)]
    fn find_surface_plainly(&self, rows: &mut [SurfaceRow; 64]) -> u64 {
        of_layers!(self.shape, self.find_surface_of(rows))
    }

    #[inline(always)]
    fn find_surface_of<const LOG: u32, const WORDS: usize>(
        &self,
        rows: &mut [SurfaceRow; 64],
    ) -> u64 {
        let [log_x, log_y, log_z] = self.shape.log;
        let log_bits = LOG + log_y;
        let inner = !(of_cell(self.shape, 0) | of_cell(self.shape, 7));
        let inner = in_each_row(self.shape, inner & ((1 << (CELLS << log_x)) - 1));
        let [reached, free] =
            [&self.reached, &self.free].map(|words| words[..self.shape.words()].as_chunks().0);
        let mut words = [Surface::default(); MAX_CELL_LAYER];
        let mut found = 0_u64;
        for z in 1..7 {
            let layers = (z << log_z) - 1..;
            let layers = reached.get(layers.clone()).zip(free.get(layers));
            let Some((reached, free)) = layers else {
                continue;
            };
            let mut any = 0;
            let of_cells = words.as_chunks_mut().0.iter_mut().take(1 << log_z);
            for ((words, reached), free) in
                of_cells.zip(reached.windows(3)).zip(free.iter().skip(1))
            {
                any |= surface_of::<LOG, WORDS>(reached, free, inner, words);
            }
            if any == 0 {
                continue;
            }
            for y in 1..7 {
                let mut row = SurfaceRow::NONE;
                for in_cell in 0..1 << log_z {
                    // the rows of voxels of this row of cells stand side by side
                    let [from, to] = [y, in_cell].map(|number| number << log_bits);
                    let at = |word: usize| words[(in_cell * WORDS + word) & (MAX_CELL_LAYER - 1)];
                    if log_bits > 6 {
                        let both = [at(from / 64), at(from / 64 + 1)];
                        row.free = both.map(|word| word.free);
                        row.solid = both.map(|word| word.solid);
                    } else {
                        let bits = u64::MAX >> (64 - (1 << log_bits)) << (from & 63);
                        let place = |word: u64| (word & bits) >> (from & 63) << (to & 63);
                        let Surface { free, solid } = at(from / 64);
                        row.free[(to / 64) & 1] |= place(free);
                        row.solid[(to / 64) & 1] |= place(solid);
                    }
                }
                let place = 8 * z + y;
                rows[place] = row;
                found |= u64::from(row != SurfaceRow::NONE) << place;
            }
        }
        found
    }
}

/// Those of the `inner` voxels of a layer that are at the surface, between the layer before it and
/// the one after it; all of them in one word. Words on their own, so that several go at once.
#[inline(always)]
fn surface_of<const LOG: u32, const WORDS: usize>(
    reached: &[[u64; WORDS]],
    free: &[u64; WORDS],
    inner: u64,
    surface: &mut [Surface; WORDS],
) -> u64 {
    let &[before, here, after] = reached else {
        return 0;
    };
    let row = 1 << LOG;
    // beyond the border is an outermost cell
    let [mut up, mut down] = [0, 0].map(|_: u64| [0; WORDS]);
    for word in 0..WORDS {
        [up[word], down[word]] = [here[word] << row, here[word] >> row];
    }
    for word in 1..WORDS {
        up[word] |= here[word - 1] >> (64 - row);
    }
    for word in 1..WORDS {
        down[word - 1] |= here[word] << (64 - row);
    }
    let mut found = 0;
    for word in 0..WORDS {
        let here = here[word];
        let [x, y, z] = [
            [here << 1, here >> 1],
            [up[word], down[word]],
            [before[word], after[word]],
        ];
        let all = x[0] & x[1] & y[0] & y[1] & z[0] & z[1];
        let any = x[0] | x[1] | y[0] | y[1] | z[0] | z[1];
        surface[word] = Surface {
            free: here & !all & inner,
            solid: !here & !free[word] & any & inner,
        };
        found |= surface[word].free | surface[word].solid;
    }
    found
}
