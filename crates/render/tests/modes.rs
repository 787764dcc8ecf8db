//! Each mode of grey and the iso-surface against what can be reckoned along the ray.

use glam::{DVec3, Vec3};
use palpate_render::appearance::Blend;
use palpate_render::camera::Camera;
use palpate_volume::voxels::Voxels;

use crate::common::{
    COLOUR, appearance, assert_near, ball, cube, grey, parallel, picture, request, scene, value_at,
};

/// Blobs of a few voxels in air, each value another.
fn blobs() -> Voxels {
    let mut random = oorandom::Rand32::new(7);
    let blobs: Vec<(DVec3, f64)> = (0..25)
        .map(|_| {
            let mut place = || 3.0 + 18.0 * f64::from(random.rand_float());
            let middle = DVec3::new(place(), place(), place());
            (middle, 200.0 + 600.0 * f64::from(random.rand_float()))
        })
        .collect();
    cube(24, |voxel| {
        let place = voxel.as_dvec3() + 0.5;
        let sum: f64 = blobs
            .iter()
            .map(|(middle, peak)| peak * (-place.distance_squared(*middle) / 8.0).exp())
            .sum();
        sum.min(900.0)
    })
}

/// Values along the ray of a pixel, every 0.01 mm.
fn values_along(voxels: &Voxels, camera: &Camera, (x, y, size): (u32, u32, u32)) -> Vec<f64> {
    let across = (f64::from(x) + 0.5) / f64::from(size) - 0.5;
    let upward = 0.5 - (f64::from(y) + 0.5) / f64::from(size);
    let start = camera.target + camera.distance * (across * camera.right + upward * camera.up);
    let end = voxels.grid().dimensions().as_dvec3();
    (-4000..4000)
        .map(|i| start - 0.01 * f64::from(i) * camera.back)
        .filter(|place| place.cmpgt(DVec3::ZERO).all() && place.cmplt(end).all())
        .map(|place| value_at(voxels, place))
        .collect()
}

/// Compares a mode of grey with numbers from all values along each ray, given what counts as tissue; rays on which that
/// depends on a few units more or less, at the edges of tissue, are left out.
fn compare(blend: Blend, steps: f32, allowed: f64, expected: impl Fn(&[f64], f64) -> f64) {
    let voxels = blobs();
    let back = DVec3::new(0.5, -0.7, 0.4).normalize();
    let camera = parallel(DVec3::splat(12.0), back, 24.0);
    let size = 16;
    let mut view = request(camera, size);
    view.steps_per_voxel = steps;
    let drawn = picture(&scene(&voxels), &appearance(blend, 1.0), &view);
    let mut seen = 0;
    for pixel in 0..size * size {
        let values = values_along(&voxels, &camera, (pixel % size, pixel / size, size));
        if values.iter().any(|&value| value > 150.0) {
            let [least, value, most] = [80.0, 100.0, 120.0].map(|from| expected(&values, from));
            if least.max(most) - least.min(most) < 25.0 {
                let found = grey(drawn.colours[pixel as usize][0]);
                assert_near(found, value / 1000.0, allowed);
                seen += 1;
            }
        }
    }
    assert!(seen > 40, "{seen} rays met tissue");
}

/// From the first value of tissue to the last.
fn tissue(values: &[f64], from: f64) -> &[f64] {
    let is_tissue = |&value: &f64| value >= from;
    let first = values.iter().position(is_tissue).unwrap();
    &values[first..=values.iter().rposition(is_tissue).unwrap()]
}

#[test]
fn mip_is_the_largest_value_of_a_ray() {
    let largest = |values: &[f64], _| values.iter().fold(0.0, |a, &b| f64::max(a, b));
    compare(Blend::Mip, 4.0, 0.004, largest);
    // of two blobs, the sample nearer to its middle is refined
    compare(Blend::Mip, 1.0, 0.03, largest);
}

#[test]
fn minip_is_the_least_between_the_first_tissue_and_the_last() {
    compare(Blend::MinIp, 4.0, 0.03, |values, from| {
        let tissue = tissue(values, from);
        tissue.iter().fold(1e9, |a, &b| f64::min(a, b))
    });
}

#[test]
fn the_average_is_that_between_the_first_tissue_and_the_last() {
    compare(Blend::Average, 4.0, 0.025, |values, from| {
        let tissue = tissue(values, from);
        tissue.iter().sum::<f64>() / tissue.len() as f64
    });
}

#[test]
fn minip_finds_a_hole_within_tissue() {
    let hole = DVec3::new(12.0, 12.0, 9.0);
    let voxels = cube(24, |voxel| {
        let away = (voxel.as_dvec3() + 0.5).distance(hole);
        200.0 + 600.0 * (away / 6.0).min(1.0)
    });
    let camera = parallel(DVec3::splat(12.0), DVec3::Z, 0.1);
    let drawn = picture(
        &scene(&voxels),
        &appearance(Blend::MinIp, 1.0),
        &request(camera, 1),
    );
    let values = values_along(&voxels, &camera, (0, 0, 1));
    let expected = values.iter().fold(1e9, |a, &b| f64::min(a, b));
    assert!(expected < 300.0);
    assert_near(grey(drawn.colours[0][0]), expected / 1000.0, 0.006);
}

/// Pixels of a ball in perspective, from the middle outward, and where its surface is met.
fn places_on_ball(camera: &Camera, size: u32, radius: f64) -> Vec<(usize, DVec3)> {
    let eye = camera.eye();
    let half = (camera.field / 2.0).tan();
    (0..size * size)
        .filter_map(|pixel| {
            let (x, y) = (f64::from(pixel % size), f64::from(pixel / size));
            let across = (2.0 * (x + 0.5) / f64::from(size) - 1.0) * half;
            let upward = (1.0 - 2.0 * (y + 0.5) / f64::from(size)) * half;
            let ray = across * camera.right + upward * camera.up - camera.back;
            let from = eye - camera.target;
            let (a, b) = (ray.length_squared(), ray.dot(from));
            let root = b * b - a * (from.length_squared() - radius * radius);
            // not at its rim, where a ray runs along it
            (root > 0.3 * b * b * 0.02).then(|| {
                let length = (-b - root.sqrt()) / a;
                (pixel as usize, eye + length * ray)
            })
        })
        .collect()
}

fn on_ball() -> (Camera, f64) {
    let back = DVec3::new(0.3, -0.8, 0.52).normalize();
    let camera = Camera {
        distance: 90.0,
        field: 0.4,
        parallel: None,
        ..parallel(DVec3::splat(20.0), back, 1.0)
    };
    (camera, 12.0)
}

#[test]
fn the_iso_surface_of_a_ball_is_where_it_is_to_a_tenth_of_a_voxel() {
    let (camera, radius) = on_ball();
    let mut view = request(camera, 48);
    view.steps_per_voxel = 2.0;
    let drawn = picture(
        &scene(&ball(40, radius)),
        &appearance(Blend::Iso, 1.0),
        &view,
    );
    let places = places_on_ball(&camera, 48, radius);
    assert!(places.len() > 500, "{} pixels", places.len());
    for (pixel, place) in places {
        let depth = (camera.eye() - place).dot(camera.back);
        assert_near(drawn.depths[pixel], depth, 0.1);
    }
}

#[test]
fn the_iso_surface_is_lit_by_its_normal() {
    let (camera, radius) = on_ball();
    let mut view = request(camera, 48);
    view.is_in_haste = true;
    let drawn = picture(
        &scene(&ball(40, radius)),
        &appearance(Blend::Iso, 1.0),
        &view,
    );
    for (pixel, place) in places_on_ball(&camera, 48, radius) {
        let normal = (place - camera.target).normalize();
        let expected = light_on(normal, (camera.eye() - place).normalize(), &camera);
        let found = Vec3::from_slice(&drawn.colours[pixel]);
        // normals of central differences over voxels of a ball
        assert_near(found.distance(expected), 0.0, 0.04);
    }
}

/// Blinn's light on a surface of `COLOUR` as `docs/understand/optics.md` has it, with all of sky and lamp.
fn light_on(normal: DVec3, to_eye: DVec3, camera: &Camera) -> Vec3 {
    let lamp = camera.lamp();
    let share = 0.5 + 0.5 * normal.dot(camera.up);
    let sky = Vec3::new(0.14, 0.11, 0.10).lerp(Vec3::new(0.36, 0.38, 0.42), share as f32);
    let key = normal.dot(lamp).max(0.0) as f32;
    let direct = 0.82 * key * Vec3::new(1.06, 1.0, 0.92);
    let rim = 0.04 * (1.0 - normal.dot(to_eye).max(0.0)) as f32;
    let highlight = normal.dot((lamp + to_eye).normalize()).max(0.0).powf(28.0) as f32;
    COLOUR * (sky + direct + rim) + 0.16 * highlight
}

/// A ray along z through a block of tissue from `near` to `far` voxels below the top, in which one layer is densest.
fn haze_of(blend: Blend) -> f64 {
    let voxels = cube(24, |voxel| match voxel.z {
        9 => 900.0,
        6..18 => 400.0,
        _ => 0.0,
    });
    let mut view = request(parallel(DVec3::splat(12.0), DVec3::Z, 0.1), 1);
    view.steps_per_voxel = 4.0;
    f64::from(picture(&scene(&voxels), &appearance(blend, 1e-3), &view).depths[0])
}

#[test]
fn where_all_of_a_ray_is_seen_depth_is_that_of_its_middle_below_zero() {
    // rays begin 500 mm before the middle, at z = 512
    let (densest, middle) = (9.5 - 512.0, 12.0 - 512.0);
    assert_near(haze_of(Blend::Mip), densest, 0.3);
    assert_near(haze_of(Blend::Average), middle, 0.6);
    // by extinction, which is in proportion to the value: 900 beside eleven times 400
    let sum: f64 = (6..18).map(|z| if z == 9 { 900.0 } else { 400.0 }).sum();
    let weighted: f64 = (6..18)
        .map(|z| f64::from(z) + 0.5)
        .map(|z| z * if z == 9.5 { 900.0 } else { 400.0 })
        .sum();
    let mean = weighted / sum - 512.0;
    assert_near(haze_of(Blend::Absorption), mean, 0.3);
    assert_near(haze_of(Blend::Emission), mean, 0.3);
    assert!(haze_of(Blend::Shaded).is_infinite());
}
