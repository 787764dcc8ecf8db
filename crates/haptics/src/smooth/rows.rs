//! Rows of voxels packed in words, seen as rows of eight cells.
//!
//! Memory: as in `bit_rows.rs`.

/// Set bits of a byte in groups of 1, 2 or 4, each sum in a byte of its own.
static GROUPS: [[u64; 256]; 3] = groups();

const fn groups() -> [[u64; 256]; 3] {
    let mut table = [[0; 256]; 3];
    let mut log = 0;
    while log < 3 {
        let mut byte = 0;
        while byte < 256 {
            let mut bit = 0;
            while bit < 8 {
                table[log][byte] += (byte as u64 >> bit & 1) << (8 * (bit >> log));
                bit += 1;
            }
            byte += 1;
        }
        log += 1;
    }
    table
}

/// Words whose rows have 2^`LOG` bits.
pub(super) struct CellRows<const LOG: u32>;

impl<const LOG: u32> CellRows<LOG> {
    /// Clear bits of a row that has no other: as many in each of eight groups.
    pub(super) const ALL_CLEAR: u64 = 0x0101_0101_0101_0101 << (LOG - 3);

    /// Clear bits of the first row of a word, in eight groups, each sum in a byte of its own.
    #[inline]
    pub(super) fn clear_in_row(word: u64) -> u64 {
        let groups = &GROUPS[(LOG - 3) as usize & 3];
        let bytes = 1 << (LOG - 3);
        (0..bytes).fold(0, |cells, byte| {
            let bits = !word >> (8 * byte) & 0xff;
            cells | groups[bits as usize] << (64 / bytes * byte)
        })
    }
}
