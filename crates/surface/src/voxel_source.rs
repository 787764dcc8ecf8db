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
        let within = |stored: i16| {
            let value = scan.physical(stored);
            (value - limits.low)
                .min(limits.high - value)
                .clamp(-FARTHEST, FARTHEST)
        };
        // beyond the border things look as at the border
        let bounds = VoxelBox::of_dimensions(scan.dimensions());
        let inside = |x: i32| (first.with_x(x) * step).clamp(IVec3::ZERO, bounds.max - 1);
        let samples = (first.x..).zip(depths);
        match overlay {
            None if step == 1 => {
                let [nx, ny, _] = bounds.max.to_array().map(|count| count as usize);
                let [_, y, z] = inside(0).to_array().map(|place| place as usize);
                let row = &scan.values()[(z * ny + y) * nx..][..nx];
                for (x, depth) in samples {
                    *depth = within(row[inside(x).x as usize]) as f32;
                }
            }
            _ => {
                let stored = |voxel: IVec3| match overlay {
                    Some(overlay) => overlay.stored(scan, voxel),
                    None => scan.stored(voxel),
                };
                for (x, depth) in samples {
                    let corner = inside(x);
                    let block = VoxelBox::new(corner, corner + step).intersect(&bounds);
                    let voxels = block.voxels();
                    let sum: f64 = voxels.map(|v| within(stored(v).unwrap_or_default())).sum();
                    *depth = (sum / block.voxel_count() as f64) as f32;
                }
            }
        }
    }
}
