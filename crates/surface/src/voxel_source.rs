//! What a surface is made of: the bits of a segment, and the scan's values where they help.

use glam::IVec3;
use palpate_volume::bits::Bits;
use palpate_volume::intensities::Intensities;
use palpate_volume::overlay::Overlay;
use palpate_volume::voxel_box::VoxelBox;

use crate::settings::Limits;

/// Beyond this a value says nothing more about where a limit is passed [physical units].
const FARTHEST: f64 = 1e6;

/// The voxels of a segment.
#[derive(Clone, Copy, Debug)]
pub struct VoxelSource<'a> {
    /// What is solid.
    pub bits: &'a Bits,
    /// Values of the scan and what lies over them, for surfaces with limits.
    pub values: Option<(&'a Intensities, Option<&'a Overlay>)>,
}

impl<'a> VoxelSource<'a> {
    /// Bits alone.
    pub fn of_bits(bits: &'a Bits) -> Self {
        Self { bits, values: None }
    }

    /// How far inside the limits the mean values of a row of samples of step³ voxels are, from
    /// sample `first` on [physical units].
    pub(crate) fn depths(&self, limits: Limits, step: i32, first: IVec3, depths: &mut [f32]) {
        let Some((scan, overlay)) = self.values else {
            depths.fill(0.0);
            return;
        };
        let bounds = VoxelBox::of_dimensions(scan.dimensions());
        for (x, depth) in (first.x..).zip(depths) {
            // beyond the border things look as at the border
            let corner = (first.with_x(x) * step).clamp(IVec3::ZERO, bounds.max - 1);
            let block = VoxelBox::new(corner, corner + step).intersect(&bounds);
            let mut sum = 0.0;
            for voxel in block.voxels() {
                let stored = match overlay {
                    Some(overlay) => overlay.stored(scan, voxel),
                    None => scan.stored(voxel),
                };
                let value = scan.physical(stored.unwrap_or_default());
                let within = (value - limits.low).min(limits.high - value);
                sum += within.clamp(-FARTHEST, FARTHEST);
            }
            *depth = (sum / block.voxel_count() as f64) as f32;
        }
    }
}
