//! Rows of voxels packed in words, seen as rows of eight cells.
//!
//! Memory: as in `bit_rows.rs`.

/// Words whose rows have 2^`LOG` bits.
pub(super) struct CellRows<const LOG: u32>;

impl<const LOG: u32> CellRows<LOG> {
    /// Rows of a word.
    pub(super) const ROWS: usize = 64 >> LOG;

    /// Clear bits of the first row of a word, in eight groups, each sum in a byte of its own.
    ///
    /// Without tables or branches, so that several rows go at once.
    #[inline(always)]
    pub(super) fn clear_in_row(word: u64) -> u64 {
        let clear = !word;
        // sums of one, two or four bits stand side by side; halves of them are moved apart
        match LOG {
            3 => {
                let four = apart(clear & 0xff, 28, 0x0000_000f_0000_000f);
                let two = apart(four, 14, 0x0003_0003_0003_0003);
                apart(two, 7, 0x0101_0101_0101_0101)
            }
            4 => {
                let clear = clear & 0xffff;
                let pairs = clear - (clear >> 1 & 0x5555);
                let four = apart(pairs, 24, 0x0000_00ff_0000_00ff);
                let two = apart(four, 12, 0x000f_000f_000f_000f);
                apart(two, 6, 0x0303_0303_0303_0303)
            }
            _ => {
                let clear = clear & 0xffff_ffff;
                let pairs = clear - (clear >> 1 & 0x5555_5555);
                let fours = (pairs & 0x3333_3333) + (pairs >> 2 & 0x3333_3333);
                let four = apart(fours, 16, 0x0000_ffff_0000_ffff);
                let two = apart(four, 8, 0x00ff_00ff_00ff_00ff);
                apart(two, 4, 0x0f0f_0f0f_0f0f_0f0f)
            }
        }
    }
}

/// Moves the upper halves of numbers up.
#[inline(always)]
fn apart(numbers: u64, bits: u32, kept: u64) -> u64 {
    (numbers | numbers << bits) & kept
}
