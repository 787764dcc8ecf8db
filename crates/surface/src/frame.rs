//! From samples to mm: where a vertex stands, and which way it looks.
//!
//! Positions are along the axes of the patient (LPS) [mm], counted from where the grid frame is
//! zero, so that single precision resolves every voxel wherever a scan stands.

use glam::{DMat3, DVec3};
use palpate_volume::grid::Grid;

/// The grid of a segment, as a surface needs it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    patient_from_grid: DMat3,
    normal_from_gradient: DMat3,
    /// Whether the grid's axes are left-handed, so that triangles turn the other way.
    pub(crate) mirrored: bool,
}

impl Frame {
    pub(crate) fn new(grid: &Grid) -> Self {
        let patient_from_grid = grid.patient_from_grid().matrix3;
        Self {
            patient_from_grid,
            normal_from_gradient: patient_from_grid.inverse().transpose(),
            mirrored: patient_from_grid.determinant() < 0.0,
        }
    }

    /// A point of the grid frame [mm from where the frame is zero, LPS].
    #[inline]
    pub(crate) fn position(&self, point_in_grid: DVec3) -> [f32; 3] {
        (self.patient_from_grid * point_in_grid)
            .as_vec3()
            .to_array()
    }

    /// Unit vector against a gradient taken along the grid's axes; none where it is zero.
    #[inline]
    pub(crate) fn normal(&self, gradient_in_grid: DVec3) -> Option<[f32; 3]> {
        let normal = -(self.normal_from_gradient * gradient_in_grid);
        let length = normal.length();
        // far below what any two different samples differ by
        (length > 1e-9).then(|| (normal / length).as_vec3().to_array())
    }
}
