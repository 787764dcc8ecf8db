//! The 8×8×8 voxels in which a slide looks for a better place, and distances in it.
//!
//! Frame: grid; memory as in a brick: one word per z, bit y·8 + x, from the window's own
//! corner. On each axis the window reaches [`BEHIND`] voxels away from the device and five
//! toward it, and never further than [`BEHIND`] voxels past the voxels between proxy and
//! device.

use crate::contact::voxel_distance::squared_along;
use glam::{DVec3, IVec3};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::walk::voxel_of;

/// Voxels that the window reaches away from the device. Two let the proxy climb the steps
/// of voxel stairs that hold it up; each more would also let it reach holes further away.
const BEHIND: i32 = 2;
/// Voxels that the window reaches toward the device: what is left of eight.
const TOWARD: i32 = 7 - BEHIND;

/// Bit 0 of every row of a word.
const ROWS: u64 = 0x0101_0101_0101_0101;

/// Where the window stands, and which of its voxels may be used.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SlideWindow {
    /// First voxel.
    pub(crate) min: IVec3,
    /// Usable offsets, first and last, per axis.
    first: IVec3,
    last: IVec3,
}

impl SlideWindow {
    /// The window for a proxy in voxel `from`.
    pub(crate) fn new(from: IVec3, device: DVec3) -> Self {
        let goal = voxel_of(device);
        let down = goal.cmplt(from);
        let min = from - IVec3::select(down, IVec3::splat(TOWARD), IVec3::splat(BEHIND));
        let first = from.min(goal) - BEHIND - min;
        let last = from.max(goal) + BEHIND - min;
        Self {
            min,
            first: first.max(IVec3::ZERO),
            last: last.min(IVec3::splat(7)),
        }
    }

    /// The free voxels of the window that a slide may use, one bit each.
    #[inline]
    pub(crate) fn free(&self, occupancy: &(impl Occupancy + ?Sized)) -> [u64; 8] {
        self.outside(&occupancy.block(self.min))
    }

    /// The usable voxels that are not solid.
    #[inline]
    pub(crate) fn outside(&self, solid: &BitBrick) -> [u64; 8] {
        let columns = span(self.first.x, self.last.x) * ROWS;
        let rows = span(8 * self.first.y, 8 * self.last.y + 7);
        let plane = columns & rows;
        std::array::from_fn(|z| {
            let usable = (self.first.z..=self.last.z).contains(&(z as i32));
            if usable { !solid.0[z] & plane } else { 0 }
        })
    }
}

/// Bits `first` to `last`, both of 0..64.
fn span(first: i32, last: i32) -> u64 {
    (!0 << first) & (!0 >> (63 - last))
}

/// Which of eight numbers are below a limit, a bit for each.
#[inline(always)]
fn below(numbers: [f64; 8], limit: f64) -> u64 {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_mm_cmplt_pd, _mm_movemask_pd, _mm_set_pd, _mm_set1_pd};
        let two = |i: usize| {
            // SAFETY: every such machine has these instructions
            let bits = unsafe {
                let two = _mm_set_pd(numbers[i + 1], numbers[i]);
                _mm_movemask_pd(_mm_cmplt_pd(two, _mm_set1_pd(limit)))
            };
            (bits as u64) << i
        };
        two(0) | two(2) | two(4) | two(6)
    }
    #[cfg(not(target_arch = "x86_64"))]
    packed(numbers.map(|number| u8::from(number < limit)))
}

/// Eight bytes of 0 or 1 as eight bits.
#[cfg(not(target_arch = "x86_64"))]
fn packed(bits: [u8; 8]) -> u64 {
    // each byte is moved to its own bit of the highest byte; no two meet
    u64::from_le_bytes(bits).wrapping_mul(0x0102_0408_1020_4080) >> 56
}

/// Eight bits as rows of eight.
fn whole_rows(rows: u64) -> u64 {
    // each row has the bit of its own number, and so a highest bit where 127 is added
    let own = (rows * ROWS) & 0x8040_2010_0804_0201;
    ((own + 0x7f * ROWS) >> 7 & ROWS) * 0xff
}

/// The smallest and the largest of the distances to layers.
fn span_of(layers: &[f64; 8]) -> [f64; 2] {
    let smaller = |a: f64, b: f64| if b < a { b } else { a };
    // by halves, which takes less long than one after the other
    let four: [f64; 4] = std::array::from_fn(|i| smaller(layers[i], layers[i + 4]));
    let two: [f64; 2] = std::array::from_fn(|i| smaller(four[i], four[i + 2]));
    let least = smaller(two[0], two[1]);
    // they fall up to the device and rise after it
    [least, layers[0].max(layers[7])]
}

/// Squared distances [mm²] from the device to each layer of the window, per axis; their sum
/// is the squared distance to a voxel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LayerDistances {
    x: [f64; 8],
    y: [f64; 8],
    z: [f64; 8],
}

impl LayerDistances {
    #[inline(always)]
    pub(crate) fn new(min: IVec3, device: DVec3, spacing: DVec3) -> Self {
        let layers = |min: i32, device: f64, spacing: f64| {
            std::array::from_fn(|i| squared_along(min + i as i32, device, spacing))
        };
        Self {
            x: layers(min.x, device.x, spacing.x),
            y: layers(min.y, device.y, spacing.y),
            z: layers(min.z, device.z, spacing.z),
        }
    }

    /// Squared distance to a voxel, by its offset in the window.
    #[inline(always)]
    pub(crate) fn of(&self, offset: IVec3) -> f64 {
        let at = |layers: &[f64; 8], i: i32| layers[(i & 7) as usize];
        at(&self.x, offset.x) + at(&self.y, offset.y) + at(&self.z, offset.z)
    }

    /// Those of `voxels` whose squared distance is below `limit`.
    ///
    /// Sums are taken in the order of [`Self::of`], so that a voxel is never found nearer than
    /// itself; they do not fall where a part of them rises, so that those of the nearest and of
    /// the farthest layer can decide for all between.
    #[inline(always)]
    pub(crate) fn nearer(&self, voxels: &[u64; 8], limit: f64) -> [u64; 8] {
        let [x, y, z] = [&self.x, &self.y, &self.z].map(span_of);
        // a box around what is nearer, without branches
        let columns = below(self.x.map(|x| x + y[0] + z[0]), limit) * ROWS;
        let rows = whole_rows(below(self.y.map(|y| x[0] + y + z[0]), limit));
        let layers = below(self.z.map(|z| x[0] + y[0] + z), limit);
        let in_box: [u64; 8] = std::array::from_fn(|z| {
            let layer = (layers >> z & 1).wrapping_neg();
            voxels[z] & columns & rows & layer
        });
        std::array::from_fn(|z| {
            let (word, z) = (in_box[z], self.z[z]);
            if word == 0 || x[1] + y[1] + z < limit {
                word
            } else {
                self.within(word, z, limit)
            }
        })
    }

    /// The part of one word within `limit`.
    #[inline(always)]
    fn within(&self, word: u64, z: f64, limit: f64) -> u64 {
        let (mut within, mut left) = (0, word);
        while left != 0 {
            let row = left.trailing_zeros() / 8;
            left &= !(0xff << (8 * row));
            let y = self.y[row as usize & 7];
            within |= below(self.x.map(|x| x + y + z), limit) << (8 * row);
        }
        word & within
    }

    /// The nearest of some voxels, by its offset; the first of several.
    pub(crate) fn nearest(&self, voxels: &[u64; 8]) -> Option<IVec3> {
        let mut best = (f64::INFINITY, None);
        for (z, &word) in voxels.iter().enumerate() {
            let mut left = word;
            while left != 0 {
                let bit = left.trailing_zeros() as i32;
                left &= left - 1;
                let offset = IVec3::new(bit & 7, bit >> 3, z as i32);
                let distance = self.of(offset);
                if distance < best.0 {
                    best = (distance, Some(offset));
                }
            }
        }
        best.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearer_voxels_are_those_whose_distance_is_below_the_limit() {
        let mut random = oorandom::Rand64::new(3);
        let spacing = DVec3::new(0.7, 0.7, 2.5);
        for _ in 0..2000 {
            let mut between = |low: f64, high: f64| low + (high - low) * random.rand_float();
            let device = DVec3::new(between(-9., 15.), between(-9., 15.), between(-9., 15.));
            let distances = LayerDistances::new(IVec3::ZERO, device, spacing);
            let free = [0; 8].map(|_| between(0.0, 1.8e19) as u64);
            // the distance of a voxel itself, so that equal ones must not count as nearer
            let offset = IVec3::new(3, 5, 2);
            let limit = distances.of(offset);
            let nearer = distances.nearer(&free, limit);
            for bit in 0..512 {
                let offset = IVec3::new(bit & 7, bit >> 3 & 7, bit >> 6);
                let is_set = |words: &[u64; 8]| words[(bit >> 6) as usize] >> (bit & 63) & 1 == 1;
                let expected = is_set(&free) && distances.of(offset) < limit;
                assert_eq!(is_set(&nearer), expected, "{offset} {device}");
            }
        }
    }

    #[test]
    fn the_window_holds_the_proxy_and_stays_between_it_and_the_device() {
        let from = IVec3::new(20, -4, 7);
        for device in [DVec3::new(22.5, -30.5, 7.5), DVec3::new(-900.0, 3.2, 8.0)] {
            let window = SlideWindow::new(from, device);
            let offset = from - window.min;
            assert!(offset.cmpge(window.first).all() && offset.cmple(window.last).all());
            // two behind on each axis, and five toward the device where it is that far
            let goal = voxel_of(device);
            let [first, last] = [window.first, window.last].map(|offset| offset + window.min);
            assert_eq!(first, (from.min(goal) - 2).max(from - 5));
            assert_eq!(last, (from.max(goal) + 2).min(from + 5));
        }
    }
}
