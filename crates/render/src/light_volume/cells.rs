//! The cells in which light is worked out: coarse cubes that cover all of the scan.

use std::ops::Range;

use glam::{DVec3, IVec3, Vec3};
use palpate_volume::grid::Grid;
use palpate_volume::voxel_box::VoxelBox;

use crate::light_volume::WHOLE;
use crate::light_volume::lookup::LEAD;
use crate::prepared::Prepared;

/// Smallest edge of a cell [smallest voxel edges].
const SMALLEST: f64 = 1.5;

/// Voxels from a place to the farthest that tells of its opacity, by its gradient.
const READ: i32 = 2;

#[derive(Clone, Copy, Debug)]
pub(super) struct CellGrid {
    /// Cells along the scan's axes.
    pub counts: IVec3,
    /// Edge of a cell [mm]; along each axis they fill the scan, so they may be a little shorter.
    pub edge: f32,
    /// Voxels of a cell along each axis.
    pub voxels: Vec3,
    /// Size of the scan [mm].
    size: Vec3,
    /// From where on nothing is drawn that could look a cell up [bricks].
    empty_reach: u8,
}

impl CellGrid {
    pub fn new(grid: &Grid, most: u32) -> Self {
        let dimensions = grid.dimensions().as_dvec3();
        let size = grid.spacing() * dimensions;
        let smallest = grid.smallest_spacing();
        let edge = (size.max_element() / f64::from(most.max(1))).max(SMALLEST * smallest);
        let counts = (size / edge - 1e-6).ceil().max(DVec3::ONE);
        let seen_from = (f64::from(LEAD) + 2.0) * edge / smallest;
        Self {
            counts: counts.as_ivec3(),
            edge: edge as f32,
            voxels: (dimensions / counts).as_vec3(),
            size: size.as_vec3(),
            empty_reach: ((seen_from / 8.0).ceil() as u8).saturating_add(1),
        }
    }

    pub fn all(&self) -> VoxelBox {
        VoxelBox::new(IVec3::ZERO, self.counts)
    }

    /// The way of a cell's edge along each axis [cells].
    pub fn cells_per_edge(&self) -> Vec3 {
        self.edge * self.counts.as_vec3() / self.size
    }

    /// Cells whose opacity some voxels tell of.
    pub fn reached_by(&self, voxels: &VoxelBox) -> VoxelBox {
        let low = ((voxels.min - READ).as_vec3() / self.voxels).floor();
        let high = ((voxels.max + READ).as_vec3() / self.voxels).ceil();
        VoxelBox::new(low.as_ivec3(), high.as_ivec3()).intersect(&self.all())
    }

    /// Columns of voxels of which cells of a row tell, from one cell to another.
    pub fn columns_read_by(&self, first: i32, last: i32) -> Range<usize> {
        let end = (self.counts.x as f32 * self.voxels.x).round() as usize;
        let low = (first as f32 * self.voxels.x) as usize;
        let high = ((last + 1) as f32 * self.voxels.x).ceil() as usize;
        low.saturating_sub(READ as usize)..(high + READ as usize).min(end)
    }

    /// Cells from a brick to the farthest that something drawn in it makes be looked up.
    pub fn seen_from_brick(&self) -> IVec3 {
        let voxels = 8.0 * (f32::from(self.empty_reach) + 1.0);
        (voxels / self.voxels).ceil().as_ivec3() + 1
    }

    /// Cells of a part of a row, and which of them something drawn could look up.
    pub fn seen_cells(
        &self,
        prepared: &Prepared,
        (y, z): (i32, i32),
        asked: Range<usize>,
    ) -> SeenCells {
        let middle = |x: usize| (IVec3::new(x as i32, y, z).as_vec3() + 0.5) * self.voxels;
        let empty = prepared.unlit();
        let are_seen: Vec<_> = asked
            .clone()
            .map(|x| empty.distance(middle(x).as_ivec3() >> 3_i32) < self.empty_reach)
            .collect();
        let first = are_seen.iter().position(|&is| is);
        let last = are_seen.iter().rposition(|&is| is);
        let span = first.zip(last).map_or(0..0, |(first, last)| {
            asked.start + first..asked.start + last + 1
        });
        SeenCells {
            asked,
            are_seen,
            span,
        }
    }
}

/// Some cells of a row, and which of them can be looked up; all of the light reaches the others.
pub(super) struct SeenCells {
    asked: Range<usize>,
    are_seen: Vec<bool>,
    /// From the first that can be looked up to the last.
    pub span: Range<usize>,
}

impl SeenCells {
    /// Writes fractions of light, given by cell of the row, as one of the two numbers of each cell.
    pub fn put(&self, found: &[f32], cells: &mut [i16], number: usize) {
        for (x, is_seen) in self.asked.clone().zip(&self.are_seen) {
            let share = if *is_seen { found[x] } else { 1.0 };
            cells[2 * x + number] = (share * WHOLE).round() as i16;
        }
    }
}
