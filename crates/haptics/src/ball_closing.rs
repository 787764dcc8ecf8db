//! What a ball cannot get into, filled: holes and gaps narrower than it would not be felt by it.
//!
//! A free voxel stays free where a box that fits about into the ball holds it and is free; all
//! others become solid (a closing by that box). Boxes along the voxels fit into any stairs, so
//! that slopes of every direction and all that bulges stay as they are, to the voxel, where a
//! closing by the ball itself would fill all stairs up to their corners.
//!
//! Frame: grid. Source: Serra, "Image Analysis and Mathematical Morphology" (1982), ch. II.

use crate::ball_cache::BallCache;
use crate::ball_shape::BallShape;
use glam::{DVec3, IVec3};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::block::block_of_bricks;
use palpate_volume::brick_grid::BRICK;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::voxel_box::VoxelBox;

/// Edge of the box in radii of the ball: a square across a round hole that the ball closes.
const EDGE: f64 = 1.4;
/// Its longest edge [voxels].
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
    /// For a ball of this shape; nothing is allocated later.
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

/// Of the box that fits a ball.
fn edges(shape: &BallShape) -> IVec3 {
    let edges: DVec3 = (EDGE * shape.radius_mm() / shape.spacing()).ceil();
    edges.as_ivec3().clamp(IVec3::ONE, IVec3::splat(LONGEST))
}

/// Rows along x of a brick and what is around it, by z and y.
type Rows = [[u16; SIDE]; SIDE];

/// The brick whose first voxel is `corner`, holes filled by a box.
fn closed_brick(inner: &impl Occupancy, edges: IVec3, corner: IVec3) -> BitBrick {
    let Some(mut rows) = read(inner, corner - MARGIN) else {
        return BitBrick::EMPTY;
    };
    // solid wherever a box with its first corner there, going down, holds a solid voxel ...
    along_x(&mut rows, edges.x, |row, step| row | row << step);
    across(&mut rows, edges, |a, b| a | b, true);
    // ... and all of those boxes that hold the voxel do
    along_x(&mut rows, edges.x, |row, step| row & row >> step);
    across(&mut rows, edges, |a, b| a & b, false);

    let first = MARGIN as usize;
    BitBrick(std::array::from_fn(|z| {
        let layer = &rows[first + z];
        u64::from_le_bytes(std::array::from_fn(|y| (layer[first + y] >> first) as u8))
    }))
}

/// Reads 16×16×16 voxels; none where none is solid.
fn read(inner: &impl Occupancy, min: IVec3) -> Option<Rows> {
    let mut rows = [[0; SIDE]; SIDE];
    let mut any = 0;
    for [x, y, z] in (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2]) {
        let block = inner.smooth_block(min + BRICK * IVec3::new(x, y, z));
        for (layer, word) in rows[8 * z as usize..].iter_mut().zip(block.0) {
            any |= word;
            for (row, byte) in layer[8 * y as usize..].iter_mut().zip(word.to_le_bytes()) {
                *row |= u16::from(byte) << (8 * x);
            }
        }
    }
    (any != 0).then_some(rows)
}

/// Joins `count` neighbours along each row, in steps that double; `join` takes a row and how far
/// to move it.
fn along_x(rows: &mut Rows, count: i32, join: impl Fn(u16, i32) -> u16) {
    for step in steps(count) {
        for row in rows.iter_mut().flatten() {
            *row = join(*row, step);
        }
    }
}

/// The same along y and z, each row with those before it, or after it.
fn across(rows: &mut Rows, edges: IVec3, join: impl Fn(u16, u16) -> u16, before: bool) {
    let other = |place: usize, step: usize| match before {
        true => place.checked_sub(step),
        false => Some(place + step).filter(|&other| other < SIDE),
    };
    for step in steps(edges.y) {
        for layer in rows.iter_mut() {
            let old = *layer;
            for (place, row) in layer.iter_mut().enumerate() {
                if let Some(other) = other(place, step as usize) {
                    *row = join(*row, old[other]);
                }
            }
        }
    }
    for step in steps(edges.z) {
        let old = *rows;
        for (place, layer) in rows.iter_mut().enumerate() {
            let Some(other) = other(place, step as usize) else {
                continue;
            };
            for (row, other) in layer.iter_mut().zip(old[other]) {
                *row = join(*row, other);
            }
        }
    }
}

/// Ways by which something joined with itself covers `count` places.
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
