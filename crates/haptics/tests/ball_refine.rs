//! Balls moved on from their cell to the place where they touch.

mod support;

use glam::{DVec3, IVec3, UVec3};
use palpate_haptics::ball_probe::ProbeSolid;
use palpate_haptics::placement::nearest_free;
use palpate_haptics::proxy::Proxy;
use support::{Body, Random, SPACINGS, advance, distance_to_solid, grid, hard, noise};

/// Guarantee 1 for the refined centre, which also comes nearer to the device, or stays.
#[test]
fn a_refined_ball_overlaps_nothing_and_is_no_farther_from_the_device() {
    const SIZE: u32 = 40;
    let [mut moved, mut touching] = [0, 0];
    for (spacing, radius) in [(0, 0.7), (0, 1.2), (0, 2.0), (0, 5.3), (1, 1.0), (1, 3.3)] {
        let spacing = SPACINGS[spacing];
        let radius_mm = radius * spacing.min_element();
        let grid = grid(UVec3::splat(SIZE), spacing);
        let reach = hard(radius, spacing).shape().reach().max_element() + 3;
        for seed in 0..6 {
            let body = noise(SIZE, 2.0 / (2.0 * radius + 1.0).powi(3), seed);
            let probe = ProbeSolid::new(body, Some(hard(radius, spacing)));
            let mut random = Random::new(seed);
            let mut device = DVec3::splat(20.0);
            let mut proxy = nearest_free(&probe, &grid, device, 20).expect("free");
            for _ in 0..1000 {
                device += random.direction() * random.between(0.0, 2.0);
                device = device.clamp(DVec3::splat(-4.0), DVec3::splat(44.0));
                advance(&probe, &grid, device, &mut proxy);
                let centre = probe.refined(&proxy, device);
                let distance = distance_to_solid(probe.inner(), spacing, centre, reach);
                // what is stated, and the rounding of lengths of some 10 mm
                assert!(distance >= radius_mm - 1.001e-9, "{distance} {radius_mm}");
                let [hard, refined] =
                    [proxy.point(), centre].map(|from| ((from - device) * spacing).length());
                assert!(refined <= hard + 1e-9);
                assert!((centre - proxy.point()).abs().max_element() <= 2.0);
                assert_eq!(probe.refined(&proxy, device), centre);
                moved += u32::from(refined < hard - 1e-3);
                touching += u32::from(distance < radius_mm + 1e-6);
            }
        }
    }
    assert!(moved > 5000 && touching > 5000, "{moved} {touching}");
}

#[test]
fn a_refined_ball_lies_on_a_floor_in_a_corner_and_on_an_edge_exactly() {
    let solid_below =
        |axes: usize| Body(move |v: IVec3| v.to_array()[..axes].iter().any(|&c| c < 20));
    for spacing in SPACINGS {
        let grid = grid(UVec3::splat(64), spacing);
        for radius in [0.7, 1.2, 2.0, 4.4] {
            let radius_mm = radius * spacing.min_element();
            // one, two and three walls: the ball touches each of them
            for walls in 1..=3 {
                let probe = ProbeSolid::new(solid_below(walls), Some(hard(radius, spacing)));
                let mut proxy = Proxy::at(DVec3::splat(31.3)).expect("finite");
                let device = DVec3::splat(19.1);
                advance(&probe, &grid, device, &mut proxy);
                let centre = probe.refined(&proxy, device);
                for axis in 0..3 {
                    let expected = if axis < walls {
                        20.0 + radius_mm / spacing[axis]
                    } else {
                        19.1
                    };
                    // each move keeps to its tolerance of 1e-9 mm
                    let off = (centre[axis] - expected) * spacing[axis];
                    assert!(off.abs() < 1e-8, "{radius} {walls} {centre}");
                }
            }
        }
    }

    // over a slot three voxels wide it hangs between the two edges
    let slot = Body(|v: IVec3| v.z < 20 && !(20..23).contains(&v.x));
    let grid = grid(UVec3::splat(64), DVec3::ONE);
    let probe = ProbeSolid::new(slot, Some(hard(2.5, DVec3::ONE)));
    let mut proxy = Proxy::at(DVec3::new(21.1, 7.5, 30.0)).expect("finite");
    let device = DVec3::new(21.5, 7.5, 15.0);
    advance(&probe, &grid, device, &mut proxy);
    let centre = probe.refined(&proxy, device);
    assert!(
        (centre - DVec3::new(21.5, 7.5, 22.0)).length() < 1e-7,
        "{centre}"
    );
}

/// A ball a little smaller than a channel has no free cell there; refined it dips in.
#[test]
fn a_ball_that_just_fits_dips_into_a_channel_by_less_than_two_cells() {
    let grid = grid(UVec3::splat(64), DVec3::ONE);
    let block = Body(|v: IVec3| v.z < 20 && (v.truncate() - 31).abs().max_element() > 1);
    let probe = ProbeSolid::new(block, Some(hard(1.2, DVec3::ONE)));
    let mut proxy = Proxy::at(DVec3::new(31.5, 31.5, 30.0)).expect("finite");
    let device = DVec3::new(31.6, 31.4, 5.0);
    advance(&probe, &grid, device, &mut proxy);
    assert_eq!(proxy.voxel(), IVec3::new(31, 31, 21));
    let centre = probe.refined(&proxy, device);
    assert!(centre.z < 20.001 && centre.z > 19.0, "{centre}");
}
