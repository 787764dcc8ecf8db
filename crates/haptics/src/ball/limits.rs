//! How much a tick may do with a ball, where each new brick of cells costs a dilation.
//!
//! A brick takes up to 1.3 µs where the shape reaches over 8 voxels at most, up to 7 µs beyond
//! (`docs/decisions/ball.md`); the limits keep what a tick can need of them under 300 µs. They
//! are met in free flight only: a hand that slides needs a few bricks every 40 ticks.

use crate::ball::shape::BallShape;
use crate::contact::ExactLimits;
use glam::IVec3;
use palpate_volume::brick_grid::BRICK;

/// The limits for a ball of this shape; those of a point where it is one.
pub fn ball_limits(shape: &BallShape) -> ExactLimits {
    if shape.reach() == IVec3::ZERO {
        ExactLimits::default()
    } else if shape.reach().max_element() <= BRICK {
        // 202 bricks; as many slides as a point
        ExactLimits {
            max_visits: 800,
            max_slides: 8,
        }
    } else {
        // 40 bricks
        ExactLimits {
            max_visits: 96,
            max_slides: 2,
        }
    }
}

/// Most bricks of cells that one tick within these limits can fill, for one body.
pub fn most_bricks(limits: &ExactLimits) -> u32 {
    // A straight move over n voxels crosses a plane between bricks at most once per 8 steps
    // and once more on each axis: 1 + (n - 1 + 3 · 7) / 8 bricks, so n / 8 + 4 at most. Each
    // visits one voxel at least, even where none is left to visit.
    let moves = limits.max_slides.saturating_add(1);
    let visits = limits.max_visits.saturating_add(moves);
    // a slide looks at 8×8×8 cells, which stand on 8 bricks
    (visits / 8)
        .saturating_add(moves.saturating_mul(4))
        .saturating_add(limits.max_slides.saturating_mul(8))
}
