//! A probe with a radius: the space of centres, as one more occupancy.
//!
//! The centre of a ball moves among the cells of the grid that are not blocked by a solid
//! voxel, exactly as a point moves among voxels that are not solid. So whatever holds for a
//! point holds for the ball: exact traversal, sliding, admission, bounded work. Blocked cells
//! are worked out a brick at a time, where the probe is, and kept until an edit comes near;
//! nothing is computed over the whole volume, and no answer depends on what is kept.
//!
//! A ball fits where the *cells* leave room: through a channel of 2 ⌈r/h⌉ + 1 voxels, for a
//! radius of ⌈r/h⌉ voxels. That errs to the safe side, by less than a voxel on either side;
//! `docs/decisions/ball.md` says why.
//!
//! Frame: grid; radii in mm.

mod brick;
mod cache;
mod closing;
mod limits;
mod nearest;
mod probe;
mod shape;

pub use limits::{ball_limits, most_bricks};
pub use probe::{MAX_BODIES, ProbeSolid, ProbeView, admit_radius};
pub use shape::{BallError, BallShape, MAX_REACH};

use crate::ball::brick::dilated_brick;
use crate::ball::cache::BallCache;
use crate::ball::nearest::nearest_solid;
use glam::IVec3;
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::block::block_of_bricks;
use palpate_volume::brick_grid::BRICK;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::voxel_box::VoxelBox;

/// A shape, and the cells that it was found to be blocked in. It belongs to one occupancy;
/// whoever changes that says where.
#[derive(Debug)]
pub struct Ball {
    shape: BallShape,
    is_point: bool,
    cache: BallCache,
}

impl Ball {
    /// A ball of this shape; 64 KiB are allocated now, and nothing later.
    pub fn new(shape: BallShape) -> Self {
        Self {
            shape,
            is_point: shape.reach() == IVec3::ZERO,
            cache: BallCache::new(),
        }
    }

    /// The shape of the ball.
    pub fn shape(&self) -> &BallShape {
        &self.shape
    }

    /// Gives it another shape and forgets all cells; nothing is allocated.
    pub fn set_shape(&mut self, shape: BallShape) {
        self.shape = shape;
        self.is_point = shape.reach() == IVec3::ZERO;
        self.invalidate();
    }

    /// Whether the ball has no reach: it blocks the solid voxels only, like a point.
    #[inline]
    pub fn is_point(&self) -> bool {
        self.is_point
    }

    /// Forgets all cells: the occupancy is another one now.
    pub fn invalidate(&mut self) {
        self.cache.invalidate();
    }

    /// These voxels of the occupancy may have changed. Work: a few ns per brick of the box.
    pub fn invalidate_box(&mut self, changed: &VoxelBox) {
        self.cache.invalidate_box(&self.shape.grown(changed));
    }

    /// The solid voxel that the ball rests against where this cell holds its centre back: the
    /// nearest one [mm, centre to centre] of those that block the cell; none where it is free.
    pub fn solid_near(&self, inner: &(impl Occupancy + ?Sized), cell: IVec3) -> Option<IVec3> {
        nearest_solid(inner, &self.shape, cell)
    }

    /// The cells that are blocked in this occupancy, which must be the one that the ball
    /// belongs to.
    #[inline]
    pub fn dilate<'a, O: Occupancy + ?Sized>(&'a self, inner: &'a O) -> Dilated<'a, O> {
        Dilated { inner, ball: self }
    }
}

/// What is solid for the centre of a ball.
#[derive(Debug)]
pub struct Dilated<'a, O: ?Sized> {
    inner: &'a O,
    ball: &'a Ball,
}

impl<O: Occupancy + ?Sized> Dilated<'_, O> {
    fn fill(&self) -> impl FnOnce(IVec3) -> BitBrick {
        |place| dilated_brick(self.inner, &self.ball.shape, place * BRICK)
    }
}

impl<O: Occupancy + ?Sized> Occupancy for Dilated<'_, O> {
    #[inline]
    fn is_solid(&self, cell: IVec3) -> bool {
        self.ball.cache.is_blocked(cell, self.fill())
    }

    #[inline]
    fn block(&self, min: IVec3) -> BitBrick {
        block_of_bricks(min, |corner| {
            // a block that stands on bricks along an axis needs none beyond
            if corner.cmpge(min + BRICK).any() {
                return BitBrick::EMPTY;
            }
            self.ball.cache.brick(corner >> 3_i32, self.fill())
        })
    }
}
