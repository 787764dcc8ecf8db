//! A change of what is solid, brick by brick, and what is to be freed once the servo has taken it.
//!
//! Frame: grid.

use palpate_haptics::needle::tissues::Tissues;
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::BrickSwap;
use palpate_volume::edit::SegmentId;
use palpate_volume::occupancy_fractions::FractionBrick;

use crate::touch::occupancy_fractions::{FractionalBits, union_fraction_brick};
use crate::touch::touchable::{Touchable, union_brick};

/// The bricks of one edit.
#[derive(Debug)]
pub struct BrickChange {
    /// Number of the change.
    pub sequence: u64,
    /// Of the union: at most [`MAX_BRICKS`], by rising index, each once.
    pub swaps: Vec<BrickSwap<BitBrick>>,
    /// Of the segments that it changes, at most [`MAX_BRICKS`].
    pub parts: Vec<(SegmentId, BrickSwap<BitBrick>)>,
    /// What is known of the occupancy fractions of the union: at most [`MAX_FRACTIONS`], by rising
    /// index.
    pub fractions: Vec<BrickSwap<FractionBrick>>,
    /// The same of the segments, at most [`MAX_BRICKS`], for whoever records.
    pub part_fractions: Vec<FractionSwap>,
}

/// What is known of the shares in a brick of a segment.
pub type FractionSwap = (SegmentId, BrickSwap<FractionBrick>);

impl BrickChange {
    /// Bricks of segments that hold them by now; what becomes of the union follows from all
    /// segments that were not moved.
    #[must_use]
    pub fn new(
        sequence: u64,
        unmoved: &[FractionalBits<'_>],
        changed: Vec<(SegmentId, BrickSwap<BitBrick>)>,
        part_fractions: Vec<FractionSwap>,
    ) -> Self {
        let mut bricks: Vec<u32> = changed.iter().map(|(_, swap)| swap.index).collect();
        bricks.sort_unstable();
        bricks.dedup();
        let bits: Vec<&Bits> = unmoved.iter().map(|part| part.bits).collect();
        let swaps = bricks.iter().map(|&index| BrickSwap {
            index,
            brick: union_brick(&bits, index),
        });
        let swaps = swaps.collect();
        Self {
            sequence,
            swaps,
            parts: changed,
            fractions: Self::union_fractions(unmoved, bricks, &part_fractions),
            part_fractions,
        }
    }

    /// What becomes of the occupancy fractions of the union where bits or occupancy fractions of
    /// segments change.
    fn union_fractions(
        unmoved: &[FractionalBits<'_>],
        mut bricks: Vec<u32>,
        changed: &[FractionSwap],
    ) -> Vec<BrickSwap<FractionBrick>> {
        if unmoved.iter().all(|part| part.fractions.is_none()) {
            return Vec::new();
        }
        if let [first, _, ..] = unmoved {
            // where one segment goes on beside another there is no surface
            let directory = first.bits.bricks();
            let beside = |&index: &u32| directory.indices_beside(index);
            let beside: Vec<u32> = bricks.iter().flat_map(beside).collect();
            bricks.extend(beside);
        }
        bricks.extend(changed.iter().map(|(_, swap)| swap.index));
        bricks.sort_unstable();
        bricks.dedup();
        let swap = |index| BrickSwap {
            index,
            brick: union_fraction_brick(unmoved, index),
        };
        bricks.into_iter().map(swap).collect()
    }
}

/// Servo → simulation: what is to be freed there. The fields are only ever dropped.
#[derive(Debug)]
pub enum Garbage {
    /// An occupancy that is no longer touched.
    Root(Box<Touchable>),
    /// Bricks that are no longer touched.
    Bricks(BrickChange),
    /// What a command told of a needle, once that is known.
    Tissues(Box<Tissues>),
    /// A brick that was never touched.
    Brick(BrickSwap<BitBrick>),
    /// The same of occupancy fractions.
    Fractions(BrickSwap<FractionBrick>),
}

/// Bricks of one edit, at most; larger edits go as a root.
pub const MAX_BRICKS: usize = 256;
/// Bricks of occupancy fractions that come with them, at most.
pub const MAX_FRACTIONS: usize = 2 * MAX_BRICKS;
/// Edits that are held back, at most; beyond, a root has to bring them all.
pub const MAX_HELD: usize = 8;
