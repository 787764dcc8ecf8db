//! Cameras: side by side, in perspective, two eyes, and from within.

use glam::DVec3;
use palpate_render::appearance::Blend;
use palpate_render::camera::Camera;

use crate::common::{ALL, appearance, assert_near, ball, cube, parallel, picture, request, scene};

fn perspective(target: DVec3, back: DVec3, distance: f64) -> Camera {
    Camera {
        distance,
        field: 0.6,
        parallel: None,
        ..parallel(target, back, 1.0)
    }
}

#[test]
fn the_depth_of_a_plane_is_one_in_perspective_and_side_by_side() {
    // 500 is reached halfway between the voxels' middles
    let plane = scene(&cube(20, |voxel| if voxel.z < 10 { 1000.0 } else { 0.0 }));
    let look = appearance(Blend::Iso, 1.0);
    let top = DVec3::new(10.0, 10.0, 12.0);
    let side = request(parallel(top, DVec3::Z, 12.0), 16);
    for depth in picture(&plane, &look, &side).depths {
        assert_near(depth, 502.0, 0.05);
    }
    let mut near = request(perspective(top, DVec3::Z, 15.0), 16);
    for depth in picture(&plane, &look, &near).depths {
        assert_near(depth, 17.0, 0.05);
    }
    // a second eye sees it as far away
    near.camera.aside = 0.05;
    for depth in picture(&plane, &look, &near).depths {
        assert_near(depth, 17.0, 0.05);
    }
}

#[test]
fn an_eye_inside_the_scan_sees_what_is_before_it() {
    let block = scene(&cube(20, |_| 500.0));
    let middle = DVec3::splat(10.0);
    let inside = perspective(middle - DVec3::Z * 5.0, DVec3::Z, 5.0);
    let mut narrow = request(inside, 1);
    narrow.camera.field = 1e-4;
    let drawn = picture(&block, &appearance(Blend::Absorption, 0.1), &narrow);
    assert_near(drawn.colours[0][3], 1.0 - f64::exp(-0.05 * 10.0), 2e-3);
    for blend in ALL {
        let drawn = picture(&block, &appearance(blend, 0.1), &request(inside, 9));
        assert!(drawn.colours.as_flattened().iter().all(|it| it.is_finite()));
    }
}

#[test]
fn an_eye_that_looks_away_sees_nothing() {
    let block = scene(&cube(20, |_| 900.0));
    let away = perspective(DVec3::new(10.0, 10.0, 90.0), DVec3::NEG_Z, 30.0);
    for blend in ALL {
        let drawn = picture(&block, &appearance(blend, 1.0), &request(away, 8));
        assert!(
            drawn.colours.iter().all(|colour| colour[3] == 0.0),
            "{blend:?}"
        );
    }
}

#[test]
fn sizes_that_are_no_multiple_of_a_packet_are_the_same_picture() {
    let ball = scene(&ball(24, 8.0));
    let look = appearance(Blend::Iso, 1.0);
    // pixels of one mm each, about the same middle
    let drawn = |size: u32| {
        let camera = parallel(DVec3::splat(12.0), DVec3::Z, f64::from(size));
        picture(&ball, &look, &request(camera, size))
    };
    let (small, large) = (drawn(7), drawn(13));
    for y in 0..7 {
        for x in 0..7 {
            let (one, other) = (small.depths[x + 7 * y], large.depths[x + 3 + 13 * (y + 3)]);
            assert_near(one, other, 1e-3);
        }
    }
}

#[test]
fn numbers_that_no_camera_has_crash_nothing() {
    let ball = scene(&ball(16, 5.0));
    let good = perspective(DVec3::splat(8.0), DVec3::Z, 40.0);
    for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e300, 0.0] {
        let cameras = [
            Camera {
                target: DVec3::splat(bad),
                ..good
            },
            Camera {
                distance: bad,
                ..good
            },
            Camera {
                back: DVec3::splat(bad),
                ..good
            },
            Camera {
                right: DVec3::splat(bad),
                ..good
            },
            Camera { field: bad, ..good },
            Camera {
                parallel: Some(bad),
                ..good
            },
            Camera { aside: bad, ..good },
        ];
        for (camera, blend) in cameras
            .into_iter()
            .flat_map(|it| ALL.map(|blend| (it, blend)))
        {
            // that they are drawn at all is the test
            let drawn = picture(&ball, &appearance(blend, 1.0), &request(camera, 8));
            assert_eq!(drawn.colours.len(), 64);
        }
    }
}
