//! A smooth field whose level is the surface: near 1 inside a body, near 0 outside.
//!
//! Frame: the field's own *nodes*: its window has eight along each axis, numbered from 0, one
//! apart. They are few and near, so that single precision is plenty.

use glam::{DVec3, Vec3A};

/// A field of one width at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Level {
    /// 0..=1; the surface is where it is ½.
    pub value: f32,
    /// Change per node along each axis.
    pub gradient: Vec3A,
}

/// A field at a point, blurred by two kernels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FieldSample {
    /// Sample of the narrow kernel, which follows edges and small features.
    pub fine: Level,
    /// Sample of the wide kernel, which smooths the stairs of voxels away.
    pub wide: Level,
}

/// How wide a field's kernels are, along each axis [nodes]: standard deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kernel {
    /// Standard deviation of the narrow kernel.
    pub fine: Vec3A,
    /// Standard deviation of the wide kernel.
    pub wide: Vec3A,
}

/// What a smooth contact point is found on.
pub trait Field {
    /// The field at a point. Both levels have continuous gradients.
    fn sample(&self, point_in_nodes: Vec3A) -> FieldSample;

    /// The value of the wide level alone.
    fn wide_value(&self, point_in_nodes: Vec3A) -> f32 {
        self.sample(point_in_nodes).wide.value
    }

    /// The kernels of the field.
    fn kernel(&self) -> &Kernel;

    /// Distance between nodes along each axis of the grid of its body [voxels].
    fn cell(&self) -> Vec3A;

    /// A point of that grid, near the window, among the nodes.
    fn nodes_at(&self, point_in_grid: DVec3) -> Vec3A;
}
