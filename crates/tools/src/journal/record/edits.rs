//! Edits in a journal: brick by brick the exclusive or of what was and what is.

use glam::UVec3;
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::edit::{Edit, EditKind, SegmentId};
use palpate_volume::grid::Grid;
use palpate_volume::intensities::Intensities;
use palpate_volume::intensity_brick::IntensityBrick;
use palpate_volume::overlay::Overlay;
use palpate_volume::voxel_box::VoxelBox;
use palpate_volume::voxels::Voxels;

use super::Wrong;
use super::bytes::{Reader, number_of, push_bits, push_count, values_as_bytes, words_as_bytes};
use crate::journal::entry::{Action, Delta, Entry};

pub(super) fn edit_bytes(action: Action, delta: &Delta, scan: &Intensities) -> Vec<u8> {
    let unedited = Overlay::empty(scan.dimensions());
    let values = |brick: Option<&IntensityBrick>, index| {
        brick
            .cloned()
            .unwrap_or_else(|| unedited.brick(scan, index))
    };
    let mut before = crc32fast::Hasher::new();
    let mut body = Vec::new();

    push_count(&mut body, delta.segments.len());
    for (id, bricks) in &delta.segments {
        body.push(id.0);
        push_count(&mut body, bricks.len());
        for brick in bricks {
            let [old, new] =
                [&brick.old, &brick.new].map(|brick| brick.as_deref().copied().unwrap_or_default());
            before.update(&words_as_bytes(&old.0));
            push_bits(&mut body, brick.index, &exclusive_or(&old, &new));
        }
    }
    push_count(&mut body, delta.intensities.len());
    for brick in &delta.intensities {
        let old = values(brick.old.as_deref(), brick.index);
        before.update(&values_as_bytes(&old.0));
        body.extend(brick.index.to_le_bytes());
        body.push(u8::from(brick.new.is_some()));
        if let Some(new) = &brick.new {
            body.extend(values_as_bytes(&differences(&old, new).0));
        }
    }

    let mut bytes = vec![number_of(action), u8::from(delta.kind == EditKind::Voxel)];
    bytes.extend(before.finalize().to_le_bytes());
    bytes.extend(body);
    bytes
}

pub(super) fn edit_of(bytes: &[u8], voxels: &Voxels) -> Result<Entry, Wrong> {
    let mut reader = Reader(bytes);
    let action = reader.action()?;
    let kind = match reader.byte()? {
        0 => EditKind::Label,
        1 => EditKind::Voxel,
        _ => return Err("neither a label nor a matter edit"),
    };
    let checksum = reader.number()?;
    let mut before = crc32fast::Hasher::new();
    let mut edit = Edit::empty(kind);

    for _ in 0..reader.count()? {
        let id = SegmentId(reader.byte()?);
        let segment = voxels.segment(id).ok_or("a segment that does not exist")?;
        let bricks = segment.occupancy().bricks();
        let mut swaps = Vec::new();
        for _ in 0..reader.count()? {
            let (index, differs) = reader.bits()?;
            let old = bricks.get(index).map_or(BitBrick::EMPTY, |brick| **brick);
            before.update(&words_as_bytes(&old.0));
            let new = exclusive_or(&old, &differs);
            let dirty = dirty_of(segment.grid(voxels.grid()), index, &differs)?;
            edit.dirty = edit.dirty.union(&dirty);
            let brick = new.shared();
            swaps.push(BrickSwap { index, brick });
        }
        edit.segments.push((id, swaps));
    }
    for _ in 0..reader.count()? {
        let index = reader.number()?;
        let exists = reader.byte()? != 0;
        part_of(voxels.grid(), index)?;
        let old = voxels.overlay().brick(voxels.intensities(), index);
        before.update(&values_as_bytes(&old.0));
        let new = if exists {
            Some(differences(&old, &reader.values()?))
        } else {
            None
        };
        let shown = match &new {
            Some(new) => new.clone(),
            None => Overlay::empty(voxels.grid().dimensions()).brick(voxels.intensities(), index),
        };
        let dirty = dirty_of(voxels.grid(), index, &where_different(&old, &shown))?;
        edit.dirty = edit.dirty.union(&dirty);
        let brick = new.map(Into::into);
        edit.intensities.push(BrickSwap { index, brick });
    }

    if before.finalize() != checksum {
        return Err("it follows on other voxels");
    }
    if kind == EditKind::Label && !edit.intensities.is_empty() {
        return Err("a label edit of intensities");
    }
    reader.end()?;
    Ok(Entry::Edit(action, edit))
}

/// The part of a brick inside the grid.
fn part_of(grid: &Grid, index: u32) -> Result<VoxelBox, Wrong> {
    let bricks = grid.dimensions().map(|n| n.div_ceil(8));
    let all = u64::from(bricks.x) * u64::from(bricks.y) * u64::from(bricks.z);
    if u64::from(index) >= all {
        return Err("a brick beyond the scan");
    }
    let row = index / bricks.x;
    let place = UVec3::new(index % bricks.x, row % bricks.y, row / bricks.y);
    let min = 8 * place.as_ivec3();
    Ok(VoxelBox::new(min, min + 8).intersect(&grid.bounds()))
}

/// The smallest box of the voxels whose bit is set; all must be inside the grid.
pub(super) fn dirty_of(grid: &Grid, index: u32, bits: &BitBrick) -> Result<VoxelBox, Wrong> {
    let part = part_of(grid, index)?;
    let dirty = bits.difference(&BitBrick::EMPTY);
    if dirty.is_empty() {
        return Ok(dirty);
    }
    let dirty = VoxelBox::new(dirty.min + part.min, dirty.max + part.min);
    if !part.contains_box(&dirty) {
        return Err("voxels beyond the scan");
    }
    Ok(dirty)
}

fn where_different(a: &IntensityBrick, b: &IntensityBrick) -> BitBrick {
    BitBrick::from_fn(UVec3::splat(8), |voxel| a.stored(voxel) != b.stored(voxel))
}

fn exclusive_or(a: &BitBrick, b: &BitBrick) -> BitBrick {
    BitBrick(std::array::from_fn(|z| a.0[z] ^ b.0[z]))
}

fn differences(a: &IntensityBrick, b: &IntensityBrick) -> IntensityBrick {
    IntensityBrick(std::array::from_fn(|place| a.0[place] ^ b.0[place]))
}
