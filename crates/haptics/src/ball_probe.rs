//! What is solid for the probe, be it a point or a ball: one type for whoever runs the ticks.
//!
//! It owns the voxels, so that none of them changes without the ball being told. For a point
//! it is the voxels and one branch that is always the same. Admission works on two balls that
//! change places: nothing is allocated when voxels or the radius change. Frame: grid.

use crate::admission::{Admission, admit};
use crate::ball::{Ball, BallShape, Dilated};
use crate::proxy::Proxy;
use glam::{DVec3, IVec3};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::grid::Grid;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::voxel_box::VoxelBox;

/// What is solid for a point or for the centre of a ball; answers come from elsewhere.
#[derive(Debug)]
pub enum ProbeView<'a, O: ?Sized> {
    /// The voxels themselves.
    Point(&'a O),
    /// The cells that they block.
    Ball(Dilated<'a, O>),
}

impl<O: Occupancy + ?Sized> Occupancy for ProbeView<'_, O> {
    #[inline]
    fn is_solid(&self, voxel: IVec3) -> bool {
        match self {
            Self::Point(inner) => inner.is_solid(voxel),
            Self::Ball(dilated) => dilated.is_solid(voxel),
        }
    }

    #[inline]
    fn block(&self, min: IVec3) -> BitBrick {
        match self {
            Self::Point(inner) => inner.block(min),
            Self::Ball(dilated) => dilated.block(min),
        }
    }
}

/// Voxels, and the ball that touches them; none for a point, or one of radius 0.
#[derive(Debug)]
pub struct ProbeSolid<O> {
    inner: O,
    ball: Option<Ball>,
}

impl<O: Occupancy> ProbeSolid<O> {
    /// These voxels, for a ball or a point. A probe that shall be given a radius later is made
    /// with a ball of radius 0, for which nothing is dilated.
    pub fn new(inner: O, mut ball: Option<Ball>) -> Self {
        if let Some(ball) = &mut ball {
            ball.invalidate();
        }
        Self { inner, ball }
    }

    /// The voxels.
    pub fn inner(&self) -> &O {
        &self.inner
    }

    /// The ball; none for a point.
    pub fn ball(&self) -> Option<&Ball> {
        self.ball.as_ref()
    }

    /// Exchanges the voxels as a whole; gives the old ones, so that nothing is freed here.
    pub fn replace(&mut self, inner: O) -> O {
        if let Some(ball) = &mut self.ball {
            ball.invalidate();
        }
        std::mem::replace(&mut self.inner, inner)
    }

    /// Changes voxels, none of them outside the box.
    pub fn change<T>(&mut self, changed: &VoxelBox, change: impl FnOnce(&mut O) -> T) -> T {
        if let Some(ball) = &mut self.ball {
            ball.invalidate_box(changed);
        }
        change(&mut self.inner)
    }

    /// Exchanges the ball, or makes the probe a point; gives the old one.
    pub fn replace_ball(&mut self, mut ball: Option<Ball>) -> Option<Ball> {
        if let Some(ball) = &mut ball {
            ball.invalidate();
        }
        std::mem::replace(&mut self.ball, ball)
    }

    /// What would be solid for this probe among other voxels; `spare` works it out.
    pub fn among<'a, N: Occupancy + ?Sized>(
        &self,
        other: &'a N,
        spare: &'a mut Ball,
    ) -> ProbeView<'a, N> {
        match self.large_ball() {
            None => ProbeView::Point(other),
            Some(ball) => {
                spare.set_shape(*ball.shape());
                ProbeView::Ball(spare.dilate(other))
            }
        }
    }

    /// Takes another shape where the rule of admission allows it, pushing the proxy where it
    /// must. `spare` works it out and is exchanged for the ball; a probe without one holds.
    ///
    /// A push has a short reach, so a radius is raised step by step: see [`BallShape::toward`].
    pub fn admit_shape(
        &mut self,
        shape: BallShape,
        spare: &mut Ball,
        grid: &Grid,
        proxy: &mut Proxy,
    ) -> Admission {
        if self.ball.is_none() {
            return Admission::Held;
        }
        spare.set_shape(shape);
        let admission = admit(self, &spare.dilate(&self.inner), grid, proxy);
        if admission != Admission::Held
            && let Some(ball) = &mut self.ball
        {
            std::mem::swap(ball, spare);
        }
        admission
    }

    /// The ball, where it is more than a point.
    #[inline]
    fn large_ball(&self) -> Option<&Ball> {
        self.ball.as_ref().filter(|ball| !ball.is_point())
    }

    /// The solid voxel that the probe rests against where this cell holds it back: for a ball
    /// the nearest one [mm, centre to centre] of those that block the cell. None where the cell
    /// is free.
    pub fn solid_near(&self, cell: IVec3) -> Option<IVec3> {
        match self.large_ball() {
            None => self.inner.is_solid(cell).then_some(cell),
            Some(ball) => ball.solid_near(&self.inner, cell),
        }
    }

    /// The centre of the ball where it really touches, grid: see [`Ball::refined`]. A point
    /// stays where it is.
    pub fn refined(&self, proxy: &Proxy, device_in_grid: DVec3) -> DVec3 {
        match self.large_ball() {
            None => proxy.point(),
            Some(ball) => ball.refined(&self.inner, proxy, device_in_grid),
        }
    }
}

impl<O: Occupancy> Occupancy for ProbeSolid<O> {
    #[inline]
    fn is_solid(&self, voxel: IVec3) -> bool {
        match self.large_ball() {
            None => self.inner.is_solid(voxel),
            Some(ball) => ball.dilate(&self.inner).is_solid(voxel),
        }
    }

    #[inline]
    fn block(&self, min: IVec3) -> BitBrick {
        match self.large_ball() {
            None => self.inner.block(min),
            Some(ball) => ball.dilate(&self.inner).block(min),
        }
    }
}
