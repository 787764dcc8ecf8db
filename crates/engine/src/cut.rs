//! Parts a segment by a plane. Frame: the scan, before the segment's pose; mm.

use glam::{DAffine3, DVec3};
use palpate_volume::grid::Grid;
use palpate_volume::segment::Segment;

/// A plane in the scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// A point of it [mm].
    pub point: DVec3,
    /// Out of it, of any length but zero.
    pub normal: DVec3,
}

impl Plane {
    /// The plane of the scene in the scan of a segment that stands at a pose; none where it has
    /// no direction or no place.
    #[must_use]
    pub fn in_scan(point: DVec3, normal: DVec3, pose: &DAffine3) -> Option<Self> {
        if !(point.is_finite() && normal.is_finite()) {
            return None;
        }
        // by the largest component first, so that no square over- or underflows
        let normal = (normal / normal.abs().max_element()).try_normalize()?;
        Some(Self {
            point: pose.inverse().transform_point3(point),
            normal: pose.matrix3.transpose() * normal,
        })
    }

    /// The voxels of a segment whose middles lie behind the plane, and those before it.
    #[must_use]
    pub fn part(&self, segment: &Segment, grid: &Grid) -> (Segment, Segment) {
        // (middle - point) · normal, as a sum along the voxel's axes
        let axes = grid.patient_from_grid().matrix3.transpose() * self.normal;
        let start = grid.patient_from_grid().transform_point3(DVec3::splat(0.5)) - self.point;
        let level = start.dot(self.normal);
        let side = |before: bool| {
            Segment::from_fn(segment.dimensions(), |voxel| {
                segment.contains(voxel) && (axes.dot(voxel.as_dvec3()) + level > 0.0) == before
            })
        };
        (side(false), side(true))
    }
}
