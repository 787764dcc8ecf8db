//! Which segment each voxel belongs to, in bricks: only where there are any.

use std::sync::Arc;

use glam::{IVec3, UVec3};
use palpate_volume::brick_grid::BRICK;
use palpate_volume::edit::SegmentId;
use palpate_volume::voxels::Voxels;
use rayon::prelude::*;

use crate::bricks::counts_of;

/// Segments' numbers of 8×8×8 voxels, x fastest; 0 for none.
type LabelBrick = [u8; 512];

/// The number of the segment of each voxel; of several the last of the list.
#[derive(Clone, Debug)]
pub(crate) struct Labels {
    dimensions: UVec3,
    counts: IVec3,
    bricks: Vec<Option<Arc<LabelBrick>>>,
}

impl Labels {
    /// The voxels of these segments; one with a grid of its own has none of the scan. None where there are none.
    pub fn of(voxels: &Voxels, segments: &[u8]) -> Option<Self> {
        let dimensions = voxels.grid().dimensions();
        let counts = counts_of(dimensions);
        let occupancies: Vec<_> = segments
            .iter()
            .filter_map(|&id| Some((id, voxels.segment(SegmentId(id))?)))
            .filter(|(_, segment)| segment.own_grid().is_none() && segment.count() > 0)
            .map(|(id, segment)| (id, segment.occupancy().bricks()))
            .collect();
        if occupancies.is_empty() {
            return None;
        }
        let bricks = (0..counts.element_product() as u32)
            .into_par_iter()
            .map(|index| {
                let mut labels: Option<LabelBrick> = None;
                for (id, bricks) in &occupancies {
                    if let Some(bits) = bricks.get(index) {
                        let labels = labels.get_or_insert([0; 512]);
                        for (layer, &word) in labels.chunks_exact_mut(64).zip(&bits.0) {
                            let mut left = word;
                            while left != 0 {
                                layer[left.trailing_zeros() as usize] = *id;
                                left &= left - 1;
                            }
                        }
                    }
                }
                labels.map(Arc::new)
            })
            .collect();
        Some(Self {
            dimensions,
            counts,
            bricks,
        })
    }

    /// Whether a brick has a voxel of any segment.
    pub fn has_any(&self, brick: usize) -> bool {
        self.bricks[brick].is_some()
    }

    /// The segment of a voxel; of the nearest one outside the grid.
    #[inline]
    pub fn at(&self, voxel: IVec3) -> u8 {
        let voxel = voxel.clamp(IVec3::ZERO, self.dimensions.as_ivec3() - 1);
        let brick = voxel >> 3_i32;
        let index = brick.x + self.counts.x * (brick.y + self.counts.y * brick.z);
        match &self.bricks[index as usize] {
            Some(labels) => {
                let inside = voxel & (BRICK - 1);
                labels[(inside.x + 8 * (inside.y + 8 * inside.z)) as usize]
            }
            None => 0,
        }
    }
}
