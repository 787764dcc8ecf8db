//! What is solid for the probe, be it a point or a ball: one type for whoever runs the ticks.
//!
//! It owns the voxels, so that none of them changes without the balls being told. For a point
//! it is the voxels and one branch that is always the same; the balls are there all the same,
//! so that nothing is allocated when voxels or the radius change. Frame: grid.

use crate::admission::{Admission, admit_scene};
use crate::ball::closing::Closing;
use crate::ball::{Ball, BallError, BallShape, Dilated};
use crate::contact::Proxy;
use crate::scene::{MAX_OBJECTS, Object, TouchScene};
use arrayvec::ArrayVec;
use glam::{DVec3, IVec3};
use palpate_volume::bit_brick::BitBrick;
use palpate_volume::first_solid::Traversal;
use palpate_volume::occupancy::Occupancy;
use palpate_volume::voxel_box::VoxelBox;

/// Bodies of a scene, the world among them.
pub const MAX_BODIES: usize = MAX_OBJECTS + 1;

/// What is solid for a point or for the centre of a ball; answers come from elsewhere.
#[derive(Debug)]
pub enum ProbeView<'a, O: ?Sized> {
    /// The voxels themselves.
    Point(&'a O),
    /// The cells that they block.
    Ball(Dilated<'a, O>),
}

impl<'a, O: Occupancy + ?Sized> ProbeView<'a, O> {
    /// What these voxels are for a ball that belongs to them.
    pub fn new(voxels: &'a O, ball: &'a Ball) -> Self {
        if ball.is_point() {
            Self::Point(voxels)
        } else {
            Self::Ball(ball.dilate(voxels))
        }
    }

    /// What these voxels are for a ball of this shape; `spare` works it out.
    pub fn of_shape(voxels: &'a O, shape: BallShape, spare: &'a mut Ball) -> Self {
        spare.set_shape(shape);
        Self::new(voxels, spare)
    }
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

/// Voxels, and the ball that touches them; one of radius 0 is a point.
#[derive(Debug)]
pub struct ProbeSolid<O> {
    inner: O,
    /// Where its centre cannot be.
    hard: Ball,
    /// Holes and gaps too narrow for the ball, which the smooth force takes as solid.
    closing: Closing,
}

impl<O: Occupancy> ProbeSolid<O> {
    /// These voxels of a size [mm], for a probe of a radius [mm]; 0 is a point.
    ///
    /// # Errors
    /// Where the ball is too large for these voxels.
    pub fn new(inner: O, radius_mm: f64, spacing: DVec3) -> Result<Self, BallError> {
        let shape = BallShape::new(radius_mm, spacing)?;
        Ok(Self {
            inner,
            hard: Ball::new(shape),
            closing: Closing::new(&shape),
        })
    }

    /// The voxels.
    pub fn inner(&self) -> &O {
        &self.inner
    }

    /// The ball's hard shape.
    pub fn shape(&self) -> &BallShape {
        self.hard.shape()
    }

    /// The ball that belongs to the voxels, hard.
    pub fn ball(&self) -> &Ball {
        &self.hard
    }

    /// Changes voxels, none of them outside the box.
    pub fn change<T>(&mut self, changed: &VoxelBox, change: impl FnOnce(&mut O) -> T) -> T {
        if !self.hard.is_point() {
            self.hard.invalidate_box(changed);
            self.closing.invalidate_box(changed);
        }
        change(&mut self.inner)
    }

    /// Takes another radius [mm] at once; whether the probe admits that is asked in
    /// [`admit_radius`].
    ///
    /// # Errors
    /// Where the ball is too large for these voxels; nothing is changed then.
    pub fn set_radius(&mut self, radius_mm: f64) -> Result<(), BallError> {
        let shape = BallShape::new(radius_mm, self.shape().spacing())?;
        self.hard.set_shape(shape);
        self.closing.set_shape(&shape);
        Ok(())
    }

    /// What would be solid for this probe among other voxels; `spare` works it out.
    pub fn among<'a, N: Occupancy + ?Sized>(
        &self,
        other: &'a N,
        spare: &'a mut Ball,
    ) -> ProbeView<'a, N> {
        ProbeView::of_shape(other, *self.shape(), spare)
    }

    /// The solid voxel that the probe rests against where this cell holds it back: for a ball
    /// the nearest one [mm, centre to centre] of those that block the cell. None where the cell
    /// is free.
    pub fn solid_near(&self, cell: IVec3) -> Option<IVec3> {
        if self.hard.is_point() {
            self.inner.is_solid(cell).then_some(cell)
        } else {
            self.hard.solid_near(&self.inner, cell)
        }
    }
}

/// A ball's cells are not put into the loops that ask: those of a point stay short.
impl<O: Occupancy> ProbeSolid<O> {
    #[inline(never)]
    fn is_blocked(&self, voxel: IVec3) -> bool {
        self.hard.dilate(&self.inner).is_solid(voxel)
    }

    #[inline(never)]
    fn first_blocked(&self, start: DVec3, end: DVec3, max_visits: u32) -> Traversal {
        self.hard
            .dilate(&self.inner)
            .first_solid(start, end, max_visits)
    }

    #[inline(never)]
    fn blocked(&self, min: IVec3) -> BitBrick {
        self.hard.dilate(&self.inner).block(min)
    }
}

impl<O: Occupancy> Occupancy for ProbeSolid<O> {
    #[inline]
    fn is_solid(&self, voxel: IVec3) -> bool {
        if self.hard.is_point() {
            self.inner.is_solid(voxel)
        } else {
            self.is_blocked(voxel)
        }
    }

    #[inline]
    fn first_solid(&self, start: DVec3, end: DVec3, max_visits: u32) -> Traversal {
        if self.hard.is_point() {
            self.inner.first_solid(start, end, max_visits)
        } else {
            self.first_blocked(start, end, max_visits)
        }
    }

    #[inline]
    fn block(&self, min: IVec3) -> BitBrick {
        if self.hard.is_point() {
            self.inner.block(min)
        } else {
            self.blocked(min)
        }
    }

    #[inline]
    fn smooth_block(&self, min: IVec3) -> BitBrick {
        self.closing.block(&self.inner, min)
    }

    #[inline]
    fn prepare_smooth_brick(&self, min: IVec3) -> bool {
        self.closing.prepare(&self.inner, min)
    }

    #[inline]
    fn probe_radius_mm(&self) -> f64 {
        self.shape().radius_mm()
    }

    #[inline]
    fn knows_fractions(&self) -> bool {
        self.inner.knows_fractions()
    }

    #[inline]
    fn occupancy_fraction(&self, voxel: IVec3, solid: bool) -> Option<f32> {
        self.inner.occupancy_fraction(voxel, solid)
    }

    #[inline]
    fn fraction_changes(&self, voxels: &[(IVec3, bool)], changes: &mut [f32]) {
        self.inner.fraction_changes(voxels, changes);
    }
}

impl<O: Occupancy> Object<ProbeSolid<O>> {
    /// A box that holds all cells that a ball of a shape is blocked in, where the voxels are
    /// within the box of the present shape.
    fn bounds_for(&self, shape: &BallShape) -> VoxelBox {
        let bounds = self.bounds();
        if bounds.is_empty() {
            return bounds;
        }
        let further = shape.reach() - self.occupancy().shape().reach();
        VoxelBox::new(bounds.min - further, bounds.max + further)
    }

    /// Takes another radius [mm] at once, see [`ProbeSolid::set_radius`].
    ///
    /// # Errors
    /// Where the ball is too large for these voxels; nothing is changed then.
    pub fn set_radius(&mut self, radius_mm: f64) -> Result<(), BallError> {
        let shape = BallShape::new(radius_mm, self.spacing())?;
        self.set_bounds(self.bounds_for(&shape));
        self.occupancy_mut().set_radius(radius_mm)
    }
}

/// Asks whether the probe in a scene may take another radius [mm], and pushes the proxy where it
/// must: the rule of admission. Whoever owns the bodies gives it to them unless it is held.
///
/// A push has a short reach, so a radius is raised step by step: see [`BallShape::toward`].
/// `spares` work out what would be solid.
///
/// # Errors
/// Where the ball is too large for the voxels of a body.
pub fn admit_radius<O: Occupancy>(
    scene: &TouchScene<'_, ProbeSolid<O>>,
    radius_mm: f64,
    spares: &mut [Ball; MAX_BODIES],
    proxy: &mut Proxy,
) -> Result<Admission, BallError> {
    let [spare_of_world, spares @ ..] = spares;
    let shape = BallShape::new(radius_mm, scene.grid.spacing())?;
    let world = ProbeView::of_shape(scene.occupancy.inner(), shape, spare_of_world);
    let mut objects = ArrayVec::<_, MAX_OBJECTS>::new();
    for (object, spare) in scene.objects.iter().zip(spares) {
        let shape = if object.spacing() == shape.spacing() {
            shape
        } else {
            BallShape::new(radius_mm, object.spacing())?
        };
        let view = ProbeView::of_shape(object.occupancy().inner(), shape, spare);
        objects.push(object.with_occupancy(view, object.bounds_for(&shape)));
    }
    let new = TouchScene {
        occupancy: &world,
        grid: scene.grid,
        objects: &objects,
    };
    Ok(admit_scene(scene, &new, proxy))
}
