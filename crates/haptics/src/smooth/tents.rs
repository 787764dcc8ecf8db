//! Tents over the cells of a window: ¼, ½, ¼ along each axis, once for the narrow kernel and
//! three times for the wide one; beyond the border the outermost cells go on.
//!
//! Along x sums are exact, in words of four numbers of 16 bits: no instruction of all targets
//! moves numbers inside a register, but shifts of words do. Then means of eight numbers, each
//! rounded up, which is one instruction.
//!
//! Memory: rows along x, y before z; in a row first x = 0, 2, 4, 6, then 1, 3, 5, 7.

use super::spline::Width;

/// Solid shares of cells, a word for each row.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    /// Those of even x.
    even: [u64; 64],
    /// Those of odd x.
    odd: [u64; 64],
}

/// Blurred cells: rows of 0 to almost 2¹⁶.
pub(super) type Blurred = [[u16; 8]; 64];

/// The largest share of a cell: 64 of them, as three tents add up, are less than 2¹⁶.
const LARGEST: u16 = 0x3ff;

/// Every second byte.
const EVEN: u64 = 0x00ff_00ff_00ff_00ff;
/// The first of four numbers, and the last.
const FIRST: u64 = 0xffff;
const LAST: u64 = 0xffff << 48;

/// The share of one of so many voxels in a cell, as large as it may be.
pub(super) fn unit_of(voxels: u16) -> u16 {
    LARGEST / voxels
}

impl Cells {
    /// From the number of solid voxels in each cell, a word for each row and a byte for each
    /// cell; a voxel is `unit`.
    pub(super) fn of_counts(counts: &[u64; 64], unit: u16) -> Self {
        let numbers = |bytes: u64| (bytes & EVEN) * u64::from(unit);
        Self {
            even: counts.map(numbers),
            odd: counts.map(|bytes| numbers(bytes >> 8)),
        }
    }

    /// Adds to a cell, but leaves it from nothing to `full`.
    #[inline]
    pub(super) fn add(&mut self, row: usize, x: usize, change: i32, full: i32) {
        let words = if x & 1 == 0 {
            &mut self.even
        } else {
            &mut self.odd
        };
        let (word, place) = (&mut words[row & 63], 8 * (x & 6));
        let cell = (*word >> place & FIRST) as i32;
        let changed = (cell + change).clamp(0, full) as u64;
        *word = *word & !(FIRST << place) | changed << place;
    }

    /// The sums ¼, ½, ¼ along x, four times too large.
    fn widen(&mut self) {
        for (even, odd) in self.even.iter_mut().zip(&mut self.odd) {
            let before = *odd << 16 | *even & FIRST;
            let after = *even >> 16 | *odd & LAST;
            let sides = *even + *odd;
            (*even, *odd) = (before + *even + sides, after + *odd + sides);
        }
    }

    fn lanes(&self, log_scale: u32, rows: &mut Blurred) {
        for (row, (even, odd)) in rows.iter_mut().zip(self.even.iter().zip(&self.odd)) {
            // nothing goes from one number to the next, for they are small enough
            let [even, odd] = [even, odd].map(|word| word << log_scale);
            let [a, b, c, d] = numbers(even);
            let [e, f, g, h] = numbers(odd);
            *row = [a, b, c, d, e, f, g, h];
        }
    }

    /// The narrow kernel, then the wide one; 64 is what a cell of 1 becomes.
    pub(super) fn blur(mut self, mut take: impl FnMut(Width, &Blurred)) {
        let mut rows = [[0; 8]; 64];
        self.widen();
        self.lanes(4, &mut rows);
        across::<1>(&mut rows);
        take(Width::Fine, &rows);
        self.widen();
        self.widen();
        self.lanes(0, &mut rows);
        across::<3>(&mut rows);
        take(Width::Wide, &rows);
    }
}

/// The four numbers of a word.
#[inline(always)]
fn numbers(word: u64) -> [u16; 4] {
    [0, 16, 32, 48].map(|place| (word >> place) as u16)
}

/// So many tents along y and z.
fn across<const TENTS: usize>(rows: &mut Blurred) {
    for layer in 0..8 {
        column::<TENTS>(rows, 8 * layer, 1);
    }
    for y in 0..8 {
        column::<TENTS>(rows, y, 8);
    }
}

/// So many tents over eight rows.
#[inline(always)]
fn column<const TENTS: usize>(rows: &mut Blurred, first: usize, step: usize) {
    let place = |i: usize| (first + i * step) & 63;
    for _ in 0..TENTS {
        let mut here = rows[place(0)];
        let mut before = here;
        for i in 0..8 {
            let after = rows[place((i + 1).min(7))];
            let row = &mut rows[place(i)];
            for lane in 0..8 {
                row[lane] = mean(mean(before[lane], after[lane]), here[lane]);
            }
            (before, here) = (here, after);
        }
    }
}

/// Rounded up.
#[inline(always)]
fn mean(a: u16, b: u16) -> u16 {
    ((u32::from(a) + u32::from(b) + 1) >> 1) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One tent along each axis.
    fn blurred_plainly(cells: &[f64; 512]) -> [f64; 512] {
        let mut cells = *cells;
        for step in [1, 8, 64] {
            let before = cells;
            for (place, cell) in cells.iter_mut().enumerate() {
                let along = place / step % 8;
                let lower = place - if along > 0 { step } else { 0 };
                let upper = place + if along < 7 { step } else { 0 };
                *cell = 0.25 * before[lower] + 0.5 * before[place] + 0.25 * before[upper];
            }
        }
        cells
    }

    #[test]
    fn both_kernels_are_one_tent_and_three_along_each_axis() {
        let mut random = oorandom::Rand64::new(9);
        for voxels in [2, 4, 8, 16] {
            let unit = unit_of(voxels);
            let counts: [u64; 64] = std::array::from_fn(|_| {
                (0..8).fold(0, |row, _| {
                    row << 8 | random.rand_range(0..u64::from(voxels) + 1)
                })
            });
            let mut plain: [f64; 512] = std::array::from_fn(|place| {
                let count = counts[place / 8] >> (8 * (place % 8)) & 0xff;
                64.0 * f64::from(unit) * count as f64
            });
            Cells::of_counts(&counts, unit).blur(|width, rows| {
                let times = if matches!(width, Width::Fine) { 1 } else { 2 };
                (0..times).for_each(|_| plain = blurred_plainly(&plain));
                for (place, plain) in plain.iter().enumerate() {
                    let x = place % 8;
                    let number = f64::from(rows[place / 8][x / 2 + 4 * (x % 2)]);
                    // each of two means in each of six tents is rounded up by ½ at most
                    assert!(
                        (-1e-6..=6.0).contains(&(number - plain)),
                        "{number} for {plain}"
                    );
                }
            });
        }
    }
}
