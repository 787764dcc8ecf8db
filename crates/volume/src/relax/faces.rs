//! Faces between solid and free voxels of a box. Frame: grid.

use glam::IVec3;

use crate::bit_brick::BitBrick;
use crate::bits::Bits;
use crate::block::block_of_bits;
use crate::brick_grid::BRICK;
use crate::grid::is_inside;
use crate::voxel_box::VoxelBox;

/// The axes by their number.
pub(super) const AXES: [IVec3; 3] = [IVec3::X, IVec3::Y, IVec3::Z];

/// A solid voxel and a free one beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Face {
    /// The solid one.
    pub(super) solid: IVec3,
    /// The free one.
    pub(super) free: IVec3,
    /// The axis on which they stand side by side.
    pub(super) axis: usize,
}

/// All faces of which both voxels are in a box, which must lie in the grid: at the border of the
/// scan nothing is known of where a body ends.
pub(super) fn faces_in(bits: &Bits, region: &VoxelBox) -> Vec<Face> {
    let mut faces = Vec::new();
    for index in bits.bricks().indices_in(region) {
        let corner = bits.bricks().box_of(index).min;
        let here = block_of_bits(bits, corner);
        for (axis, step) in AXES.into_iter().enumerate() {
            let there = block_of_bits(bits, corner + step);
            if here == there {
                continue;
            }
            visit_differing(&here, &there, |offset, solid| {
                let [near, far] = [corner + offset, corner + offset + step];
                if !region.contains(near) || !region.contains(far) {
                    return;
                }
                debug_assert!(is_inside(bits.dimensions(), far), "the box is in the grid");
                let (solid, free) = if solid { (near, far) } else { (far, near) };
                faces.push(Face { solid, free, axis });
            });
        }
    }
    faces
}

/// Tells each voxel that differs, from the corner, and whether it is solid in the first.
fn visit_differing(first: &BitBrick, second: &BitBrick, mut tell: impl FnMut(IVec3, bool)) {
    for (z, (a, b)) in (0..).zip(first.0.into_iter().zip(second.0)) {
        let mut left = a ^ b;
        while left != 0 {
            let bit = left.trailing_zeros();
            left &= left - 1;
            let place = bit as i32;
            tell(
                IVec3::new(place % BRICK, place / BRICK, z),
                a >> bit & 1 == 1,
            );
        }
    }
}
