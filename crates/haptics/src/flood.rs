//! Which voxels of a window can be reached face to face: a flood on the bits.
//!
//! Memory: one word per z, bit y·8 + x, as in a brick. A whole layer grows in a few
//! operations, so a flood costs some ten operations per layer and pass.

/// Bit x = 0 of every row, and x = 7.
const LEFT: u64 = 0x0101_0101_0101_0101;
const RIGHT: u64 = 0x8080_8080_8080_8080;

/// Most passes. Paths that wind more than any in a window of eight voxels need to are cut
/// short: what is reached is then a part of what could be, and still legal.
const MAX_PASSES: usize = 32;

/// The voxels of `free` that are reached from `start` through faces; `start` is one bit of
/// the word `z`, and counts as free.
pub(crate) fn reached(free: &[u64; 8], z: usize, start: u64) -> [u64; 8] {
    let mut filled = [0; 8];
    if let Some(word) = filled.get_mut(z) {
        *word = start;
    }
    for _ in 0..MAX_PASSES {
        let before = filled;
        // up and down again, each layer fed by the one before it
        for z in 0..8 {
            let below = if z > 0 { filled[z - 1] } else { 0 };
            filled[z] = grown(filled[z] | (below & free[z]), free[z]);
        }
        for z in (0..7).rev() {
            filled[z] = grown(filled[z] | (filled[z + 1] & free[z]), free[z]);
        }
        if filled == before {
            break;
        }
    }
    filled
}

/// A layer grown by one voxel through its free faces, twice.
fn grown(layer: u64, free: u64) -> u64 {
    let once = layer | (spread(layer) & free);
    once | (spread(once) & free)
}

/// The four neighbours in a layer, without wrapping from row to row.
fn spread(layer: u64) -> u64 {
    ((layer & !RIGHT) << 1) | ((layer & !LEFT) >> 1) | (layer << 8) | (layer >> 8)
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
}
