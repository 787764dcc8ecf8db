//! Rows of bits packed in words, and a flood through layers of them.
//!
//! Memory: a row has 8, 16 or 32 bits, x from the lowest bit on; a word holds 8, 4 or 2 rows;
//! a layer has a power of two of words. `LOG` is the logarithm of a row's bits.

/// Most growths of a layer in a flood, for each layer; ways that wind more are cut short.
const MAX_GROWTHS: usize = 24;

/// Bits x = 0 of all rows of a word.
const fn first_column(log: u32) -> u64 {
    match log {
        3 => 0x0101_0101_0101_0101,
        4 => 0x0001_0001_0001_0001,
        _ => 0x0000_0001_0000_0001,
    }
}

/// Words whose rows have 2^`LOG` bits.
pub(super) struct Rows<const LOG: u32>;

impl<const LOG: u32> Rows<LOG> {
    const BITS: u32 = 1 << LOG;
    const NOT_FIRST: u64 = !first_column(LOG);
    const NOT_LAST: u64 = !(first_column(LOG) << (Self::BITS - 1));

    /// The neighbours of voxels in a word, along the rows and from row to row.
    #[inline]
    fn spread(word: u64) -> u64 {
        let along = (word & Self::NOT_LAST) << 1 | (word & Self::NOT_FIRST) >> 1;
        along | word << Self::BITS | word >> Self::BITS
    }

    /// All of `free` that `seed` reaches first along the rows of a word, then across them.
    #[inline]
    fn grown(seed: u64, free: u64) -> u64 {
        if seed == 0 || seed == free {
            return seed;
        }
        // along the rows, in steps that double
        let (mut up, mut down) = (seed, seed);
        let (mut pass_up, mut pass_down) = (free & Self::NOT_FIRST, free & Self::NOT_LAST);
        for log in 0..LOG {
            let step = 1 << log;
            up |= pass_up & (up << step);
            down |= pass_down & (down >> step);
            pass_up &= pass_up << step;
            pass_down &= pass_down >> step;
        }
        let seed = up | down;

        // from row to row
        let (mut up, mut down) = (seed, seed);
        let (mut pass_up, mut pass_down) = (free, free);
        for log in LOG..6 {
            let step = 1 << log;
            up |= pass_up & (up << step);
            down |= pass_down & (down >> step);
            pass_up &= pass_up << step;
            pass_down &= pass_down >> step;
        }
        up | down
    }

    /// Grows what is reached in a layer by one voxel; whether there was any to grow.
    #[inline]
    fn widen(reached: &mut [u64], free: &[u64]) -> bool {
        let (mut any, mut below) = (0, 0);
        let words = reached.len().min(free.len());
        for word in 0..words {
            let here = reached[word];
            let above = match word + 1 < words {
                true => reached[word + 1] << (64 - Self::BITS),
                false => 0,
            };
            let new = (Self::spread(here) | above | below) & free[word] & !here;
            reached[word] = here | new;
            any |= new;
            below = here >> (64 - Self::BITS);
        }
        any != 0
    }

    /// Grows what is reached in a layer, down and up; whether there may be more of it.
    #[inline]
    fn grow(reached: &mut [u64], free: &[u64]) -> bool {
        // from one layer to the next there is little to grow
        if !Self::widen(reached, free) || !Self::widen(reached, free) {
            return false;
        }
        let mut from_last = 0;
        for (reached, free) in reached.iter_mut().zip(free) {
            *reached = Self::grown((*reached | from_last) & free, *free);
            from_last = *reached >> (64 - Self::BITS);
        }
        let mut from_next = 0;
        for (reached, free) in reached.iter_mut().zip(free).rev() {
            *reached = Self::grown((*reached | from_next) & free, *free);
            from_next = *reached << (64 - Self::BITS);
        }
        Self::widen(reached, free)
    }

    /// Grows what is reached, some voxels of the layer `first`, to all free voxels that are
    /// connected to it through faces; false where there was no end to it. A layer has `words`.
    pub(super) fn flood(words: usize, first: usize, free: &[u64], reached: &mut [u64]) -> bool {
        let layers = free.len() / words.max(1);
        // a bit for each layer that is to grow, of at most 32, and one beyond
        let mut waiting = 1_u64 << (first & 31);
        for _ in 0..MAX_GROWTHS * layers {
            if waiting == 0 {
                return true;
            }
            let z = waiting.trailing_zeros() as usize;
            waiting &= waiting - 1;
            let (below, rest) = reached.split_at_mut(z * words);
            let (here, above) = rest.split_at_mut(words);
            let (free_below, free) = free.split_at(z * words);
            let (free, free_above) = free.split_at(words);
            waiting |= u64::from(Self::grow(here, free)) << z;
            if z > 0 {
                let last = (z - 1) * words;
                let any = pour(here, &free_below[last..], &mut below[last..]);
                waiting |= u64::from(any) << (z - 1);
            }
            waiting |= u64::from(pour(here, free_above, above)) << (z + 1);
        }
        false
    }
}

/// From a layer to the one after it; whether that reaches anything new.
#[inline]
fn pour(from: &[u64], free: &[u64], to: &mut [u64]) -> bool {
    let mut any = 0;
    for ((from, free), to) in from.iter().zip(free).zip(to) {
        let new = from & free & !*to;
        *to |= new;
        any |= new;
    }
    any != 0
}

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

impl<const LOG: u32> Rows<LOG> {
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

impl<const LOG: u32> Rows<LOG> {
    /// The first row of a word in eight groups of bits, each in 16 bits of its own.
    #[inline]
    pub(super) fn in_cells(word: u64) -> [u64; 2] {
        let group = 1 << (LOG - 3);
        let bits = |count: u32| (1_u64 << count) - 1;
        let spread = |half: u64| {
            let pairs =
                (half | half << (32 - 2 * group)) & (bits(2 * group) * 0x0000_0001_0000_0001);
            (pairs | pairs << (16 - group)) & (bits(group) * 0x0001_0001_0001_0001)
        };
        [0, 4 * group].map(|first| spread(word >> first & bits(4 * group)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same, voxel by voxel; rows of `width` voxels, `height` of them in a layer.
    fn reached_plainly(free: &[u64], [width, height]: [usize; 2], start: usize) -> Vec<u64> {
        let is_set = |bits: &[u64], voxel: usize| bits[voxel / 64] >> (voxel % 64) & 1 == 1;
        let (layer, count) = (width * height, free.len() * 64);
        let mut filled = vec![0; free.len()];
        let mut stack = vec![start];
        while let Some(voxel) = stack.pop() {
            if !is_set(free, voxel) || is_set(&filled, voxel) {
                continue;
            }
            filled[voxel / 64] |= 1 << (voxel % 64);
            let [x, y, z] = [voxel % width, voxel / width % height, voxel / layer];
            let steps = [
                (x > 0, voxel.wrapping_sub(1)),
                (x + 1 < width, voxel + 1),
                (y > 0, voxel.wrapping_sub(width)),
                (y + 1 < height, voxel + width),
                (z > 0, voxel.wrapping_sub(layer)),
                ((z + 1) * layer < count, voxel + layer),
            ];
            stack.extend(
                steps
                    .into_iter()
                    .filter_map(|(inside, to)| inside.then_some(to)),
            );
        }
        filled
    }

    fn check<const LOG: u32>(words: usize) {
        let mut random = oorandom::Rand64::new(u128::from(LOG));
        let mut finished = 0;
        for run in 0..3000 {
            let share = 0.3 + 0.1 * f64::from(run % 7);
            let mut free = vec![0_u64; 8 * words];
            for word in &mut free {
                *word = (0..64).fold(0, |word, _| {
                    word << 1 | u64::from(random.rand_float() < share)
                });
            }
            let start = random.rand_range(0..64 * free.len() as u64) as usize;
            free[start / 64] |= 1 << (start % 64);
            let mut reached = vec![0; free.len()];
            reached[start / 64] = 1 << (start % 64);
            let complete = Rows::<LOG>::flood(words, start / 64 / words, &free, &mut reached);
            let size = [1 << LOG, (words * 64) >> LOG];
            let truth = reached_plainly(&free, size, start);
            let beyond = reached
                .iter()
                .zip(&truth)
                .any(|(flood, truth)| flood & !truth != 0);
            assert!(!beyond, "a voxel that no way leads to");
            assert!(!complete || reached == truth, "not all of it");
            finished += u32::from(complete);
        }
        // ways through noise just dense enough to connect are the longest
        assert!(finished > 2990, "{finished} of 3000 came to an end");
    }

    #[test]
    fn a_flood_through_rows_of_any_length_reaches_what_single_steps_reach() {
        check::<3>(1);
        check::<4>(4);
        check::<5>(16);
        check::<4>(2);
    }

    #[test]
    fn a_flood_goes_up_to_the_last_of_32_layers() {
        let free = vec![u64::MAX; 32];
        let mut reached = vec![0; 32];
        reached[3] = 1;
        assert!(Rows::<3>::flood(1, 3, &free, &mut reached));
        assert!(reached == free);
    }
}
