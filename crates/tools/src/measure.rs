//! How much an edit changes.

use std::collections::BTreeMap;

use palpate_volume::bit_brick::BitBrick;
use palpate_volume::edit::Edit;
use palpate_volume::voxels::Voxels;

/// Voxels whose bit differs in at least one segment, were `edit` applied to `voxels`.
pub(crate) fn changed_voxels(voxels: &Voxels, edit: &Edit) -> u64 {
    let mut changed = BTreeMap::<u32, [u64; 8]>::new();
    for (id, swaps) in &edit.segments {
        let bricks = voxels
            .segment(*id)
            .map(|segment| segment.occupancy().bricks());
        for swap in swaps {
            let old = bricks.and_then(|bricks| bricks.get(swap.index));
            let [old, new] = [old, swap.brick.as_ref()]
                .map(|brick| brick.map_or(BitBrick::EMPTY, |brick| **brick));
            let words = changed.entry(swap.index).or_default();
            for (word, (old, new)) in words.iter_mut().zip(old.0.into_iter().zip(new.0)) {
                *word |= old ^ new;
            }
        }
    }
    let ones = |words: &[u64; 8]| {
        words
            .iter()
            .map(|word| u64::from(word.count_ones()))
            .sum::<u64>()
    };
    changed.values().map(ones).sum()
}
