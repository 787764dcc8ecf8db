//! Random points, boxes and masks for property tests, and dense models to compare with.

use glam::{DVec3, IVec3, UVec3};
use palpate_volume::voxel_box::VoxelBox;

/// Seeded numbers.
pub struct Random(oorandom::Rand64);

impl Random {
    pub fn new(seed: u128) -> Self {
        Self(oorandom::Rand64::new(seed))
    }

    /// Uniform in [low, high).
    pub fn number(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.rand_float()
    }

    /// Uniform in low..high.
    pub fn integer(&mut self, low: i32, high: i32) -> i32 {
        low + self.0.rand_range(0..(high - low) as u64) as i32
    }

    /// True in this share of the calls.
    pub fn chance(&mut self, share: f64) -> bool {
        self.0.rand_float() < share
    }

    /// A point of the cube from `low` to `high`.
    pub fn point(&mut self, low: f64, high: f64) -> DVec3 {
        DVec3::from_array([(); 3].map(|()| self.number(low, high)))
    }

    /// A point of the same cube on a lattice of eighths, so often on planes and edges.
    pub fn lattice_point(&mut self, low: i32, high: i32) -> DVec3 {
        let eighths = [(); 3].map(|()| self.integer(8 * low, 8 * high));
        IVec3::from_array(eighths).as_dvec3() / 8.0
    }

    /// A voxel of the cube from `low` to `high`.
    pub fn voxel(&mut self, low: i32, high: i32) -> IVec3 {
        IVec3::from_array([(); 3].map(|()| self.integer(low, high)))
    }

    /// A box that may reach beyond the grid.
    pub fn voxel_box(&mut self, dimensions: UVec3) -> VoxelBox {
        let mut axis = |length: u32| {
            let ends = [(); 2].map(|()| self.integer(-2, length as i32 + 3));
            (ends[0].min(ends[1]), ends[0].max(ends[1]))
        };
        let [x, y, z] = dimensions.to_array().map(&mut axis);
        VoxelBox::new(IVec3::new(x.0, y.0, z.0), IVec3::new(x.1, y.1, z.1))
    }

    /// One byte per voxel, 1 in blobs, so that some bricks are empty and some full.
    pub fn mask(&mut self, dimensions: UVec3) -> Vec<u8> {
        let voxels = || VoxelBox::of_dimensions(dimensions).voxels();
        let mut mask = vec![0; voxels().count()];
        for _ in 0..6 {
            let (blob, value) = (self.voxel_box(dimensions), u8::from(self.chance(0.7)));
            for (byte, voxel) in mask.iter_mut().zip(voxels()) {
                if blob.contains(voxel) {
                    *byte = value;
                }
            }
        }
        for _ in 0..20 {
            let place = self.integer(0, mask.len() as i32) as usize;
            mask[place] = u8::from(self.chance(0.5));
        }
        mask
    }
}

/// Dimensions below, at and above whole bricks.
pub const DIMENSIONS: [UVec3; 5] = [
    UVec3::new(1, 1, 1),
    UVec3::new(8, 8, 8),
    UVec3::new(7, 16, 9),
    UVec3::new(25, 17, 33),
    UVec3::new(40, 3, 8),
];

/// The smallest box of all voxels with a property, voxel by voxel.
pub fn box_where(dimensions: UVec3, holds: impl Fn(IVec3) -> bool) -> VoxelBox {
    VoxelBox::of_dimensions(dimensions)
        .voxels()
        .filter(|&voxel| holds(voxel))
        .fold(VoxelBox::EMPTY, |all, voxel| {
            all.union(&VoxelBox::of_voxel(voxel))
        })
}
