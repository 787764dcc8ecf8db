//! Rows of bits packed in words: what is next to a set of voxels.
//!
//! Memory: a row has 8, 16 or 32 bits, x from the lowest bit on; a word holds 8, 4 or 2 rows.
//! `LOG` is the logarithm of a row's bits.

/// Bits x = 0 of all rows of a word.
const fn first_column(log: u32) -> u64 {
    match log {
        3 => 0x0101_0101_0101_0101,
        4 => 0x0001_0001_0001_0001,
        _ => 0x0000_0001_0000_0001,
    }
}

/// Words whose rows have 2^`LOG` bits.
pub(crate) struct Rows<const LOG: u32>;

impl<const LOG: u32> Rows<LOG> {
    /// Bits of a row.
    pub(crate) const BITS: u32 = 1 << LOG;
    const NOT_FIRST: u64 = !first_column(LOG);
    const NOT_LAST: u64 = !(first_column(LOG) << (Self::BITS - 1));

    /// The neighbours of voxels in a word, along the rows and from row to row.
    #[inline(always)]
    pub(crate) fn spread(word: u64) -> u64 {
        let along = (word & Self::NOT_LAST) << 1 | (word & Self::NOT_FIRST) >> 1;
        along | word << Self::BITS | word >> Self::BITS
    }

    /// All of `free` that `seed`, a part of it, reaches along the rows of a word.
    #[inline(always)]
    pub(crate) fn along(seed: u64, free: u64) -> u64 {
        // upward, a one added to a run of free voxels goes on to its end; the last column is
        // added on its own, so that nothing goes from row to row
        let last = !Self::NOT_LAST;
        let sum = ((free & !last) + (seed & !last)) ^ ((free ^ seed) & last);
        let up = free & !sum | seed;

        // downward in steps that double
        let (mut down, mut pass) = (up, free & Self::NOT_LAST);
        for log in 0..LOG {
            let step = 1 << log;
            down |= pass & (down >> step);
            pass &= pass >> step;
        }
        down
    }

    /// All of `free` that `seed` reaches from row to row of a word, upward in number.
    #[inline(always)]
    pub(crate) fn up(seed: u64, free: u64) -> u64 {
        let (mut up, mut pass) = (seed, free);
        for log in LOG..6 {
            let step = 1 << log;
            up |= pass & (up << step);
            pass &= pass << step;
        }
        up
    }

    /// The same toward lower bits.
    #[inline(always)]
    pub(crate) fn down(seed: u64, free: u64) -> u64 {
        let (mut down, mut pass) = (seed, free);
        for log in LOG..6 {
            let step = 1 << log;
            down |= pass & (down >> step);
            pass &= pass >> step;
        }
        down
    }
}
