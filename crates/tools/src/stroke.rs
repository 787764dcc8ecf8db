//! A stroke: the edits from press to release, as one step of undo.
//!
//! Of each brick only the first inverse is kept, the one that holds what was there when the
//! stroke began. So a stroke weighs as much as the bricks that it touched, however long the
//! tool rubbed on them, and undoing it is one swap per brick.

use std::collections::BTreeMap;
use std::sync::Arc;

use palpate_volume::bit_brick::BitBrick;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::edit::{Edit, EditKind, SegmentId};
use palpate_volume::intensity_brick::IntensityBrick;
use palpate_volume::voxel_box::VoxelBox;

/// A brick of bits with its two counters, which fill a cache line of their own.
const BITS_BYTES: usize = 2 * size_of::<BitBrick>();
/// A brick of values with its two counters.
const VALUES_BYTES: usize = size_of::<IntensityBrick>() + 2 * size_of::<usize>();

/// Bricks as they were, by place; none where there was no brick.
type Bricks<B> = BTreeMap<u32, Option<Arc<B>>>;

/// The inverse of all edits so far.
#[derive(Clone, Debug, Default)]
pub struct Stroke {
    is_matter: bool,
    dirty: VoxelBox,
    segments: BTreeMap<SegmentId, Bricks<BitBrick>>,
    intensities: Bricks<IntensityBrick>,
}

impl Stroke {
    /// Adds the inverse of the newest edit, as `Voxels::apply` gives it.
    pub fn add(&mut self, inverse: Edit) {
        self.is_matter |= inverse.kind == EditKind::Voxel;
        self.dirty = self.dirty.union(&inverse.dirty);
        for (id, swaps) in inverse.segments {
            keep_first(self.segments.entry(id).or_default(), swaps);
        }
        keep_first(&mut self.intensities, inverse.intensities);
    }

    /// Whether nothing was changed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.dirty.is_empty()
    }

    /// The edit that takes the whole stroke back; its box holds all that the stroke changed.
    #[must_use]
    pub fn into_inverse(self) -> Edit {
        Edit {
            kind: if self.is_matter {
                EditKind::Voxel
            } else {
                EditKind::Label
            },
            dirty: self.dirty,
            segments: self
                .segments
                .into_iter()
                .map(|(id, bricks)| (id, swaps_of(bricks)))
                .collect(),
            intensities: swaps_of(self.intensities),
        }
    }
}

/// Bytes that an edit holds on to, directories of its bricks included.
#[must_use]
pub fn bytes_of(edit: &Edit) -> usize {
    let bits: usize = edit.segments.iter().map(|(_, swaps)| swaps.len()).sum();
    bits * (BITS_BYTES + size_of::<BrickSwap<BitBrick>>())
        + edit.intensities.len() * (VALUES_BYTES + size_of::<BrickSwap<IntensityBrick>>())
}

fn keep_first<B>(bricks: &mut Bricks<B>, swaps: Vec<BrickSwap<B>>) {
    for swap in swaps {
        bricks.entry(swap.index).or_insert(swap.brick);
    }
}

fn swaps_of<B>(bricks: Bricks<B>) -> Vec<BrickSwap<B>> {
    bricks
        .into_iter()
        .map(|(index, brick)| BrickSwap { index, brick })
        .collect()
}
