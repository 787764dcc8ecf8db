//! A smooth field whose level is the surface: near 1 inside a body, near 0 outside.
//!
//! Frame: the grid of the body, in voxels.

use glam::DVec3;

/// A field of one width at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Level {
    /// 0..=1; the surface is where it is ½.
    pub value: f64,
    /// Change per voxel along each axis of the grid.
    pub gradient: DVec3,
}

/// A field at a point, blurred by two kernels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FieldSample {
    /// By the narrow kernel, which follows edges and small features.
    pub fine: Level,
    /// By the wide kernel, which sees through the stairs of voxels.
    pub wide: Level,
}

/// How wide a field's kernels are, along each axis [voxels].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kernel {
    /// Edges of the cells that the field is made of.
    pub cell: DVec3,
    /// Standard deviation of the narrow kernel.
    pub fine: DVec3,
    /// Standard deviation of the wide kernel.
    pub wide: DVec3,
}

/// What a smooth contact point is found on.
pub trait Field {
    /// The field at a point of its grid. Both levels have continuous gradients.
    fn sample(&self, point_in_grid: DVec3) -> FieldSample;

    /// The gradient of the wide level alone.
    fn wide_gradient(&self, point_in_grid: DVec3) -> DVec3 {
        self.sample(point_in_grid).wide.gradient
    }

    /// Its kernels.
    fn kernel(&self) -> &Kernel;
}
