//! What of a deformable segment is rigid: the voxels that its regions make rigid, for the servo.
//!
//! A mask holds whatever its segment has there now or later, so that it is worked out anew only
//! where the regions, or a segment that one of them is shared with, are others: brick by brick
//! after an edit.

use std::collections::{BTreeMap, BTreeSet};

use glam::IVec3;
use palpate_deform::material::{Region, Treatment};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::edit::SegmentId;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::Voxels;

use crate::scene::Step;

/// Regions of a segment, and how they take part.
pub type Regions = [(Region, Treatment)];

/// Which voxels of segments are others than before, as far as regions are shared with them.
#[derive(Clone, Debug, PartialEq)]
pub enum SharedChange {
    /// In these bricks, by rising place in the directory.
    Bricks(BTreeSet<u32>),
    /// Anywhere.
    All,
}

/// What steps have changed of segments that regions are shared with, since it was last looked at.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SharedRegionChanges(BTreeMap<SegmentId, SharedChange>);

impl SharedRegionChanges {
    /// Takes note of a step that was performed, told by its inverse.
    pub fn note(&mut self, inverse: &Step, is_shared: impl Fn(SegmentId) -> bool + Copy) {
        match inverse {
            Step::Edit { edit, .. } => {
                for (id, swaps) in edit.segments.iter().filter(|(id, _)| is_shared(*id)) {
                    let known = self.0.entry(*id);
                    let known = known.or_insert_with(|| SharedChange::Bricks(BTreeSet::new()));
                    if let SharedChange::Bricks(bricks) = known {
                        bricks.extend(swaps.iter().map(|swap| swap.index));
                    }
                }
            }
            Step::Replace { id, .. } | Step::Insert { id, .. } | Step::Remove { id } => {
                // where nobody shares it, this is asked for by nobody
                self.0.insert(*id, SharedChange::All);
            }
            Step::Several(steps) => steps.iter().for_each(|step| self.note(step, is_shared)),
            Step::Move { .. } | Step::Material { .. } | Step::Model(_) => {}
        }
    }

    /// Where regions hold other voxels than before.
    #[must_use]
    pub fn within(&self, regions: &Regions) -> SharedChange {
        let mut all = BTreeSet::new();
        for (region, _) in regions {
            let Region::Shared(other) = region else {
                continue;
            };
            match self.0.get(other) {
                Some(SharedChange::All) => return SharedChange::All,
                Some(SharedChange::Bricks(bricks)) => all.extend(bricks),
                None => {}
            }
        }
        SharedChange::Bricks(all)
    }
}

/// Where a segment with these regions is rigid; none where it is so nowhere.
#[must_use]
pub fn rigid_mask(voxels: &Voxels, regions: &Regions) -> Option<Bits> {
    let dimensions = voxels.grid().dimensions();
    regions
        .iter()
        .any(is_rigid)
        .then(|| Bits::from_bricks(dimensions, |bounds| rigid_brick(voxels, regions, &bounds)))
}

/// The bricks of a mask, of some that may, that are others by now.
#[must_use]
pub fn changed_bricks(
    mask: &Bits,
    voxels: &Voxels,
    regions: &Regions,
    bricks: &BTreeSet<u32>,
) -> Vec<BrickSwap<BitBrick>> {
    let all = voxels.grid().bounds();
    let known = |index: u32| mask.bricks().get(index).map_or(BitBrick::EMPTY, |b| **b);
    bricks
        .iter()
        // what has a grid of its own has other bricks
        .filter(|index| (**index as usize) < mask.bricks().len())
        .filter_map(|&index| {
            let bounds = mask.bricks().box_of(index).intersect(&all);
            let brick = rigid_brick(voxels, regions, &bounds);
            (brick != known(index)).then(|| BrickSwap {
                index,
                brick: brick.shared(),
            })
        })
        .collect()
}

fn is_rigid((_, treatment): &(Region, Treatment)) -> bool {
    *treatment == Treatment::Rigid
}

/// Of several regions that hold a voxel the last counts.
fn rigid_brick(voxels: &Voxels, regions: &Regions, bounds: &VoxelBox) -> BitBrick {
    regions.iter().fold(BitBrick::EMPTY, |mask, each| {
        let region = brick_of(voxels, &each.0, bounds);
        BitBrick(std::array::from_fn(|z| {
            if is_rigid(each) {
                mask.0[z] | region.0[z]
            } else {
                mask.0[z] & !region.0[z]
            }
        }))
    })
}

/// The voxels of a region in a brick.
fn brick_of(voxels: &Voxels, region: &Region, bounds: &VoxelBox) -> BitBrick {
    let size = bounds.size();
    match region {
        Region::Whole => BitBrick::filled(size),
        Region::Within(held) if held.contains_box(bounds) => BitBrick::filled(size),
        Region::Within(held) if held.intersect(bounds).is_empty() => BitBrick::EMPTY,
        Region::Within(held) => {
            BitBrick::from_fn(size, |offset: IVec3| held.contains(bounds.min + offset))
        }
        Region::Shared(other) => {
            let other = voxels.segment(*other);
            // what has a grid of its own shares no voxel of the scan
            let other = other.filter(|other| other.own_grid().is_none());
            let bricks = other.and_then(|other| other.occupancy().bricks().at(bounds.min));
            bricks.copied().unwrap_or_default()
        }
        Region::CutAway(mask) => {
            BitBrick::from_fn(size, |offset: IVec3| mask.cuts(bounds.min + offset))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat3, DVec3, UVec3};
    use palpate_volume::edit::SegmentId;
    use palpate_volume::grid::Grid;
    use palpate_volume::intensities::Intensities;
    use palpate_volume::segment::Segment;

    #[test]
    fn of_several_regions_that_hold_a_voxel_the_last_counts() {
        let size = UVec3::new(20, 11, 9);
        let grid = Grid::new(size, DVec3::ONE, DVec3::ZERO, DMat3::IDENTITY).unwrap();
        let values = Intensities::new(size, vec![0; grid.voxel_count()], 1.0, 0.0).unwrap();
        let mut voxels = Voxels::new(grid, values).unwrap();
        let stone = |voxel: IVec3| voxel.y > 5;
        let other = voxels.add_segment(Segment::from_fn(size, stone)).unwrap();
        let low = VoxelBox::new(IVec3::new(2, 0, 0), IVec3::new(17, 9, 9));
        let regions = [
            (Region::Whole, Treatment::Rigid),
            (Region::Within(low), Treatment::Deformable),
            (Region::Shared(other), Treatment::Rigid),
            (Region::Shared(SegmentId(9)), Treatment::Empty),
        ];
        let mask = rigid_mask(&voxels, &regions).unwrap();
        for voxel in VoxelBox::of_dimensions(size).voxels() {
            let expected = !low.contains(voxel) || stone(voxel);
            assert_eq!(mask.is_solid(voxel), expected, "{voxel}");
        }
        assert!(rigid_mask(&voxels, &regions[1..2]).is_none());
        assert!(rigid_mask(&voxels, &[]).is_none());
    }
}
