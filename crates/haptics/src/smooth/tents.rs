//! Tents over the cells of a window: ¼, ½, ¼ along each axis, once for the narrow kernel and
//! three times for the wide one; beyond the border the outermost cells go on.
//!
//! Along x sums are exact, in words of four numbers of 16 bits: no instruction of all targets
//! moves numbers inside a register, but shifts of words do. Then means of eight numbers, each
//! rounded up, which is one instruction.
//!
//! Memory: rows along x, y before z; in a row first x = 0, 2, 4, 6, then 1, 3, 5, 7.

/// Solid shares of cells: of each row, the cells of even x, and those of odd x.
#[derive(Clone, Debug)]
pub(super) struct Cells([[u64; 2]; 64]);

/// Blurred cells: rows of 0 to almost 2¹⁶.
pub(super) type Blurred = [[u16; 8]; 64];

/// The largest share of a cell: 64 of them, as three tents add up, are less than 2¹⁶.
const LARGEST: i32 = 0x3ff;

/// Every second byte.
const EVEN: u64 = 0x00ff_00ff_00ff_00ff;
/// The first of four numbers, and the last.
const FIRST: u64 = 0xffff;
const LAST: u64 = 0xffff << 48;

/// The share of one of so many voxels in a cell, as large as it may be.
pub(super) fn unit_of(voxels: i32) -> i32 {
    LARGEST / voxels
}

impl Cells {
    /// From the number of solid voxels in each cell, a word for each row and a byte for each
    /// cell; a voxel is `unit`.
    pub(super) fn of_counts(counts: &[u64; 64], unit: i32) -> Self {
        let numbers = |bytes: u64| (bytes & EVEN) * unit as u64;
        Self(counts.map(|row| [numbers(row), numbers(row >> 8)]))
    }

    /// Adds to each cell, x fastest, but leaves it from nothing to `full`.
    pub(super) fn add(&mut self, change: &[[i32; 8]; 64], full: i32) {
        for (row, change) in self.0.iter_mut().zip(change) {
            for (x, change) in change.iter().enumerate() {
                let (word, place) = (&mut row[x & 1], 8 * (x & !1));
                let cell = (*word >> place & FIRST) as i32;
                let changed = (cell + change).clamp(0, full) as u64;
                *word = *word & !(FIRST << place) | changed << place;
            }
        }
    }

    /// The sums ¼, ½, ¼ along x, four times too large.
    fn widen(&mut self) {
        for [even, odd] in &mut self.0 {
            let before = *odd << 16 | *even & FIRST;
            let after = *even >> 16 | *odd & LAST;
            (*even, *odd) = (before + 2 * *even + *odd, *even + 2 * *odd + after);
        }
    }

    fn lanes(&self, log_scale: u32) -> Blurred {
        self.0.map(|words| {
            std::array::from_fn(|lane| {
                let number = words[lane / 4] >> (16 * (lane % 4)) & FIRST;
                (number as u16) << log_scale
            })
        })
    }

    /// Both kernels: the narrow one, the wide one; 64 is what a cell of 1 becomes.
    pub(super) fn blurred(mut self) -> [Blurred; 2] {
        self.widen();
        let mut fine = self.lanes(4);
        self.widen();
        self.widen();
        let mut wide = self.lanes(0);
        across::<1>(&mut fine);
        across::<3>(&mut wide);
        [fine, wide]
    }
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
