//! Which voxels of a window can be reached face to face: a flood on the bits.
//!
//! Memory: a window is layers along z of words of rows along x (`bit_rows.rs`). A whole layer
//! grows in a few operations, and only layers that something new came into grow at all.

use crate::contact::bit_rows::Rows;

/// Most growths of a layer, for each layer. Paths that wind more are cut short: what is reached
/// is then a part of what could be, and still legal.
const MAX_GROWTHS: usize = 24;

/// Voxels by which a layer grows before all of it is swept, which takes as long as some of them.
const WIDENINGS: usize = 2;

/// The voxels of a window of 8×8×8, a word for each z, bit y·8 + x, that are reached from
/// `start` through faces and free voxels; `start` is one bit of the word `z`, and counts as free.
pub(crate) fn reached(free: &[u64; 8], z: usize, start: u64) -> [u64; 8] {
    let (mut free, mut reached) = (*free, [0; 8]);
    let z = z & 7;
    free[z] |= start;
    reached[z] = start;
    flood::<3, 1>(z, free.as_chunks().0, reached.as_chunks_mut().0);
    reached
}

/// Grows what is reached, some voxels of the layer `first`, to all free voxels that are
/// connected to it through faces; false where there was no end to it. A layer has `WORDS` of
/// rows of 2^`LOG` bits; there are 32 at most.
#[inline(always)]
pub(crate) fn flood<const LOG: u32, const WORDS: usize>(
    first: usize,
    free: &[[u64; WORDS]],
    reached: &mut [[u64; WORDS]],
) -> bool {
    let layers = free.len().min(reached.len()).min(32);
    // a bit for each layer that is to grow
    let mut waiting = 1_u64 << (first & 31);
    for _ in 0..MAX_GROWTHS * layers {
        if waiting == 0 {
            return true;
        }
        let z = waiting.trailing_zeros() as usize;
        waiting &= waiting - 1;
        let (Some(here), Some(free_here)) = (reached.get_mut(z), free.get(z)) else {
            continue;
        };
        waiting |= u64::from(grow::<LOG, WORDS>(here, free_here)) << z;
        let here = *here;
        for beside in [z.wrapping_sub(1), z + 1] {
            if let (Some(to), Some(free)) = (reached.get_mut(beside), free.get(beside)) {
                waiting |= u64::from(pour(&here, free, to)) << beside;
            }
        }
    }
    waiting == 0
}

/// Grows what is reached in a layer, down and up; whether there may be more of it.
#[inline(always)]
fn grow<const LOG: u32, const WORDS: usize>(
    reached: &mut [u64; WORDS],
    free: &[u64; WORDS],
) -> bool {
    // from one layer to the next there is little to grow
    for _ in 0..WIDENINGS {
        if !widen::<LOG, WORDS>(reached, free) {
            return false;
        }
    }
    sweep::<LOG, WORDS>(reached, free);
    widen::<LOG, WORDS>(reached, free)
}

/// Grows what is reached in a layer along its rows, then from row to row, down and up.
#[inline(always)]
fn sweep<const LOG: u32, const WORDS: usize>(reached: &mut [u64; WORDS], free: &[u64; WORDS]) {
    along::<LOG, WORDS>(reached, free);
    let to_next = 64 - Rows::<LOG>::BITS;
    let mut from_last = 0;
    for (reached, free) in reached.iter_mut().zip(free) {
        *reached = Rows::<LOG>::up(*reached | from_last & free, *free);
        from_last = *reached >> to_next;
    }
    let mut from_next = 0;
    for (reached, free) in reached.iter_mut().zip(free).rev() {
        *reached = Rows::<LOG>::down(*reached | from_next & free, *free);
        from_next = *reached << to_next;
    }
    along::<LOG, WORDS>(reached, free);
}

/// Grows what is reached in a layer along its rows, each word on its own, so that several go at
/// once.
#[inline(always)]
fn along<const LOG: u32, const WORDS: usize>(reached: &mut [u64; WORDS], free: &[u64; WORDS]) {
    for word in 0..WORDS {
        reached[word] = Rows::<LOG>::along(reached[word], free[word]);
    }
}

/// Grows what is reached in a layer by one voxel; whether there was any to grow.
#[inline(always)]
fn widen<const LOG: u32, const WORDS: usize>(
    reached: &mut [u64; WORDS],
    free: &[u64; WORDS],
) -> bool {
    let to_next = 64 - Rows::<LOG>::BITS;
    let here = *reached;
    // each on its own, so that several words go at once
    let mut beside = [0; WORDS];
    for word in 0..WORDS {
        beside[word] = Rows::<LOG>::spread(here[word]);
    }
    for word in 1..WORDS {
        beside[word] |= here[word - 1] >> to_next;
    }
    for word in 1..WORDS {
        beside[word - 1] |= here[word] << to_next;
    }
    let mut any = 0;
    for word in 0..WORDS {
        let new = beside[word] & free[word] & !here[word];
        reached[word] |= new;
        any |= new;
    }
    any != 0
}

/// From a layer to the one after it; whether that reaches anything new.
#[inline(always)]
fn pour<const WORDS: usize>(
    from: &[u64; WORDS],
    free: &[u64; WORDS],
    to: &mut [u64; WORDS],
) -> bool {
    let mut any = 0;
    for word in 0..WORDS {
        let new = from[word] & free[word] & !to[word];
        to[word] |= new;
        any |= new;
    }
    any != 0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same, voxel by voxel.
    fn reached_plainly(free: &[u64; 8], start: [i32; 3]) -> [u64; 8] {
        let mut filled = [0_u64; 8];
        let mut stack = vec![start];
        while let Some([x, y, z]) = stack.pop() {
            if [x, y, z].iter().any(|i| !(0..8).contains(i)) {
                continue;
            }
            let bit = 1 << (8 * y + x);
            let open = free[z as usize] & bit != 0 || [x, y, z] == start;
            if !open || filled[z as usize] & bit != 0 {
                continue;
            }
            filled[z as usize] |= bit;
            for (dx, dy, dz) in [(1, 0, 0), (0, 1, 0), (0, 0, 1)] {
                stack.push([x + dx, y + dy, z + dz]);
                stack.push([x - dx, y - dy, z - dz]);
            }
        }
        filled
    }

    #[test]
    fn a_flood_reaches_what_single_steps_reach() {
        let mut random = oorandom::Rand64::new(1);
        for run in 0..20_000 {
            let share = 0.3 + 0.1 * f64::from(run % 7);
            let free = [0; 8].map(|_| {
                (0..64).fold(0_u64, |word, _| {
                    word << 1 | u64::from(random.rand_float() < share)
                })
            });
            let start = [0; 3].map(|_| random.rand_range(0..8) as i32);
            let [x, y, z] = start;
            let flood = reached(&free, z as usize, 1 << (8 * y + x));
            assert_eq!(flood, reached_plainly(&free, start));
        }
    }

    /// A way through all rows of all layers takes more passes than there are.
    #[test]
    fn a_way_too_winding_is_cut_short_but_never_left() {
        let row = |y: i32| 0xff_u64 << (8 * y);
        // rows 0, 2, 4, 6 joined at alternating ends; layers 0, 2, 4, 6 at alternating rows
        let joints = 1 << 15 | 1 << 24 | 1 << 47;
        let layer = row(0) | row(2) | row(4) | row(6) | joints;
        let [first, last] = [1, 1 << 48];
        let free = [layer, last, layer, first, layer, last, layer, 0];
        let flood = reached(&free, 0, 1);
        let truth = reached_plainly(&free, [0, 0, 0]);
        assert!(
            flood
                .iter()
                .zip(truth)
                .all(|(&flood, truth)| flood & !truth == 0)
        );
        assert!(truth.iter().map(|word| word.count_ones()).sum::<u32>() > 140);
    }

    /// The same, voxel by voxel; rows of `width` voxels, `height` of them in a layer.
    fn reached_in_rows(free: &[u64], [width, height]: [usize; 2], start: usize) -> Vec<u64> {
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

    fn check<const LOG: u32, const WORDS: usize>() {
        let mut random = oorandom::Rand64::new(u128::from(LOG));
        let mut finished = 0;
        for run in 0..3000 {
            let share = 0.3 + 0.1 * f64::from(run % 7);
            let mut free = vec![0_u64; 8 * WORDS];
            for word in &mut free {
                *word = (0..64).fold(0, |word, _| {
                    word << 1 | u64::from(random.rand_float() < share)
                });
            }
            let start = random.rand_range(0..64 * free.len() as u64) as usize;
            free[start / 64] |= 1 << (start % 64);
            let mut reached = vec![0; free.len()];
            reached[start / 64] = 1 << (start % 64);
            let layers = free.as_chunks().0;
            let first = start / 64 / WORDS;
            let complete = flood::<LOG, WORDS>(first, layers, reached.as_chunks_mut().0);
            let size = [1 << LOG, (WORDS * 64) >> LOG];
            let truth = reached_in_rows(&free, size, start);
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
        check::<3, 1>();
        check::<4, 4>();
        check::<5, 16>();
        check::<4, 2>();
    }

    #[test]
    fn a_flood_goes_up_to_the_last_of_32_layers() {
        let free = vec![u64::MAX; 32];
        let mut reached = vec![0; 32];
        reached[3] = 1;
        assert!(flood::<3, 1>(
            3,
            free.as_chunks().0,
            reached.as_chunks_mut().0
        ));
        assert!(reached == free);
    }
}
