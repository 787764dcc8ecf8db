//! A smooth field whose level is the surface: near 1 inside a body, 0 outside.

use glam::DVec3;

/// A field at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FieldSample {
    /// 0..=1; the surface is where it is ½.
    pub value: f64,
    /// Per voxel, grid axes.
    pub gradient: DVec3,
}

/// What a smooth contact point is found on.
pub trait Field {
    /// The field at a point of its grid frame.
    fn sample(&self, point_in_grid: DVec3) -> FieldSample;

    /// Size of a cell [voxels].
    fn cell(&self) -> DVec3;

    /// Standard deviation of the kernel along each axis [voxels].
    fn sigma(&self) -> DVec3;
}
