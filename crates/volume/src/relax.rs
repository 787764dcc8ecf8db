//! Where the surface of a mask goes between its voxels: the smoothest way that leaves solid voxels
//! on one side and free ones on the other.
//!
//! A mask has bits only, and a plane voxelised is stairs. But few smooth surfaces pass between the
//! middles of just these voxels: that of a voxelised plane is a plane, to within a part of a voxel.
//! It is looked for as the zero of a field φ on the voxels around the surface [mm, positive inside]:
//! of least bending, and near zero between each solid voxel and a free one beside it, the nearer
//! the less the surface can be elsewhere. On a flat terrace it can be anywhere in a voxel's
//! height; at the edge of the terrace, where the normal points past the next voxel, it is
//! known to a part of that. So flat slopes are carried by the edges of their terraces.
//!
//! Levels of voxels, each twice as wide as the one before, bring what is far apart together; each
//! is solved from what the coarser one has found. Where the field bends, bending costs less, so that
//! bodies keep their curvature and edges stay within their voxels. Around one place all of that is
//! a function of the bits around it, so that it can be done box by box, and again after an edit.
//!
//! Sources: Whitaker, "Reducing Aliasing Artifacts in Iso-Surfaces of Binary Volumes" (2000), for
//! the constraint; Lempitsky, "Surface Extraction from Binary Volumes with Higher-Order
//! Smoothness" (2010), for the bending energy; the weights of faces, the levels and the
//! curvature are ours.
//!
//! Frame: grid; normals and φ in mm.

mod band;
mod faces;
mod flats;
mod level;
mod solve;
mod terms;

use std::sync::Arc;

use glam::{IVec3, UVec3, Vec3};

use crate::bit_brick::BitBrick;
use crate::bits::Bits;
use crate::brick_grid::BrickSwap;
use crate::occupancy_fractions::{FractionBrick, OccupancyFractions, byte_of};
use crate::voxel_box::VoxelBox;
use level::Level;

/// Voxels along each side of a region.
const REGION: i32 = 64;
/// Cells around a box that a level looks at.
const MARGIN: i32 = 8;
/// Widest cells, in longest voxel sides.
const WIDEST: f32 = 8.0;
/// An axis is coarsened where cells are no longer than this along it, in their shortest side.
const UNEVEN: f32 = 1.5;

/// Occupancy fractions of the voxels at the surface in a box of a mask, as bricks to put in the place of those
/// that there are. Voxels outside the box keep the fractions that they have in `known`, and what is
/// new goes on from there.
pub fn relaxed_fractions(
    bits: &Bits,
    spacing: Vec3,
    core: &VoxelBox,
    known: &OccupancyFractions,
) -> Vec<BrickSwap<FractionBrick>> {
    let core = core.intersect(&VoxelBox::of_dimensions(bits.dimensions()));
    if core.is_empty() {
        return Vec::new();
    }
    let field = relaxed(bits, spacing, &core, known);
    let bricks = bits.bricks();
    let brick = |index: u32| {
        let old = known.bricks().get(index);
        let mut brick = old.map_or(FractionBrick::UNKNOWN, |brick| (**brick).clone());
        for voxel in bricks.box_of(index).intersect(&core).voxels() {
            let fraction = field.as_ref().and_then(|field| field.fraction(bits, voxel));
            let byte = fraction.map_or(0, |fraction| byte_of(fraction, bits.is_solid(voxel)));
            brick.set(voxel, byte);
        }
        let is_known = brick != FractionBrick::UNKNOWN;
        let changed = old.map_or(is_known, |old| **old != brick);
        changed.then(|| BrickSwap {
            index,
            brick: is_known.then(|| Arc::new(brick)),
        })
    };
    let indices = bricks.indices_in(&core);
    indices.into_iter().filter_map(brick).collect()
}

/// Boxes that together hold all of a grid in which a mask has a surface.
pub fn regions(bits: &Bits) -> Vec<VoxelBox> {
    let grid = VoxelBox::of_dimensions(bits.dimensions());
    let counts = bits.dimensions().map(|count| count.div_ceil(REGION as u32));
    let region = |place: IVec3| VoxelBox::new(place * REGION, (place + 1) * REGION);
    let has_surface = |region: &VoxelBox| {
        let mut bricks = bits.bricks().indices_in(region).into_iter();
        let mut brick = || bricks.next().map(|index| bits.bricks().get(index));
        let Some(first) = brick() else { return false };
        let is_uniform = first.is_none_or(BitBrick::is_shared_full);
        let is_same = |other: Option<&Arc<BitBrick>>| match (first, other) {
            (Some(first), Some(other)) => Arc::ptr_eq(first, other),
            (first, other) => first.is_none() && other.is_none(),
        };
        !is_uniform || std::iter::from_fn(brick).any(|other| !is_same(other))
    };
    let all = VoxelBox::of_dimensions(counts).voxels().map(region);
    // a surface between two boxes has voxels in both
    all.map(|region| region.intersect(&grid))
        .filter(|region| has_surface(&region.dilate(1).intersect(&grid)))
        .collect()
}

/// The field around a box, solved from the coarsest level on; none where there is no surface.
fn relaxed(
    bits: &Bits,
    spacing: Vec3,
    core: &VoxelBox,
    known: &OccupancyFractions,
) -> Option<Level> {
    let mut coarser: Option<Level> = None;
    for factor in factors(spacing).into_iter().rev() {
        let mut level = Level::around(bits, spacing, core, factor)?;
        level.start(bits, coarser.as_ref());
        if factor == UVec3::ONE {
            level.hold(core, known);
        }
        level.solve(bits, coarser.is_none());
        coarser = Some(level);
    }
    coarser
}

/// Voxels of a cell along each axis, from the finest level on.
fn factors(spacing: Vec3) -> Vec<UVec3> {
    let widest = WIDEST * spacing.max_element();
    let mut factors = vec![UVec3::ONE];
    let mut factor = UVec3::ONE;
    loop {
        let cell = spacing * factor.as_vec3();
        let short = cell.cmplt(Vec3::splat(UNEVEN * cell.min_element()));
        factor = UVec3::select(short, 2 * factor, factor);
        if (spacing * factor.as_vec3()).max_element() > widest {
            return factors;
        }
        factors.push(factor);
    }
}

/// The cell that holds a voxel.
fn cell_of(voxel: IVec3, factor: UVec3) -> IVec3 {
    // voxels of a grid are not negative
    (voxel.as_uvec3() / factor).as_ivec3()
}
