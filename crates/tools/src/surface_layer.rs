//! What lies near a surface as a probe sees it from outside: free voxels that the probe can reach
//! in a box, and the solid ones whose centres are not deeper below them than a depth.
//!
//! Depths are measured from the boxes of free voxels, in mm along each axis, so that voxels of any
//! spacing are told exactly. What lies on the other side of a wall is not reached, and so no part
//! of the layer, however thin the wall is.
//!
//! Frame: grid.

use glam::{IVec3, UVec3};
use palpate_volume::grid::Grid;
use palpate_volume::voxel_box::VoxelBox;

use crate::sweep::SAME;

/// Solid voxels near a surface.
#[derive(Debug)]
pub(crate) struct SurfaceLayer {
    region: VoxelBox,
    /// Squared depth of each voxel of the region [mm²], x fastest; 0 where the probe can be.
    squared: Vec<f64>,
    allowed: f64,
}

impl SurfaceLayer {
    /// The layer of `depth` [mm] in a region inside the grid, seen from free voxels `seeds`; without
    /// one of these in the region nothing is in it.
    pub(crate) fn new(
        grid: &Grid,
        region: VoxelBox,
        seeds: &[IVec3],
        depth: f64,
        solid: impl Fn(IVec3) -> bool,
    ) -> Self {
        let mut squared = vec![f64::INFINITY; region.voxel_count() as usize];
        for place in reachable(&region, seeds, solid) {
            squared[place] = 0.0;
        }
        for axis in 0..3 {
            spread(
                &mut squared,
                region.size(),
                axis,
                grid.spacing()[axis],
                depth,
            );
        }
        Self {
            region,
            squared,
            allowed: depth * depth * (1.0 + SAME),
        }
    }

    /// Whether a voxel is in the layer, or the probe could be there.
    pub(crate) fn holds(&self, voxel: IVec3) -> bool {
        self.region.contains(voxel) && self.squared[place_of(&self.region, voxel)] <= self.allowed
    }
}

/// Places of the free voxels of a region to which a way over faces leads from one of the seeds.
fn reachable(region: &VoxelBox, seeds: &[IVec3], solid: impl Fn(IVec3) -> bool) -> Vec<usize> {
    let mut seen = vec![false; region.voxel_count() as usize];
    let mut found = Vec::new();
    let mut open = seeds.to_vec();
    while let Some(voxel) = open.pop() {
        if !region.contains(voxel) || solid(voxel) {
            continue;
        }
        let place = place_of(region, voxel);
        if std::mem::replace(&mut seen[place], true) {
            continue;
        }
        found.push(place);
        for axis in IVec3::AXES {
            open.extend([voxel - axis, voxel + axis]);
        }
    }
    found
}

/// Takes in what is nearer along an axis: one of the three passes by which squared distances of a
/// box come about.
fn spread(squared: &mut [f64], size: UVec3, axis: usize, edge: f64, depth: f64) {
    let [nx, ny, _] = size.to_array().map(|n| n as usize);
    let stride = [1, nx, nx * ny][axis];
    let length = size[axis] as usize;
    // from the face of a free voxel to the centre of one so many further on
    let apart = |steps: usize| (steps as f64 - 0.5).max(0.0) * edge;
    let reach = (1..length)
        .take_while(|steps| apart(*steps) <= depth * (1.0 + SAME))
        .count();
    let mut line = vec![0.0; length];
    for start in (0..squared.len()).filter(|place| (place / stride).is_multiple_of(length)) {
        for (i, value) in line.iter_mut().enumerate() {
            *value = squared[start + i * stride];
        }
        if line.iter().all(|value| value.is_infinite()) {
            continue;
        }
        for i in 0..length {
            let near = i.saturating_sub(reach)..(i + reach + 1).min(length);
            let least = near.map(|j| line[j] + apart(i.abs_diff(j)).powi(2));
            squared[start + i * stride] = least.fold(f64::INFINITY, f64::min);
        }
    }
}

fn place_of(region: &VoxelBox, voxel: IVec3) -> usize {
    let [x, y, z] = (voxel - region.min).to_array().map(|c| c as usize);
    let [nx, ny, _] = region.size().to_array().map(|n| n as usize);
    (z * ny + y) * nx + x
}
