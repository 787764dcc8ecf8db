//! Where the particles of a global model may stand, and what they are made of there.
//!
//! Frame: mm along the axes of the grid. Source: thesis 5.26, step 1 (a).

use glam::{DVec3, IVec3};
use palpate_volume::grid::Grid;
use palpate_volume::voxel_box::VoxelBox;

use super::state::Origin;
use crate::material::{Solid, Treatment};
use crate::model::ModelInput;
use crate::voxel_ledger::solid_of;

/// Share of the voxels around a place that must be solid for a particle to stand there.
const SOLID_SHARE: f64 = 0.5;

/// The box of all segments of the materials, and their voxels, those of several counted often.
pub(super) fn extent(input: &ModelInput<'_>) -> (VoxelBox, u64) {
    let segments = input.materials.segments.iter();
    let segments = segments.filter_map(|of| input.voxels.segment(of.segment));
    segments.fold((VoxelBox::EMPTY, 0), |(region, count), segment| {
        let bounds = segment.bounding_box().unwrap_or(VoxelBox::EMPTY);
        (region.union(&bounds), count + segment.count())
    })
}

/// The tissue of a particle at a place: that of its voxel or the nearest solid one; none where
/// fewer than [`SOLID_SHARE`] of the voxels within `reach` take part.
pub(super) fn matter_around(
    input: &ModelInput<'_>,
    grid: &Grid,
    place: DVec3,
    reach: f64,
) -> Option<(Origin, Solid, Treatment)> {
    let spacing = grid.spacing();
    let own = (place / spacing).floor().as_ivec3();
    let low = ((place - reach) / spacing).floor().as_ivec3();
    let around = VoxelBox::new(low, ((place + reach) / spacing).ceil().as_ivec3());
    let distance = |voxel: IVec3| ((voxel.as_dvec3() + 0.5) * spacing).distance(place);
    let (mut all, mut solid) = (0_u32, 0_u32);
    let mut nearest: Option<(f64, Origin, Solid, Treatment)> = None;
    let near = around
        .voxels()
        .filter(|voxel| distance(*voxel) <= reach || *voxel == own);
    for voxel in near {
        all += 1;
        let Some(matter) = input.voxels.state(voxel) else {
            continue;
        };
        let Some((of, treatment)) = solid_of(input.voxels, input.materials, voxel, &matter) else {
            continue;
        };
        solid += 1;
        let better = nearest.is_none_or(|(best, ..)| distance(voxel) < best);
        if better {
            nearest = Some((distance(voxel), Origin { voxel, matter }, of, treatment));
        }
    }
    let enough = f64::from(solid) >= SOLID_SHARE * f64::from(all);
    nearest
        .filter(|_| enough)
        .map(|(_, origin, solid, treatment)| (origin, solid, treatment))
}
