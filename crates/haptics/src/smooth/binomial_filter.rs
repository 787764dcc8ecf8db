//! Tents over the cells of a window: ¼, ½, ¼ along each axis, once for the narrow kernel and
//! three times for the wide one; beyond the border the outermost cells go on.
//!
//! Along x sums are exact, in words of four numbers of 16 bits: no instruction of all targets
//! moves numbers inside a register, but shifts of words do. Then means of eight numbers, each
//! rounded up, which is one instruction.
//!
//! Memory: rows along x, y before z; in a row first x = 0, 2, 4, 6, then 1, 3, 5, 7.

use super::spline::Width;

/// Solid fractions of cells, a word for each row.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    /// Cells of even x.
    even: [u64; 64],
    /// Cells of odd x.
    odd: [u64; 64],
}

/// Blurred cells: rows of 0 to almost 2¹⁶.
pub(super) type Blurred = [[u16; 8]; 64];

/// The largest fraction of a cell: 64 of them, as three tents add up, are less than 2¹⁶.
const LARGEST: u16 = 0x3ff;

/// Every second byte.
const EVEN: u64 = 0x00ff_00ff_00ff_00ff;
/// The first of four numbers, and the last.
const FIRST: u64 = 0xffff;
const LAST: u64 = 0xffff << 48;

/// A one in each of four numbers.
const EACH: u64 = 0x0001_0001_0001_0001;

/// A bit above all numbers.
const BIT: u32 = 12;

/// What is to be added to the eight cells of a row, each less than 2¹⁰ up or down.
///
/// 16 bits for each, of the change plus 2¹² with that bit turned: so that nothing is 0, and
/// nothing goes from one to the next.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Changes {
    /// Cells of even x.
    even: u64,
    /// Cells of odd x.
    odd: u64,
}

impl Changes {
    /// None.
    pub(super) const NONE: Self = Self { even: 0, odd: 0 };

    /// Sets that of a cell.
    #[inline]
    pub(super) fn set(&mut self, cell: u32, change: i32) {
        let bits = ((change + (1 << BIT)) ^ (1 << BIT)) as u16;
        let place = 16 * ((cell / 2) & 3);
        let word = match cell.is_multiple_of(2) {
            true => &mut self.even,
            false => &mut self.odd,
        };
        *word = *word & !(0xffff << place) | u64::from(bits) << place;
    }

    /// The change of a cell.
    #[cfg(test)]
    pub(super) fn get(self, cell: u32) -> i32 {
        let is_even = cell.is_multiple_of(2);
        let word = if is_even { self.even } else { self.odd };
        i32::from((word >> (16 * (cell / 2))) as u16 ^ 1 << BIT) - (1 << BIT)
    }

    /// Those of the cells so many places on, and nothing where there were none.
    #[inline]
    pub(super) fn moved(self, cells: i32) -> Self {
        // what is even becomes odd where the way is
        let [even, odd] = match cells & 1 == 0 {
            true => [moved(self.even, cells >> 1), moved(self.odd, cells >> 1)],
            false => [
                moved(self.odd, cells >> 1),
                moved(self.even, (cells >> 1) + 1),
            ],
        };
        Self { even, odd }
    }
}

/// What is to be added to the cells of all rows: nothing, until told.
#[derive(Clone, Debug)]
pub(super) struct ChangesOfRows {
    even: [u64; 64],
    odd: [u64; 64],
}

impl ChangesOfRows {
    /// Nothing.
    pub(super) const NONE: Self = Self {
        even: [0; 64],
        odd: [0; 64],
    };

    /// Sets those of a row.
    #[inline]
    pub(super) fn set(&mut self, row: usize, changes: Changes) {
        (self.even[row & 63], self.odd[row & 63]) = (changes.even, changes.odd);
    }
}

/// Four numbers of 16 bits, so many places on.
#[inline]
fn moved(numbers: u64, places: i32) -> u64 {
    let bits = 16 * places.unsigned_abs();
    let moved = match places >= 0 {
        true => numbers.checked_shr(bits),
        false => numbers.checked_shl(bits),
    };
    moved.unwrap_or(0)
}

/// Four numbers and changes of them, each sum from nothing to the number of `full`.
#[inline(always)]
fn sum(numbers: u64, changes: u64, full: u64) -> u64 {
    /// All bits of those numbers that have the bit; without a multiplication, so that several
    /// words go at once.
    #[inline(always)]
    fn with_bit(numbers: u64) -> u64 {
        let ones = numbers >> BIT & EACH;
        (ones << 16).wrapping_sub(ones)
    }
    // the bit keeps numbers above zero, and is gone where they would be below
    let bits = EACH << BIT;
    let sum = numbers + (changes ^ bits);
    let sum = sum & !bits & with_bit(sum);
    let within = with_bit((full | bits) - sum);
    sum & within | full & !within
}

/// The fraction of one of so many voxels in a cell, as large as it may be.
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

    /// Adds to the cells, but leaves each from nothing to `full`.
    #[inline(always)]
    pub(super) fn add(&mut self, changes: &ChangesOfRows, full: u16) {
        let full = u64::from(full) * EACH;
        let sides = [
            (&mut self.even, &changes.even),
            (&mut self.odd, &changes.odd),
        ];
        for (words, changes) in sides {
            for (word, change) in words.iter_mut().zip(changes) {
                *word = sum(*word, *change, full);
            }
        }
    }

    /// The sums ¼, ½, ¼ along x, four times too large.
    #[inline(always)]
    fn widen(&mut self) {
        for (even, odd) in self.even.iter_mut().zip(&mut self.odd) {
            let before = *odd << 16 | *even & FIRST;
            let after = *even >> 16 | *odd & LAST;
            let sides = *even + *odd;
            (*even, *odd) = (before + *even + sides, after + *odd + sides);
        }
    }

    #[inline(always)]
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
    #[inline(always)]
    pub(super) fn blur(&self, mut take: impl FnMut(Width, &Blurred)) {
        let mut wide = self.clone();
        let mut rows = [[0; 8]; 64];
        wide.widen();
        wide.lanes(4, &mut rows);
        across::<1>(&mut rows);
        take(Width::Fine, &rows);
        wide.widen();
        wide.widen();
        wide.lanes(0, &mut rows);
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
#[inline(always)]
fn across<const TENTS: usize>(rows: &mut Blurred) {
    for layer in rows.as_chunks_mut::<8>().0 {
        let column = tents::<1, TENTS>(layer.map(|row| [row]));
        *layer = column.map(|[row]| row);
    }
    // two rows side by side fill the widest registers
    let (pairs, _) = rows.as_chunks_mut::<2>();
    for y in 0..4 {
        let place = |z: usize| (4 * z + y) & 31;
        let column = tents::<2, TENTS>(std::array::from_fn(|z| pairs[place(z)]));
        for (z, row) in column.into_iter().enumerate() {
            pairs[place(z)] = row;
        }
    }
}

/// So many tents over a column of eight, each of some rows side by side; it stays in registers.
#[inline(always)]
fn tents<const ROWS: usize, const TENTS: usize>(
    mut column: [[[u16; 8]; ROWS]; 8],
) -> [[[u16; 8]; ROWS]; 8] {
    for _ in 0..TENTS {
        let mut before = column[0];
        for i in 0..8 {
            let [here, after] = [column[i], column[(i + 1).min(7)]];
            for row in 0..ROWS {
                for lane in 0..8 {
                    let sides = mean(before[row][lane], after[row][lane]);
                    column[i][row][lane] = mean(sides, here[row][lane]);
                }
            }
            before = here;
        }
    }
    column
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
    fn what_is_added_leaves_cells_from_nothing_to_full() {
        let mut random = oorandom::Rand64::new(5);
        let largest = i64::from(LARGEST);
        for full in [LARGEST, 1020, 1008] {
            for _ in 0..2000 {
                let cells: [u16; 8] =
                    std::array::from_fn(|_| random.rand_range(0..u64::from(full) + 1) as u16);
                let change: [i32; 8] = std::array::from_fn(|_| {
                    let change = random.rand_range(0..2 * largest as u64 + 1);
                    (change as i64 - largest) as i32
                });
                let word = |first: usize| {
                    (0..4).fold(0, |word, i| {
                        word | u64::from(cells[2 * i + first]) << (16 * i)
                    })
                };
                let mut sums = Cells {
                    even: [word(0); 64],
                    odd: [word(1); 64],
                };
                let mut changes = Changes::default();
                (0..8).for_each(|x| changes.set(x as u32, change[x]));
                let mut of_rows = ChangesOfRows::NONE;
                of_rows.set(9, changes);
                sums.add(&of_rows, full);
                for x in 0..8 {
                    let word = if x % 2 == 0 { sums.even } else { sums.odd };
                    let number = (word[9] >> (8 * (x & 6)) & FIRST) as i32;
                    let plain = (i32::from(cells[x]) + change[x]).clamp(0, full.into());
                    assert_eq!(number, plain, "{cells:?} and {change:?}");
                }
                assert_eq!(sums.even[8], word(0));
            }
        }
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
