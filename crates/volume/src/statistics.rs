//! Count and bounding box of a segment, kept up to date brick by brick.
//!
//! Memory: the number of solid voxels on each plane of each axis, padded to whole bricks.
//! A box's border is the first and last plane that has any, so no voxel is read again.

use glam::{IVec3, UVec3};
use rayon::prelude::*;

use crate::bit_brick::{BitBrick, PlaneCounts};
use crate::brick_grid::{BRICK, BrickGrid};
use crate::voxel_box::VoxelBox;

/// Counts of solid voxels, in all and per plane.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Statistics {
    count: u64,
    planes: [Vec<u32>; 3],
}

impl Statistics {
    /// Statistics of a segment with these bricks, counted in parallel.
    pub fn of_bricks(bricks: &BrickGrid<BitBrick>) -> Self {
        let size = bricks.size();
        (0..bricks.len() as u32)
            .into_par_iter()
            .filter_map(|index| Some((bricks.box_of(index).min, bricks.get(index)?)))
            .fold(
                || Self::empty(size),
                |mut sum, (corner, brick)| {
                    sum.add(corner, &brick.plane_counts());
                    sum
                },
            )
            .reduce(|| Self::empty(size), Self::plus)
    }

    /// Solid voxels.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The smallest box that holds every solid voxel; none where nothing is solid.
    pub fn bounding_box(&self) -> Option<VoxelBox> {
        let ends = |axis: usize| {
            let planes = &self.planes[axis];
            let first = planes.iter().position(|&voxels| voxels > 0)?;
            let last = planes.iter().rposition(|&voxels| voxels > 0)?;
            Some((first as i32, last as i32 + 1))
        };
        let (x, y, z) = (ends(0)?, ends(1)?, ends(2)?);
        Some(VoxelBox::new(
            IVec3::new(x.0, y.0, z.0),
            IVec3::new(x.1, y.1, z.1),
        ))
    }

    /// Follows the exchange of one brick.
    pub fn exchange(&mut self, corner: IVec3, old: Option<&BitBrick>, new: Option<&BitBrick>) {
        if let Some(old) = old {
            self.subtract(corner, &old.plane_counts());
        }
        if let Some(new) = new {
            self.add(corner, &new.plane_counts());
        }
    }

    /// The bytes it holds.
    pub fn memory_bytes(&self) -> usize {
        self.planes
            .iter()
            .map(|planes| size_of_val(&planes[..]))
            .sum()
    }

    fn empty(bricks: UVec3) -> Self {
        Self {
            count: 0,
            planes: bricks
                .to_array()
                .map(|bricks| vec![0; bricks as usize * BRICK as usize]),
        }
    }

    fn add(&mut self, corner: IVec3, counts: &PlaneCounts) {
        self.count += solid_voxels(counts);
        for (plane, &voxels) in self.planes_of(corner, counts) {
            *plane += u32::from(voxels);
        }
    }

    fn subtract(&mut self, corner: IVec3, counts: &PlaneCounts) {
        self.count -= solid_voxels(counts);
        for (plane, &voxels) in self.planes_of(corner, counts) {
            *plane -= u32::from(voxels);
        }
    }

    /// Pairs the planes of the segment with those of a brick.
    fn planes_of<'a>(
        &'a mut self,
        corner: IVec3,
        counts: &'a PlaneCounts,
    ) -> impl Iterator<Item = (&'a mut u32, &'a u8)> {
        let starts = corner.to_array().map(|start| start as usize);
        self.planes
            .iter_mut()
            .zip(starts)
            .zip(counts)
            .flat_map(|((planes, start), counts)| planes[start..].iter_mut().zip(counts))
    }

    fn plus(mut self, other: Self) -> Self {
        self.count += other.count;
        for (ours, theirs) in self.planes.iter_mut().zip(other.planes) {
            for (ours, theirs) in ours.iter_mut().zip(theirs) {
                *ours += theirs;
            }
        }
        self
    }
}

fn solid_voxels(counts: &PlaneCounts) -> u64 {
    counts[2].iter().map(|&voxels| u64::from(voxels)).sum()
}
