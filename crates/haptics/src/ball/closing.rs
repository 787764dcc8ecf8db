//! What a ball cannot get into, filled: holes and gaps narrower than it would not be felt by it.
//!
//! A free voxel stays free where a box that fits about into the ball holds it and is free; all
//! others become solid (a closing by that box). Boxes along the voxels fit into any stairs, so
//! that slopes of every direction and all that bulges stay as they are, to the voxel, where a
//! closing by the ball itself would fill all stairs up to their corners.
//!
//! Frame: grid. Source: Serra, "Image Analysis and Mathematical Morphology" (1982), ch. II.

use crate::ball::cache::BallCache;
use crate::ball::shape::BallShape;
use glam::{DVec3, IVec3};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::block::block_of_bricks;
use palpate_volume::brick_grid::BRICK;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::simd_dispatch;
use palpate_volume::voxel_box::VoxelBox;
use std::ops::Range;

/// Edge of the box in radii of the ball: a square across a round hole that the ball closes.
const EDGE: f64 = 1.4;
/// Longest edge of the box [voxels].
const LONGEST: i32 = 4;
/// Voxels around a brick that matter.
const MARGIN: i32 = LONGEST - 1;
/// Voxels along each edge of a brick and what is around it.
const SIDE: usize = 16;

/// A box, and the bricks that were filled with it. It belongs to one occupancy; whoever changes
/// that says where.
#[derive(Debug)]
pub(crate) struct Closing {
    /// Voxels along each edge of the box.
    edges: IVec3,
    cache: BallCache,
}

impl Closing {
    /// A closing for a ball of this shape; nothing is allocated later.
    pub(crate) fn new(shape: &BallShape) -> Self {
        Self {
            edges: edges(shape),
            cache: BallCache::new(),
        }
    }

    /// Takes another ball.
    pub(crate) fn set_shape(&mut self, shape: &BallShape) {
        self.edges = edges(shape);
        self.cache.invalidate();
    }

    /// These voxels of the occupancy may have changed.
    pub(crate) fn invalidate_box(&mut self, changed: &VoxelBox) {
        if !changed.is_empty() {
            self.cache.invalidate_box(&changed.dilate(MARGIN));
        }
    }

    /// The voxels from `min` on, holes filled.
    #[inline]
    pub(crate) fn block(&self, inner: &impl Occupancy, min: IVec3) -> BitBrick {
        if self.edges == IVec3::ONE {
            return inner.smooth_block(min);
        }
        self.filled(inner, min)
    }

    /// Works out the brick that begins at a voxel, if it is not known; whether there was any work.
    pub(crate) fn prepare(&self, inner: &impl Occupancy, min: IVec3) -> bool {
        if self.edges == IVec3::ONE || self.cache.knows(min >> 3_i32) {
            return false;
        }
        self.filled(inner, min);
        true
    }

    #[inline(never)]
    fn filled(&self, inner: &impl Occupancy, min: IVec3) -> BitBrick {
        block_of_bricks(min, |corner| {
            // a block that stands on bricks along an axis needs none beyond
            if corner.cmpge(min + BRICK).any() {
                return BitBrick::EMPTY;
            }
            let fill = |place: IVec3| closed_brick(inner, self.edges, place * BRICK);
            self.cache.brick(corner >> 3_i32, fill)
        })
    }
}

/// Edges of the box that a ball of this shape fits [voxels].
fn edges(shape: &BallShape) -> IVec3 {
    let edges: DVec3 = (EDGE * shape.radius_mm() / shape.spacing()).ceil();
    edges.as_ivec3().clamp(IVec3::ONE, IVec3::splat(LONGEST))
}

/// Rows along x of a brick and what is around it, by z and y.
type Rows = [[u16; SIDE]; SIDE];

/// The brick whose first voxel is `corner`, holes filled by a box.
fn closed_brick(inner: &impl Occupancy, edges: IVec3, corner: IVec3) -> BitBrick {
    // filling takes nothing away
    if inner.smooth_block(corner) == BitBrick::FULL {
        return BitBrick::FULL;
    }
    let Some(mut rows) = read(inner, corner) else {
        return BitBrick::EMPTY;
    };
    close(&mut rows, edges);

    let first = MARGIN as usize;
    BitBrick(std::array::from_fn(|z| {
        let layer = &rows[first + z];
        u64::from_le_bytes(std::array::from_fn(|y| (layer[first + y] >> first) as u8))
    }))
}

simd_dispatch! {
    /// Makes those voxels solid that no free box holds.
    fn close(rows: &mut Rows, edges: IVec3) = [avx2] close_plainly
}

#[inline(always)]
fn close_plainly(rows: &mut Rows, edges: IVec3) {
    // solid wherever a box with its first corner there, going down, holds a solid voxel ...
    dilate(rows, edges);
    // ... and all of those boxes that hold the voxel do
    erode(rows, edges);
}

/// Reads a brick and what is around it; none where nothing is solid. Whole bricks are read, since
/// blocks between them would each be put together from eight.
fn read(inner: &impl Occupancy, corner: IVec3) -> Option<Rows> {
    let mut rows = [[0; SIDE]; SIDE];
    let mut any = 0;
    for (z, layers) in BESIDE {
        for (y, lines) in BESIDE {
            let along_x = BESIDE.map(|(x, _)| {
                let place = IVec3::new(x, y, z);
                inner.smooth_block(corner + BRICK * place).0
            });
            for layer in layers.clone() {
                let [before, here, after] = along_x.map(|brick| brick[layer]);
                if before | here | after == 0 {
                    continue;
                }
                any |= before | here | after;
                let bytes = [before, here, after].map(u64::to_le_bytes);
                let rows = &mut rows[place_of(z, layer)];
                for line in lines.clone() {
                    let row =
                        u32::from_le_bytes([bytes[0][line], bytes[1][line], bytes[2][line], 0]);
                    rows[place_of(y, line)] = (row >> (BRICK - MARGIN)) as u16;
                }
            }
        }
    }
    (any != 0).then_some(rows)
}

/// The bricks before, at and after a place along an axis, and their layers that matter.
const BESIDE: [(i32, Range<usize>); 3] = [
    (-1, (BRICK - MARGIN) as usize..8),
    (0, 0..8),
    (1, 0..MARGIN as usize),
];

/// Where the layer of a brick stands among the rows.
fn place_of(brick: i32, layer: usize) -> usize {
    (BRICK * brick + MARGIN + layer as i32) as usize & (SIDE - 1)
}

/// Joins each voxel with those before it, in steps that double.
#[inline(always)]
fn dilate(rows: &mut Rows, edges: IVec3) {
    for step in steps(edges.x) {
        for row in rows.as_flattened_mut() {
            *row |= *row << step;
        }
    }
    for step in steps(edges.y) {
        for layer in rows.iter_mut() {
            let old = *layer;
            for (row, before) in layer[step as usize..].iter_mut().zip(old) {
                *row |= before;
            }
        }
    }
    for step in steps(edges.z) {
        let old = *rows;
        let rows = rows[step as usize..].as_flattened_mut();
        for (row, before) in rows.iter_mut().zip(old.as_flattened()) {
            *row |= before;
        }
    }
}

/// Leaves each voxel after which all are solid too; the last ones are too far away to matter.
#[inline(always)]
fn erode(rows: &mut Rows, edges: IVec3) {
    for step in steps(edges.x) {
        for row in rows.as_flattened_mut() {
            *row &= *row >> step;
        }
    }
    for step in steps(edges.y) {
        for layer in rows.iter_mut() {
            let old = *layer;
            for (row, after) in layer.iter_mut().zip(&old[step as usize..]) {
                *row &= after;
            }
        }
    }
    for step in steps(edges.z) {
        let old = *rows;
        let rows = rows.as_flattened_mut().iter_mut();
        for (row, after) in rows.zip(old[step as usize..].as_flattened()) {
            *row &= after;
        }
    }
}

/// Ways by which something joined with itself covers `count` places.
#[inline(always)]
fn steps(count: i32) -> impl Iterator<Item = i32> {
    let mut covered = 1;
    std::iter::from_fn(move || {
        let step = covered.min(count - covered);
        covered += step;
        (step > 0).then_some(step)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec3;
    use palpate_volume::bits::Bits;
    use palpate_volume::segment::Segment;

    fn body(is_solid: impl Fn(IVec3) -> bool + Sync) -> Bits {
        Segment::from_fn(UVec3::splat(40), is_solid)
            .occupancy()
            .clone()
    }

    fn closing(edges: IVec3) -> Closing {
        Closing {
            edges,
            cache: BallCache::new(),
        }
    }

    /// Whether a free box of voxels holds a voxel.
    fn is_held(bits: &Bits, edges: IVec3, voxel: IVec3) -> bool {
        let starts = VoxelBox::new(voxel - edges + 1, voxel + 1);
        starts.voxels().any(|start| {
            let held = VoxelBox::new(start, start + edges);
            held.voxels().all(|voxel| !bits.is_solid(voxel))
        })
    }

    #[test]
    fn free_is_what_a_free_box_holds() {
        let mut random = oorandom::Rand32::new(11);
        let numbers: Vec<u32> = (0..40 * 40 * 40)
            .map(|_| random.rand_range(0..100))
            .collect();
        let number = |voxel: IVec3| numbers[((voxel.z * 40 + voxel.y) * 40 + voxel.x) as usize];
        for (edges, share) in [
            ([1, 2, 3], 20),
            ([4, 4, 2], 2),
            ([4, 3, 4], 3),
            ([2, 1, 1], 50),
        ] {
            let bits = body(|voxel| number(voxel) < share);
            let edges = IVec3::from_array(edges);
            let closing = closing(edges);
            for voxel in VoxelBox::new(IVec3::splat(9), IVec3::new(25, 19, 19)).voxels() {
                let solid = closing.block(&bits, voxel).0[0] & 1 == 1;
                assert_eq!(solid, !is_held(&bits, edges, voxel), "{edges} {voxel}");
            }
        }
    }

    #[test]
    fn slopes_of_all_directions_stay_as_they_are() {
        let mut random = oorandom::Rand64::new(3);
        for _ in 0..20 {
            let normal = DVec3::from_array([(); 3].map(|()| 2.0 * random.rand_float() - 1.0));
            let is_below = |voxel: IVec3| (voxel.as_dvec3() - 20.0).dot(normal) < 0.0;
            let plane = body(is_below);
            let brick = closing(IVec3::splat(LONGEST)).block(&plane, IVec3::splat(16));
            assert_eq!(brick, plane.block(IVec3::splat(16)), "{normal}");
        }
    }

    #[test]
    fn a_shaft_narrower_than_the_box_is_filled_and_one_as_wide_is_not() {
        for width in [3, 4] {
            let in_shaft = |x: i32| (18..18 + width).contains(&x);
            let shaft = body(|voxel| voxel.z < 22 && !(in_shaft(voxel.x) && in_shaft(voxel.y)));
            let solid = closing(IVec3::splat(4)).block(&shaft, IVec3::splat(16));
            let filled = body(|voxel| voxel.z < 22).block(IVec3::splat(16));
            assert_eq!(solid == filled, width < 4, "{width}");
        }
    }
}
