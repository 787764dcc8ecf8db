//! Where the probe can be placed: at a point, or in the free voxel nearest to it.

use glam::DVec3;
use palpate_haptics::admission::nearest_free_in;
use palpate_haptics::scene::TouchScene;
use palpate_volume::grid::Grid;
use palpate_volume::occupancy::Occupancy;

/// How far around a point is searched, along each axis [voxels].
pub const PLACEMENT_REACH: i32 = 64;

/// The free point nearest to `point` [mm], the point itself where it is free; none where no
/// voxel within reach is.
#[must_use]
pub fn free_point<O: Occupancy>(scene: &TouchScene<'_, O>, point: DVec3) -> Option<DVec3> {
    let grid = scene.grid;
    let point_in_grid = grid.grid_from_patient().transform_point3(point);
    let probe = nearest_free_in(scene, point_in_grid, PLACEMENT_REACH)?;
    if probe.point() == point_in_grid {
        return Some(point);
    }
    // the middle of the voxel, where that is free too: no rounding on the way to mm and back
    // leaves it
    let middle = probe.voxel().as_dvec3() + 0.5;
    let free = if scene.solid_at(middle).is_none() {
        middle
    } else {
        probe.point()
    };
    Some(grid.patient_from_grid().transform_point3(free))
}

/// In front of a scan: half a scan's width before its front side, in the middle of its other
/// sides, where nothing can be solid [mm].
#[must_use]
pub fn in_front_of(grid: &Grid) -> DVec3 {
    let corners = (0..8).map(|corner| {
        let share = DVec3::new(
            f64::from(corner & 1),
            f64::from(corner >> 1 & 1),
            f64::from(corner >> 2 & 1),
        );
        let corner_in_grid = share * grid.dimensions().as_dvec3();
        grid.patient_from_grid().transform_point3(corner_in_grid)
    });
    let (low, high) = corners.fold(
        (DVec3::INFINITY, DVec3::NEG_INFINITY),
        |(low, high), corner| (low.min(corner), high.max(corner)),
    );
    let middle = (low + high) * 0.5;
    // −y is anterior
    DVec3::new(middle.x, low.y - DISTANCE, middle.z)
}

/// Distance of the start from the front side [mm]: a hand's breadth of free way.
const DISTANCE: f64 = 20.0;

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat3, UVec3};
    use palpate_volume::bits::Bits;
    use palpate_volume::segment::Segment;

    fn grid() -> Grid {
        let turned = DMat3::from_rotation_z(0.3);
        Grid::new(
            UVec3::new(40, 30, 20),
            DVec3::new(0.5, 0.5, 2.0),
            DVec3::new(-10.0, 5.0, 100.0),
            turned,
        )
        .unwrap()
    }

    #[test]
    fn a_free_point_is_kept_to_the_bit() {
        let grid = grid();
        let empty = Bits::empty(grid.dimensions());
        let point = DVec3::new(-4.123, 9.7, 111.1);
        assert_eq!(
            free_point(&TouchScene::of_world(&empty, &grid), point),
            Some(point)
        );
    }

    #[test]
    fn a_point_in_a_solid_goes_to_the_nearest_free_voxel() {
        let grid = grid();
        // solid up to x = 30 voxels; the next free voxel center is half a voxel beyond
        let wall = Segment::from_fn(grid.dimensions(), |voxel| voxel.x < 30);
        let to_patient = |point| grid.patient_from_grid().transform_point3(point);
        let inside = to_patient(DVec3::new(27.2, 10.4, 9.1));
        let free = free_point(&TouchScene::of_world(&wall, &grid), inside).unwrap();
        let expected = to_patient(DVec3::new(30.5, 10.5, 9.5));
        // rounding of coordinates of some hundred mm
        assert!(free.distance(expected) < 1e-9, "{free} {expected}");
    }

    #[test]
    fn where_all_within_reach_is_solid_there_is_no_free_point() {
        let dimensions = UVec3::splat(200);
        let grid = Grid::new(dimensions, DVec3::ONE, DVec3::ZERO, DMat3::IDENTITY).unwrap();
        let full = Segment::from_fn(dimensions, |_| true);
        assert_eq!(
            free_point(&TouchScene::of_world(&full, &grid), DVec3::splat(100.0)),
            None
        );
    }

    #[test]
    fn the_start_is_anterior_of_every_voxel() {
        let grid = grid();
        let start = in_front_of(&grid);
        for corner in [DVec3::ZERO, DVec3::new(40.0, 0.0, 20.0)] {
            assert!(start.y < grid.patient_from_grid().transform_point3(corner).y);
        }
        let voxel = grid.grid_from_patient().transform_point3(start).floor();
        assert!(!grid.contains(voxel.as_ivec3()));
    }
}
