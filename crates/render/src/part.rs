//! Parts of a picture: the pixels alone in which something may have changed.

use glam::{DMat3, DVec2, DVec3, U64Vec2, UVec2};
use palpate_volume::voxel_box::VoxelBox;

use crate::camera::RayFan;

/// Multiples at which parts begin, so that rays are followed together with the same ones as in the whole picture.
const ALIGNED: UVec2 = UVec2::new(4, 8);

/// Voxels around another value that are drawn otherwise: values are mixed with their neighbours', and gradients taken
/// between those. Shade reaches farther; it follows with the whole picture.
const AROUND: i32 = 2;

/// Least depth of what is seen in a part [mm]; nearer to the eye the whole picture may change.
const NEAREST: f64 = 1e-3;

/// Some columns and rows of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// The first column and row, from the upper left corner.
    pub first: UVec2,
    /// Columns and rows.
    pub size: UVec2,
}

impl Part {
    /// All of a picture.
    #[must_use]
    pub fn whole(size: (u32, u32)) -> Self {
        Self {
            first: UVec2::ZERO,
            size: size.into(),
        }
    }

    /// Whether a picture of this size has this part, and it begins where parts do.
    #[must_use]
    pub fn is_of(&self, size: (u32, u32)) -> bool {
        let [first, own, whole] = [self.first, self.size, size.into()].map(UVec2::as_u64vec2);
        own.cmpgt(U64Vec2::ZERO).all()
            && (first + own).cmple(whole).all()
            && self.first % ALIGNED == UVec2::ZERO
    }

    /// The pixels whose rays pass by voxels of a box, which may reach beyond the scan as surfaces do, and some around
    /// them.
    pub(crate) fn showing(voxels: &VoxelBox, fan: &RayFan) -> Self {
        let whole = Self::whole(fan.size);
        let voxels = voxels.dilate(AROUND);
        if voxels.is_empty() {
            return whole.between(DVec2::ZERO, DVec2::ZERO);
        }
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for corner in corners_of(&voxels) {
            let Some(pixel) = pixel_of(corner, fan) else {
                return whole;
            };
            (low, high) = (low.min(pixel), high.max(pixel));
        }
        whole.between(low - 1.0, high + 1.0)
    }

    /// Those of its pixels between two places, and what begins at multiples before them; one packet of rays at least.
    fn between(self, low: DVec2, high: DVec2) -> Self {
        let last = (self.size - 1).as_dvec2();
        // a cast rounds towards 0
        let first = low.clamp(DVec2::ZERO, last).as_uvec2() / ALIGNED * ALIGNED;
        let end = high
            .ceil()
            .clamp(DVec2::ONE, self.size.as_dvec2())
            .as_uvec2();
        Self {
            first,
            size: end.max(first + ALIGNED).min(self.size) - first,
        }
    }
}

fn corners_of(voxels: &VoxelBox) -> [DVec3; 8] {
    let (low, high) = (voxels.min.as_dvec3(), voxels.max.as_dvec3());
    std::array::from_fn(|corner| {
        let is_high = |axis: usize| corner >> axis & 1 == 1;
        DVec3::from_array(std::array::from_fn(|axis| {
            if is_high(axis) { high[axis] } else { low[axis] }
        }))
    })
}

/// Where a place of the grid is seen, in pixels from the upper left corner; none beside or behind the eye.
fn pixel_of(place: DVec3, fan: &RayFan) -> Option<DVec2> {
    let from_eye = (place - fan.eye.as_dvec3()) * fan.spacing.as_dvec3();
    let axes = DMat3::from_cols(
        fan.forward.as_dvec3(),
        fan.across.as_dvec3(),
        fan.upward.as_dvec3(),
    );
    let along = axes.inverse() * from_eye;
    let depth = if fan.is_parallel { 1.0 } else { along.x };
    if depth < NEAREST {
        return None;
    }
    let beside = DVec2::new(along.y, -along.z) / depth;
    Some((beside + 1.0) / 2.0 * UVec2::from(fan.size).as_dvec2())
}
