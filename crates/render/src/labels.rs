//! Which segment each voxel belongs to, in bricks: only where there are any.
//!
//! Memory: the bricks that have any one after the other, after one without, each of 8×8×8 bytes, x fastest.

use glam::{IVec3, UVec3};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::brick_grid::{BRICK, BrickGrid};
use palpate_volume::edit::SegmentId;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::Voxels;
use rayon::prelude::*;

use crate::bricks::counts_of;
use crate::lanes::{Floats, Gather, Ints, LANES, Masks, Vector};

/// Voxels of a brick.
const SIZE: usize = 512;

/// Bytes after the last brick, for look-ups of four.
const PADDING: usize = 3;

/// The number of the segment of each voxel, 0 for none; of several the last of the list.
#[derive(Clone, Debug)]
pub(crate) struct Labels {
    dimensions: UVec3,
    counts: IVec3,
    /// Which of the bricks in memory each brick is, x fastest; 0 where it has no segment.
    slots: Vec<i32>,
    labels: Vec<u8>,
    /// Bricks in memory that are no longer used.
    free: Vec<i32>,
}

/// Segments' numbers and their voxels.
type Solids<'a> = Vec<(u8, &'a BrickGrid<BitBrick>)>;

/// Segments of a list that have voxels of the scan; one with a grid of its own has none.
fn on_scan<'a>(voxels: &'a Voxels, segments: &[u8]) -> Solids<'a> {
    segments
        .iter()
        .filter_map(|&id| Some((id, voxels.segment(SegmentId(id))?)))
        .filter(|(_, segment)| segment.own_grid().is_none())
        .map(|(id, segment)| (id, segment.occupancy().bricks()))
        .collect()
}

fn is_held(solids: &Solids<'_>, brick: u32) -> bool {
    solids.iter().any(|(_, bits)| bits.get(brick).is_some())
}

/// Writes the numbers of a brick that had none.
fn paint(solids: &Solids<'_>, brick: u32, labels: &mut [u8]) {
    for (id, bricks) in solids {
        let Some(bits) = bricks.get(brick) else {
            continue;
        };
        for (layer, &word) in labels.chunks_exact_mut(64).zip(&bits.0) {
            let mut left = word;
            while left != 0 {
                layer[left.trailing_zeros() as usize] = *id;
                left &= left - 1;
            }
        }
    }
}

impl Labels {
    /// The voxels of these segments. None where there are no such segments.
    pub fn of(voxels: &Voxels, segments: &[u8]) -> Option<Self> {
        let solids = on_scan(voxels, segments);
        if solids.is_empty() {
            return None;
        }
        let dimensions = voxels.grid().dimensions();
        let counts = counts_of(dimensions);
        let count = counts.element_product() as u32;
        let held: Vec<u32> = (0..count)
            .into_par_iter()
            .filter(|&brick| is_held(&solids, brick))
            .collect();
        let mut slots = vec![0; count as usize];
        for (slot, &brick) in (1..).zip(&held) {
            slots[brick as usize] = slot;
        }
        let mut labels = vec![0; SIZE * (held.len() + 1) + PADDING];
        labels[SIZE..]
            .par_chunks_exact_mut(SIZE)
            .zip(&held)
            .for_each(|(labels, &brick)| paint(&solids, brick, labels));
        Some(Self {
            dimensions,
            counts,
            slots,
            labels,
            free: Vec::new(),
        })
    }

    /// With the voxels of a box from a later edit. None where there are no such segments any more.
    pub fn renewed(mut self, voxels: &Voxels, segments: &[u8], changed: &VoxelBox) -> Option<Self> {
        let solids = on_scan(voxels, segments);
        for brick in solids.first()?.1.indices_in(changed) {
            self.clear(brick);
            if is_held(&solids, brick) {
                let start = SIZE * self.take(brick);
                paint(&solids, brick, &mut self.labels[start..start + SIZE]);
            }
        }
        Some(self)
    }

    /// Gives a brick's memory back.
    fn clear(&mut self, brick: u32) {
        let slot = std::mem::take(&mut self.slots[brick as usize]);
        if slot > 0 {
            let start = SIZE * slot as usize;
            self.labels[start..start + SIZE].fill(0);
            self.free.push(slot);
        }
    }

    /// Memory for a brick.
    fn take(&mut self, brick: u32) -> usize {
        let slot = self.free.pop().unwrap_or_else(|| {
            let slot = self.labels.len() / SIZE;
            self.labels.resize(SIZE * (slot + 1) + PADDING, 0);
            slot as i32
        });
        self.slots[brick as usize] = slot;
        slot as usize
    }

    /// Whether a brick has a voxel of any segment.
    pub fn has_any(&self, brick: usize) -> bool {
        self.slots[brick] > 0
    }

    /// The segment of a voxel; of the nearest one outside the grid.
    #[inline]
    pub fn at(&self, voxel: IVec3) -> u8 {
        let voxel = voxel.clamp(IVec3::ZERO, self.dimensions.as_ivec3() - 1);
        let brick = voxel >> 3_i32;
        let index = brick.x + self.counts.x * (brick.y + self.counts.y * brick.z);
        let inside = voxel & (BRICK - 1);
        let start = SIZE * self.slots[index as usize] as usize;
        self.labels[start + (inside.x + 8 * (inside.y + 8 * inside.z)) as usize]
    }

    /// The segments at places; of the nearest voxels outside the grid.
    #[inline(always)]
    pub fn around<L: Gather>(&self, grid: Vector<L>) -> L::Int {
        let last = self.dimensions.as_vec3() - 1.0;
        let (x, y, z) = (
            voxel_along::<L>(grid.x, last.x),
            voxel_along::<L>(grid.y, last.y),
            voxel_along::<L>(grid.z, last.z),
        );
        let (columns, rows) = (Ints::splat(self.counts.x), L::Int::splat(self.counts.y));
        let layer = z.shifted_right::<3>() * rows;
        let brick = x.shifted_right::<3>() + (y.shifted_right::<3>() + layer) * columns;
        // SAFETY: the voxels lie within the grid, and so do their bricks
        let slot = unsafe { L::ints(&self.slots, brick) };
        let held = slot.greater(Ints::splat(0));
        if !held.any() {
            return slot;
        }
        if self.labels.len() > i32::MAX as usize {
            return self.one_by_one::<L>(x, y, z);
        }
        let end = L::Int::splat(BRICK - 1);
        let inside = x.and(end) + y.and(end).shifted_left::<3>() + z.and(end).shifted_left::<6>();
        // SAFETY: slots tell of whole bricks in memory, behind which there are three bytes more
        unsafe { L::bytes(&self.labels, slot.shifted_left::<9>() + inside) }
    }

    /// The segments of voxels of a scan with more labels than lanes can count.
    #[inline(never)]
    fn one_by_one<L: Gather>(&self, x: L::Int, y: L::Int, z: L::Int) -> L::Int {
        let (x, y, z) = (x.store(), y.store(), z.store());
        let mut found = [0; LANES];
        for (lane, found) in found.iter_mut().enumerate() {
            *found = i32::from(self.at(IVec3::new(x[lane], y[lane], z[lane])));
        }
        Ints::load(&found)
    }
}

#[inline(always)]
fn voxel_along<L: Gather>(place: L::Float, last: f32) -> L::Int {
    place
        .max(Floats::splat(0.0))
        .min(Floats::splat(last))
        .truncated()
}
