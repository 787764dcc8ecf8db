//! The guarantees of touch, found out the slow way: every voxel near is asked, by those of the stress
//! benchmark's checker, which shares nothing with the code that is checked.
//!
//! Frame: cubes of 1 mm from the origin on, so that places in mm are places in voxels.

use glam::{DVec3, IVec3};
use palpate_bench::stress::dense::Dense;

/// Whether a ball with its centre at a point overlaps a solid voxel; one of radius 0 is the point.
pub fn overlaps(solid: &Dense, centre: DVec3, radius: f64) -> bool {
    solid.is_solid(centre.floor().as_ivec3()) || solid.is_near(centre, centre, DVec3::ONE, radius)
}

/// Whether a ball with its centre anywhere in a cell overlaps no solid voxel.
pub fn leaves_free(solid: &Dense, cell: IVec3, radius: f64) -> bool {
    let low = cell.as_dvec3();
    !solid.is_solid(cell) && !solid.is_near(low, low + 1.0, DVec3::ONE, radius)
}

/// Parts of free space that hang together face to face; all around the box is one.
pub struct Parts {
    around: Dense,
    numbers: Vec<u32>,
}

impl Parts {
    /// The parts that a body leaves free, with a border of one free voxel around it.
    pub fn beside(solid: &Dense) -> Self {
        let around = Dense::from_fn(solid.size() + 2, |cell| solid.is_solid(cell - 1));
        let numbers = around.parts();
        Self { around, numbers }
    }

    /// The part that a point is in, 0 where solid; the first is the one outside.
    pub fn of(&self, point: DVec3) -> u32 {
        let place = self.around.index(point.floor().as_ivec3() + 1);
        place.map_or(1, |place| self.numbers[place])
    }
}
