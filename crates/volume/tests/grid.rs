//! Frames of a grid, and what is refused.

use crate::support::Random;
use glam::{DAffine3, DMat3, DQuat, DVec3, IVec3, UVec3};
use palpate_volume::grid::{Grid, GridError};

const SPACING: DVec3 = DVec3::new(0.7, 0.8, 2.5);
const ORIGIN: DVec3 = DVec3::new(-120.5, -98.25, 1033.0);

fn grid(direction: DMat3) -> Grid {
    Grid::new(UVec3::new(512, 400, 133), SPACING, ORIGIN, direction).expect("a plain scan")
}

/// Any rotation, and its mirror image: ITK allows both.
fn directions() -> impl Iterator<Item = DMat3> {
    let mut random = Random::new(21);
    (0..50).map(move |number| {
        let axis = random.point(-1.0, 1.0).normalize();
        let rotation = DMat3::from_quat(DQuat::from_axis_angle(axis, random.number(0.0, 6.0)));
        let mirror = DVec3::new(1.0, 1.0, if number % 2 == 0 { 1.0 } else { -1.0 });
        rotation * DMat3::from_diagonal(mirror)
    })
}

#[test]
fn the_origin_is_the_centre_of_the_first_voxel() {
    for direction in directions() {
        let grid = grid(direction);
        let centre = grid.patient_from_grid().transform_point3(DVec3::splat(0.5));
        // 1e-12 mm is rounding of coordinates of some 1000 mm
        assert!((centre - ORIGIN).length() < 1e-12, "{centre}");
    }
}

/// ITK: point = origin + direction · (spacing · continuous index).
#[test]
fn a_grid_point_is_the_continuous_index_and_a_half() {
    let mut random = Random::new(22);
    for direction in directions() {
        let grid = grid(direction);
        let continuous_index = random.point(-1.0, 500.0);
        let itk = ORIGIN + direction * (SPACING * continuous_index);
        let ours = grid
            .patient_from_grid()
            .transform_point3(continuous_index + 0.5);
        // 1e-9 mm is rounding of sums of some 1000 mm
        assert!((itk - ours).length() < 1e-9, "{itk} {ours}");
    }
}

#[test]
fn the_transforms_are_inverse_to_one_another() {
    let mut random = Random::new(23);
    for direction in directions() {
        let grid = grid(direction);
        let there_and_back = grid.grid_from_patient() * grid.patient_from_grid();
        // 1e-9: an offset of 1000 mm over the smallest spacing, times rounding
        assert!(there_and_back.abs_diff_eq(DAffine3::IDENTITY, 1e-9));

        let point = random.point(-10.0, 600.0);
        let patient = grid.patient_from_grid().transform_point3(point);
        let back = grid.grid_from_patient().transform_point3(patient);
        assert!((back - point).length() < 1e-9, "{point} {back}");
    }
}

/// A rigid direction: lengths in mm need no matrix.
#[test]
fn lengths_in_mm_are_those_of_the_spacing() {
    let mut random = Random::new(24);
    for direction in directions() {
        let grid = grid(direction);
        let (a, b) = (random.point(0.0, 400.0), random.point(0.0, 400.0));
        let patient = [a, b].map(|point| grid.patient_from_grid().transform_point3(point));
        let length = ((a - b) * grid.spacing()).length();
        // 1e-9 mm is rounding of sums of some 1000 mm
        assert!((length - patient[0].distance(patient[1])).abs() < 1e-9);
    }
}

#[test]
fn sizes_are_those_of_the_voxels() {
    let grid = grid(DMat3::IDENTITY);
    assert_eq!(grid.voxel_count(), 512 * 400 * 133);
    assert_eq!(grid.smallest_spacing(), 0.7);
    // 1e-15 is rounding of the product
    assert!((grid.voxel_volume() - 1.4).abs() < 1e-15);
    assert_eq!(grid.bounds().voxel_count(), 512 * 400 * 133);
}

#[test]
fn memory_runs_along_x_then_y_then_z() {
    let grid = Grid::new(UVec3::new(3, 4, 5), SPACING, ORIGIN, DMat3::IDENTITY).expect("a scan");
    let places = grid.bounds().voxels().map(|voxel| grid.index(voxel));
    assert!(places.eq(0..60));
    assert_eq!(grid.index(IVec3::new(2, 3, 4)), 59);
}

#[test]
fn a_voxel_outside_is_not_contained() {
    let grid = Grid::new(UVec3::new(3, 4, 5), SPACING, ORIGIN, DMat3::IDENTITY).expect("a scan");
    for voxel in grid.bounds().dilate(2).voxels() {
        assert_eq!(grid.contains(voxel), grid.bounds().contains(voxel));
    }
    for far in [IVec3::MIN, IVec3::MAX] {
        assert!(!grid.contains(far));
    }
}

#[test]
fn a_point_lies_in_the_voxel_below_it() {
    let grid = grid(DMat3::IDENTITY);
    let voxel = |x: f64| grid.voxel_at(DVec3::new(x, 3.9, 0.0));
    assert_eq!(voxel(2.0), Some(IVec3::new(2, 3, 0)));
    assert_eq!(voxel(511.999), Some(IVec3::new(511, 3, 0)));
    for outside in [-1e-9, 512.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(voxel(outside), None, "{outside}");
    }
}

#[test]
fn dimensions_without_voxels_or_with_too_many_are_refused() {
    let new = |dimensions| Grid::new(dimensions, SPACING, ORIGIN, DMat3::IDENTITY);
    let refused = [
        UVec3::new(0, 5, 5),
        UVec3::new(5, 5, 65_536),
        UVec3::splat(65_535),
        UVec3::MAX,
    ];
    for dimensions in refused {
        assert_eq!(new(dimensions), Err(GridError::Dimensions(dimensions)));
    }
    assert!(new(UVec3::splat(2048)).is_ok());
}

#[test]
fn spacings_that_are_no_length_are_refused() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-300] {
        let spacing = DVec3::new(1.0, bad, 1.0);
        let result = Grid::new(UVec3::ONE, spacing, ORIGIN, DMat3::IDENTITY);
        assert!(matches!(result, Err(GridError::Spacing(_))), "{bad}");
    }
}

#[test]
fn an_origin_beyond_reason_is_refused() {
    for bad in [f64::NAN, f64::INFINITY, -1e12] {
        let result = Grid::new(
            UVec3::ONE,
            SPACING,
            DVec3::new(0.0, 0.0, bad),
            DMat3::IDENTITY,
        );
        assert!(matches!(result, Err(GridError::Origin(_))), "{bad}");
    }
}

#[test]
fn a_direction_that_shears_or_scales_is_refused() {
    let sheared = DMat3::from_cols(DVec3::X, DVec3::Y, DVec3::new(0.0, 0.32, 0.95));
    let rounded = DMat3::from_cols(
        DVec3::new(0.9998, 0.0, 0.0175),
        DVec3::Y,
        DVec3::new(-0.0175, 0.0, 0.9998),
    );
    let new = |direction| Grid::new(UVec3::ONE, SPACING, ORIGIN, direction);
    for bad in [sheared, DMat3::IDENTITY * 2.0, DMat3::ZERO, DMat3::NAN] {
        assert!(matches!(new(bad), Err(GridError::Direction(_))), "{bad}");
    }
    assert!(new(rounded).is_ok(), "cosines come rounded in DICOM");
}

#[test]
fn a_message_says_what_was_given_and_what_is_allowed() {
    let error = Grid::new(UVec3::new(0, 5, 5), SPACING, ORIGIN, DMat3::IDENTITY).expect_err("no x");
    let message = error.to_string();
    assert!(
        message.contains("[0, 5, 5]") && message.contains("allowed: 1 to 65535"),
        "{message}"
    );
}
