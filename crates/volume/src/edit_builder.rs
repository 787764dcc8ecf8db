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
use crate::segment::Segment;
use crate::segment_set::SegmentSet;
use crate::voxel_box::VoxelBox;
use crate::voxel_state::VoxelState;
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

/// A label edit: new bits of some segments, each given once, in all bricks that a box meets.
pub(crate) fn label_edit(
    segments: &[(SegmentId, &Segment)],
    boxes: &[VoxelBox],
    solid: impl Fn(SegmentId, IVec3, bool) -> bool + Sync,
) -> Edit {
    let Some((_, first)) = segments.first() else {
        return Edit::empty(EditKind::Label);
    };
    let bricks = first.occupancy().bricks();
    let changes = changed_bricks(bricks, boxes, |index, voxels| {
        let mut change = BrickChange {
            index,
            dirty: VoxelBox::EMPTY,
            intensities: None,
            segments: Vec::new(),
        };
        for &(id, segment) in segments {
            let brick = segment.occupancy().bricks().get(index);
            let old = brick.map_or(BitBrick::EMPTY, |brick| **brick);
            let mut new = old;
            for voxel in voxels.voxels() {
                new.set(voxel, solid(id, voxel, old.contains(voxel)));
            }
            if new != old {
                let differs = moved(old.difference(&new), bricks.box_of(index).min);
                change.dirty = change.dirty.union(&differs);
                change.segments.push((id, new));
            }
        }
        change
    });
    collect(EditKind::Label, changes)
}

/// A voxel edit: new intensities, and new bits of all segments.
pub(crate) fn voxel_edit(
    voxels: &Voxels,
    region: &VoxelBox,
    change: impl Fn(IVec3, VoxelState) -> VoxelState + Sync,
) -> Edit {
    let bricks = voxels.overlay().bricks();
    let changes = changed_bricks(bricks, &[*region], |index, region| {
        let old_values = voxels.overlay().brick(voxels.intensities(), index);
        let old_bits = bits_of_all(voxels, index);
        let (mut new_values, mut new_bits) = (old_values.clone(), old_bits.clone());
        let mut dirty = VoxelBox::EMPTY;

        for voxel in region.voxels() {
            let was = VoxelState {
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
    collect(EditKind::Voxel, changes)
}

fn bits_of_all(voxels: &Voxels, index: u32) -> Vec<(SegmentId, BitBrick)> {
    let bits = |segment: &Segment| {
        let brick = segment.occupancy().bricks().get(index);
        brick.map_or(BitBrick::EMPTY, |brick| **brick)
    };
    voxels
        .segments()
        .filter(|(_, segment)| segment.own_grid().is_none())
        .map(|(id, segment)| (id, bits(segment)))
        .collect()
}

fn segments_at(bits: &[(SegmentId, BitBrick)], voxel: IVec3) -> SegmentSet {
    bits.iter()
        .filter(|(_, bits)| bits.contains(voxel))
        .map(|&(id, _)| id)
        .collect()
}

/// Asks for every brick that a box meets, once, with the part of the boxes in it.
fn changed_bricks<B: Send + Sync>(
    bricks: &BrickGrid<B>,
    boxes: &[VoxelBox],
    change: impl Fn(u32, VoxelBox) -> BrickChange + Sync,
) -> Vec<BrickChange> {
    let parts = parts_by_brick(bricks, boxes);
    let change = |(index, part): &(u32, VoxelBox)| {
        let change = change(*index, *part);
        (!change.dirty.is_empty()).then_some(change)
    };
    if parts.len() < PARALLEL_BRICKS {
        parts.iter().filter_map(change).collect()
    } else {
        parts.par_iter().filter_map(change).collect()
    }
}

/// The bricks that boxes meet, by rising place, each with the smallest box of what they
/// cover of it.
fn parts_by_brick<B>(bricks: &BrickGrid<B>, boxes: &[VoxelBox]) -> Vec<(u32, VoxelBox)> {
    let mut parts: Vec<(u32, VoxelBox)> = boxes
        .iter()
        .flat_map(|region| {
            let part = |index| (index, bricks.box_of(index).intersect(region));
            bricks.indices_in(region).into_iter().map(part)
        })
        .collect();
    parts.sort_unstable_by_key(|(index, _)| *index);
    parts.dedup_by(|next, kept| {
        let same = next.0 == kept.0;
        if same {
            kept.1 = kept.1.union(&next.1);
        }
        same
    });
    parts
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
