//! The voxels of one body, and what more is known of its surface than them.
//!
//! Frame: the body's own grid. Nothing here allocates after it was made.

use glam::{DVec3, IVec3};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::first_solid::Traversal;
use palpate_volume::occupancy::Occupancy;

use crate::touch::occupancy_fractions::BodyFractions;

/// Voxels, and what is known of their occupancy fractions.
#[derive(Debug)]
pub struct BodyVoxels {
    /// The voxels.
    pub bits: Bits,
    /// How much of those at the surface is solid; none where only the bits are known.
    pub fractions: Option<BodyFractions>,
}

impl From<Bits> for BodyVoxels {
    /// Voxels of which only the bits are known.
    fn from(bits: Bits) -> Self {
        Self {
            bits,
            fractions: None,
        }
    }
}

impl Occupancy for BodyVoxels {
    #[inline]
    fn is_solid(&self, voxel: IVec3) -> bool {
        self.bits.is_solid(voxel)
    }

    #[inline]
    fn first_solid(&self, start: DVec3, end: DVec3, max_visits: u32) -> Traversal {
        self.bits.first_solid(start, end, max_visits)
    }

    #[inline]
    fn block(&self, min: IVec3) -> BitBrick {
        self.bits.block(min)
    }

    #[inline]
    fn knows_fractions(&self) -> bool {
        self.fractions.is_some()
    }

    #[inline]
    fn occupancy_fraction(&self, voxel: IVec3, solid: bool) -> Option<f32> {
        self.fractions.as_ref()?.share(voxel, solid)
    }

    #[inline]
    fn fraction_changes(&self, voxels: &[(IVec3, bool)], changes: &mut [f32]) {
        match &self.fractions {
            Some(fractions) => fractions.fraction_changes(voxels, changes),
            None => changes.fill(0.0),
        }
    }
}
