//! Planes that cut, and a slab around the middle of the view.

use glam::DVec3;
use palpate_render::appearance::{Blend, Plane, Shown, ShownSegment};

use crate::common::{
    COLOUR, appearance, assert_near, ball, cube, one_ray, parallel, picture, request, scene,
};

#[test]
fn what_lies_before_a_plane_absorbs_nothing() {
    let block = scene(&cube(20, |_| 500.0));
    let mut look = appearance(Blend::Absorption, 0.1);
    look.clip.push(Plane {
        normal: DVec3::Z,
        offset: 12.5,
    });
    let seen = one_ray(&block, &look, (10.0, 10.0));
    assert_near(seen.opacity, 1.0 - f64::exp(-0.05 * 12.5), 2e-3);
    // another from below leaves a layer
    look.clip.push(Plane {
        normal: DVec3::NEG_Z,
        offset: -7.5,
    });
    let seen = one_ray(&block, &look, (10.0, 10.0));
    assert_near(seen.opacity, 1.0 - f64::exp(-0.05 * 5.0), 2e-3);
}

#[test]
fn a_cut_face_is_flat_and_lit_by_the_planes_normal() {
    let middle = DVec3::splat(20.0);
    let normal = DVec3::new(0.2, -0.3, 0.93).normalize();
    let scene = scene(&ball(40, 14.0));
    let bone = ShownSegment {
        id: 1,
        range: Some((500.0, 2000.0)),
        is_edited: false,
        shown: Shown::Solid,
        colour: COLOUR,
        ambient: 1.0,
        specular: 1.0,
    };
    for (blend, segments) in [(Blend::Iso, vec![]), (Blend::Shaded, vec![bone])] {
        let mut look = appearance(blend, 0.0);
        look.segments = segments;
        look.clip.push(Plane {
            normal,
            offset: normal.dot(middle),
        });
        let mut view = request(parallel(middle, DVec3::Z, 16.0), 24);
        view.is_in_haste = true;
        let drawn = picture(&scene, &look, &view);
        for pixel in 0..24 * 24 {
            let x = (f64::from(pixel % 24) + 0.5) / 24.0 - 0.5;
            let y = 0.5 - (f64::from(pixel / 24) + 0.5) / 24.0;
            let aside = 16.0 * (x * view.camera.right + y * view.camera.up);
            let depth = 500.0 + aside.dot(normal) / normal.z;
            assert_near(drawn.depths[pixel as usize], depth, 0.01);
        }
        let first = drawn.colours[0];
        assert!(first[0] > 0.3 && first[3] == 1.0, "{first:?}");
        for colour in &drawn.colours {
            for (channel, expected) in colour.iter().zip(first) {
                assert_near(*channel, expected, 1e-4);
            }
        }
    }
}

#[test]
fn a_slab_shows_its_thickness_around_the_middle_of_the_view() {
    let block = scene(&cube(20, |voxel| 100.0 * f64::from(voxel.z / 4)));
    let mut look = appearance(Blend::Mip, 1.0);
    look.slab = Some(3.0);
    let mut look_at = |z| {
        let camera = parallel(DVec3::new(10.0, 10.0, z), DVec3::Z, 1e-3);
        let absorbed = {
            look.blend = Blend::Absorption;
            picture(&block, &look, &request(camera, 1)).colours[0][3]
        };
        f64::from(absorbed)
    };
    // values of 200 from 8 to 12 and their extinction
    assert_near(look_at(10.0), 1.0 - f64::exp(-0.2 * 3.0), 5e-3);
    assert_near(look_at(18.0), 1.0 - f64::exp(-0.4 * 3.0), 5e-3);
    // half of it lies beyond the scan
    assert_near(look_at(20.0), 1.0 - f64::exp(-0.4 * 1.5), 5e-3);
}
