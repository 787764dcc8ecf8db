//! What can be touched: the union of all touchable segments, brick by brick.
//!
//! The servo reads one set of bits however many segments there are, so that its work per visit
//! stays the same. Bricks that only one segment has are shared with it; only where segments
//! overlap is a new brick made.

use std::sync::Arc;

use glam::UVec3;
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::bits::Bits;
use palpate_volume::brick_grid::BrickSwap;

/// The union of segments of one grid.
#[must_use]
pub fn union_of(dimensions: UVec3, segments: &[&Bits]) -> Bits {
    let Some((first, rest)) = segments.split_first() else {
        return Bits::empty(dimensions);
    };
    let mut union = (*first).clone();
    for segment in rest {
        for (index, brick) in (0..).zip(segment.bricks().entries()) {
            let Some(brick) = brick else { continue };
            let merged = merged(union.bricks().get(index), brick);
            union.swap(&mut BrickSwap {
                index,
                brick: Some(merged),
            });
        }
    }
    union
}

/// One brick of the union.
#[must_use]
pub fn union_brick(segments: &[&Bits], index: u32) -> Option<Arc<BitBrick>> {
    segments
        .iter()
        .filter_map(|segment| segment.bricks().get(index))
        .fold(None, |union, brick| Some(merged(union.as_ref(), brick)))
}

fn merged(union: Option<&Arc<BitBrick>>, brick: &Arc<BitBrick>) -> Arc<BitBrick> {
    let Some(union) = union else {
        return Arc::clone(brick);
    };
    let both = BitBrick(std::array::from_fn(|z| union.0[z] | brick.0[z]));
    // where one holds the other it is shared, not copied
    if both == **union {
        Arc::clone(union)
    } else if both == **brick {
        Arc::clone(brick)
    } else {
        both.shared()
            .expect("the union of two bricks is not empty where one of them is not")
    }
}
