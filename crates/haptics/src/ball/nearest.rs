//! The solid voxel that a ball rests against: whose surface is touched.
//!
//! Of the voxels that block a cell it is the one whose centre is nearest to that of the cell
//! [mm], the first along z, y, x of several. Frame: grid.

use crate::ball::shape::BallShape;
use glam::IVec3;
use palpate_volume::brick_grid::BRICK;
use palpate_volume::occupancy::Occupancy;

/// The voxel of `inner` that blocks this cell; none where the cell is free.
pub(crate) fn nearest_solid(
    inner: &(impl Occupancy + ?Sized),
    shape: &BallShape,
    cell: IVec3,
) -> Option<IVec3> {
    // the voxel itself would be nearest
    if inner.is_solid(cell) {
        return Some(cell);
    }
    let mut nearest = Nearest {
        shape,
        squared: f64::INFINITY,
        offset: None,
    };
    let reach = shape.reach();
    for z in (-reach.z..=reach.z).step_by(BRICK as usize) {
        for y in (-reach.y..=reach.y).step_by(BRICK as usize) {
            for x in (-reach.x..=reach.x).step_by(BRICK as usize) {
                let first = IVec3::new(x, y, z);
                nearest.look_in(first, inner.block(cell + first).0);
            }
        }
    }
    nearest.offset.map(|offset| cell + offset)
}

/// The best voxel so far.
struct Nearest<'a> {
    shape: &'a BallShape,
    squared: f64,
    offset: Option<IVec3>,
}

impl Nearest<'_> {
    /// Looks at a block of voxels whose first is this far from the cell.
    fn look_in(&mut self, first: IVec3, block: [u64; 8]) {
        for (z, layer) in (first.z..).zip(block) {
            if layer == 0 {
                continue;
            }
            for (y, row) in (first.y..).zip(layer.to_le_bytes()) {
                self.look_at(IVec3::new(first.x, y, z), row);
            }
        }
    }

    /// Looks at a row of voxels.
    fn look_at(&mut self, first: IVec3, row: u8) {
        let beside = self.squared_length(first.with_x(0));
        if row == 0 || beside >= self.squared {
            return;
        }
        for x in (0..BRICK).filter(|x| row >> x & 1 != 0) {
            let offset = first.with_x(first.x + x);
            let squared = self.squared_length(offset);
            if squared < self.squared && self.shape.blocks(offset) {
                self.squared = squared;
                self.offset = Some(offset);
            }
        }
    }

    /// Squared length of an offset [mm²].
    fn squared_length(&self, offset: IVec3) -> f64 {
        (offset.as_dvec3() * self.shape.spacing()).length_squared()
    }
}
