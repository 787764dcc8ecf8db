//! The voxels that a ball passes over: a capsule, the ball's way from one pass to the next.
//!
//! A voxel belongs to it where its centre is at most the radius from the way [mm], so voxels
//! of any spacing are told exactly, and two sweeps that share an end leave no gap.
//!
//! Frame: patient (LPS mm) for points, grid for voxels.

use glam::{DAffine3, DVec3, IVec3};
use palpate_volume::grid::Grid;
use palpate_volume::voxel_box::VoxelBox;

/// Boxes along the way, at most: a long oblique way would else have one box that is nearly
/// all air.
const MAX_BOXES: f64 = 256.0;

/// Share by which two squared lengths may differ and be the same: a voxel that is a radius away but
/// for rounding is, to all sides.
pub(crate) const SAME: f64 = 1e-6;

/// A ball that moves along a straight way.
#[derive(Clone, Debug)]
pub(crate) struct Sweep {
    from: DVec3,
    to: DVec3,
    radius: f64,
    patient_from_grid: DAffine3,
    boxes: Vec<VoxelBox>,
}

impl Sweep {
    /// The way of a ball of `radius` [mm] between two finite points [mm].
    pub(crate) fn new(grid: &Grid, from: DVec3, to: DVec3, radius: f64) -> Self {
        Self {
            from,
            to,
            radius,
            patient_from_grid: grid.patient_from_grid(),
            boxes: boxes(grid, from, to, radius),
        }
    }

    /// Boxes inside the grid that hold every voxel of the sweep together; they overlap.
    pub(crate) fn boxes(&self) -> &[VoxelBox] {
        &self.boxes
    }

    /// Whether the voxel's centre is swept over.
    pub(crate) fn holds(&self, voxel: IVec3) -> bool {
        let centre = centre_of(&self.patient_from_grid, voxel);
        let nearest = nearest_on_way(self.from, self.to, centre);
        nearest.distance_squared(centre) <= self.radius * self.radius * (1.0 + SAME)
    }
}

/// The centre of a voxel [mm].
pub(crate) fn centre_of(patient_from_grid: &DAffine3, voxel: IVec3) -> DVec3 {
    patient_from_grid.transform_point3(voxel.as_dvec3() + 0.5)
}

/// The point of a way that is nearest to another point.
pub(crate) fn nearest_on_way(from: DVec3, to: DVec3, point: DVec3) -> DVec3 {
    let way = to - from;
    let length_squared = way.length_squared();
    if length_squared == 0.0 {
        return from;
    }
    let share = (point - from).dot(way) / length_squared;
    from + way * share.clamp(0.0, 1.0)
}

/// A box for each piece of the way, inside the grid.
fn boxes(grid: &Grid, from: DVec3, to: DVec3, radius: f64) -> Vec<VoxelBox> {
    let piece = (2.0 * radius).max(8.0 * grid.smallest_spacing());
    let pieces = (from.distance(to) / piece).ceil().clamp(1.0, MAX_BOXES);
    (0..pieces as u32)
        .map(|i| {
            let [start, end] = [i, i + 1].map(|i| from.lerp(to, f64::from(i) / pieces));
            ball_box(grid, start, radius).union(&ball_box(grid, end, radius))
        })
        .map(|region| region.intersect(&grid.bounds()))
        .filter(|region| !region.is_empty())
        .collect()
}

/// The voxels that a ball meets, and maybe some more.
fn ball_box(grid: &Grid, centre: DVec3, radius: f64) -> VoxelBox {
    let grid_from_patient = grid.grid_from_patient();
    let centre = grid_from_patient.transform_point3(centre);
    // along an axis of the grid, a ball reaches as far as that axis' row is long
    let rows = grid_from_patient.matrix3.transpose();
    let reach = radius
        * DVec3::new(
            rows.x_axis.length(),
            rows.y_axis.length(),
            rows.z_axis.length(),
        );
    VoxelBox::new(
        (centre - reach).floor().as_ivec3(),
        (centre + reach).ceil().as_ivec3(),
    )
}
