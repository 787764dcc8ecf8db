//! Voxels as good as random, for tests that all compiled forms of a function give the same.

use glam::IVec3;
use palpate_volume::occupancy::Occupancy;

/// Voxels and fractions as good as random, a function of the place: for tests that both give the same.
#[derive(Debug)]
pub(crate) struct Noise {
    /// Of a hundred voxels, so many are solid.
    pub(crate) density: u32,
}

impl Noise {
    fn random(voxel: IVec3) -> u32 {
        let voxel = voxel.wrapping_mul(IVec3::new(73_856_093, 19_349_663, 83_492_791));
        let bits = (voxel.x ^ voxel.y ^ voxel.z) as u32;
        (0..3).fold(bits, |bits, _| {
            (bits ^ bits >> 15).wrapping_mul(0x2c1b_3c6d)
        }) >> 8
    }
}

impl Occupancy for Noise {
    fn is_solid(&self, voxel: IVec3) -> bool {
        Self::random(voxel) % 100 < self.density
    }

    fn occupancy_fraction(&self, voxel: IVec3, solid: bool) -> Option<f32> {
        let fraction = (Self::random(voxel) >> 8) as f32 / 131_072.0;
        Some(if solid { 1.0 - fraction } else { fraction })
    }
}
