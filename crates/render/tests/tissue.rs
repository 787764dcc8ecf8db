//! Tissue absorbs by Beer and Lambert, whatever the step.

use glam::{DVec3, IVec3};
use palpate_render::appearance::Blend;

use crate::common::{
    COLOUR, appearance, assert_near, ball, cube, difference, one_ray, parallel, picture, request,
    scene,
};

const MIDDLE: (f64, f64) = (10.0, 10.0);

#[test]
fn a_homogeneous_block_absorbs_by_beer_and_lambert() {
    let block = scene(&cube(20, |_| 500.0));
    let expected = 1.0 - f64::exp(-0.05 * 20.0);
    for blend in [Blend::Composite, Blend::Shaded, Blend::Absorption] {
        let seen = one_ray(&block, &appearance(blend, 0.1), MIDDLE);
        assert_near(seen.opacity, expected, 2e-3);
    }
    let seen = one_ray(&block, &appearance(Blend::Composite, 0.1), MIDDLE);
    assert_near((seen.colour / seen.opacity).distance(COLOUR), 0.0, 1e-3);
    let seen = one_ray(&block, &appearance(Blend::Absorption, 0.1), MIDDLE);
    assert_near(seen.colour.x, expected, 2e-3);
}

#[test]
fn what_is_emitted_is_extinction_times_the_way() {
    let block = scene(&cube(20, |_| 500.0));
    let seen = one_ray(&block, &appearance(Blend::Emission, 0.02), MIDDLE);
    assert_near(seen.colour.distance(COLOUR * 0.01 * 20.0), 0.0, 2e-3);
}

#[test]
fn density_is_a_factor_on_extinction_and_homogeneous_tissue_loses_its_share() {
    let block = scene(&cube(20, |_| 500.0));
    let mut thin = appearance(Blend::Composite, 0.1);
    thin.density = 0.5;
    assert_near(
        one_ray(&block, &thin, MIDDLE).opacity,
        1.0 - f64::exp(-0.5),
        2e-3,
    );
    thin.lighting.edges = 0.75;
    assert_near(
        one_ray(&block, &thin, MIDDLE).opacity,
        1.0 - f64::exp(-0.125),
        2e-3,
    );
}

#[test]
fn depth_is_where_half_of_the_light_is_gone() {
    let block = scene(&cube(20, |_| 500.0));
    let seen = one_ray(&block, &appearance(Blend::Composite, 0.2), MIDDLE);
    assert_near(seen.depth, f64::ln(2.0) / 0.1, 1.0);
    let clear = one_ray(&block, &appearance(Blend::Composite, 0.02), MIDDLE);
    assert!(clear.depth.is_infinite(), "{clear:?}");
}

#[test]
fn values_between_two_samples_are_not_missed() {
    // a thin shell of tissue by its value, between air and an empty inside
    let layered = scene(&cube(
        16,
        |voxel: IVec3| if voxel.z < 8 { 1000.0 } else { 0.0 },
    ));
    let mut shell = appearance(Blend::Absorption, 1.0);
    for (point, value, extinction) in [(0, 450.0, 0.0), (1, 550.0, 0.0)] {
        shell.transfer[point].value = value;
        shell.transfer[point].extinction = extinction;
    }
    let mut top = shell.transfer[0];
    (top.value, top.extinction) = (500.0, 2.0);
    shell.transfer.insert(1, top);
    // it is a tenth of a voxel thick, of a mean extinction of 1
    let expected = 1.0 - f64::exp(-0.1);
    for steps in [1.0, 4.0] {
        let seen_at = |target| {
            let mut view = request(parallel(target, DVec3::Z, 1e-3), 1);
            view.steps_per_voxel = steps;
            f64::from(picture(&layered, &shell, &view).colours[0][3])
        };
        assert_near(seen_at(DVec3::new(8.0, 8.0, 16.0)), expected, 0.01);
        assert_near(seen_at(DVec3::new(5.3, 9.1, 15.7)), expected, 0.01);
    }
}

#[test]
fn the_step_changes_cost_and_not_look() {
    let ball = scene(&ball(40, 12.0));
    let back = DVec3::new(0.4, -0.8, 0.45).normalize();
    for (blend, full) in [
        (Blend::Shaded, 1.5),
        (Blend::Composite, 0.3),
        (Blend::Absorption, 0.05),
        (Blend::Iso, 1.0),
        (Blend::Mip, 1.0),
    ] {
        let drawn = [1.0, 2.0, 4.0].map(|steps| {
            let mut request = request(parallel(DVec3::splat(20.0), back, 34.0), 96);
            request.steps_per_voxel = steps;
            picture(&ball, &appearance(blend, full), &request)
        });
        for coarse in &drawn[..2] {
            let (mean, far) = difference(coarse, &drawn[2]);
            assert!(mean <= 2.0, "{blend:?}: mean difference {mean} of 255");
            assert!(far <= 1e-3, "{blend:?}: {far} of all differ by more than 8");
        }
    }
}
