//! Segments as commands have them: with the bricks that were put, and those that a new root
//! changes.

use std::sync::Arc;

use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::edit::SegmentId;
use palpate_volume::grid::Grid;
use palpate_volume::occupancy_fractions::OccupancyFractions;
use palpate_volume::voxel_box::VoxelBox;

use super::{PartSwap, TapePart};
use crate::replay::mask_runs::mask_of;
use crate::touch::{FractionSwap, MovedPart, Part, ScanValues, Threshold};

/// Puts bricks in the place of those that are there.
pub fn put(parts: &mut [Part], swaps: &[PartSwap]) {
    for (id, swap) in swaps {
        if let Ok(place) = place_of(parts, *id) {
            parts[place].bits.swap(&mut swap.clone());
        }
    }
}

/// Puts what is known of occupancy fractions in the place of what was.
pub fn put_fractions(parts: &mut [Part], swaps: &[FractionSwap]) {
    for (id, swap) in swaps {
        if let Ok(place) = place_of(parts, *id) {
            let part = &mut parts[place];
            let unknown = || Arc::new(OccupancyFractions::unknown(part.bits.dimensions()));
            let fractions = part.fractions.get_or_insert_with(unknown);
            Arc::make_mut(fractions).swap(&mut swap.clone());
        }
    }
}

/// Parts as a new root has them: those that stay keep their voxels, new ones have none yet.
#[must_use]
pub fn rooted(old: &[Part], new: &[TapePart], values: &ScanValues) -> Vec<Part> {
    let part = |part: &TapePart| {
        let id = SegmentId(part.id);
        let own = part.own_grid.as_ref().map(Grid::dimensions);
        let dimensions = own.unwrap_or(values.dimensions());
        let bits = match place_of(old, id) {
            Ok(place) if old[place].bits.dimensions() == dimensions => old[place].bits.clone(),
            _ => Bits::empty(dimensions),
        };
        let known = place_of(old, id)
            .ok()
            .and_then(|place| old[place].fractions.clone());
        let is_mask = part.threshold.is_none();
        let fractions = known.filter(|known| is_mask && known.dimensions() == dimensions);
        let moved = part.moved.map(|(min, max, pose)| MovedPart {
            own_grid: part.own_grid,
            bounds: VoxelBox::new(min, max),
            pose,
        });
        Part {
            id,
            bits,
            moved,
            threshold: part.threshold.map(|range| Threshold {
                range,
                values: values.clone(),
            }),
            fractions,
            punctured: part.punctured,
            rigid: mask_of(&part.rigid, dimensions),
        }
    };
    new.iter().map(part).collect()
}

fn place_of(parts: &[Part], id: SegmentId) -> Result<usize, usize> {
    parts.binary_search_by_key(&id.0, |part| part.id.0)
}

/// The bricks of a part that hold other voxels than before.
pub(super) fn changed_bricks(old: &[Part], new: &Part) -> Vec<PartSwap> {
    let old = place_of(old, new.id).ok().map(|place| &old[place].bits);
    let old = old.filter(|bits| bits.dimensions() == new.bits.dimensions());
    let before = |index| old.and_then(|bits| bits.bricks().get(index));
    (0..)
        .zip(new.bits.bricks().entries())
        .filter(|(index, brick)| !is_same(before(*index), brick.as_ref()))
        .map(|(index, brick)| {
            let brick = brick.clone();
            (new.id, BrickSwap { index, brick })
        })
        .collect()
}

/// The same of occupancy fractions.
pub(super) fn changed_fractions(old: &[Part], new: &Part) -> Vec<FractionSwap> {
    let old = place_of(old, new.id).ok().map(|place| &old[place]);
    let old = old.and_then(|old| old.fractions.as_ref());
    let old = old.filter(|old| old.dimensions() == new.bits.dimensions());
    let Some(fractions) = &new.fractions else {
        return Vec::new();
    };
    if old.is_some_and(|old| Arc::ptr_eq(old, fractions)) {
        return Vec::new();
    }
    let before = |index| old.and_then(|fractions| fractions.bricks().get(index));
    (0..)
        .zip(fractions.bricks().entries())
        .filter(|(index, brick)| !is_same(before(*index), brick.as_ref()))
        .map(|(index, brick)| {
            let brick = brick.clone();
            (new.id, BrickSwap { index, brick })
        })
        .collect()
}

fn is_same<B: PartialEq>(old: Option<&Arc<B>>, new: Option<&Arc<B>>) -> bool {
    match (old, new) {
        (Some(old), Some(new)) => Arc::ptr_eq(old, new) || old == new,
        (old, new) => old.is_none() && new.is_none(),
    }
}
