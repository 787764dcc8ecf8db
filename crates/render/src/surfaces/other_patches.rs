//! Which triangles are others than before.

use std::collections::BTreeSet;

use glam::{DAffine3, DVec3, Vec3};
use palpate_volume::voxel_box::VoxelBox;

use crate::surfaces::{SegmentSurface, Triangles};

/// Triangles of a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OnePatch<'a> {
    surface: &'a SegmentSurface,
    triangles: &'a dyn Triangles,
}

/// Patches that are gone or new; none where whole surfaces have come, gone or moved.
pub(crate) fn other_patches<'a>(
    before: &'a [SegmentSurface],
    now: &'a [SegmentSurface],
) -> Option<Vec<OnePatch<'a>>> {
    let stands = |it: &SegmentSurface| (it.id, it.origin, it.pose);
    if !before.iter().map(stands).eq(now.iter().map(stands)) {
        return None;
    }
    let pairs = before.iter().zip(now);
    let others = pairs.flat_map(|(before, now)| {
        let gone = only_in(before, &places(now));
        gone.into_iter().chain(only_in(now, &places(before)))
    });
    Some(others.collect())
}

/// Where triangles lie in memory: those that are shared lie there but once.
fn places(surface: &SegmentSurface) -> BTreeSet<*const [f32; 3]> {
    let patches = surface.patches.iter();
    patches.map(|patch| patch.positions().as_ptr()).collect()
}

fn only_in<'a>(
    surface: &'a SegmentSurface,
    others: &BTreeSet<*const [f32; 3]>,
) -> Vec<OnePatch<'a>> {
    let patches = surface.patches.iter().map(|patch| &**patch);
    let own = patches.filter(|patch| !others.contains(&patch.positions().as_ptr()));
    own.map(|triangles| OnePatch { surface, triangles })
        .collect()
}

impl OnePatch<'_> {
    /// Voxels around all of its corners.
    pub fn voxels(&self, grid_from_patient: &DAffine3) -> VoxelBox {
        let positions = self.triangles.positions().iter().copied().map(Vec3::from);
        let ends = positions.map(|at| (at, at));
        let Some((low, high)) = ends.reduce(|one, other| (one.0.min(other.0), one.1.max(other.1)))
        else {
            return VoxelBox::EMPTY;
        };
        let to_grid = *grid_from_patient * self.surface.pose;
        let corners = (0..8).map(|corner| {
            let is_high = glam::BVec3::new(corner & 1 != 0, corner & 2 != 0, corner & 4 != 0);
            let at = Vec3::select(is_high, high, low).as_dvec3();
            to_grid.transform_point3(self.surface.origin + at)
        });
        let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (low, high) = corners.fold(none, |(low, high), at| (low.min(at), high.max(at)));
        // a flat one lies in voxels too
        VoxelBox::new(low.floor().as_ivec3(), high.floor().as_ivec3() + 1)
    }
}
