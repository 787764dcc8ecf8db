//! Lowest and highest value of each brick of 8×8×8 voxels, and how far empty space reaches.
//!
//! A brick's range also covers the voxels around it that interpolation inside it reads, so that leaping
//! over a brick in which no value is drawn changes no pixel.
//!
//! Source: Cohen and Sheffer, "Proximity clouds", The Visual Computer 11 (1994).

use glam::{IVec3, UVec3};
use palpate_volume::brick_grid::BRICK;
use rayon::prelude::*;

use crate::field::Field;
use crate::lanes::{Floats, Gather, Ints, Vector};

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
        let ranges = (0..counts.element_product())
            .into_par_iter()
            .map(|index| range_of(field, place(counts, index)))
            .collect();
        Self { counts, ranges }
    }

    /// Reads again the bricks that reach into a box of voxels.
    pub fn renew(&mut self, field: &Field, low: IVec3, high: IVec3) {
        let last = self.counts - 1;
        let first = ((low - 1) >> 3_i32).clamp(IVec3::ZERO, last);
        let end = ((high + 1) >> 3_i32).clamp(IVec3::ZERO, last);
        for z in first.z..=end.z {
            for y in first.y..=end.y {
                for x in first.x..=end.x {
                    let brick = IVec3::new(x, y, z);
                    let index = x + self.counts.x * (y + self.counts.y * z);
                    self.ranges[index as usize] = range_of(field, brick);
                }
            }
        }
    }
}

/// Bricks along each axis.
pub(crate) fn counts_of(dimensions: UVec3) -> IVec3 {
    (dimensions.as_ivec3() + (BRICK - 1)) / BRICK
}

fn place(counts: IVec3, index: i32) -> IVec3 {
    let row = index / counts.x;
    IVec3::new(index % counts.x, row % counts.y, row / counts.y)
}

fn range_of(field: &Field, brick: IVec3) -> (i16, i16) {
    let size = field.dimensions().as_ivec3();
    let low = (brick * BRICK - 1).max(IVec3::ZERO);
    let high = (brick * BRICK + BRICK + 1).min(size);
    let (mut least, mut most) = (i16::MAX, i16::MIN);
    for z in low.z..high.z {
        for y in low.y..high.y {
            field.for_row(low.x..high.x, y, z, |value| {
                least = least.min(value);
                most = most.max(value);
            });
        }
    }
    (least, most)
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
        let mut distances: Vec<u8> = (0..count)
            .into_par_iter()
            .map(|index| if filled(index) { 0 } else { FARTHEST })
            .collect();
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
        let before = reach - Floats::splat(1.0);
        let x = (bx + reach - place.x).or_else(is_forward[0], place.x - bx + before);
        let y = (by + reach - place.y).or_else(is_forward[1], place.y - by + before);
        let z = (bz + reach - place.z).or_else(is_forward[2], place.z - bz + before);
        let leap = (x * inverse.x).min(y * inverse.y).min(z * inverse.z);
        let zero = L::Float::splat(0.0);
        leap.or_else(zero.less(reach), zero)
    }
}

#[inline(always)]
fn brick_along<L: Gather>(place: L::Float, count: i32) -> (L::Int, L::Float) {
    let brick = place
        .floor()
        .max(Floats::splat(0.0))
        .min(Floats::splat((count - 1) as f32));
    (brick.truncated(), brick)
}

/// For every line along an axis: the least over its bricks of the larger of value and distance.
fn spread_along(values: &mut [u8], stride: usize, size: usize) {
    let mut line = vec![0; size];
    for start in (0..values.len()).filter(|start| (start / stride).is_multiple_of(size)) {
        for i in 0..size {
            line[i] = values[start + i * stride];
        }
        for i in 0..size {
            values[start + i * stride] = nearest_on_line(&line, i);
        }
    }
}

fn nearest_on_line(line: &[u8], i: usize) -> u8 {
    let mut best = line[i];
    for away in 1..=i.max(line.len() - 1 - i).min(usize::from(FARTHEST)) {
        if away >= usize::from(best) {
            break;
        }
        let before = i.checked_sub(away).map_or(FARTHEST, |i| line[i]);
        let after = line.get(i + away).copied().unwrap_or(FARTHEST);
        best = best.min(before.min(after).max(away as u8));
    }
    best
}
