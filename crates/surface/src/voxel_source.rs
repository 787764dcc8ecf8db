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

    /// How far inside the limits a sample of step³ voxels is, by its mean; with the sign of its
    /// bit, for edits may have made solid what the values are not.
    pub(crate) fn depth(&self, limits: Limits, step: i32, (sample, solid): (IVec3, bool)) -> f32 {
        let Some((scan, overlay)) = self.values else {
            return if solid { 0.5 } else { -0.5 };
        };
        // beyond the border things look as at the border, so that the surface closes upon it
        let bounds = VoxelBox::of_dimensions(scan.dimensions());
        let corner = (sample * step).clamp(IVec3::ZERO, bounds.max - 1);
        let block = VoxelBox::new(corner, corner + step).intersect(&bounds);
        let mut sum = 0.0;
        for voxel in block.voxels() {
            let stored = match overlay {
                Some(overlay) => overlay.stored(scan, voxel),
                None => scan.stored(voxel),
            };
            let value = scan.physical(stored.unwrap_or_default());
            let depth = (value - limits.low).min(limits.high - value);
            sum += depth.clamp(-FARTHEST, FARTHEST);
        }
        let size = (sum / block.voxel_count() as f64).abs() as f32;
        if solid { size } else { -size }
    }
}
