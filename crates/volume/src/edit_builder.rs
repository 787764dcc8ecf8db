//! Building edits brick by brick, without changing anything yet.
//!
//! A brick whose voxels all keep their state gives no swap. Edits of many bricks are built
//! in parallel.

use glam::IVec3;
use rayon::prelude::*;

use crate::bit_brick::BitBrick;
use crate::bits::moved;
use crate::brick_grid::{BrickGrid, BrickSwap};
use crate::edit::{Edit, EditKind, SegmentId};
use crate::intensity_brick::IntensityBrick;
use crate::matter::{Matter, SegmentSet};
use crate::segment::Segment;
use crate::voxel_box::VoxelBox;
use crate::voxels::Voxels;

/// From here on, handing out work to threads costs less than it saves; a brick takes some
/// microseconds.
const PARALLEL_BRICKS: usize = 64;

/// What an edit does to one brick.
struct BrickChange {
    index: u32,
    dirty: VoxelBox,
    intensities: Option<IntensityBrick>,
    segments: Vec<(SegmentId, BitBrick)>,
}

/// A label edit: new bits of one segment.
pub(crate) fn label_edit(
    (id, segment): (SegmentId, &Segment),
    region: &VoxelBox,
    solid: impl Fn(IVec3, bool) -> bool + Sync,
) -> Edit {
    let bricks = segment.occupancy().bricks();
    let changes = changed_bricks(bricks, region, |index, voxels| {
        let old = bricks.get(index).map_or(BitBrick::EMPTY, |brick| **brick);
        let mut new = old;
        for voxel in voxels.voxels() {
            new.set(voxel, solid(voxel, old.contains(voxel)));
        }
        BrickChange {
            index,
            dirty: moved(old.difference(&new), bricks.box_of(index).min),
            intensities: None,
            segments: vec![(id, new)],
        }
    });
    collect(EditKind::Label, changes)
}

/// A matter edit: new intensities, and new bits of all segments.
pub(crate) fn matter_edit(
    voxels: &Voxels,
    region: &VoxelBox,
    change: impl Fn(IVec3, Matter) -> Matter + Sync,
) -> Edit {
    let bricks = voxels.overlay().bricks();
    let changes = changed_bricks(bricks, region, |index, region| {
        let old_values = voxels.overlay().brick(voxels.intensities(), index);
        let old_bits = bits_of_all(voxels, index);
        let (mut new_values, mut new_bits) = (old_values.clone(), old_bits.clone());
        let mut dirty = VoxelBox::EMPTY;

        for voxel in region.voxels() {
            let was = Matter {
                stored: old_values.stored(voxel),
                segments: segments_at(&old_bits, voxel),
            };
            let now = change(voxel, was);
            new_values.set(voxel, now.stored);
            let mut differs = now.stored != was.stored;
            for (id, bits) in &mut new_bits {
                let solid = now.segments.contains(*id);
                differs |= solid != was.segments.contains(*id);
                bits.set(voxel, solid);
            }
            if differs {
                dirty = dirty.union(&VoxelBox::of_voxel(voxel));
            }
        }

        let changed_bits = new_bits.into_iter().zip(old_bits);
        BrickChange {
            index,
            dirty,
            intensities: (new_values != old_values).then_some(new_values),
            segments: changed_bits
                .filter(|(new, old)| new != old)
                .map(|(new, _)| new)
                .collect(),
        }
    });
    collect(EditKind::Matter, changes)
}

fn bits_of_all(voxels: &Voxels, index: u32) -> Vec<(SegmentId, BitBrick)> {
    let bits = |segment: &Segment| {
        let brick = segment.occupancy().bricks().get(index);
        brick.map_or(BitBrick::EMPTY, |brick| **brick)
    };
    voxels
        .segments()
        .map(|(id, segment)| (id, bits(segment)))
        .collect()
}

fn segments_at(bits: &[(SegmentId, BitBrick)], voxel: IVec3) -> SegmentSet {
    bits.iter()
        .filter(|(_, bits)| bits.contains(voxel))
        .map(|&(id, _)| id)
        .collect()
}

/// Asks for every brick that a region meets, with the part of the region in it.
fn changed_bricks<B: Send + Sync>(
    bricks: &BrickGrid<B>,
    region: &VoxelBox,
    change: impl Fn(u32, VoxelBox) -> BrickChange + Sync,
) -> Vec<BrickChange> {
    let indices = bricks.indices_in(region);
    let change = |&index: &u32| {
        let change = change(index, bricks.box_of(index).intersect(region));
        (!change.dirty.is_empty()).then_some(change)
    };
    if indices.len() < PARALLEL_BRICKS {
        indices.iter().filter_map(change).collect()
    } else {
        indices.par_iter().filter_map(change).collect()
    }
}

/// Puts the changes of all bricks together.
fn collect(kind: EditKind, changes: Vec<BrickChange>) -> Edit {
    let mut edit = Edit::empty(kind);
    let mut segments = std::collections::BTreeMap::<SegmentId, Vec<_>>::new();
    for change in changes {
        let index = change.index;
        edit.dirty = edit.dirty.union(&change.dirty);
        edit.intensities
            .extend(change.intensities.map(|brick| BrickSwap {
                index,
                brick: Some(brick.into()),
            }));
        for (id, bits) in change.segments {
            segments.entry(id).or_default().push(BrickSwap {
                index,
                brick: bits.shared(),
            });
        }
    }
    edit.segments = segments.into_iter().collect();
    edit
}
