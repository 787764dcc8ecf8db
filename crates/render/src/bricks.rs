//! Lowest and highest value of each brick of 8×8×8 voxels, and how far empty space reaches.
//!
//! A brick's range also covers the voxels around it that interpolation inside it reads, so that leaping
//! over a brick in which no value is drawn changes no pixel.
//!
//! Source: Cohen and Sheffer, "Proximity clouds", The Visual Computer 11 (1994).

use glam::{IVec3, UVec3};
use palpate_volume::brick_grid::BRICK;
use palpate_volume::voxel_box::VoxelBox;
use rayon::prelude::*;

use crate::field::Field;
use crate::lanes::{Floats, Gather, Ints, Masks, Vector};

/// Farthest distance that is kept [bricks].
const FARTHEST: u8 = 255;

/// Value ranges of bricks, x fastest.
#[derive(Clone, Debug)]
pub(crate) struct BrickRanges {
    pub counts: IVec3,
    pub ranges: Vec<(i16, i16)>,
}

impl BrickRanges {
    pub fn new(field: &Field) -> Self {
        let counts = counts_of(field.dimensions());
        let mut ranges = vec![(i16::MAX, i16::MIN); counts.element_product() as usize];
        ranges
            .par_chunks_mut(counts.x as usize)
            .enumerate()
            .for_each_init(RowRange::default, |row, (index, ranges)| {
                let (y, z) = (index as i32 % counts.y, index as i32 / counts.y);
                row.read(field, (0, y, z), ranges);
            });
        Self { counts, ranges }
    }

    /// Reads again the bricks that reach into a box of voxels.
    pub fn renew(&mut self, field: &Field, low: IVec3, high: IVec3) {
        let last = self.counts - 1;
        let first = ((low - 1) >> 3_i32).clamp(IVec3::ZERO, last);
        let end = ((high + 1) >> 3_i32).clamp(IVec3::ZERO, last);
        let mut row = RowRange::default();
        for z in first.z..=end.z {
            for y in first.y..=end.y {
                let start = self.counts.x * (y + self.counts.y * z);
                let bricks = (start + first.x) as usize..=(start + end.x) as usize;
                row.read(field, (first.x, y, z), &mut self.ranges[bricks]);
            }
        }
    }
}

/// Bricks along each axis.
pub(crate) fn counts_of(dimensions: UVec3) -> IVec3 {
    (dimensions.as_ivec3() + (BRICK - 1)) / BRICK
}

/// Least and most of columns of voxels that go through a row of bricks; memory for the next row.
#[derive(Default)]
struct RowRange {
    least: Vec<i16>,
    most: Vec<i16>,
    memory: Vec<i16>,
}

impl RowRange {
    /// Reads the ranges of bricks of a row from one on.
    fn read(&mut self, field: &Field, (x, y, z): (i32, i32, i32), ranges: &mut [(i16, i16)]) {
        let size = field.dimensions().as_ivec3();
        let reach = |brick: i32, bricks: i32, size: i32| {
            (brick * BRICK - 1).max(0)..((brick + bricks) * BRICK + 1).min(size)
        };
        let columns = reach(x, ranges.len() as i32, size.x);
        let columns = columns.start as usize..columns.end as usize;
        self.reset(columns.len());
        for z in reach(z, 1, size.z) {
            for y in reach(y, 1, size.y) {
                let row = field.row(y, z, &columns, &mut self.memory);
                let sides = self.least.iter_mut().zip(&mut self.most);
                for ((least, most), &value) in sides.zip(row) {
                    *least = value.min(*least);
                    *most = value.max(*most);
                }
            }
        }
        for (brick, range) in (x..).zip(ranges) {
            let own = reach(brick, 1, size.x);
            let own = own.start as usize - columns.start..own.end as usize - columns.start;
            let least = self.least[own.clone()].iter().min();
            let most = self.most[own].iter().max();
            *range = least
                .zip(most)
                .map_or(*range, |(&least, &most)| (least, most));
        }
    }

    fn reset(&mut self, columns: usize) {
        for (values, value) in [
            (&mut self.least, i16::MAX),
            (&mut self.most, i16::MIN),
            (&mut self.memory, 0),
        ] {
            values.clear();
            values.resize(columns, value);
        }
    }
}

/// How far from each brick nothing is drawn.
#[derive(Clone, Debug)]
pub(crate) struct EmptySpace {
    counts: IVec3,
    /// Chebyshev distance to the nearest brick in which something is drawn, 0 in one; three bytes of padding.
    distances: Vec<u8>,
}

impl EmptySpace {
    /// Of bricks of which some are filled.
    pub fn new(counts: IVec3, filled: impl Fn(usize) -> bool + Sync) -> Self {
        let count = counts.element_product() as usize;
        let distances = (0..count)
            .into_par_iter()
            .map(|brick| distance_of(filled(brick)))
            .collect();
        Self::spread(counts, distances)
    }

    /// Looks again at the bricks of a box of voxels within the scan; distances are others only where one was filled
    /// or emptied.
    pub fn renew(&mut self, voxels: &VoxelBox, filled: impl Fn(usize) -> bool) {
        let mut changed = Vec::new();
        let (low, high) = (voxels.min >> 3_i32, (voxels.max - 1) >> 3_i32);
        for z in low.z..=high.z {
            for y in low.y..=high.y {
                for x in low.x..=high.x {
                    let brick = (x + self.counts.x * (y + self.counts.y * z)) as usize;
                    let is_filled = filled(brick);
                    if is_filled != (self.distances[brick] == 0) {
                        changed.push((brick, is_filled));
                    }
                }
            }
        }
        if changed.is_empty() {
            return;
        }
        let count = self.counts.element_product() as usize;
        let mut distances: Vec<u8> = self.distances[..count]
            .iter()
            .map(|&distance| distance_of(distance == 0))
            .collect();
        for (brick, is_filled) in changed {
            distances[brick] = distance_of(is_filled);
        }
        *self = Self::spread(self.counts, distances);
    }

    /// From 0 in filled bricks and `FARTHEST` in all others.
    fn spread(counts: IVec3, mut distances: Vec<u8>) -> Self {
        let [columns, rows, layers] = counts.to_array().map(|count| count as usize);
        // along one axis after the other: within a box means within on every axis
        for (stride, size) in [(1, columns), (columns, rows), (columns * rows, layers)] {
            spread_along(&mut distances, stride, size);
        }
        distances.extend([0; 3]);
        Self { counts, distances }
    }

    /// Bricks from one to the nearest in which something is drawn; the nearest one outside the scan.
    pub fn distance(&self, brick: IVec3) -> u8 {
        let brick = brick.clamp(IVec3::ZERO, self.counts - 1);
        self.distances[(brick.x + self.counts.x * (brick.y + self.counts.y * brick.z)) as usize]
    }

    /// Length that can be leapt over from a place along a ray [mm], 0 in a filled brick and so many bricks beside it
    /// (`margin`). `inverse`: mm for each brick along each axis, without sign; `is_forward` where the ray runs toward
    /// higher numbers.
    #[inline(always)]
    pub fn ahead<L: Gather>(
        &self,
        grid: Vector<L>,
        margin: L::Float,
        inverse: Vector<L>,
        is_forward: [L::Mask; 3],
    ) -> L::Float {
        let eighth = L::Float::splat(1.0 / BRICK as f32);
        let place = grid.scaled(eighth);
        let (x, bx) = brick_along::<L>(place.x, self.counts.x);
        let (y, by) = brick_along::<L>(place.y, self.counts.y);
        let (z, bz) = brick_along::<L>(place.z, self.counts.z);
        let index = x + (y + z * Ints::splat(self.counts.y)) * Ints::splat(self.counts.x);
        // SAFETY: each coordinate was clamped to the bricks, of which there are three bytes more in memory
        let reach = unsafe { L::bytes(&self.distances, index) }.to_float() - margin;
        let zero = L::Float::splat(0.0);
        if !zero.less(reach).any() {
            return zero;
        }
        let before = reach - Floats::splat(1.0);
        let x = (bx + reach - place.x).or_else(is_forward[0], place.x - bx + before);
        let y = (by + reach - place.y).or_else(is_forward[1], place.y - by + before);
        let z = (bz + reach - place.z).or_else(is_forward[2], place.z - bz + before);
        let leap = (x * inverse.x).min(y * inverse.y).min(z * inverse.z);
        leap.or_else(zero.less(reach), zero)
    }
}

/// Place in memory of the brick that holds a place; of the nearest one outside the grid.
#[inline(always)]
pub(crate) fn brick_index<L: Gather>(grid: Vector<L>, counts: IVec3) -> L::Int {
    let place = grid.scaled(L::Float::splat(1.0 / BRICK as f32));
    let (x, _) = brick_along::<L>(place.x, counts.x);
    let (y, _) = brick_along::<L>(place.y, counts.y);
    let (z, _) = brick_along::<L>(place.z, counts.z);
    x + (y + z * Ints::splat(counts.y)) * Ints::splat(counts.x)
}

#[inline(always)]
fn brick_along<L: Gather>(place: L::Float, count: i32) -> (L::Int, L::Float) {
    let brick = place
        .floor()
        .max(Floats::splat(0.0))
        .min(Floats::splat((count - 1) as f32));
    (brick.truncated(), brick)
}

fn distance_of(is_filled: bool) -> u8 {
    if is_filled { 0 } else { FARTHEST }
}

/// For every line along an axis: the least over its bricks of the larger of value and distance. Lines lie side by
/// side, `stride` of them in each part.
fn spread_along(values: &mut [u8], stride: usize, size: usize) {
    values.par_chunks_mut(stride * size).for_each_init(
        || vec![0; stride * size],
        |before, values| {
            before.copy_from_slice(values);
            for away in 1..size.min(usize::from(FARTHEST)) {
                // nothing farther away brings less
                if values.iter().all(|&value| usize::from(value) <= away) {
                    break;
                }
                let shift = away * stride;
                let nearer = |value: &mut u8, other: u8| *value = other.max(away as u8).min(*value);
                let (ahead, behind) = (&before[shift..], &before[..size * stride - shift]);
                for (value, &other) in values.iter_mut().zip(ahead) {
                    nearer(value, other);
                }
                for (value, &other) in values[shift..].iter_mut().zip(behind) {
                    nearer(value, other);
                }
            }
        },
    );
}
