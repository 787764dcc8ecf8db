//! The voxels of a window on either side of the surface, by rows of cells.
//!
//! Only what is inside the window is right, without its outermost cells: those hardly count.
//!
//! Memory: a row of cells has as many rows of voxels as a cell, z by z; they stand one after the
//! other, x from the lowest bit on, as they do in the words of a window.

use super::cell_shape::{CELLS, CellShape, MAX_WORDS};
use super::window::Window;
use glam::IVec3;

/// Words of the largest layer of cells.
const MAX_CELL_LAYER: usize = MAX_WORDS / CELLS as usize;

/// The voxels of eight cells along x on either side of the surface, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct SurfaceRow {
    /// Voxels that are reached, next to those that are not.
    free: u128,
    /// Solid ones next to those that are reached.
    solid: u128,
}

impl SurfaceRow {
    /// No voxel.
    pub(super) const NONE: Self = Self { free: 0, solid: 0 };

    /// Those of the cells so many places on, and none where there were none.
    pub(super) fn moved(self, shape: CellShape, cells: i32) -> Self {
        let [log_x, ..] = shape.log;
        let row = (1_u64 << (CELLS << log_x)) - 1;
        let away = cells.unsigned_abs() << log_x;
        if cells.abs() >= CELLS {
            return Self::NONE;
        }
        if cells >= 0 {
            let left = in_each_row(shape, row >> away);
            Self {
                free: self.free >> away & left,
                solid: self.solid >> away & left,
            }
        } else {
            let left = in_each_row(shape, row << away & row);
            Self {
                free: self.free << away & left,
                solid: self.solid << away & left,
            }
        }
    }

    /// The cells that have other voxels, by their place in the row.
    #[inline]
    pub(super) fn differing(self, other: Self, shape: CellShape) -> impl Iterator<Item = u32> {
        let [log_x, ..] = shape.log;
        let bits = (self.free ^ other.free) | (self.solid ^ other.solid);
        let mut left = bits as u64 | (bits >> 64) as u64;
        // the rows of voxels on one another
        left |= left >> 32;
        left |= if log_x < 2 { left >> 16 } else { 0 };
        left |= if log_x < 1 { left >> 8 } else { 0 };
        left &= (1 << (CELLS << log_x)) - 1;
        std::iter::from_fn(move || {
            let cell = (left != 0).then(|| left.trailing_zeros() >> log_x)?;
            left &= !(of_cell(shape, cell));
            Some(cell)
        })
    }

    /// Tells the voxels of a cell and whether they are solid, z by z and row by row, where the
    /// row has its first cell at a number.
    #[inline]
    pub(super) fn visit(
        self,
        shape: CellShape,
        first: IVec3,
        cell: u32,
        mut tell: impl FnMut(IVec3, bool),
    ) {
        let min = first * shape.voxels();
        let [log_x, log_y, _] = shape.log;
        let [last_x, last_y] = [(CELLS << log_x) - 1, (1 << log_y) - 1];
        let mask = in_each_row(shape, of_cell(shape, cell));
        for half in [0, 64] {
            let mut left = (((self.free | self.solid) & mask) >> half) as u64;
            let solid = (self.solid >> half) as u64;
            while left != 0 {
                let place = left.trailing_zeros();
                left &= left - 1;
                let bit = (place + half) as i32;
                let row = bit >> (3 + log_x);
                let voxel = min + IVec3::new(bit & last_x, row & last_y, row >> log_y);
                tell(voxel, solid >> place & 1 == 1);
            }
        }
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
fn in_each_row(shape: CellShape, row: u64) -> u128 {
    let in_word = row
        * match shape.log {
            [0, ..] => 0x0101_0101_0101_0101,
            [1, ..] => 0x0001_0001_0001_0001,
            _ => 0x0000_0001_0000_0001,
        };
    u128::from(in_word) << 64 | u128::from(in_word)
}

/// Voxels at the surface, one bit each.
#[derive(Clone, Copy, Debug, Default)]
struct Surface {
    /// Reached ones next to others.
    free: u64,
    /// Solid ones next to those that are reached.
    solid: u64,
}

impl Window {
    /// Tells rows of cells, y and z in the window, with voxels that are reached next to others,
    /// or solid ones next to those that are reached.
    pub(super) fn visit_surface(&self, tell: &mut impl FnMut(usize, usize, SurfaceRow)) {
        match self.shape.log_width() {
            3 => self.visit_surface_of::<3>(tell),
            4 => self.visit_surface_of::<4>(tell),
            _ => self.visit_surface_of::<5>(tell),
        }
    }

    #[inline]
    fn visit_surface_of<const LOG: u32>(&self, tell: &mut impl FnMut(usize, usize, SurfaceRow)) {
        let [log_x, log_y, log_z] = self.shape.log;
        let (layer, log_bits) = (self.shape.layer(), LOG + log_y);
        let inner = !(of_cell(self.shape, 0) | of_cell(self.shape, 7));
        let inner = in_each_row(self.shape, inner & ((1 << (CELLS << log_x)) - 1)) as u64;
        let mut words = [Surface::default(); MAX_CELL_LAYER];
        for z in 1..7 {
            let first = (z << log_z) * layer;
            let mut any = 0;
            for (place, word) in words.iter_mut().enumerate().take(layer << log_z) {
                *word = self.surface_of::<LOG>(first + place, inner);
                any |= word.free | word.solid;
            }
            if any == 0 {
                continue;
            }
            for y in 1..7 {
                let mut row = SurfaceRow::NONE;
                for in_cell in 0..1 << log_z {
                    // the rows of voxels of this row of cells stand side by side
                    let bit = y << log_bits;
                    let word = in_cell * layer + bit / 64;
                    let at = |word: usize| words[word & (MAX_CELL_LAYER - 1)];
                    let to = in_cell << log_bits;
                    if log_bits > 6 {
                        let [low, high] = [at(word), at(word + 1)];
                        let both = |low: u64, high: u64| u128::from(high) << 64 | u128::from(low);
                        row.free |= both(low.free, high.free) << to;
                        row.solid |= both(low.solid, high.solid) << to;
                    } else {
                        let bits = |word: u64| {
                            u128::from(word >> (bit & 63) & (u64::MAX >> (64 - (1 << log_bits))))
                        };
                        let Surface { free, solid } = at(word);
                        row.free |= bits(free) << to;
                        row.solid |= bits(solid) << to;
                    }
                }
                if row != SurfaceRow::NONE {
                    tell(y, z, row);
                }
            }
        }
    }

    /// Those of the `inner` voxels of a word that are at the surface.
    #[inline]
    fn surface_of<const LOG: u32>(&self, word: usize, inner: u64) -> Surface {
        let at = |word: usize| self.reached[word & (MAX_WORDS - 1)];
        let (here, layer, row) = (at(word), self.shape.layer(), 1 << LOG);
        let beside = [
            here << 1,
            here >> 1,
            here << row | at(word.wrapping_sub(1)) >> (64 - row),
            here >> row | at(word + 1) << (64 - row),
            at(word.wrapping_sub(layer)),
            at(word + layer),
        ];
        let all = beside.iter().fold(u64::MAX, |all, beside| all & beside);
        let any = beside.iter().fold(0, |any, beside| any | beside);
        Surface {
            free: here & !all & inner,
            solid: !here & !self.free[word & (MAX_WORDS - 1)] & any & inner,
        }
    }
}
