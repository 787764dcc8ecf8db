//! Scans of a few voxels, and grids that stand askew or are mirrored.

use glam::{DMat3, DVec3, UVec3};
use palpate_render::appearance::Blend;
use palpate_render::camera::Camera;
use palpate_volume::grid::Grid;
use palpate_volume::voxels::Voxels;

use crate::common::{
    ALL, appearance, assert_near, difference, grid, parallel, picture, request, scene, voxels_on,
};

#[test]
fn scans_of_one_column_one_row_one_slice_and_few_voxels_absorb_along_each_axis() {
    let sizes = [
        (1, 5, 6),
        (5, 1, 6),
        (5, 6, 1),
        (1, 1, 6),
        (2, 1, 1),
        (1, 2, 1),
        (1, 1, 2),
        (1, 1, 1),
        (9, 1, 17),
    ];
    for size in sizes.map(UVec3::from) {
        let spacing = DVec3::new(2.0, 3.0, 4.0);
        let scene = scene(&voxels_on(grid(size, spacing), |_| 500.0));
        let extent = size.as_dvec3() * spacing;
        for axis in DVec3::AXES {
            let way = extent.dot(axis);
            let view = request(parallel(extent / 2.0, axis, 0.5), 3);
            let drawn = picture(&scene, &appearance(Blend::Absorption, 0.04), &view);
            for colour in drawn.colours {
                assert_near(colour[3], 1.0 - f64::exp(-0.02 * way), 3e-3);
            }
        }
        for blend in ALL {
            let askew = DVec3::new(0.5, -0.6, 0.4).normalize();
            let drawn = picture(
                &scene,
                &appearance(blend, 1.0),
                &request(parallel(extent / 2.0, askew, 9.0), 11),
            );
            assert!(drawn.colours.as_flattened().iter().all(|it| it.is_finite()));
            assert!(
                drawn.colours.iter().any(|colour| colour[3] > 0.05),
                "{size} {blend:?}"
            );
        }
    }
}

/// Tissue that differs along each axis.
fn lopsided(place: DVec3) -> f64 {
    let ball = |x: f64, y: f64, z: f64, radius: f64| {
        (500.0 + 60.0 * (radius - place.distance(DVec3::new(x, y, z)))).clamp(0.0, 1000.0)
    };
    ball(8.0, 12.0, 9.0, 5.0).max(ball(16.0, 9.0, 14.0, 3.0))
}

fn upright() -> Voxels {
    voxels_on(grid(UVec3::splat(24), DVec3::ONE), |voxel| {
        lopsided(voxel.as_dvec3() + 0.5)
    })
}

fn view() -> Camera {
    parallel(
        DVec3::splat(12.0),
        DVec3::new(0.4, -0.7, 0.6).normalize(),
        26.0,
    )
}

#[test]
fn a_mirrored_grid_shows_the_same_patient() {
    let mirror = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
    // its first voxel is the upright one's last along x
    let origin = DVec3::new(23.5, 0.5, 0.5);
    let left = Grid::new(UVec3::splat(24), DVec3::ONE, origin, mirror).unwrap();
    let mirrored = voxels_on(left, |voxel| {
        lopsided(
            left.patient_from_grid()
                .transform_point3(voxel.as_dvec3() + 0.5),
        )
    });
    for blend in ALL {
        let look = appearance(blend, 1.0);
        let a = picture(&scene(&upright()), &look, &request(view(), 48));
        let b = picture(&scene(&mirrored), &look, &request(view(), 48));
        let (mean, far) = difference(&a, &b);
        assert!(mean < 0.1 && far < 2e-3, "{blend:?}: {mean} {far}");
    }
}

#[test]
fn a_grid_askew_shows_what_it_holds_turned_with_it() {
    let turn = DMat3::from_euler(glam::EulerRot::XYZ, 0.5, -0.3, 1.1);
    let middle = DVec3::splat(12.0);
    let origin = middle + turn * (DVec3::splat(0.5) - middle);
    let askew = Grid::new(UVec3::splat(24), DVec3::ONE, origin, turn).unwrap();
    let turned = voxels_on(askew, |voxel| lopsided(voxel.as_dvec3() + 0.5));
    let camera = view();
    let with_it = Camera {
        right: turn * camera.right,
        up: turn * camera.up,
        back: turn * camera.back,
        ..camera
    };
    for blend in ALL {
        let look = appearance(blend, 1.0);
        let a = picture(&scene(&upright()), &look, &request(camera, 48));
        let b = picture(&scene(&turned), &look, &request(with_it, 48));
        let (mean, far) = difference(&a, &b);
        assert!(mean < 0.1 && far < 2e-3, "{blend:?}: {mean} {far}");
    }
}
